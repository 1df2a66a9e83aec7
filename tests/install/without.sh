#!/bin/sh
# Optional libraries left out: all of them at once, then each one alone. It builds without a warning
# each time. Without all of them every fast test passes or is skipped; without one, the tests that
# meet it and those of the command as a whole.
#
#   without.sh SOURCE SCRATCH [NAME...]     NAME: all, or a library; without it all, then each
#
# There is one build folder, configured anew each time, so that only what asks for the library is
# compiled again, and only what these tests need is linked; so it is, too, where people install or
# remove one later.
set -eu
source=$1 scratch=$2
shift 2
cmake=${CMAKE:-cmake}
libraries=$(sed -n 's/^set(LARIAT_OPTIONAL_NAMES \(.*\))$/\1/p' "$source/cmake/LariatOptional.cmake")
[ -n "$libraries" ] || { echo "without: no optional library was found" >&2; exit 1; }
# shellcheck disable=SC2086
[ $# -gt 0 ] || set -- all $libraries
rm -rf "$scratch"
mkdir -p "$scratch"

# run COMMAND...: said only when it fails.
run() {
    "$@" >>"$scratch/log" 2>&1 || {
        tail -n 40 "$scratch/log" >&2
        return 1
    }
}
configure() {
    : >"$scratch/log"
    run "$cmake" -S "$source" -B "$scratch/build" -G Ninja -DCMAKE_BUILD_TYPE=Release \
        -DCMAKE_C_COMPILER="${CC:-cc}" -DLARIAT_WERROR="${WERROR:-OFF}" "-DLARIAT_WITHOUT=$1"
}
# build TARGET...: without a warning.
build() {
    run "$cmake" --build "$scratch/build" -j 2 --target "$@" || return 1
    ! grep -n 'warning:\|CMake Warning' "$scratch/log" >&2
}

# targets_of TESTS: what is installed, and the programs of these tests: room/name is test_room_name,
# fuzz/name fuzz_name.
targets_of() {
    (cd "$scratch/build" && ctest -N -L fast -R "$1") | sed -n 's/^ *Test *#[0-9]*: //p' |
        sed 's|/|_|g; /^fuzz_/!s/^/test_/' | sort >"$scratch/wanted"
    ninja -C "$scratch/build" -t targets all | sed -n 's/: phony$//p' | sort >"$scratch/known"
    comm -12 "$scratch/wanted" "$scratch/known"
    echo products json_check
}

# tests_of LIBRARY: the tests that meet it, as a regular expression. A library without a row of its
# own gets all.
tests_of() {
    case $1 in
    cminpack) echo 'study/fit|cli/fit' ;;
    png) echo 'study/f|cli/f|fuzz/f' ;;
    hwloc) echo 'base/|comm/threads' ;;
    libwebsockets) echo 'session/(server|device)|cli/(view|replay)' ;;
    metis) echo 'divide/distribution|cli/partition' ;;
    mpi | ucx) echo 'comm/|cli/processes' ;;
    nifti) echo 'meshing/image|fuzz/nifti|cli/mesh$' ;;
    python) echo 'python/|layers/' ;;
    petsc) echo 'study/implicit|cli/bench' ;;
    sdl2) echo 'session/device_gamepad' ;;
    *) echo '' ;;
    esac
}

failed=
for name; do
    list=$name tests=
    if [ "$name" = all ]; then
        list=$(echo "$libraries" | tr ' ' ';')
    else
        tests="^($(tests_of "$name")|install/embed|cli/(usage|doctor|readme|help))"
    fi
    echo "---- without $list"
    started=$(date +%s)
    # shellcheck disable=SC2046
    if configure "$list" && build $([ -n "$tests" ] && targets_of "$tests" || echo all); then
        echo "built in $(($(date +%s) - started)) s"
        (cd "$scratch/build" && ctest -L fast ${tests:+-R "$tests"} --output-on-failure \
            --no-label-summary) || failed="$failed $name"
    else
        failed="$failed $name"
    fi
done
if [ -n "$failed" ]; then
    echo "without: failed without$failed" >&2
    exit 1
fi
rm -rf "$scratch"
