#!/usr/bin/env bash
# What `make check` runs: the fast tests and the fuzz smoke tests with the address and
# undefined-behaviour sanitizers, then every test on the release build. Both parts always run;
# the release build's closing line comes last. Where clang is there it builds the sanitized half,
# so that both compilers see the code.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1
jobs=${JOBS:-2}
werror=${WERROR:-OFF} # continuous integration sets it ON; a newer compiler may warn of new things

sanitizer_cc=${SANITIZER_CC:-}
if [ -z "$sanitizer_cc" ]; then
    sanitizer_cc=gcc
    probe=$(mktemp -d)
    if printf 'int main(void) { return 0; }\n' |
        clang -fsanitize=address,undefined -x c - -o "$probe/a" >/dev/null 2>&1; then
        sanitizer_cc=clang
    fi
    rm -rf "$probe"
fi

# A build folder keeps its compiler for life: start again when it was made with another one.
if [ -f build-asan/CMakeCache.txt ] &&
    ! grep -q "^CMAKE_C_COMPILER:[A-Z]*=\(.*/\)\?$sanitizer_cc\$" build-asan/CMakeCache.txt; then
    rm -rf build-asan
fi

cmake --preset release --log-level=NOTICE -DLARIAT_WERROR="$werror" &&
    cmake --build --preset release -j "$jobs" || exit 1

# suite PRESET: the tests of one build, shown and kept.
suite() {
    ctest --preset "$1" -j "$jobs" --no-label-summary 2>&1 | tee "$logs/$1"
}
closing_line() {
    grep -h '% tests passed' "$logs/$1" 2>/dev/null | tail -n 1
}
logs=$(mktemp -d)
trap 'rm -rf "$logs"' EXIT

sanitized=yes
{
    cmake --preset asan --log-level=NOTICE -DCMAKE_C_COMPILER="$sanitizer_cc" \
        -DLARIAT_WERROR="$werror" &&
        cmake --build --preset asan -j "$jobs" &&
        suite asan
} || sanitized=no

release=yes
suite release || release=no

echo
if [ $sanitized = yes ]; then
    echo "sanitizers ($sanitizer_cc): $(closing_line asan)"
else
    echo "check: the part with the sanitizers ($sanitizer_cc) FAILED, see above; alone:" \
        "ctest --preset asan" >&2
fi
closing_line release
[ $sanitized = yes ] && [ $release = yes ]
