#!/bin/sh
# The same bits from every instruction set, NEON among them: digest.c runs here and, compiled for
# ARM, under qemu.
#
#   digest.sh SOURCE NATIVE-PROGRAM SCRATCH KEPT
#
# What ARM says is kept in the folder KEPT for all builds, with the sum of what it was made from.
set -eu
source=$1 native=$2 scratch=$3 kept=$4
mkdir -p "$scratch"

"$native" >"$scratch/native.txt"

cross=aarch64-linux-gnu-gcc
emulator=qemu-aarch64
for tool in $cross $emulator; do
    command -v "$tool" >/dev/null 2>&1 || {
        echo "skipped: $tool is missing (apt-get install gcc-aarch64-linux-gnu qemu-user libc6-dev-arm64-cross)"
        exit 77
    }
done

# The flags of lariat_flags. Functions that nobody calls are dropped, and with them whatever other
# library they would need.
flags="-std=gnu17 -O2 -ffp-contract=off -fno-math-errno -fwrapv -ffunction-sections -D_GNU_SOURCE
    -I$source/include -I$source/src"
sum=$({
    find "$source/src" "$source/include" "$source/tests/neon" -type f | LC_ALL=C sort | xargs cat
    echo "$flags"
    $cross --version
    $emulator --version
} | sha256sum)
objects=""
compile() {
    object=$scratch/$1.o
    shift
    # shellcheck disable=SC2086
    $cross $flags -c -o "$object" "$@"
    objects="$objects $object"
}
if [ "$(cat "$kept/sum" 2>/dev/null)" = "$sum" ]; then
    cp "$kept/arm.txt" "$scratch/arm.txt"
else
    compile digest "$source/tests/neon/digest.c"
    compile kernel_c -DLAR_SIMD=1 "$source/src/mechanics/hex8_kernel.c"
    compile kernel_neon -DLAR_SIMD=2 "$source/src/mechanics/hex8_kernel.c"
    compile kernels -DLAR_HAVE_C -DLAR_HAVE_NEON "$source/src/mechanics/kernels.c"
    for file in base/error base/text base/memory mechanics/hex8 mechanics/hex8_lean mechanics/hexahedron \
        mechanics/stress law/law model/material model/mesh/mesh; do
        compile "$(basename $file)" "$source/src/$file.c"
    done
    # shellcheck disable=SC2086
    $cross -static -Wl,--gc-sections -o "$scratch/digest" $objects -lm
    $emulator "$scratch/digest" >"$scratch/arm.txt"
    mkdir -p "$kept"
    rm -f "$kept/sum"
    cp "$scratch/arm.txt" "$kept/arm.txt"
    echo "$sum" >"$kept/sum"
fi

cat "$scratch/native.txt" "$scratch/arm.txt"
grep -q '^neon ' "$scratch/arm.txt" || {
    echo "digest: the ARM program has no NEON kernels" >&2
    exit 1
}
# Per law and body, one digest only.
cat "$scratch/native.txt" "$scratch/arm.txt" | awk '
    { body = $2 " " $3
      if (body in digest && digest[body] != $4) {
          print "digest: " $1 " differs for " body " (" $5 ", " $6 ")"; bad = 1 }
      digest[body] = $4 }
    END { exit bad }'
