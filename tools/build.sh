#!/usr/bin/env bash
# Builds, and tells how far it is: one line that changes on a terminal, a line every fifth otherwise.
# What the compiler says is passed on.
#
#   tools/build.sh PRESET [JOBS]        PRESET: a build preset of CMakePresets.json
#
# The estimate takes the files that are left to be like those that are done; it is given once some
# are done.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1
preset=$1 jobs=${2:-2}
terminal=no
[ ! -t 2 ] || terminal=yes

# left DONE TOTAL SECONDS: an estimate in words.
left() {
    local seconds=$(($3 * ($2 - $1) / $1))
    if [ "$seconds" -ge 90 ]; then
        echo "about $(((seconds + 30) / 60)) minutes left"
    elif [ "$seconds" -ge 10 ]; then
        echo "about $(((seconds + 5) / 10 * 10)) s left"
    else
        echo "nearly done"
    fi
}

told=0 fifth=0
# tell DONE TOTAL
tell() {
    local done=$1 total=$2 words="compiling, $1 of $2"
    # Before two seconds there is nothing to go by; few files are no matter.
    [ "$SECONDS" -lt 2 ] || words="$words, $(left "$done" "$total" "$SECONDS")"
    if [ $terminal = yes ]; then
        printf '\r\033[Kbuild: %s' "$words" >&2
        told=1
    elif [ "$total" -ge 20 ] && [ $((5 * done / total)) -gt $fifth ]; then
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
    [ "$total" -lt 20 ] || printf 'build: %d steps in %d s\n' "$total" $SECONDS >&2
}
exit "${PIPESTATUS[0]}"
