#!/usr/bin/env bash
# What `make deb` runs: Debian packages of what lies here, into out/deb.
#
#   tools/deb.sh [JOBS]
#
#     files of this folder, web/dist ---> build/deb/lariat-VERSION ---> build/deb/objects
#     packaging/debian                    (debian/ in it)               dpkg-buildpackage ---> out/deb
#
# The version is that of CMakeLists.txt, and the changelog is made of it. The page is built before,
# since npm fetches from the network, which a package's build may not. DEBFULLNAME and DEBEMAIL say
# whose packages these are. With LARIAT_BUILT=FOLDER that build is packed as it is, into
# $LARIAT_DEB_OUT, with which a test looks at the packages in some seconds.
set -euo pipefail
cd "$(dirname "$0")/.."
jobs=${1:-2}
out=${LARIAT_DEB_OUT:-$PWD/out/deb}
work=${LARIAT_DEB_WORK:-$PWD/build/deb}

fail() {
    echo "deb: $*" >&2
    exit 1
}
version=$(sed -n 's/^project(lariat VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
[ -n "$version" ] || fail "CMakeLists.txt names no version"
[ -e web/dist/index.html ] ||
    fail "the viewer's page is not there; tools/web.sh --required makes it and says what it lacks"
maintainer="${DEBFULLNAME:-The Lariat developers} <${DEBEMAIL:-packages@lariat.invalid}>"

# A folder of its own: Debian's tools want debian/ at the top, and leave much behind.
source=$work/lariat-$version
rm -rf "$source" "$out"
mkdir -p "$source" "$out"
if git rev-parse --git-dir >/dev/null 2>&1; then
    git ls-files -z --cached --others --exclude-standard
else
    find . -name node_modules -prune -o \( -path ./build -o -path ./out \) -prune -o -type f -print0
fi | while IFS= read -r -d '' file; do [ ! -e "$file" ] || printf '%s\0' "$file"; done |
    tar -c --null -T - | tar -x -C "$source"
mkdir -p "$source/web/dist"
cp -r web/dist/. "$source/web/dist/"
mv "$source/packaging/debian" "$source/debian"
sed -i "s/@MAINTAINER@/$maintainer/" "$source/debian/control"
date=$(git log -1 --format=%cD 2>/dev/null) || date=$(date -R -r CMakeLists.txt)
cat >"$source/debian/changelog" <<END
lariat ($version) unstable; urgency=medium

  * Version $version, packed by Lariat's own "make deb".

 -- $maintainer  $date
END

export LARIAT_OBJECTS=../objects
export DEB_BUILD_OPTIONS="parallel=$jobs nocheck noautodbgsym ${DEB_BUILD_OPTIONS:-}"
log=$work/log
if ! (cd "$source" && dpkg-buildpackage --build=binary --no-sign --no-pre-clean) >"$log" 2>&1; then
    tail -n 40 "$log" >&2
    fail "dpkg-buildpackage failed, see above and $log"
fi
mv "$work"/*_"$version"_*.deb "$work/lariat_${version}"_*.changes "$work/lariat_${version}"_*.buildinfo "$out/"
rm -rf "$source"
if [ -z "${LARIAT_BUILT:-}" ] && command -v lintian >/dev/null; then
    lintian --fail-on error "$out"/*.changes >&2 || fail "lintian found errors, see above"
fi
(cd "$out" && ls -1 ./*.deb | sed "s|^\./|$out/|")
