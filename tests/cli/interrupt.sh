#!/bin/sh
# Ctrl-C ends a run with what there is.
. "$(dirname "$0")/lib.sh"

# A shell without job control starts background programs with SIGINT ignored, so SIGTERM, which is
# treated alike, is sent; the paced run would take an hour.
"$LARIAT" run "$SOURCE/examples/beam.yaml" --time 3600 --realtime --json --out "$SCRATCH/results" \
    >"$SCRATCH/out" 2>"$SCRATCH/err" &
pid=$!
for _ in 1 2 3 4 5 6 7 8 9 10; do
    [ -e "$SCRATCH/results/probes.csv" ] && break
    sleep 0.2
done
sleep 0.2
kill -TERM $pid
wait $pid
status=$?
[ $status -eq 130 ] || fail "exit status $status instead of 130"
has_keys state_hash --numbers steps frames
[ "$(value_of interrupted)" = true ] || fail "the summary does not say that it was interrupted"
[ "$(value_of steps)" -gt 0 ] || fail "no step was done"
[ -e "$SCRATCH/results/beam_000000.vtu" ] || fail "the last state was not written"
finish "interrupted after $(value_of steps) steps"
