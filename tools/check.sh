#!/usr/bin/env bash
# What `make check` runs: the fast tests and the fuzz smoke tests with the address and
# undefined-behaviour sanitizers, what has several threads with the thread sanitizer, then the tests
# on the release build (all but those labelled long). All parts always run; the release build's
# closing line comes last. With --long, what `make check-long` runs: the tests labelled long, and in
# full what `make check` shortens or leaves out with the sanitizers. Where clang is there it builds the sanitized parts, so that both
# compilers see the code.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1
jobs=${JOBS:-2}
tests_at_once=$jobs release_tests=release kind=
if [ "${1:-}" = --long ]; then
    tests_at_once=1 release_tests=long kind=-long
fi
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
for preset in asan tsan; do
    if [ -f build-$preset/CMakeCache.txt ] &&
        ! grep -q "^CMAKE_C_COMPILER:[A-Z]*=\(.*/\)\?$sanitizer_cc\$" \
            build-$preset/CMakeCache.txt; then
        rm -rf build-$preset
    fi
done

cmake --preset release --log-level=NOTICE -DLARIAT_WERROR="$werror" &&
    cmake --build --preset release -j "$jobs" || exit 1

# suite PRESET: the tests of one build, shown and kept. In short slices of time: processors of a
# simulation that wait for each other beside another test wait shorter.
suite() {
    build/tests/short_slices ctest --preset "$1" -j "$tests_at_once" --no-label-summary 2>&1 | tee "$logs/$1"
}
closing_line() {
    grep -h '% tests passed' "$logs/$1" 2>/dev/null | tail -n 1
}
logs=$(mktemp -d)
trap 'rm -rf "$logs"' EXIT

# sanitized PRESET: builds and tests with a sanitizer.
sanitized() {
    cmake --preset "$1" --log-level=NOTICE -DCMAKE_C_COMPILER="$sanitizer_cc" \
        -DLARIAT_WERROR="$werror" &&
        cmake --build --preset "$1" -j "$jobs" &&
        suite "$1$kind"
}
failed=""
for preset in asan tsan; do
    sanitized $preset || failed="$failed $preset"
done

release=yes
suite $release_tests || release=no

echo
for preset in asan tsan; do
    case " $failed " in
    *" $preset "*)
        echo "check: the part with the sanitizer $preset ($sanitizer_cc) FAILED, see above; alone:" \
            "ctest --preset $preset$kind" >&2
        ;;
    *) echo "sanitizer $preset ($sanitizer_cc): $(closing_line $preset$kind)" ;;
    esac
done
closing_line $release_tests
[ -z "$failed" ] && [ $release = yes ]
