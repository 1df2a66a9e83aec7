#!/usr/bin/env bash
# Brings a Debian machine to where Lariat builds: asks dpkg what is there and installs only what
# is missing. On a machine that is set up it needs no network, no privilege and no time.
#
#   tools/setup.sh [build] [scan] [fit] [web] [python] [deb] [check] [fuzz] [report]
#                                                    default: build scan fit web python
#
#   build   what the library and the command need; an error when it cannot be had
#   scan    what scans are read with: libnifti
#   fit     what `lariat fit` finds parameters with, cminpack, and reads frames with, libpng
#   web     what people look through: libwebsockets for the server, Node.js and npm for the page
#   python  what the Python module is built with: Python and its headers, and what `pip install .` needs
#   deb     what Debian packages are made with, as packages: dpkg looks after that
#   check   what the tests need: cmocka; and what widens them: a second compiler, METIS, hwloc, UCX,
#           MPI, SDL2, PETSc, the cross compiler and emulator for NEON
#   fuzz    clang with libFuzzer
#   report  what writes and draws the figures of `make report`
#
# The default does everything that README.md shows. What belongs to `scan`, `fit`, `web` and `python`,
# and what widens the tests, is optional: without it a sentence says what is left out.
set -euo pipefail

# One line each: package, then how to see the same thing when it came from somewhere else than
# dpkg (c: a command, m: a pkg-config module, w: an MPI's compiler wrapper that finds mpi.h, which the
# wrapper alone does not prove).
BUILD_PACKAGES="
build-essential   c:c++
cmake             c:cmake
ninja-build       c:ninja
pkg-config        c:pkg-config
libyaml-dev       m:yaml-0.1
libxml2-dev       m:libxml-2.0
zlib1g-dev        m:zlib"
TEST_PACKAGES="
libcmocka-dev     m:cmocka"
LWS_PACKAGES="
libwebsockets-dev m:libwebsockets"
NODE_PACKAGES="
nodejs            c:node
npm               c:npm"
PYTHON_PACKAGES="
python3-dev       -
python3-venv      -"
NUMPY_PACKAGES="
python3-numpy     -"
MATPLOTLIB_PACKAGES="
python3-matplotlib -"
BROWSER_PACKAGES="
chromium          c:chromium"
CLANG_PACKAGES="
clang             c:clang"
METIS_PACKAGES="
libmetis-dev      -"
HWLOC_PACKAGES="
libhwloc-dev      m:hwloc"
UCX_PACKAGES="
libucx-dev        m:ucx"
SDL_PACKAGES="
libsdl2-dev       m:sdl2"
NIFTI_PACKAGES="
libnifti-dev      -"
FIT_PACKAGES="
libcminpack-dev   m:cminpack"
PNG_PACKAGES="
libpng-dev        m:libpng"
PETSC_PACKAGES="
petsc-dev         m:PETSc"
# packaging/debian/control, but for the page's.
DEB_PACKAGES="
build-essential   -
cmake             -
debhelper         -
dh-python         -
libcminpack-dev   -
libhwloc-dev      -
libmetis-dev      -
libnifti-dev      -
libpng-dev        -
libsdl2-dev       -
libwebsockets-dev -
libxml2-dev       -
libyaml-dev       -
ninja-build       -
pkg-config        -
python3-dev       -
zlib1g-dev        -"
LINTIAN_PACKAGES="
lintian           c:lintian"
REPORT_PACKAGES="
python3           c:python3
gnuplot-nox       c:gnuplot"
# Both can be installed side by side; which one plain `mpirun` is does not matter.
MPI_PACKAGES="
openmpi-bin       c:mpirun.openmpi
libopenmpi-dev    w:mpicc.openmpi
mpich             c:mpirun.mpich
libmpich-dev      w:mpicc.mpich"
NEON_PACKAGES="
gcc-aarch64-linux-gnu  c:aarch64-linux-gnu-gcc
qemu-user              c:qemu-aarch64
libc6-dev-arm64-cross  -"

say() { printf 'setup: %s\n' "$*" >&2; }

# The packages of a table that this machine lacks, on one line.
missing_of() {
    local table=$1 names installed package probe lacking=""
    names=$(printf '%s\n' "$table" | awk 'NF { print $1 }')
    installed=""
    if command -v dpkg-query >/dev/null 2>&1; then
        # shellcheck disable=SC2086
        installed=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' $names 2>/dev/null |
            awk '$2 == "installed" { print $1 }') || true
    fi
    while read -r package probe; do
        [ -n "$package" ] || continue
        case $'\n'"$installed"$'\n' in *$'\n'"$package"$'\n'*) continue ;; esac
        case $probe in
        c:*) command -v "${probe#c:}" >/dev/null 2>&1 && continue ;;
        m:*) pkg-config --exists "${probe#m:}" 2>/dev/null && continue ;;
        w:*) "${probe#w:}" -E -x c - <<<'#include <mpi.h>' >/dev/null 2>&1 && continue ;;
        esac
        lacking="$lacking $package"
    done <<<"$table"
    printf '%s' "${lacking# }"
}

