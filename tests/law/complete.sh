#!/bin/sh
# complete.sh SOURCE SCRATCH CC: a law without one of its members does not compile. Takes the laws'
# room, takes one definition away at a time, and compiles. Also: docs/theory.md and docs/formats.md
# have every law.
set -eu
source=$1
scratch=$2
cc=$3
rm -rf "$scratch"
mkdir -p "$scratch"
failed=0
compiles() {
    "$cc" -std=gnu17 -fsyntax-only -w -fwrapv -I"$scratch/src" -I"$source/src" \
        "$scratch/src/law/law.c" 2>"$scratch/messages" &&
        "$cc" -std=gnu17 -fsyntax-only -w -DLAR_SIMD=1 -I"$scratch/src" -I"$source/src" \
            -I"$source/include" "$source/src/mechanics/hex8_kernel.c" 2>>"$scratch/messages"
}
laws=$(sed -n 's/^ *X(\([a-z_0-9]*\)).*/\1/p' "$source/src/law/list.h")
[ -n "$laws" ] || { echo "complete: no law found in list.h" >&2; exit 1; }
for law in $laws; do
    for member in name title parameter febio abaqus history fibres shear bulk from_moduli energy \
        stress stiffened tangent strained; do
        rm -rf "$scratch/src"
        mkdir -p "$scratch/src"
        cp -r "$source/src/law" "$scratch/src/law"
        if [ $member = name ]; then
            compiles || { cat "$scratch/messages"; echo "complete: $law as it is" >&2; exit 1; }
        fi
        sed -i "s/\\blar_${law}_$member\\b\\([[ =(]\\)/taken_away_${law}_$member\\1/" \
            "$scratch/src/law/$law.h"
        if cmp -s "$source/src/law/$law.h" "$scratch/src/law/$law.h"; then
            echo "complete: $law.h defines no lar_${law}_$member" >&2
            failed=1
        elif compiles; then
            echo "complete: $law compiles without its $member" >&2
            failed=1
        fi
    done
    name=$(sed -n "s/.*lar_${law}_name\\[\\] = \"\\([^\"]*\\)\".*/\\1/p" "$source/src/law/$law.h")
    for page in theory formats; do
        grep -q "^| \`$name\`" "$source/docs/$page.md" || {
            echo "complete: docs/$page.md has no row for $name" >&2
            failed=1
        }
    done
done
exit $failed
