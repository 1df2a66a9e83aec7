#!/bin/sh
# The same state hash from two hosts: network namespaces that share nothing but a cable.
. "$(dirname "$0")/lib.sh"
. "$(dirname "$0")/../comm/two_hosts.sh"
clean_up() {
    # shellcheck disable=SC2046
    kill $(jobs -p) 2>/dev/null
    wait
    remove_hosts
}
trap clean_up EXIT
trap 'exit 1' HUP INT TERM
make_hosts
cd "$SCRATCH" || exit 1
expect 0 "$LARIAT" demo-model demo
expect 0 "$LARIAT" run demo/uterus.yaml --steps 1000 --json
hash=$(value_of state_hash)
for backend in tcp ucx; do
    "$LARIAT" run demo/uterus.yaml --grid 2x1x1 --steps 1 --comm $backend >/dev/null 2>&1 || {
        echo "$backend: does not work here"
        continue
    }
    for options in "--scheme all" "--scheme local --threads 2 --delays 3"; do
        # shellcheck disable=SC2086
        set -- "$LARIAT" run demo/uterus.yaml --grid 2x1x1 --steps 1000 --comm $backend $options \
            --master "$MASTER"
        ip netns exec "$B" "$@" --processor 1 >"$SCRATCH/other" 2>&1 &
        other=$!
        expect 0 ip netns exec "$A" "$@" --processor 0 --json
        wait $other || {
            fail "the other host: $backend $options"
            cat "$SCRATCH/other" >&2
        }
        [ "$(value_of state_hash)" = "$hash" ] || fail "another hash: $backend $options"
    done
    echo "$backend: the same hash from two hosts"
done
finish "two hosts, one hash"