# Runs a command with the right to install: as root directly, else through sudo.
as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    elif sudo -n true 2>/dev/null; then
        sudo -n "$@"
    else
        sudo "$@" # asks on the terminal; may_install saw that there is one
    fi
}

may_install() {
    command -v apt-get >/dev/null 2>&1 || return 1
    [ "$(id -u)" -eq 0 ] && return 0
    command -v sudo >/dev/null 2>&1 || return 1
    sudo -n true 2>/dev/null || [ -t 0 ]
}

# What apt-get and dpkg say, package by package, is shown only when they fail.
quietly() {
    local log
    log=$(mktemp)
    if "$@" >"$log" 2>&1 </dev/null; then
        rm -f "$log"
    else
        cat "$log" >&2
        rm -f "$log"
        return 1
    fi
}

updated=no
apt_install() {
    # A bounded wait for the network, and for another apt that holds the lock.
    local apt=(env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0
        -o DPkg::Lock::Timeout=120 -o Acquire::Retries=2
        -o Acquire::http::Timeout=30 -o Acquire::https::Timeout=30)
    if [ $updated = no ]; then
        quietly as_root "${apt[@]}" update || return 1
        updated=yes
    fi
    quietly as_root "${apt[@]}" install -y --no-install-recommends "$@"
}

# need TABLE: installs what is missing, or ends with a sentence.
need() {
    local lacking
    lacking=$(missing_of "$1")
    [ -n "$lacking" ] || return 0
    if ! may_install; then
        say "these packages are missing and cannot be installed from here; install them as root" \
            "and try again: apt-get install $lacking"
        exit 1
    fi
    say "installing $lacking (a few minutes on a bare system)"
    # shellcheck disable=SC2086
    if ! apt_install $lacking; then
        say "apt-get could not install them; check the network and the package sources, then" \
            "try again: apt-get install $lacking"
        exit 1
    fi
}

# want TABLE CONSEQUENCE: the same, but goes on without them.
want() {
    local lacking
    lacking=$(missing_of "$1")
    [ -n "$lacking" ] || return 0
    if may_install; then
        say "installing $lacking (a few minutes on a bare system)"
        # shellcheck disable=SC2086
        apt_install $lacking && return 0
    fi
    say "$2 (optional: apt-get install $lacking)"
    return 1
}

# The sanitizer and fuzzer runtime is packaged per clang version, and clang only recommends it.
want_clang() {
    local consequence=$1 version
    want "$CLANG_PACKAGES" "$consequence" || return 0
    version=$(dpkg-query -W -f '${Depends}' clang 2>/dev/null |
        sed -n 's/.*clang-\([0-9][0-9]*\).*/\1/p') || true
    [ -n "$version" ] || return 0
    want "libclang-rt-$version-dev -" "$consequence" || true
}

[ $# -gt 0 ] || set -- build scan fit web python
for group in "$@"; do
    case $group in
    build) need "$BUILD_PACKAGES" ;;
    scan) want "$NIFTI_PACKAGES" "lariat mesh is built without .nii" || true ;;
    fit)
        want "$FIT_PACKAGES" "lariat fit is built without its solver" || true
        want "$PNG_PACKAGES" "lariat fit --profile reads no .png" || true
        ;;
    web)
        want "$LWS_PACKAGES" "lariat view is built without its server" || true
        want "$NODE_PACKAGES" "the viewer's page is not built" || true
        ;;
    python) want "$PYTHON_PACKAGES" "import lariat is not built" || true ;;
    deb)
        need "$DEB_PACKAGES"
        need "$NODE_PACKAGES"
        want "$LINTIAN_PACKAGES" "the packages are not looked through" || true
        ;;
    check)
        need "$TEST_PACKAGES"
        want_clang "the sanitizers run with gcc instead of clang"
        want "$PETSC_PACKAGES" "lariat bench implicit is built and tested with its own solver only" || true
        want "$METIS_PACKAGES" "lariat partition is built and tested without METIS" || true
        want "$HWLOC_PACKAGES" "threads are not bound to cores" || true
        want "$UCX_PACKAGES" "the backend ucx is neither built nor tested" || true
        want "$SDL_PACKAGES" "game controllers are neither built nor tested" || true
        want "$MPI_PACKAGES" "the backend mpi is built and tested with those MPIs that are there" || true
        want "$NEON_PACKAGES" "the NEON tests are left out" || true
        want "$BROWSER_PACKAGES" "the viewer is not tested in a browser" || true
        want "$REPORT_PACKAGES" "the report is not tested" || true
        want "$NUMPY_PACKAGES" "the Python module is not tested with numpy" || true
        want "$MATPLOTLIB_PACKAGES" "the notebook is not run" || true
        ;;
    fuzz)
        need "$TEST_PACKAGES"
        want_clang "fuzzing runs with the plain driver instead of libFuzzer"
        ;;
    report)
        need "$REPORT_PACKAGES"
        want_clang "the report has no second compiler"
        ;;
    *)
        say "unknown group '$group'; use build, scan, fit, web, python, deb, check, fuzz or report"
        exit 2
        ;;
    esac
done
