#!/usr/bin/env bash
# Builds, and tells how far it is: one line that changes on a terminal, a line every fifth otherwise.
# What the compiler says is passed on.
#
#   tools/build.sh PRESET [JOBS]        PRESET: a build preset of CMakePresets.json
#
# At first a file is taken to need what it needs in the mean on a processor of 2024; after two seconds
# the files that are left are taken to be like those that are done.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1
preset=$1 jobs=${2:-2}
terminal=no
[ ! -t 2 ] || terminal=yes

MS_PER_FILE=350 MANY=20 # fewer steps are not worth a word but on a terminal
# left DONE TOTAL: an estimate in words.
left() {
    local seconds=$((MS_PER_FILE * $2 / jobs / 1000))
    [ "$SECONDS" -lt 2 ] || [ "$1" -lt 2 ] || seconds=$((SECONDS * ($2 - $1) / $1))
    if [ "$seconds" -ge 90 ]; then
        echo "about $(((seconds + 30) / 60)) minutes left"
    elif [ "$seconds" -ge 10 ]; then
        echo "about $(((seconds + 5) / 10 * 10)) s left"
    else
        echo "nearly done"
    fi
}

told=0 fifth=-1
# tell DONE TOTAL
tell() {
    local done=$1 total=$2 words
    words="step $1 of $2, $(left "$1" "$2")"
    if [ $terminal = yes ]; then
        printf '\r\033[Kbuild: %s' "$words" >&2
        told=1
    elif [ "$total" -ge "$MANY" ] && [ $((5 * done / total)) -gt $fifth ]; then
        fifth=$((5 * done / total))
        printf 'build: %s\n' "$words" >&2
    fi
}
wipe() {
    [ $told = 0 ] || printf '\r\033[K' >&2
    told=0
}

SECONDS=0
mark=$'\001'
NINJA_STATUS="$mark%f/%t$mark" cmake --build --preset "$preset" -j "$jobs" 2>&1 | {
    total=0
    while IFS= read -r line; do
        case $line in
        "$mark"*)
            line=${line#"$mark"}
            counts=${line%%"$mark"*}
            total=${counts#*/}
            tell "${counts%/*}" "$total"
            ;;
        'ninja: no work to do.') ;;
        *)
            wipe
            printf '%s\n' "$line" >&2
            ;;
        esac
    done
    wipe
    # The page and the commit are looked at every time.
    [ "$total" -lt "$MANY" ] || printf 'build: %d steps in %d s\n' "$total" $SECONDS >&2
}
exit "${PIPESTATUS[0]}"
