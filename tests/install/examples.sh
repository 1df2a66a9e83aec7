#!/bin/sh
# What embeds Lariat in other ways than embed.c does, from an installed copy (embed.sh).
#
#   examples.sh SOURCE BUILD SCRATCH
#
# 1. pkg-config asks for no file of the libraries that Lariat uses. 2. A program has the whole library
# inside, by pkg-config and by CMake, and names of its own that are also the library's. 3. lariat.hpp:
# organ.cpp with two compilers and with CMake; what the header promises about moving and exceptions.
# 4. simulator.c: three threads for a second. 5. Embed.cs, where mono is there.
set -eu
source=$1 build=$2 scratch=$3
cc=${CC:-cc} cxx=${CXX:-c++} cmake=${CMAKE:-cmake}
fail() {
    echo "examples: $*" >&2
    exit 1
}

[ -e "$build/liblariat.a" ] || { echo "skipped: the static library is not built"; exit 77; }
rm -rf "$scratch"
mkdir -p "$scratch"
"$cmake" --install "$build" --prefix "$scratch/prefix" >"$scratch/install.log" ||
    fail "cmake --install failed, see $scratch/install.log"
pc=$(dirname "$(find "$scratch/prefix" -name lariat.pc)")
export PKG_CONFIG_LIBDIR="$pc" LD_LIBRARY_PATH="${pc%/*}" # and no other files than these
unset PKG_CONFIG_PATH
warnings="-Wall -Wextra -Werror"
beam=$source/examples/beam.yaml

# shellcheck disable=SC2046,SC2086
{
    "$cc" -std=c17 $warnings "$source/examples/embed.c" $(pkg-config --cflags --libs lariat) -o "$scratch/embed" ||
        fail "pkg-config wants more than Lariat's own files"
    first=$("$scratch/embed" "$beam")
    # A name of the library's own, in the program too; clang says no unless it is used.
    printf '#define main embed\n#include "%s"\n#undef main\nint lar_strdup(void);\nint lar_strdup(void) { return 3; }\nint main(int n, char **v) { return lar_strdup() != 3 || embed(n, v); }\n' \
        "$source/examples/embed.c" >"$scratch/whole.c"
    "$cc" -std=c17 $warnings "$scratch/whole.c" $(pkg-config --cflags --libs lariat-static) -o "$scratch/whole" ||
        fail "the static library cannot be linked"
    [ "$(env -u LD_LIBRARY_PATH "$scratch/whole" "$beam")" = "$first" ] || fail "the static library differs"
    ! objdump -p "$scratch/whole" | grep -q 'NEEDED.*liblariat' || fail "the static library is not inside"

    for compiler in "$cxx" clang++; do
        command -v "$compiler" >/dev/null || continue
        "$compiler" -std=c++17 $warnings -Wpedantic "$source/examples/organ.cpp" \
            $(pkg-config --cflags --libs lariat) -o "$scratch/organ"
        "$scratch/organ" >"$scratch/organ.out" || fail "organ failed: $(cat "$scratch/organ.out")"
    done
    "$cxx" -std=c++17 $warnings -Wpedantic "$source/tests/install/moves.cpp" \
        $(pkg-config --cflags --libs lariat) -o "$scratch/moves"
    "$scratch/moves" "$beam" "$scratch/results" || fail "lariat.hpp does not do what it says"
    "$cc" -std=c17 -O1 $warnings "$source/examples/simulator.c" $(pkg-config --cflags --libs lariat) \
        -lpthread -lm -o "$scratch/simulator"
}
cat "$scratch/organ.out"
slab=$(sed -n 's/^slab .*hash //p' "$scratch/organ.out")
grep -q "^back   hash ${slab:-none}\$" "$scratch/organ.out" || fail "it did not go back"
grep -Eq '^hand   holds [1-9][0-9]*, lifts by [0-9.]*[1-9]' "$scratch/organ.out" || fail "nothing is lifted"
grep -q '^steps  100,' "$scratch/organ.out" || fail "the callback is not heard"
grep -q '^error  1: a stiffness' "$scratch/organ.out" || fail "the library's sentence is not thrown"

found() {
    "$cmake" -S "$source/tests/install/find_package" -B "$scratch/cmake" \
        -DCMAKE_C_COMPILER="$cc" -DCMAKE_CXX_COMPILER="$cxx" -DCMAKE_PREFIX_PATH="$scratch/prefix" \
        -DEMBED_SOURCE="$source/examples/embed.c" -DORGAN_SOURCE="$source/examples/organ.cpp" &&
        "$cmake" --build "$scratch/cmake"
}
found >"$scratch/cmake.log" 2>&1 || { cat "$scratch/cmake.log"; fail "find_package(Lariat) failed"; }
[ "$(env -u LD_LIBRARY_PATH "$scratch/cmake/embed_static" "$beam")" = "$first" ] ||
    fail "Lariat::lariat_static differs"
"$scratch/cmake/organ" | cmp -s - "$scratch/organ.out" || fail "organ differs with find_package"

# How strong the force is depends on how late the machine is; that there is one does not.
"$scratch/simulator" 1 >"$scratch/simulator.out" || fail "simulator failed"
tail -n 3 "$scratch/simulator.out"
grep -Eq '^haptic   [1-9][0-9]{2,} times in 1.0 s, strongest force [0-9.]*[1-9]' "$scratch/simulator.out" ||
    fail "the haptic thread feels nothing"
grep -q '[#%@=+*]\{20\}' "$scratch/simulator.out" || fail "nothing is drawn"

if command -v mcs >/dev/null && command -v mono >/dev/null; then
    mcs -warnaserror "-out:$scratch/Embed.exe" "$source/examples/Embed.cs"
    [ "$(mono "$scratch/Embed.exe" "$beam" 2>"$scratch/stderr")" = "$first" ] || fail "Embed.cs differs"
    if mono "$scratch/Embed.exe" none.yaml 2>"$scratch/stderr"; then fail "a missing scene was not thrown"; fi
    grep -q '^none.yaml: ' "$scratch/stderr" || fail "the sentence does not arrive in C#"
    echo "C#: the same bits"
else
    echo "C#: skipped, mono is missing (apt-get install mono-mcs mono-runtime libmono-system-core4.0-cil)"
fi
