#!/bin/sh
# Fits from an installed copy, in a program of somebody else (embed.sh: the first library).
#
#   fit.sh SOURCE BUILD SCRATCH
#
# 1. liblariat-fit.so exports the functions of lariat_fit.h and nothing else, has no engine inside,
#    and liblariat.so does without cminpack. 2. lariat_fit.h alone, in C and C++. 3. examples/fit.c with
# pkg-config and CMake, with shared and static libraries, answers as the command does, and writes the
# same files. 4. Libraries that do not belong together are told. 5. It fits examples/fit_tension.yaml.
set -eu
source=$1 build=$2 scratch=$3
cc=${CC:-cc} cxx=${CXX:-c++} cmake=${CMAKE:-cmake}
fail() {
    echo "fit: $*" >&2
    exit 1
}

[ -e "$build/liblariat-fit.so" ] || { echo "skipped: built without cminpack"; exit 77; }
rm -rf "$scratch"
mkdir -p "$scratch"
"$cmake" --install "$build" --prefix "$scratch/prefix" >"$scratch/install.log" ||
    fail "cmake --install failed, see $scratch/install.log"
pc=$(dirname "$(find "$scratch/prefix" -name lariat-fit.pc)")
libdir=${pc%/*} header=$scratch/prefix/include/lariat_fit.h
library=$libdir/liblariat-fit.so

# ---- what is in it
nm -D --defined-only "$library" | awk '{ print $3 }' | sort >"$scratch/exported"
"$cc" -E -P "$header" | tr '\n' ' ' | tr ';{}' '\n\n\n' |
    sed -n 's/.*visibility("default").*[^a-z_0-9]\(lar_fit_[a-z_0-9]*\)(.*/\1/p' | sort >"$scratch/promised"
[ -s "$scratch/promised" ] || fail "no function was found in lariat_fit.h"
cmp -s "$scratch/exported" "$scratch/promised" ||
    fail "exported and promised differ: $(diff "$scratch/exported" "$scratch/promised")"
objdump -p "$library" >"$scratch/objdump"
grep -q 'SONAME *liblariat-fit\.so\.0$' "$scratch/objdump" || fail "the soname is not liblariat-fit.so.0"
grep -q 'NEEDED *liblariat\.so\.0$' "$scratch/objdump" || fail "it does not use liblariat.so.0"
grep -q 'NEEDED *libcminpack' "$scratch/objdump" || fail "it does not use cminpack"
! objdump -p "$libdir/liblariat.so" | grep -q 'NEEDED.*\(cminpack\|fit\)' || fail "liblariat.so needs more than before"
[ "$(stat -c %s "$library")" -lt 400000 ] || fail "there is an engine inside: $(stat -c %s "$library") bytes"

# ---- the header
strict="-Wall -Wextra -pedantic-errors -Werror -fsyntax-only"
# shellcheck disable=SC2086
for standard in c99 c17; do "$cc" -std=$standard $strict -x c "$header"; done
# shellcheck disable=SC2086
for standard in c++11 c++17; do "$cxx" -std=$standard $strict -x c++ "$header"; done

# ---- the example, four times
cd "$scratch"
cat >one.vtk <<'END'
# vtk DataFile Version 3.0
one element, 10 x 10 x 20 mm
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 8 double
0 0 0  0.01 0 0  0.01 0.01 0  0 0.01 0
0 0 0.02  0.01 0 0.02  0.01 0.01 0.02  0 0.01 0.02
CELLS 1 9
8 0 1 2 3 4 5 6 7
CELL_TYPES 1
12
END
cat >one.yaml <<'END'
lariat: 1
mesh: one.vtk
materials:
  - { cells: all, name: gel, law: neo-hookean, density: 1050, shear_modulus: 1.0e3, bulk_modulus: 4.0e4 }
sets: [ { name: top, nodes: { plane: { point: [0, 0, 0.02], normal: [0, 0, 1] } } } ]
fix:
  - { nodes: { plane: { point: [0, 0, 0], normal: [0, 0, 1] } }, axes: z }
  - { nodes: { nearest: [0, 0, 0] }, axes: xy }
  - { nodes: { nearest: [0.01, 0, 0] }, axes: y }
move: [ { nodes: top, axes: z, by: 0.002, over: 1 } ]
END
printf 'displacement,force\n0.001,0.0286\n0.002,0.0547\n0.003,0.0788\n0.004,0.1011\n' >one.csv
cat >fit.yaml <<'END'
lariat-fit: 1
parameters:
  - { material: gel, parameter: shear_modulus, guess: 1.5e3, bounds: [1.0e2, 1.0e5] }
experiments:
  - { kind: tension, scene: one.yaml, data: one.csv }
END
export PKG_CONFIG_LIBDIR="$pc" # and no other files than these
unset PKG_CONFIG_PATH
warnings="-std=c17 -Wall -Wextra -Werror"
# shellcheck disable=SC2046,SC2086
{
    "$cc" $warnings "$source/examples/fit.c" $(pkg-config --cflags --libs lariat-fit) -o fit-shared
    "$cc" $warnings "$source/examples/fit.c" $(pkg-config --cflags --libs lariat-fit-static) -o fit-static
}
"$cmake" -S "$source/tests/install/find_package" -B cmake -DCMAKE_C_COMPILER="$cc" \
    -DCMAKE_PREFIX_PATH="$scratch/prefix" -DEMBED_SOURCE="$source/examples/embed.c" \
    -DFIT_SOURCE="$source/examples/fit.c" >cmake.log 2>&1 || { cat cmake.log; fail "find_package(Lariat) failed"; }
"$cmake" --build cmake >cmake.log 2>&1 || { cat cmake.log; fail "building with find_package(Lariat) failed"; }
for program in fit-static cmake/fit_static; do
    ! objdump -p $program | grep -q 'NEEDED.*liblariat' || fail "$program needs a library of ours"
done

comparable() { # FILE: without what is another one each time
    grep -v 'wall_time\|^converged\|^# Fitted by' "$1"
}
"$scratch/prefix/bin/lariat" fit fit.yaml --out command >command.out || fail "the command fails"
for program in fit-shared fit-static cmake/fit cmake/fit_static; do
    name=$(echo $program | tr / _)
    # Only that of pkg-config's shared library has to be told where; the second library finds the first.
    case $program in
    fit-shared) LD_LIBRARY_PATH=$libdir ./$program fit.yaml "made-$name" >"$name.out" 2>"$name.err" ;;
    *) ./$program fit.yaml "made-$name" >"$name.out" 2>"$name.err" ;;
    esac || fail "$program failed: $(cat "$name.err")"
    for file in fit.json gel.tissue.yaml 1_tension.svg; do
        comparable "made-$name/$file" >a
        comparable "command/$file" >b
        cmp -s a b || fail "$program writes another $file than the command: $(diff a b)"
    done
    grep -q '^fitting: [0-9]* simulations' "$name.err" || fail "$program is not told how far it is"
    comparable fit-shared.out >a
    comparable "$name.out" >b
    cmp -s a b || fail "$program answers otherwise: $(diff a b)"
