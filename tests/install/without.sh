#!/bin/sh
# Everything that is optional left out: it builds, and the fast tests pass or are skipped.
#
#   without.sh SOURCE SCRATCH
set -eu
source=$1 scratch=$2
cmake=${CMAKE:-cmake}
rm -rf "$scratch"
mkdir -p "$scratch"
"$cmake" -S "$source" -B "$scratch/build" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_C_COMPILER="${CC:-cc}" \
    '-DLARIAT_WITHOUT=hwloc;libwebsockets;metis;mpi;nifti;petsc;sdl2;ucx' >"$scratch/log" 2>&1 &&
    "$cmake" --build "$scratch/build" -j 2 >>"$scratch/log" 2>&1 || {
    tail -n 40 "$scratch/log" >&2
    exit 1
}
cd "$scratch/build"
ctest -L fast --output-on-failure --no-label-summary
cd /
rm -rf "$scratch"
