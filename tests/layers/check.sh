#!/bin/sh
# The layer rule of docs/architecture.md, checked on every source file.
#
#   check.sh ROOT          checks ROOT/src
#   check.sh --self-test   plants one violation of each kind in a scratch tree and expects it found
#
# Rules: a file includes only from its own folder or from a folder of a lower layer; the viewers'
# server includes only lariat.h, base and its own, the command study besides; files do not include
# each other in a circle; vector intrinsics stay in simd.h and the kernels; no library file ends the
# process or prints. The Python module (python/) includes lariat.h, Python.h, the C library's headers
# and its own module.h. Files, levels of rooms and arrows that go up within a room have limits
# (sizes.awk). And what docs/architecture.md calls a file of a room is there.
set -eu

check_tree() {
    root=$1
    # shellcheck disable=SC2046
    set -- $(cd "$root" && find src -name '*.[ch]' -o -name '*.inc' | LC_ALL=C sort)
    [ $# -gt 0 ] || { echo "layers: no sources below $root/src"; return 1; }
    (cd "$root" && awk -f "$here/rooms.awk" -f "$here/rules.awk" "$@") || return 1
    (cd "$root" && awk -f "$here/rooms.awk" -f "$here/sizes.awk" "$@") || return 1
    check_python "$root" || return 1
    check_page "$root"
}

# The room outside src: what a program like any other sees.
check_python() {
    [ -d "$1/python" ] || return 0
    (cd "$1" && find python -name '*.[ch]' | LC_ALL=C sort | xargs awk '
        /^[ \t]*#[ \t]*include/ && !/include[ \t]*("module\.h"|<lariat\.h>|<Python\.h>|<(sys\/)?[a-z]+\.h>)/ {
            printf "%s:%d: python sees lariat.h and its own module.h only: %s\n", FILENAME, FNR, $0
            failed = 1
        }
        /(^|[^a-zA-Z_0-9])(exit|abort|printf|puts|stdout|stderr)([^a-zA-Z_0-9]|$)/ && !/^[ \t]*(\/?\*|")/ {
            printf "%s:%d: a module neither ends the process nor prints: %s\n", FILENAME, FNR, $0
            failed = 1
        }
        END { exit failed }')
}

# Every `room/file.c` of the page.
check_page() {
    page=$1/docs/architecture.md
    [ -f "$page" ] || return 0
    # shellcheck disable=SC2016
    missing=$(grep -o '`[a-z_0-9]*/[a-z_0-9/]*\.[ch]`' "$page" | tr -d '`' | sort -u |
        while read -r file; do
            [ -f "$1/$file" ] || [ -f "$1/src/$file" ] || echo "$file"
        done)
    [ -z "$missing" ] && return 0
    echo "layers: docs/architecture.md names what is not there: $missing"
    return 1
}

self_test() {
    scratch=$(mktemp -d)
    trap 'rm -rf "$scratch"' EXIT
    failures=0

    fresh() {
        rm -rf "$scratch/tree"
        for folder in base model mechanics divide comm simulation session server study cli; do
            mkdir -p "$scratch/tree/src/$folder"
            printf '#include "lariat.h"\n' >"$scratch/tree/src/$folder/a.h"
        done
        printf '#include "base/a.h"\n#include "model/a.h"\n/* never call exit(1) */\n%s\n' \
            'const char *s = "printf(\"x\"); // "; int f(int (*exit_early)(void));' \
            >"$scratch/tree/src/simulation/a.c"
    }
    # expect FILE LINE PATTERN: with LINE added to FILE, the check fails and says PATTERN.
    expect() {
        fresh
        printf '%s\n' "$2" >>"$scratch/tree/src/$1"
        if output=$(check_tree "$scratch/tree" 2>&1); then
            echo "self-test: not found: $2 in $1"
            failures=$((failures + 1))
        elif ! printf '%s\n' "$output" | grep -q "$3"; then
            echo "self-test: wrong message for $2 in $1: $output"
            failures=$((failures + 1))
        fi
    }

    fresh
    if ! check_tree "$scratch/tree" >/dev/null; then
        echo "self-test: a clean tree is refused:"
        check_tree "$scratch/tree" || true
        failures=$((failures + 1))
    fi
    expect base/a.h '#include "model/a.h"' 'base may not include model'
    expect model/a.h '#include "mechanics/a.h"' 'model may not include mechanics'
    expect mechanics/a.h '#include "divide/a.h"' 'mechanics may not include divide'
    expect divide/a.h '  #  include "comm/a.h"' 'divide may not include comm'
    expect comm/a.h '#include "simulation/a.h"' 'comm may not include simulation'
    expect simulation/a.h '#include "session/a.h"' 'simulation may not include session'
    expect session/a.h '#include "study/a.h"' 'session may not include study'
    expect server/a.h '#include "session/a.h"' 'server may not include session'
    expect server/a.h '#include "model/a.h"' 'server may not include model'
    expect study/a.h '#include "server/a.h"' 'study may not include server'
    expect cli/a.h '#include "simulation/a.h"' 'cli may not include simulation'
    expect cli/a.h '#include "model/a.h"' 'cli may not include model'
    expect model/a.h '#include "../simulation/a.h"' 'write the path from src'
    expect model/a.h '#include "model/none.h"' 'does not exist'
    expect model/a.h '#include "model/a.h"' 'circle'
    expect model/a.h '#include <immintrin.h>' 'intrinsics'
    expect simulation/a.c 'void g(void) { exit(1); }' 'exit'
    expect mechanics/a.h 'static void g(void) { /* x */ printf("%d", 1); }' 'printf'
    expect base/a.h 'static void g(void) { fprintf(stderr, "x"); }' 'stderr'
    expect comm/a.h 'static void g(void) { abort(); }' 'abort'

    # The Python module, which sees no room.
    for line in '#include "base/a.h"' '#include "../src/base/a.h"' '#include <model/a.h>' \
        'void g(void) { exit(1); }' 'void g(void) { printf("x"); }'; do
        fresh
        mkdir -p "$scratch/tree/python"
        printf '#include "module.h"\n%s\n' "$line" >"$scratch/tree/python/a.c"
        if check_tree "$scratch/tree" >/dev/null; then
            echo "self-test: not found in python/: $line"
            failures=$((failures + 1))
        fi
    done

    # A walk on the page to a file that has moved.
    fresh
    mkdir -p "$scratch/tree/docs"
    # shellcheck disable=SC2016
    echo 'First `base/a.h`, then `model/gone.c`.' >"$scratch/tree/docs/architecture.md"
    if ! check_tree "$scratch/tree" | grep -q 'not there: model/gone.c$'; then
        echo "self-test: a file that is not there was not missed on the page"
        failures=$((failures + 1))
    fi

    # A circle of three files.
    fresh
    printf '#include "model/c.h"\n' >"$scratch/tree/src/model/b.h"
    printf '#include "model/d.h"\n' >"$scratch/tree/src/model/c.h"
    printf '#include "model/b.h"\n' >"$scratch/tree/src/model/d.h"
    if check_tree "$scratch/tree" >/dev/null; then
        echo "self-test: a circle of three files was not found"
        failures=$((failures + 1))
    fi

    # too_much WORDS: the tree as it is now is refused with these.
    too_much() {
        if ! check_tree "$scratch/tree" | grep -q "$1"; then
            echo "self-test: not found: $1"
            failures=$((failures + 1))
        fi
    }
    fresh
    yes '/* a line */' | head -n 601 >"$scratch/tree/src/base/long.c"
    too_much 'base/long.c has more than 600 lines'
    fresh
    for i in $(seq 31); do echo '/* one of many */' >"$scratch/tree/src/base/b$i.h"; done
    too_much 'src/base has more than 30 files'
    # Five pairs that know each other; four are borne.
    fresh
    for i in 1 2 3 4 5; do
        check_tree "$scratch/tree" >/dev/null || too_much 'refused too early'
        printf '#include "model/y%s.h"\n' $i >"$scratch/tree/src/model/x$i.h"
        printf '#include "model/y%s.h"\n' $i >"$scratch/tree/src/model/y$i.c"
        printf '#include "model/x%s.h"\n' $i >>"$scratch/tree/src/model/y$i.c"
        echo '/* nothing */' >"$scratch/tree/src/model/y$i.h"
    done
    too_much 'src/model: 5 arrows go up'
    [ $failures -eq 0 ] && echo "layers: every planted violation was found"
}

here=$(cd "$(dirname "$0")" && pwd)
case ${1:-} in
--self-test) self_test ;;
'') echo "usage: check.sh ROOT | --self-test" >&2; exit 2 ;;
*) check_tree "$1" ;;
esac
