#!/bin/sh
# Processors as processes: the same hash, who is lost is named, nothing stays behind.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1
scene=$SOURCE/examples/beam.yaml # small: processes share the cores of whatever machine this is
expect 0 "$LARIAT" run $scene --steps 40 --json
hash=$(value_of state_hash)

# Process K of the run that process PID has started.
other() {
    for stat in /proc/[0-9]*/stat; do
        read -r pid _ _ parent _ 2>/dev/null <"$stat" || continue
        [ "$parent" = "$1" ] || continue
        tr '\0' ' ' <"/proc/$pid/cmdline" | grep -q -e "--processor $2 " && echo "$pid"
    done
}
# Nobody runs and nothing of ours is left in shared memory; what another test uses is locked, but
# for a moment when it comes and when it goes.
is_left() {
    for _ in $(seq 25); do
        [ -e "$1" ] && flock -n "$1" true || return 1
        sleep 0.2
    done
}
nothing_left() {
    for pid in "$@"; do
        for _ in $(seq 50); do
            [ -e "/proc/$pid" ] || break
            sleep 0.2
        done
        [ ! -e "/proc/$pid" ] || fail "process $pid is left"
    done
    for object in /dev/shm/lariat-comm-*; do
        command -v flock >/dev/null && is_left "$object" && fail "$object is left"
    done
}

comms='shm tcp'
"$LARIAT" run $scene --steps 1 --grid 1x1x1 --comm ucx >/dev/null 2>&1 && comms="$comms ucx"
for comm in $comms; do
    for grid in 2x1x1 2x2x1; do
        expect 0 "$LARIAT" run $scene --steps 40 --json --grid $grid --comm $comm
        [ "$(value_of state_hash)$(value_of comm)" = "$hash\"$comm\"" ] ||
            fail "$comm, $grid: $(value_of state_hash), not $hash"
        [ ! -s err ] || fail "messages during a good run by $comm"
    done
    expect 0 "$LARIAT" verify $scene --grid 2x1x1 --threads 2 --comm $comm --steps 40 --json
    [ "$(value_of state_hash)" = "$hash" ] || fail "verify by $comm: $(value_of state_hash)"
done

# Until process K of the run runs: it has a second thread, its watch, when all have met. Sets $pid.
await_other() {
    for _ in $(seq 150); do
        pid=$(other $zero "$1")
        [ -n "$pid" ] && [ "$(find "/proc/$pid/task" -maxdepth 1 | wc -l)" -gt 2 ] && return
        sleep 0.2
    done
    fail "processor $1 does not start"
}

# Nothing of it is left but what processor zero has to hear.
ended() {
    [ ! -e "/proc/$1" ] || [ "$(cut -d ' ' -f 3 "/proc/$1/stat" 2>/dev/null)" = Z ] ||
        [ ! -e "/proc/$1" ]
}

# One is killed or stopped: every other one says so, in time.
lose() {
    signal=$1 comm=$2 victim=$3
    "$LARIAT" run $scene --steps 1000000000 --grid 3x1x1 --comm "$comm" --json >out 2>err &
    zero=$!
    await_other 1
    one=$pid
    await_other 2
    two=$pid
    sleep 0.5
    case $victim in 0) pid=$zero ;; 1) pid=$one ;; 2) pid=$two ;; esac
    kill "-$signal" "$pid" || fail "no processor $victim to lose"
    case $signal$victim in
    STOP0)
        # Long before their patience ends (20 s); how soon exactly, comm/lost measures.
        for pid in $one $two; do
            for _ in $(seq 50); do
                ended "$pid" && break
                sleep 0.2
            done
            ended "$pid" || fail "process $pid still runs"
        done
        kill -CONT $zero
        ;;
    esac
    wait $zero
    status=$?
    [ $status -ne 0 ] || fail "success without processor $victim"
    silent
    nothing_left "$one" "$two"
    for who in 0 1 2; do
        [ $who = "$victim" ] && continue
        prefix="processor $who: "
        [ $who = 0 ] && prefix=
        grep -q "^lariat run: ${prefix}processor $victim is lost: .*last complete step of processor $who is [0-9]" err || {
            fail "processor $who does not tell that $victim is lost ($signal, $comm)"
            cat err >&2
        }
    done
}
for comm in shm tcp; do
    lose KILL $comm 2
    complains 'processor 2 was ended by signal 9'
