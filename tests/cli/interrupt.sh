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
# first signal ends it, with all that belongs to it. All of them get it, as from a terminal or
# a supervisor, and twice, as from GNU timeout.
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
    # shellcheck disable=SC2086
    kill -$signal $others $pid
    # shellcheck disable=SC2086
    kill -$signal $others $pid 2>/dev/null
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
for signal in INT TERM HUP; do
    interrupt $signal
    interrupt $signal --grid 2x2x1
    interrupt $signal --grid 2x1x1 --comm shm
    interrupt $signal --grid 3x1x1 --comm tcp
done
# What batch systems send before the end, and the system at a limit of processor time.
interrupt USR1 --grid 2x1x1 --comm shm
interrupt USR2
interrupt XCPU --grid 2x1x1 --comm tcp
(
    ulimit -S -t 1
    exec "$LARIAT" run "$SOURCE/examples/beam.yaml" --time 3600 --grid 1x1x1 --json \
        --save "$SCRATCH/cpu.checkpoint"
) >"$SCRATCH/out" 2>"$SCRATCH/err"
[ $? -eq 130 ] || fail "no interruption at the limit of processor time: $(cat "$SCRATCH/err")"
[ "$(value_of interrupted)" = true ] || fail "a run without processor time is not interrupted"
[ -s "$SCRATCH/cpu.checkpoint" ] || fail "no state when the processor time is used up"

# A session that all of its group is told to end, twice: no processor is lost.
if "$LARIAT" view "$SOURCE/examples/beam.yaml" --port 0 --seconds 0.1 --json >/dev/null 2>&1; then
    "$LARIAT" view "$SOURCE/examples/beam.yaml" --port 0 --grid 2x1x1 --comm shm --json \
        >"$SCRATCH/out" 2>"$SCRATCH/err" &
    pid=$!
    for _ in $(seq 300); do
        grep -q '^http' "$SCRATCH/err" && break
        sleep 0.1
    done
    sleep 0.3
    others=$(children $pid)
    [ -n "$others" ] || fail "no other process of the session"
    # shellcheck disable=SC2086
    kill -TERM $others $pid
    # shellcheck disable=SC2086
    kill -TERM $others $pid 2>/dev/null
    wait $pid
    status=$?
    [ $status -eq 0 ] || fail "a session that is told to end: status $status"
    grep -q 'is lost' "$SCRATCH/err" && fail "a processor is lost at the end of a session"
    has_keys url state
fi

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
steps=$(value_of steps)

# Before there is anything to end with: one sentence, and nothing is left.
listens() { # until it catches SIGTERM
    for _ in $(seq 300); do
        case $(sed -n 's/^SigCgt:.*\(.\)...$/\1/p' "/proc/$1/status") in [4567cdef]) return ;; esac
        sleep 0.02
    done
    fail "process $1 listens for no signal"
}
leave() {
    kill -TERM $pid
    wait $pid
    status=$?
    [ $status -eq 130 ] || fail "exit status $status instead of 130: $*"
    [ ! -s "$SCRATCH/out" ] || fail "output of $*"
    [ "$(cat "$SCRATCH/err")" = "lariat $1: interrupted" ] ||
        fail "instead of one sentence: $(cat "$SCRATCH/err")"
}
early() {
    "$LARIAT" "$@" >"$SCRATCH/out" 2>"$SCRATCH/err" &
    pid=$!
    listens $pid
    leave "$@"
}
early verify "$SOURCE/examples/beam.yaml" --steps 1000000000 --json
early bench jitter --seconds 60 --json
port=$((20000 + $$ % 12000))
for who in 0 1; do
    set -- run "$SOURCE/examples/beam.yaml" --grid 2x1x1 --comm shm --processor $who \
        --master 127.0.0.1:$port
    "$LARIAT" "$@" >"$SCRATCH/out" 2>"$SCRATCH/err" &
    pid=$!
    memory=
    for _ in $(seq 300); do
        memory=$(sed -n 's,.* \(/dev/shm/lariat-comm[^ ]*\)$,\1,p' /proc/$pid/maps | head -n 1)
        [ -n "$memory" ] && break
        sleep 0.02
    done
    [ -e "$memory" ] || fail "processor $who waits without memory"
    if [ $who = 0 ]; then
        leave "$@"
    else # it has a number of its own in messages
        kill -TERM $pid
        wait $pid
        [ $? -eq 130 ] || fail "processor 1 does not leave: $(cat "$SCRATCH/err")"
    fi
    [ ! -e "$memory" ] || fail "$memory is left by processor $who"
done

# At any moment of the start of several processes: the status, no process and no other words.
# (UCX stays as it is then: the address sanitizer would find its memory when the process ends.)
export ASAN_OPTIONS="${ASAN_OPTIONS:+$ASAN_OPTIONS:}detect_leaks=0"
for comm in shm tcp $("$LARIAT" doctor --no-speed | grep -q 'yes *--comm ucx' && echo ucx); do
    for wait in 0 0.01 0.02 0.03 0.04 0.05 0.06 0.08 0.1 0.15 0.2; do
        "$LARIAT" run "$SOURCE/examples/beam.yaml" --time 3600 --grid 2x1x1 --comm "$comm" --json \
            >"$SCRATCH/out" 2>"$SCRATCH/err" &
        pid=$!
        listens $pid
        sleep $wait
        others=$(children $pid)
        kill -TERM $pid
        wait $pid
        status=$?
        [ $status -eq 130 ] || fail "status $status, SIGTERM $wait s into --comm $comm"
        for other in $others; do
            [ ! -e "/proc/$other" ] || fail "process $other is left by --comm $comm"
        done
        [ ! -s "$SCRATCH/err" ] || [ "$(cat "$SCRATCH/err")" = "lariat run: interrupted" ] ||
            fail "SIGTERM $wait s into --comm $comm: $(cat "$SCRATCH/err")"
    done
done

# Too few open files: who cannot begin takes with it whom it has started.
for files in 5 6; do
    ls /dev/shm >"$SCRATCH/before"
    (
        ulimit -n $files
        exec "$LARIAT" run "$SOURCE/examples/beam.yaml" --grid 2x1x1 --comm shm --steps 10
    ) >"$SCRATCH/out" 2>"$SCRATCH/err"
    [ $? -eq 1 ] || fail "a run with $files files"
    for left in $(ls /dev/shm | grep '^lariat-comm' | grep -vxFf "$SCRATCH/before"); do
        flock -n "/dev/shm/$left" true && fail "$left is left with $files files"
    done
done
finish "interrupted after $steps steps"
