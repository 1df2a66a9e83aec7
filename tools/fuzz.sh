#!/usr/bin/env bash
# What `make fuzz` runs: every fuzz target for FUZZ_SECONDS, with libFuzzer where clang has it,
# otherwise with the plain driver under gcc's sanitizers. New inputs collect in
# build-fuzz/corpus, inputs that fail in build-fuzz/failures.
set -euo pipefail
cd "$(dirname "$0")/.."
jobs=${JOBS:-2}
seconds=${FUZZ_SECONDS:-60}
root=$PWD

probe=$(mktemp -d)
trap 'rm -rf "$probe"' EXIT
libfuzzer=no
if printf 'int LLVMFuzzerTestOneInput(const unsigned char *d, unsigned long s);\nint LLVMFuzzerTestOneInput(const unsigned char *d, unsigned long s) { return d && s > 9; }\n' |
    clang -fsanitize=fuzzer,address,undefined -x c - -o "$probe/a" >/dev/null 2>&1; then
    libfuzzer=yes
fi

compiler=gcc
[ $libfuzzer = yes ] && compiler=clang
# A build folder keeps its compiler for life; the corpus in it stays.
if [ -f build-fuzz/CMakeCache.txt ] &&
    ! grep -q "^CMAKE_C_COMPILER:[A-Z]*=\(.*/\)\?$compiler\$" build-fuzz/CMakeCache.txt; then
    rm -rf build-fuzz/CMakeCache.txt build-fuzz/CMakeFiles
fi
if [ $libfuzzer = yes ]; then
    cmake --preset fuzz --log-level=NOTICE
else
    echo "fuzz: clang has no libFuzzer here, so the plain driver runs instead" >&2
    cmake --preset fuzz --log-level=NOTICE -DCMAKE_C_COMPILER=$compiler -DLARIAT_LIBFUZZER=OFF \
        -DLARIAT_SANITIZE=address,undefined
fi
cmake --build --preset fuzz -j "$jobs"

mkdir -p build-fuzz/failures
failed=""
count=0
for source in tests/fuzz/fuzz_*.c; do
    name=$(basename "$source" .c)
    name=${name#fuzz_}
    program=build-fuzz/tests/fuzz_$name
    [ -x "$program" ] || continue
    count=$((count + 1))
    echo "fuzz: $name for $seconds s"
    mkdir -p "build-fuzz/corpus/$name"
    seeds=()
    [ -d "tests/fuzz/seeds/$name" ] && seeds=("$root/tests/fuzz/seeds/$name")
    (
        cd build-fuzz/failures
        if [ $libfuzzer = yes ]; then
            "$root/$program" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 \
                -max_len=65536 -print_final_stats=1 -verbosity=1 \
                -artifact_prefix="$PWD/$name-" "$root/build-fuzz/corpus/$name" "${seeds[@]}" \
                >"$name.log" 2>&1 || { tail -n 60 "$name.log"; exit 1; }
            grep -E '^stat::number_of_executed_units|^Done' "$name.log" || true
        else
            "$root/$program" --runs 2000000000 --seconds "$seconds" "${seeds[@]}"
        fi
    ) || failed="$failed $name"
done

if [ $count -eq 0 ]; then
    echo "fuzz: there is no fuzz target yet" >&2
    exit 1
fi
if [ -n "$failed" ]; then
    echo "fuzz: FAILED:$failed; the inputs are in build-fuzz/failures" >&2
    exit 1
fi
echo "fuzz: $count targets, no failure"
