#!/bin/sh
# Ctrl-C, or a batch system's request to end, ends a run with what there is.
. "$(dirname "$0")/lib.sh"

# The processes that process PID has started.
children() {
    for stat in /proc/[0-9]*/stat; do
        read -r child _ _ parent _ 2>/dev/null <"$stat" || continue
        [ "$parent" = "$1" ] && echo "$child"
    done
}

# interrupt SIGNAL OPTIONS...: one run, on one processor or on several, threads or processes. The
# first signal ends it, with all that belongs to it.
interrupt() {
    signal=$1
    shift
    # Paced, so that it would take an hour.
    results=$SCRATCH/$signal
    rm -rf "$results"
    "$LARIAT" run "$SOURCE/examples/beam.yaml" --time 3600 --realtime --json --out "$results" \
        "$@" >"$SCRATCH/out" 2>"$SCRATCH/err" &
    pid=$!
    for _ in $(seq 300); do
        [ -e "$results/probes.csv" ] && break
        sleep 0.2
    done
    sleep 0.2
    others=$(children $pid)
    case "$*" in *shm* | *tcp*) [ -n "$others" ] || fail "no other process with $*" ;; esac
    began=$(date +%s)
    kill -$signal $pid
    wait $pid
    status=$?
    [ $status -eq 130 ] || fail "exit status $status instead of 130 after SIG$signal $*"
    [ $(($(date +%s) - began)) -lt 10 ] || fail "SIG$signal $*: ended after 10 s only"
    for other in $others; do
        [ ! -e "/proc/$other" ] || fail "process $other is left after SIG$signal $*"
    done
    [ ! -s "$SCRATCH/err" ] || fail "messages after SIG$signal $*: $(cat "$SCRATCH/err")"
    has_keys state_hash --numbers steps frames
    [ "$(value_of interrupted)" = true ] || fail "the summary does not say interrupted"
    [ "$(value_of steps)" -gt 0 ] || fail "no step was done"
    [ -e "$results/beam_000000.vtu" ] || fail "the last state was not written"
    cmp -s "$SCRATCH/out" "$results/run.json" || fail "run.json differs from --json"
}
for signal in INT TERM; do
    interrupt $signal
    interrupt $signal --grid 2x2x1
    interrupt $signal --grid 2x1x1 --comm shm
    interrupt $signal --grid 3x1x1 --comm tcp
done

# As early as it is heard at all, perhaps before the first step: every number is a number.
for wait in 0 0.001 0.003 0.01; do
    rm -rf "$SCRATCH/early"
    "$LARIAT" run "$SOURCE/examples/beam.yaml" --time 3600 --json --out "$SCRATCH/early" \
        --grid 1x1x1 >"$SCRATCH/out" 2>"$SCRATCH/err" &
    pid=$!
    for _ in $(seq 3000); do
        [ -e "$SCRATCH/early/probes.csv" ] && break
        sleep 0.002
    done
    sleep $wait
    kill -INT $pid
    wait $pid
    status=$?
    [ $status -eq 130 ] || fail "exit status $status after an early SIGINT"
    [ ! -s "$SCRATCH/err" ] || fail "messages after an early SIGINT: $(cat "$SCRATCH/err")"
    has_keys state_hash --numbers steps frames ns_per_element real_time_factor
done
finish "interrupted after $(value_of steps) steps"
