#!/bin/sh
# Ctrl-C, or a batch system's request to end, ends a run with what there is.
. "$(dirname "$0")/lib.sh"

for signal in INT TERM; do
    # Paced, so that it would take an hour.
    results=$SCRATCH/$signal
    "$LARIAT" run "$SOURCE/examples/beam.yaml" --time 3600 --realtime --json --out "$results" \
        >"$SCRATCH/out" 2>"$SCRATCH/err" &
    pid=$!
    for _ in 1 2 3 4 5 6 7 8 9 10; do
        [ -e "$results/probes.csv" ] && break
        sleep 0.2
    done
    sleep 0.2
    kill -$signal $pid
    wait $pid
    status=$?
    [ $status -eq 130 ] || fail "exit status $status instead of 130 after SIG$signal"
    has_keys state_hash --numbers steps frames
    [ "$(value_of interrupted)" = true ] || fail "the summary does not say interrupted"
    [ "$(value_of steps)" -gt 0 ] || fail "no step was done"
    [ -e "$results/beam_000000.vtu" ] || fail "the last state was not written"
    cmp -s "$SCRATCH/out" "$results/run.json" || fail "run.json differs from --json"
done
finish "interrupted after $(value_of steps) steps"