done
lose PROF shm 1
complains 'processor 1 was ended by signal 27'
lose KILL shm 0
lose STOP shm 1
complains 'processor 1 was stopped by signal'
lose STOP tcp 0

# One that ends on its way to processor zero: nobody waits for it until the limit of the start. All
# search for a distribution meanwhile, so that there is time to lose one.
"$LARIAT" demo-model organ >/dev/null || fail "no demonstration organ"
for signal in KILL STOP; do
    "$LARIAT" run organ/uterus.yaml --steps 3 --grid 2x1x1 --comm shm --distribution genetic --json \
        >out 2>err &
    zero=$!
    pid=
    for _ in $(seq 600); do
        pid=$(other $zero 1)
        [ -n "$pid" ] && break
        sleep 0.05
    done
    began=$(date +%s)
    kill -$signal "$pid" || fail "no processor 1 to lose on its way"
    wait $zero && fail "success without processor 1"
    silent
    complains 'processor 1 was \(ended by signal 9\|stopped by signal\).*before it came'
    [ "$(wc -l <err)" -eq 1 ] || fail "told $(wc -l <err) times"
    [ $(($(date +%s) - began)) -lt 20 ] || fail "waited for a processor that had ended ($signal)"
    nothing_left "$pid"
done

# A session that rests waits for nobody, and notices all the same; so does one in slow motion, where
# the next tick is due a second later.
if "$LARIAT" view organ/uterus_live.yaml --port 0 --seconds 0.1 --json >/dev/null 2>&1; then
    for case in 'shm --paused' 'tcp --paused' 'shm --pace 0.001'; do
        # shellcheck disable=SC2086
        "$LARIAT" view organ/uterus_live.yaml --port 0 --grid 2x1x1 --json --comm $case >out 2>err &
        zero=$!
        await_other 1
        for _ in $(seq 150); do
            grep -q '^http' err && break
            sleep 0.2
        done
        sleep 1
        began=$(date +%s)
        kill -KILL "$pid" || fail "no processor 1 to lose at rest"
        for _ in $(seq 40); do
            ended $zero && break
            sleep 0.2
        done
        ended $zero || fail "a session ($case) goes on without processor 1"
        kill -TERM $zero 2>/dev/null
        wait $zero
        status=$?
        [ $status -eq 1 ] || fail "exit status $status instead of 1 ($case)"
        [ $(($(date +%s) - began)) -lt 5 ] || fail "noticed late ($case)"
        complains 'processor 1 is lost: its process or its connection ended'
        nothing_left "$pid"
    done
fi

# By hand; and who does not belong to it.
port=$((20000 + $$ % 12000)) # below those that the system gives out by itself
by_hand() {
    "$LARIAT" "$@" --grid 2x1x1 --comm tcp --processor 1 --master 127.0.0.1:$port >other 2>complaint &
    pid=$!
}
by_hand run $scene --steps 40 --json --out not-here
expect 0 "$LARIAT" run $scene --steps 40 --json --grid 2x1x1 --comm tcp --processor 0 \
    --master 127.0.0.1:$port
wait $pid || fail "processor 1 failed"
[ "$(value_of state_hash)" = "$hash" ] || fail "by hand: $(value_of state_hash), not $hash"
[ ! -s other ] && [ ! -e not-here ] || fail "processor 1 wrote something"
# Until it listens for all signals but SIGTERM, the bit 0x4000 (after the start, in which it does).
await_service() {
    for _ in $(seq 300); do
        caught=$(sed -n 's/^SigCgt:.*\(....\)$/\1/p' "/proc/$pid/status")
        case $caught in [012389ab]??[2367abef]) break ;; esac
        sleep 0.05
    done
}
# Ctrl-C in the other's terminal says where it belongs; there it ends both.
port=$((port + 1))
by_hand run $scene --time 60 --realtime
"$LARIAT" run $scene --time 60 --realtime --grid 2x1x1 --comm tcp --processor 0 \
    --master 127.0.0.1:$port >zero 2>&1 &
