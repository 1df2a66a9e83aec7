#!/bin/sh
# Installs into a scratch prefix and uses the installed copy as a stranger would.
#
#   embed.sh SOURCE BUILD SCRATCH
#
# 1. The library exports the functions of lariat.h, all of them and nothing else, and carries its
#    soname. 2. examples/embed.c builds with pkg-config and with find_package, after the tree was
# moved. 3. Both programs run on the example beam and agree. 4. The command finds the modules for
# MPI, and has its man pages and completion. 5. examples/session.c holds the beam in real time.
# 6. examples/tries.c makes its model of arrays, loads it, and goes back to a state a thousand times.
# 7. `import lariat` finds the library from where it lies, and agrees with the programs.
set -eu
source=$1 build=$2 scratch=$3
cc=${CC:-cc}
cmake=${CMAKE:-cmake}

fail() {
    echo "install: $*" >&2
    exit 1
}

rm -rf "$scratch"
mkdir -p "$scratch"
"$cmake" --install "$build" --prefix "$scratch/first" >"$scratch/install.log" ||
    fail "cmake --install failed, see $scratch/install.log"
mv "$scratch/first" "$scratch/prefix"
prefix=$scratch/prefix

pc=$(find "$prefix" -name lariat.pc)
[ -n "$pc" ] || fail "lariat.pc was not installed"
libdir=$(dirname "$(dirname "$pc")")
library=$libdir/liblariat.so
[ -e "$library" ] || fail "$library was not installed"
[ -x "$prefix/bin/lariat" ] || fail "the command was not installed"

# Man pages and completion lie where man and the shells look for them, and are of this command.
for file in man/man1/lariat.1 man/man1/lariat-run.1 man/man1/lariat-bench-kernel.1 \
    bash-completion/completions/lariat zsh/site-functions/_lariat fish/vendor_completions.d/lariat.fish; do
    [ -s "$prefix/share/$file" ] || fail "share/$file was not installed"
done
[ -s "$prefix/share/doc/lariat/docs/formats.md" ] || fail "the pages that the header names are not installed"
"$prefix/bin/lariat" help run --man | cmp -s - "$prefix/share/man/man1/lariat-run.1" ||
    fail "the installed man page is not of this command"

