#!/usr/bin/env bash
# How much fifty viewers slow the engine: `lariat view` on the demonstration organ, alone and looked
# at, in turns, and the median over the turns of a step's median time. They must not make a step
# longer by more than 5 %. A busy machine makes both slower; the turns are short and alternate, so
# that it does so to both.
#
#   tools/bench_viewers.sh [BUILD] [TURNS]      default: build, 5
#
# The viewers are one more process on the same machine, which takes its share of the cores: with two
# cores the engine has one, and server and viewers the other.
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build} turns=${2:-5}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$build/lariat" demo-model "$scratch/demo" >/dev/null

# value KEY FILE: of the report.
value() { "$build/tests/json_check" --print "$1" <"$2"; }

# turn NAME: one run; with viewers when NAME is looked.
turn() {
    "$build/lariat" view "$scratch/demo/uterus_live.yaml" --port 0 --seconds 6 --json \
        >"$scratch/out" 2>"$scratch/err" &
    local engine=$! port=""
    for _ in $(seq 100); do
        port=$(sed -n 's/^http:.*:\([0-9]*\)\/$/\1/p' "$scratch/err")
        [ -z "$port" ] || break
        sleep 0.05
    done
    if [ "$1" = looked ]; then
        "$build/tests/test_session_server_many" look "$port" 7 >"$scratch/frames" 2>/dev/null || true
    fi
    wait $engine
    value wall_per_step_us.p50 "$scratch/out" >>"$scratch/$1"
    printf '%-7s a step %6.2f us, 99 %% below %7.2f; ticks missed %s of %s\n' "$1" \
        "$(value wall_per_step_us.p50 "$scratch/out")" "$(value wall_per_step_us.p99 "$scratch/out")" \
        "$(value deadline_misses "$scratch/out")" "$(value ticks "$scratch/out")"
}

for _ in $(seq "$turns"); do
    turn alone
    turn looked
done
median() { sort -n "$1" | awk '{ v[NR] = $1 } END { print NR % 2 ? v[(NR + 1) / 2] : (v[NR / 2] + v[NR / 2 + 1]) / 2 }'; }
awk -v alone="$(median "$scratch/alone")" -v looked="$(median "$scratch/looked")" 'BEGIN {
    more = 100 * (looked / alone - 1)
    printf "alone %.2f us, with fifty viewers %.2f us: %+.1f %% (bound 5 %%)\n", alone, looked, more
    exit more > 5 }'
