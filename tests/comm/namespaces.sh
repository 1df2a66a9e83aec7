#!/bin/sh
# Two processors that share nothing but a network: two network namespaces, joined by a cable (veth).
# They exchange packets over every backend for networks; then the cable is pulled, and both end
# within two seconds with a message that names the other. Skipped where namespaces may not be made.
#     namespaces.sh PEER SCRATCH
PEER=$1
SCRATCH=$2
. "$(dirname "$0")/two_hosts.sh"
ZERO= ONE=

fail() {
    echo "namespaces: $*" >&2
    cat "$SCRATCH"/[01] >&2
    exit 1
}

clean_up() {
    for process in $ZERO $ONE; do kill -KILL "$process" 2>/dev/null; done
    wait
    remove_hosts
}

mkdir -p "$SCRATCH"
trap clean_up EXIT
trap 'exit 1' HUP INT TERM
make_hosts

# start BACKEND STEPS
start() {
    ip netns exec "$A" "$PEER" 0 2 "$1" "$MASTER" "$2" >"$SCRATCH/0" 2>&1 &
    ZERO=$!
    ip netns exec "$B" "$PEER" 1 2 "$1" "$MASTER" "$2" >"$SCRATCH/1" 2>&1 &
    ONE=$!
}

# join: the exit statuses of both, in $zero and $one
join() {
    wait "$ZERO"
    zero=$?
    wait "$ONE"
    one=$?
    ZERO= ONE=
}

for backend in tcp ucx; do
    start $backend 5000
    join
    [ "$zero$one" = 7777 ] && { echo "$backend: not in this build"; continue; }
    [ "$zero$one" = 00 ] || fail "$backend: ended with $zero and $one"
    echo "$backend: 5000 steps between two namespaces"

    start $backend 0
    for attempt in $(seq 300); do
        grep -q begun "$SCRATCH/0" && grep -q begun "$SCRATCH/1" && break
        sleep 0.1
    done
    sleep 0.3
    pulled=$(date +%s%N)
    ip -n "$A" link set cable down || fail "the cable cannot be pulled"
    sleep 2
    late=$(($(date +%s%N) - pulled - 2000000000)) # the machine itself
    join
    [ "$zero$one" = 11 ] || fail "$backend: after the cut they ended with $zero and $one"
    grep -q 'processor 1 is lost.*the last complete step' "$SCRATCH/0" || fail "$backend: zero"
    grep -q 'processor 0 is lost.*the last complete step' "$SCRATCH/1" || fail "$backend: one"
    for side in 0 1; do
        took=$(($(sed -n 's/^ended //p' "$SCRATCH/$side") - pulled))
        [ $took -lt $((2000000000 + late)) ] || fail "$backend: processor $side took $took ns"
        echo "$backend: the cable pulled, processor $side ended after $((took / 1000000)) ms"
    done
    ip -n "$A" link set cable up || fail "the cable"
done