# Modules for MPI lie beside the library, and the installed command finds them: alone, where srun
# says two, it gets as far as asking MPI.
for module in "$build"/liblariat-mpi-*.so; do
    [ -e "$module" ] || continue
    name=${module##*-mpi-}
    [ -e "$libdir/${module##*/}" ] || fail "${module##*/} was not installed"
    env -u OMPI_COMM_WORLD_RANK -u PMI_RANK SLURM_PROCID=0 SLURM_STEP_NUM_TASKS=2 \
        LARIAT_MPI="${name%.so}" timeout 60 "$prefix/bin/lariat" bench comm 2>"$scratch/stderr" &&
        fail "a processor without the others was accepted"
    grep -q 'do not belong together' "$scratch/stderr" ||
        fail "the module ${module##*/} does not work: $(cat "$scratch/stderr")"
done

# What the header promises against what the library exports, but for what liblariat-fit is lent.
nm -D --defined-only "$library" | awk '$3 != "lar_lent_to_fit" { print $3 }' | sort >"$scratch/exported"
"$cc" -E -P "$prefix/include/lariat.h" | tr '\n' ' ' | tr ';{}' '\n\n\n' |
    sed -n 's/.*visibility("default").*[^a-z_0-9]\(lar_[a-z_0-9]*\)(.*/\1/p' |
    sort >"$scratch/promised"
[ -s "$scratch/promised" ] || fail "no function was found in lariat.h"
strange=$(comm -13 "$scratch/promised" "$scratch/exported" | tr '\n' ' ')
missing=$(comm -23 "$scratch/promised" "$scratch/exported" | tr '\n' ' ')
[ -z "$strange" ] || fail "exported but not in lariat.h: $strange; hide them"
[ -z "$missing" ] || fail "in lariat.h but not exported: $missing"
# Small enough to be carried along: without symbols, as packages are, below 1.5 MB.
if grep -q '^CMAKE_BUILD_TYPE:[A-Z]*=Release' "$build/CMakeCache.txt" && [ "$(uname -m)" = x86_64 ]; then
    strip -o "$scratch/stripped" "$library" && size=$(stat -c %s "$scratch/stripped")
    [ "$size" -lt 1500000 ] || fail "liblariat.so has $size bytes, more than 1,500,000"
fi
objdump -p "$library" | grep -q 'SONAME *liblariat\.so\.0$' || fail "the soname is not liblariat.so.0"

export PKG_CONFIG_PATH="$libdir/pkgconfig"
export LD_LIBRARY_PATH="$libdir"
# shellcheck disable=SC2046
"$cc" -std=c17 -Wall -Wextra -Werror $(pkg-config --cflags lariat) "$source/examples/embed.c" \
    -o "$scratch/embed-pkg-config" $(pkg-config --libs lariat)

"$cmake" -S "$source/tests/install/find_package" -B "$scratch/cmake" \
    -DCMAKE_C_COMPILER="$cc" -DCMAKE_PREFIX_PATH="$prefix" \
    -DEMBED_SOURCE="$source/examples/embed.c" >"$scratch/cmake.log" 2>&1 ||
    { cat "$scratch/cmake.log"; fail "find_package(Lariat) failed"; }
"$cmake" --build "$scratch/cmake" >"$scratch/cmake.log" 2>&1 ||
    { cat "$scratch/cmake.log"; fail "building with find_package(Lariat) failed"; }

first=$("$scratch/embed-pkg-config" "$source/examples/beam.yaml") || fail "embed failed"
second=$("$scratch/cmake/embed" "$source/examples/beam.yaml") || fail "embed failed"
echo "$first"
[ "$first" = "$second" ] || fail "the two programs differ: '$first' and '$second'"
# The beam is fixed at one end and must hang down at the other.
echo "$first" | grep -q '^tip  *-[0-9.]*[1-9]' || fail "the tip did not sink"
echo "$first" | grep -Eq '^hash [0-9a-f]{16}$' || fail "no hash was printed"

# Loaded, used and let go again and again it says nothing and takes no signal from its host.
cat >"$scratch/plugin.c" <<'END'
#include <dlfcn.h>
#include <signal.h>
#include <stddef.h>
static volatile sig_atomic_t caught;
static void count(int number) { (void)number, caught++; }
int main(int argc, char **argv) {
    int signals = 0;
    for (int i = 1; i < 32; i++) signals += signal(i, count) != SIG_ERR;
    for (int round = 0; round < 3; round++) {
        void *library = argc > 1 ? dlopen(argv[1], RTLD_NOW | RTLD_LOCAL) : NULL;
        if (!library) return 2;
        dlclose(library);
    }
    for (int i = 1; i < 32; i++)
        if (i != SIGKILL && i != SIGSTOP) raise(i);
    return caught == signals ? 0 : 1;
}
END
"$cc" -std=gnu17 -Wall -Wextra -Werror "$scratch/plugin.c" -o "$scratch/plugin" -ldl
"$scratch/plugin" "$library" >"$scratch/plugin.out" 2>&1 || fail "the library takes signals: status $?"
[ ! -s "$scratch/plugin.out" ] || fail "the library prints: $(cat "$scratch/plugin.out")"

# The Python module, where it was built and an interpreter can load it.
module=$(find "$prefix" -name '_lariat.abi3.so')
if [ -n "$module" ] && python3 -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
    packages=$(dirname "$(dirname "$module")")
    third=$(env -u LD_LIBRARY_PATH PYTHONPATH="$packages" python3 -B -c '
import lariat, sys
sim = lariat.Simulation(lariat.Model(sys.argv[1]))
sim.advance(int(0.1 / sim.time_step))
print(f"hash {sim.hash():016x}")' "$source/examples/beam.yaml") || fail "import lariat failed"
    [ "$third" = "$(echo "$first" | grep '^hash')" ] || fail "Python says $third"
fi

if "$scratch/embed-pkg-config" "$source/examples/none.yaml" 2>"$scratch/stderr"; then
    fail "a missing scene was not reported"
fi
grep -q 'none.yaml' "$scratch/stderr" || fail "the message does not name the missing scene"

# A session without a server: the hand has hold of the beam and lifts it.
# shellcheck disable=SC2046
"$cc" -std=c17 -Wall -Wextra -Werror $(pkg-config --cflags lariat) "$source/examples/session.c" \
    -o "$scratch/session" $(pkg-config --libs lariat) -lpthread
"$scratch/session" "$source/examples/beam.yaml" >"$scratch/session.out" || fail "session failed"
cat "$scratch/session.out"
grep -q '^0\.[0-9]* s  force .* [1-9][0-9]* points held$' "$scratch/session.out" ||
    fail "the hand holds nothing"
grep -Eq '^tip lifted by [0-9.]*[1-9]' "$scratch/session.out" || fail "the beam was not lifted"
grep -Eq '^hash [0-9a-f]{16} at step [1-9]' "$scratch/session.out" || fail "no hash was printed"
if grep -Eiwq -e '-?nan|-?inf' "$scratch/session.out"; then fail "a number that is none"; fi

# A mesh from memory, two tools, a load, a thousand states: without a file.
# shellcheck disable=SC2046
"$cc" -std=c17 -Wall -Wextra -Werror $(pkg-config --cflags lariat) "$source/examples/tries.c" \
    -o "$scratch/tries" $(pkg-config --libs lariat) -lm
"$scratch/tries" >"$scratch/tries.out" || fail "tries failed"
cat "$scratch/tries.out"
grep -Eq '^grasper  holds [1-9][0-9]* points' "$scratch/tries.out" || fail "the ridge is not held"
grep -Eq '^probe    touches [1-9][0-9]* points' "$scratch/tries.out" || fail "nothing is touched"
grep -q '^tries    1000, each back to the same state but 0;' "$scratch/tries.out" ||
    fail "a state that was gone back to is another one"
echo "install: pkg-config and CMake programs agree"
