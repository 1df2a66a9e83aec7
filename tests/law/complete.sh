#!/bin/sh
# complete.sh SOURCE SCRATCH CC: a law without one of its members does not compile. Takes all
# definitions of a law away and looks whether the compiler asks for every one of them. Also:
# docs/theory.md and docs/formats.md have every law.
set -eu
source=$1
scratch=$2
cc=$3
rm -rf "$scratch"
mkdir -p "$scratch/src"
failed=0
limit=
"$cc" --version | grep -q clang && limit=-ferror-limit=0
# The table of rows, and a kernel, which asks for what lanes need.
compile() {
    "$cc" -std=gnu17 -fsyntax-only -w $limit -I"$scratch/src" -I"$source/src" \
        "$scratch/src/law/law.c" 2>"$scratch/messages" || return 1
}
compile_kernel() {
    "$cc" -std=gnu17 -fsyntax-only -w $limit -DLAR_SIMD=1 -I"$scratch/src" -I"$source/src" \
        -I"$source/include" "$source/src/mechanics/hex8_kernel.c" 2>>"$scratch/messages" || return 1
}
laws=$(sed -n 's/^ *X(\([a-z_0-9]*\)).*/\1/p' "$source/src/law/list.h")
[ -n "$laws" ] || { echo "complete: no law found in list.h" >&2; exit 1; }
cp -r "$source/src/law" "$scratch/src/law"
if ! compile || ! compile_kernel; then
    cat "$scratch/messages" >&2
    exit 1
fi
for law in $laws; do
    members="name title parameter febio abaqus history fibres uncoupled shear bulk from_moduli energy stress
        stiffened tangent strained"
    for member in $members; do
        sed -i "s/\\blar_${law}_$member\\b\\([[ =(]\\)/taken_away_${law}_$member\\1/" \
            "$scratch/src/law/$law.h"
    done
    compile || true
    compile_kernel || true
    for member in $members; do
        grep -q "taken_away_${law}_$member\\b" "$scratch/src/law/$law.h" || {
            echo "complete: $law.h defines no lar_${law}_$member" >&2
            failed=1
        }
        grep -q "error.*lar_${law}_$member\\b" "$scratch/messages" || {
            echo "complete: $law compiles without its $member" >&2
            failed=1
        }
    done
    cp "$source/src/law/$law.h" "$scratch/src/law/$law.h"
    name=$(sed -n "s/.*lar_${law}_name\\[\\] = \"\\([^\"]*\\)\".*/\\1/p" "$source/src/law/$law.h")
    for page in theory formats; do
        grep -q "^| \`$name\`" "$source/docs/$page.md" || {
            echo "complete: docs/$page.md has no row for $name" >&2
            failed=1
        }
    done
done
exit $failed