zero=$!
await_service
for try in $(seq 100); do
    kill -INT $pid 2>/dev/null || break
    sleep 0.05
    grep -q 'Ctrl-C at processor 0 ends the run' complaint && break
    [ "$try" -lt 100 ] || fail "processor 1 says nothing"
done
sleep 0.3
kill -INT $zero
wait $zero
status=$?
[ $status -eq 130 ] || fail "processor 0 ended with $status: $(cat zero)"
wait $pid || fail "processor 1 did not go on to the end: $(cat complaint)"
# A second signal at once does not count again; one half a second later does.
port=$((port + 1))
by_hand run $scene --time 60 --realtime
"$LARIAT" run $scene --time 60 --realtime --grid 2x1x1 --comm tcp --processor 0 \
    --master 127.0.0.1:$port >zero 2>&1 &
zero=$!
await_service
kill -INT $pid
kill -INT $pid
sleep 0.7
kill -0 $pid 2>/dev/null || fail "two signals at once ended processor 1: $(cat complaint)"
kill -INT $pid
wait $pid
[ $? -gt 128 ] || fail "a second Ctrl-C did not end processor 1"
wait $zero
[ $? -eq 1 ] || fail "processor 0 does not miss processor 1: $(cat zero)"
for wrong in "run $scene --time-step 1e-6" "run $scene --distribution random" "verify $scene"; do
    port=$((port + 1))
    # shellcheck disable=SC2086
    by_hand $wrong
    expect 1 "$LARIAT" run $scene --steps 40 --grid 2x1x1 --comm tcp --processor 0 \
        --master 127.0.0.1:$port
    case $wrong in
    *time-step*) differs='has a time step of 1e-06 s, processor 0 one of' ;;
    *) differs='has another model or schedule' ;;
    esac
    complains "processor 1 $differs"
    wait $pid && fail "processor 1 joined as $wrong"
    grep -q "processor 1: processor 1 $differs" complaint || fail "no word: $wrong"
done

refuse() {
    wanted=$1 sentence=$2
    shift 2
    expect "$wanted" "$LARIAT" run $scene --steps 1 --grid 2x1x1 "$@"
    complains "$sentence"
    silent
}
refuse 2 'threads, shm, ucx, mpi, tcp' --comm pigeon
refuse 2 'give --master' --comm tcp --processor 1
refuse 2 'give --comm' --processor 1 --master 127.0.0.1:1
refuse 2 'say which one' --comm tcp --master 127.0.0.1:1
refuse 2 'they count from 0' --comm tcp --processor 2 --master 127.0.0.1:1
refuse 2 'write host:port' --comm tcp --processor 0 --master nowhere
refuse 2 'a port is a number' --comm tcp --processor 1 --master localhost:99999
refuse 1 'cannot be used as a folder' --comm shm --out /dev/null/x
refuse 1 'stable step' --comm shm --time-step 1
[ "$(wc -l <err)" -eq 1 ] || fail "one failure is told $(wc -l <err) times"
# What to do: call mpirun, or get an MPI first where this build has none.
[ -n "${OMPI_COMM_WORLD_RANK-}${PMI_RANK-}${SLURM_PROCID-}" ] ||
    refuse 1 'mpirun -n 2 lariat\|found no MPI; install libopenmpi-dev or libmpich-dev' --comm mpi

# Ctrl-C in a terminal reaches all of them; processor zero ends the run.
"$LARIAT" run $scene --time 3600 --realtime --grid 2x1x1 --comm shm --json >out 2>err &
zero=$!
await_other 1
sleep 0.5
kill -INT $zero "$pid"
wait $zero
status=$?
[ $status -eq 130 ] || fail "exit status $status instead of 130 after SIGINT"
[ "$(value_of interrupted)" = true ] || fail "the summary does not say interrupted"
[ ! -s err ] || fail "messages after Ctrl-C"
nothing_left "$pid"
finish "processes: the same hash by $comms, losses told, nothing left"
