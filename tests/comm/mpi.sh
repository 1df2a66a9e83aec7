#!/bin/sh
# Processors that mpirun has started.
#
#   mpi.sh openmpi|mpich MODULE FOLDER [PACKETS]
#
# FOLDER holds the test programs. With PACKETS only the test for torn packets runs, with so many.
# Without an mpirun of that MPI, or where it does not work: skipped.
set -eu
name=$1 folder=$3 packets=${4:-}
export LARIAT_MPI=$2
log=$(mktemp)
trap 'rm -f "$log"' EXIT

fail() {
    echo "mpi: $name: $*" >&2
    cat "$log" >&2
    exit 1
}

skip() {
    echo "skipped: $*"
    exit 77
}

# Both commands are called mpirun where only one MPI is installed.
case $name in openmpi) word="Open" ;; *) word="HYDRA" ;; esac
mpirun=
for command in "mpirun.$name" mpirun; do
    if command -v "$command" >/dev/null && "$command" --version 2>&1 | grep -q "$word"; then
        mpirun=$command
        break
    fi
done
[ -n "$mpirun" ] || skip "no mpirun of $name"
# Open MPI: more processors than cores, their watch on any core, and as root in a container.
export OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_hwloc_base_binding_policy=none
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
# The libraries leave memory behind, from plugins that are gone when it is looked for.
export ASAN_OPTIONS=detect_leaks=0
# Open MPI's TCP takes its locks in two orders.
export TSAN_OPTIONS=detect_deadlocks=0

# start SECONDS COUNT PROGRAM ...
start() {
    limit=$1 count=$2
    shift 2
    timeout -k 5 "$limit" "$mpirun" -n "$count" "$@" >"$log" 2>&1
}

# What must end well.
good() {
    start "$@" || fail "status $? of $*"
}

start 30 2 true || skip "mpirun of $name does not work here: $(tail -n 3 "$log")"

if [ -n "$packets" ]; then
    good 500 2 "$folder/test_comm_torn" "$packets"
    exit 0
fi

good 60 3 "$folder/test_comm_mpi" find
sort "$log" | tr '\n' ' ' | grep -q '0 of 3 1 of 3 2 of 3' || fail "the processors got no numbers"
good 60 1 "$folder/test_comm_mpi" find
grep -qx '0 of 1' "$log" || fail "one processor is not alone"
good 200 12 "$folder/test_comm_comm"
good 100 3 "$folder/test_comm_threads"
good 100 2 "$folder/test_comm_torn" 100000
good 60 2 "$folder/test_comm_mpi" large

# Two that do not share a loopback, as far as they can tell, meet at an address of this machine.
# shellcheck disable=SC2016
if unshare -u sh -c 'echo "$0" >/proc/sys/kernel/hostname' "$(hostname)" 2>/dev/null; then
    good 60 2 sh -c 'case ${OMPI_COMM_WORLD_RANK:-$PMI_RANK} in
        0) exec "$@" ;;
        *) exec unshare -u sh -c "echo elsewhere >/proc/sys/kernel/hostname; exec \"\$@\"" sh "$@" ;;
        esac' sh "$folder/test_comm_torn" 2000
fi

# A module that does not belong to this mpirun.
for other in openmpi mpich; do
    module=$(dirname "$LARIAT_MPI")/liblariat-mpi-$other.so
    [ "$other" != "$name" ] && [ -e "$module" ] || continue
    start 60 2 env LARIAT_MPI="$module" "$folder/test_comm_mpi" find && fail "$other was accepted"
    grep -q "do not belong together" "$log" || fail "$other is not refused in words"
done

# One is lost: all end at once, and the others (those that mpirun leaves the time) say who it is.
lose() {
    backend=$1 kind=$2 victim=$3
    status=0
    start 20 4 "$folder/test_comm_mpi" lose "$backend" "$kind" "$victim" "$log" || status=$?
    case $status in
    0) fail "$kind of processor $victim, $backend: nobody complained" ;;
    124 | 137) grep -q "Killed" "$log" || fail "$kind of processor $victim, $backend: hangs" ;;
    esac
    grep -q "^processor $victim: $kind" "$log" || fail "$kind of processor $victim did not happen"
    if pgrep -f "test_comm_mpi lose .* $log" >/dev/null; then
        sleep 2
        ! pgrep -f "test_comm_mpi lose .* $log" || fail "$kind, $backend: processes are left"
    fi
}
named() {
    grep -q "^\[.\] processor $victim is lost: $1" "$log" ||
        fail "$kind of processor $victim, $backend: nobody says who is lost"
}
# MPICH's mpirun kills the others before they can say anything.
lose mpi kill 2
[ "$name" = mpich ] || named "its process or its connection ended"
lose mpi stop 2
named "it gives no sign of life"
lose mpi fail 2
named "it stopped with a failure of its own"
lose mpi stop 0
named "it gives no sign of life"
lose shm stop 2
named "it gives no sign of life"
lose tcp fail 0
named "it stopped with a failure of its own"
echo "mpi: $mpirun, all good"
