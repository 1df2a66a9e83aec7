#!/bin/sh
# tools/setup.sh on machines that are made up: what `make` and `make demo` ask for does everything
# that README.md shows, and a compiler wrapper without mpi.h is no MPI.
#
#   setup.sh SOURCE SCRATCH
set -eu
source=$1 scratch=$2
rm -rf "$scratch"
mkdir -p "$scratch/bin"
failures=0
fail() {
    echo "setup: $*" >&2
    failures=$((failures + 1))
}

# A machine on which dpkg knows no package, pkg-config no module, and apt-get can do everything: it
# writes down what it is asked for.
make_command() {
    printf '#!/bin/sh\n%s\n' "$2" >"$scratch/bin/$1"
    chmod +x "$scratch/bin/$1"
}
make_command dpkg-query 'exit 1'
make_command pkg-config 'exit 1'
make_command id 'echo 0'
make_command apt-get "printf '%s\n' \"\$@\" >>'$scratch/asked'"
for tool in sh bash env awk sed cat printf grep tr dirname mktemp rm; do
    ln -s "$(command -v $tool)" "$scratch/bin/$tool"
done
# As in Debian's openmpi-bin: it answers, and has no headers.
make_command mpicc.openmpi 'exit 1'
make_command mpicc.mpich 'exit 0'

# asked GROUP...: the packages that are asked for, in $scratch/asked
asked() {
    : >"$scratch/asked"
    PATH="$scratch/bin" bash "$source/tools/setup.sh" "$@" 2>"$scratch/err" || {
        fail "tools/setup.sh $* failed:"
        cat "$scratch/err" >&2
    }
}
wants() {
    grep -qx -e "$1" "$scratch/asked" || fail "$1 is not asked for"
}
wants_no() {
    ! grep -qx -e "$1" "$scratch/asked" || fail "$1 is asked for"
}

# What the two commands install, as the Makefile says it.
groups=$(sed -n 's/^\t@tools\/setup.sh //p' "$source/Makefile" | head -n 1)
# shellcheck disable=SC2086
asked $groups
for package in build-essential cmake ninja-build libyaml-dev libxml2-dev zlib1g-dev \
    libnifti-dev libwebsockets-dev nodejs npm python3-dev python3-venv; do
    wants $package
done
wants_no libcmocka-dev
mv "$scratch/asked" "$scratch/default"
asked
cmp -s "$scratch/asked" "$scratch/default" || fail "the default is not what the Makefile asks for"

# What apt-get says is shown when it fails, and only then.
make_command apt-get "printf '%s\n' \"\$@\" >>'$scratch/asked'; echo Unpacking thing"
asked
! grep -q Unpacking "$scratch/err" || fail "every package is told"
grep -q '^setup: installing .*libnifti-dev' "$scratch/err" || fail "no word of what is installed"
make_command apt-get "echo 'E: no such package'; exit 100"
if PATH="$scratch/bin" bash "$source/tools/setup.sh" build 2>"$scratch/err"; then
    fail "success without what cannot be installed"
fi
grep -q 'E: no such package' "$scratch/err" || fail "apt-get's own words are lost"
make_command apt-get "printf '%s\n' \"\$@\" >>'$scratch/asked'"

# MPI: the wrapper that finds mpi.h is one, the other is not.
asked check
wants libcmocka-dev
wants libopenmpi-dev
wants python3-numpy
wants python3-matplotlib
wants_no libmpich-dev

# Packages: all that they are built with, as the control file says it.
asked deb
sed -n '/^Build-Depends:/,/^$/s/^ \([a-z0-9.+-]*\).*/\1/p' "$source/packaging/debian/control" |
    sed 's/^debhelper-compat$/debhelper/' >"$scratch/depends"
[ -s "$scratch/depends" ] || fail "the packages are built with nothing"
while read -r package; do wants "$package"; done <"$scratch/depends"

# Without the right to install: one sentence with the command, and an error where it is needed.
make_command id 'echo 1000'
if PATH="$scratch/bin" bash "$source/tools/setup.sh" 2>"$scratch/err" </dev/null; then
    fail "success without what is needed"
fi
grep -q 'install them as root.*apt-get install build-essential' "$scratch/err" ||
    fail "no word how to get it: $(cat "$scratch/err")"

# The page without npm, without node, and with a node that is too old: a sentence each, no failure.
mkdir -p "$scratch/tree/tools" "$scratch/tree/web"
cp "$source/tools/web.sh" "$scratch/tree/tools/"
touch "$scratch/tree/web/package.json"
page() {
    PATH="$scratch/bin" bash "$scratch/tree/tools/web.sh" 2>"$scratch/err" ||
        fail "a page that cannot be built is a failure"
    [ "$(wc -l <"$scratch/err")" -eq 1 ] || fail "not one sentence: $(cat "$scratch/err")"
    grep -q "^viewer: not built, $1.*(optional: " "$scratch/err" || fail "$1: $(cat "$scratch/err")"
}
ln -s "$(command -v wc)" "$scratch/bin/wc" 2>/dev/null || true
page 'node is not there'
make_command npm 'exec node'
page 'node is not there'
make_command node 'case $1 in -e) exit 1 ;; *) echo v12.22.9 ;; esac'
page 'node v12.22.9 is too old'
rm "$scratch/bin/npm"
page 'npm is not there'

# `make install` into a folder whose name has spaces, and into one's own home.
(cd "$source" && make -n install PREFIX='/x y/z') >"$scratch/install"
grep -q 'cmake --install build --prefix /x\\ y/z$' "$scratch/install" || fail "a prefix with a space"
(cd "$source" && make -n install PREFIX='~/z') >"$scratch/install"
grep -q 'cmake --install build --prefix ~/z$' "$scratch/install" || fail "a prefix at home"

[ $failures -eq 0 ] || exit 1
rm -rf "$scratch"
echo "setup: the default does what README.md shows"
