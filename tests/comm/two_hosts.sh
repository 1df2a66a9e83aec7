# Two hosts on one machine, for tests to source: network namespaces A and B that share nothing but a
# cable (veth), 10.213.77.1 and 10.213.77.2. Call make_hosts, and remove_hosts at the end whatever
# happens. Where namespaces may not be made the test is skipped.
A=lariat-a-$$ B=lariat-b-$$
MASTER=10.213.77.1:7077

make_hosts() {
    command -v ip >/dev/null || { echo "skipped: no ip command"; exit 77; }
    ip netns add "$A" 2>/dev/null || { echo "skipped: no network namespaces here"; exit 77; }
    ip netns add "$B" || { echo "no second namespace" >&2; exit 1; }
    # Made inside, so that the names of the two ends are nobody else's and go with the namespaces.
    ip -n "$A" link add cable type veth peer name cable netns "$B" 2>/dev/null || {
        echo "skipped: no veth here"
        exit 77
    }
    for side in "$A 10.213.77.1" "$B 10.213.77.2"; do
        set -- $side
        ip -n "$1" addr add "$2/24" dev cable && ip -n "$1" link set lo up &&
            ip -n "$1" link set cable up || { echo "no cable in $1" >&2; exit 1; }
    done
}

remove_hosts() {
    ip netns del "$A" 2>/dev/null
    ip netns del "$B" 2>/dev/null
}
