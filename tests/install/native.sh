#!/bin/sh
# Builds with flags of one's own, such as -march=native, still have every kernel by its name.
#
#   native.sh SOURCE SCRATCH
set -eu
source=$1 scratch=$2
mkdir -p "$scratch"
[ "$(uname -m)" = x86_64 ] || { echo "install: skipped: not x86-64"; exit 0; }
# symbol WANTED OPTION...: what plain C is called in an object that is built so.
symbol() {
    wanted=$1
    shift
    for file in mechanics/hex8_kernel study/bench/fma_peak_kernel; do
        "${CC:-cc}" -std=gnu17 -w -c -I"$source/include" -I"$source/src" -DLAR_SIMD=1 "$@" \
            -o "$scratch/object.o" "$source/src/$file.c"
        nm "$scratch/object.o" | grep -q " [DR] lar_[a-z_]*_$wanted\$" ||
            { echo "install: $file built with $* has no $wanted" >&2; exit 1; }
    done
}
symbol c
symbol c -mfma
symbol c_fma -mfma -DLAR_SIMD_C_FMA
echo "install: kernels keep their names whatever the flags are"