done
cat fit-shared.out
grep -Eq '^gel shear_modulus: (19[6-9]|20[0-4])[0-9.]* Pa, 95 % between [12]' fit-shared.out || fail "another answer"
export LD_LIBRARY_PATH="$libdir"
if ./fit-shared none.yaml >none.out 2>none.err; then fail "a missing experiment was not told"; fi
grep -q 'none\.yaml' none.err || fail "the message does not name the missing file"

# ---- another liblariat
printf 'const struct { const char *version; unsigned long size[3]; } lar_lent_to_fit = { "0.0.9", { 8, 8, 8 } };\n' >other.c
"$cc" -shared -fPIC other.c -o other.so
if LD_PRELOAD=$scratch/other.so ./fit-shared fit.yaml >other.out 2>other.err; then fail "another liblariat was taken"; fi
grep -q 'liblariat-fit is of version .* and liblariat of 0\.0\.9.*install both together' other.err ||
    fail "no word about libraries that do not belong together: $(cat other.err)"

# ---- the page's example
./fit-shared "$source/examples/fit_tension.yaml" tension >tension.out 2>tension.err ||
    fail "fit_tension.yaml: $(tail -n 1 tension.err)"
cat tension.out
awk '/^gel c1: / { sub(/,/, "", $9); if ($8 < 2400 && 2400 < $10) held++ }
    /^gel m1: / { if ($7 < 14 && 14 < $9) held++ } END { exit held != 2 }' tension.out ||
    fail "the intervals do not hold 2400 Pa and 14"
grep -q '^converged after' tension.out || fail "not converged"
echo "fit: four programs answer as the command does"
