#!/usr/bin/env bash
# What `make deb` runs: Debian packages of what lies here, into out/deb.
#
#   tools/deb.sh [JOBS]
#   tools/deb.sh --prepare FOLDER      FOLDER as it would be packed, and nothing else: for a test
#
#     files of this folder, web/dist ---> build/deb/lariat-VERSION ---> build/deb/objects
#     packaging/debian                    (debian/ in it)               dpkg-buildpackage ---> out/deb
#
# The version is that of CMakeLists.txt, and the changelog is made of it. The page is built before,
# since npm fetches from the network, which a package's build may not. DEBFULLNAME and DEBEMAIL say
# whose packages these are.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() {
    echo "deb: $*" >&2
    exit 1
}
version=$(sed -n 's/^project(lariat VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
[ -n "$version" ] || fail "CMakeLists.txt names no version"
maintainer="${DEBFULLNAME:-The Lariat developers} <${DEBEMAIL:-packages@lariat.invalid}>"
out=$PWD/out/deb work=$PWD/build/deb
source=$work/lariat-$version
[ "${1:-}" != --prepare ] || source=$2

# A folder of its own: Debian's tools want debian/ at the top, and leave much behind.
rm -rf "$source"
mkdir -p "$source/web/dist"
if git rev-parse --git-dir >/dev/null 2>&1; then
    git ls-files -z --cached --others --exclude-standard
else
    find . -name node_modules -prune -o \( -path ./build -o -path ./out \) -prune -o -type f -print0
fi | while IFS= read -r -d '' file; do [ ! -e "$file" ] || printf '%s\0' "$file"; done |
    tar -c --null -T - | tar -x -C "$source"
cp -r web/dist/. "$source/web/dist/" 2>/dev/null || true
mv "$source/packaging/debian" "$source/debian"
control=$(<"$source/debian/control")
printf '%s\n' "${control//@MAINTAINER@/"$maintainer"}" >"$source/debian/control"
date=$(git log -1 --format=%cD 2>/dev/null) || date=$(date -R -r CMakeLists.txt)
cat >"$source/debian/changelog" <<END
lariat ($version) unstable; urgency=medium

  * Version $version, packed by Lariat's own "make deb".

 -- $maintainer  $date
END

[ "${1:-}" != --prepare ] || exit 0
[ -e web/dist/index.html ] ||
    fail "the viewer's page is not there; tools/web.sh --required makes it and says what it lacks"

export LARIAT_OBJECTS=../objects
export DEB_BUILD_OPTIONS="parallel=${1:-2} nocheck noautodbgsym ${DEB_BUILD_OPTIONS:-}"
log=$work/log
# CMake keeps the flags with which a build folder was made.
flags=$(cat packaging/debian/rules && dpkg-buildflags)
[ "$flags" = "$(cat "$work/flags" 2>/dev/null)" ] || rm -rf "$work/objects"
printf '%s\n' "$flags" >"$work/flags"
if ! (cd "$source" && dpkg-buildpackage --build=binary --no-sign --no-pre-clean) >"$log" 2>&1; then
    tail -n 40 "$log" >&2
    fail "dpkg-buildpackage failed, see above and $log"
fi
rm -rf "$out" "$source"
mkdir -p "$out"
mv "$work"/*_"$version"_*.deb "$work/lariat_${version}"_*.changes "$work/lariat_${version}"_*.buildinfo "$out/"
if command -v lintian >/dev/null; then
    lintian --allow-root --fail-on error "$out"/*.changes >&2 || fail "lintian found errors, see above"
fi
ls -1 "$out"/*.deb
