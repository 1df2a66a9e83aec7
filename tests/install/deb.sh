#!/bin/sh
# Debian packages: what is in them and what they depend on, in some seconds: what is built already is
# divided by packaging/debian, but not compiled anew, compressed or installed (deb_bare.sh does).
#
#   deb.sh SOURCE BUILD SCRATCH
#
# 1. One version everywhere. 2. Every file that is installed is in one package, and every line of
# the lists finds one. 3. Dependencies follow from the programs. 4. A command on the PATH finds the
# page that is installed with it.
set -eu
source=$1 build=$2 scratch=$3
fail() {
    echo "deb: $*" >&2
    exit 1
}

version=$(sed -n 's/^project(lariat VERSION \([0-9.]*\).*/\1/p' "$source/CMakeLists.txt")
grep -qx "version: $version" "$source/CITATION.cff" || fail "CITATION.cff has another version than $version"
grep -q "\"version\": \"$version\"" "$source/web/package.json" || fail "web/package.json has another version than $version"
grep -q '^dynamic = \["version"\]$' "$source/pyproject.toml" || fail "pyproject.toml has a version of its own"

for tool in dh dh_python3 dpkg-shlibdeps cmake; do
    command -v $tool >/dev/null || { echo "skipped: $tool is missing (tools/setup.sh deb)"; exit 77; }
done
for product in liblariat.so.0 liblariat.a help/man/man1/lariat.1; do
    [ -e "$build/$product" ] || fail "the products are not built: no $product"
done
[ -e "$build/liblariat-fit.so.0" ] || { echo "skipped: built without cminpack"; exit 77; }
for part in web/dist/index.html:the-page build/python/lariat/_lariat.abi3.so:the-Python-module; do
    case $part in
    build/*) file=$build/${part#build/} ;;
    *) file=$source/$part ;;
    esac
    [ -e "${file%:*}" ] || { echo "skipped: ${part#*:} is not built"; exit 77; }
done

rm -rf "$scratch"
mkdir -p "$scratch"
folder=$scratch/source
bash "$source/tools/deb.sh" --prepare "$folder"
cd "$folder"
eval "$(dpkg-architecture -s)"
export LARIAT_BUILT="$build" DEB_BUILD_OPTIONS="nocheck noautodbgsym"
{
    debian/rules override_dh_auto_install && dh_install && dh_missing && dh_python3 &&
        dh_makeshlibs -a && dh_shlibdeps -a && dh_gencontrol
} >"$scratch/log" 2>&1 || { tail -n 20 "$scratch/log" >&2; fail "debhelper failed, see above"; }

# holds PACKAGE FILE...
holds() {
    package=$1
    shift
    for file in "$@"; do
        # shellcheck disable=SC2086 # a pattern
        set -- debian/$package/$file
        [ -e "$1" ] || [ -L "$1" ] || fail "$package lacks $file"
    done
}
holds liblariat0 'usr/lib/*/liblariat.so.0'
holds liblariat-fit0 'usr/lib/*/liblariat-fit.so.0'
holds liblariat-dev usr/include/lariat.h usr/include/lariat_sizes.h usr/include/lariat.hpp usr/include/lariat_fit.h \
    'usr/lib/*/liblariat-fit.so' 'usr/lib/*/liblariat-fit.a' 'usr/lib/*/pkgconfig/lariat-fit.pc' \
    'usr/lib/*/liblariat.so' 'usr/lib/*/liblariat.a' 'usr/lib/*/pkgconfig/lariat.pc' 'usr/lib/*/cmake/Lariat/LariatConfig.cmake'
holds lariat usr/bin/lariat usr/share/man/man1/lariat-run.1 usr/share/zsh/vendor-completions/_lariat
holds lariat-viewer usr/share/lariat/viewer/index.html
holds python3-lariat usr/lib/python3/dist-packages/lariat/_lariat.abi3.so \
    usr/lib/python3/dist-packages/lariat/__init__.pyi

# depends PACKAGE PATTERN...
depends() {
    package=$1
    shift
    line=$(sed -n 's/^Depends: //p' "debian/$package/DEBIAN/control")
    for pattern in "$@"; do
        echo ", $line," | grep -Eq ", ${pattern}[ ,]" || fail "$package does not depend on $pattern: $line"
    done
    grep -qx "Version: $version" "debian/$package/DEBIAN/control" || fail "$package has another version"
}
depends liblariat0 libc6 'libxml2[a-z0-9]*' libyaml-0-2 'zlib1g'
depends liblariat-fit0 "liblariat0 \(= $version\)" libc6 'libcminpack[0-9]*'
! grep -q '^Depends: .*cminpack' debian/liblariat0/DEBIAN/control || fail "the library needs what only fits need"
depends lariat libc6 libyaml-0-2
depends liblariat-dev "liblariat0 \(= $version\)" "liblariat-fit0 \(= $version\)"
depends python3-lariat "liblariat0 \(= $version\)" "lariat \(= $version\)" 'python3 \(>= 3.11\)'
! grep -q '^Depends: .*liblariat' debian/lariat-viewer/DEBIAN/control || fail "the page needs a library"
! grep -rl "$source/" debian/*/usr/lib/*/pkgconfig debian/*/usr/lib/*/cmake 2>/dev/null ||
    fail "these files name the machine that built them"

# By its bare name, from a folder where there is something else of that name.
if command -v python3 >/dev/null && "$build/lariat" view --help >/dev/null 2>&1; then
    mkdir "$scratch/elsewhere"
    : >"$scratch/elsewhere/lariat"
    echo '<title>installed</title>' >debian/tmp/usr/share/lariat/viewer/index.html
    (cd "$scratch/elsewhere" && PATH="$folder/debian/tmp/usr/bin:$PATH" exec lariat view \
        "$source/examples/beam.yaml" --seconds 30 >"$scratch/view" 2>&1) &
    view=$!
    waited=0
    until grep -q '^http' "$scratch/view" || [ $waited -ge 200 ]; do
        sleep 0.1
        waited=$((waited + 1))
    done
    page=$(python3 -B -c 'import sys, urllib.request
print(urllib.request.urlopen(sys.argv[1]).read().decode())' "$(grep '^http' "$scratch/view")") || page=none
    kill $view 2>/dev/null || true
    wait $view || true
    [ "$page" = "<title>installed</title>
" ] || [ "$page" = "<title>installed</title>" ] || fail "a command on the PATH serves another page: $page"
fi
rm -rf "$folder"
echo "deb: six packages of version $version, each file in one of them"
