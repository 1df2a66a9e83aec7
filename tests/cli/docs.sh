#!/bin/sh
# docs/cli.md tells the truth: its examples run, every option and every JSON key is in it.
. "$(dirname "$0")/lib.sh"
page=$SOURCE/docs/cli.md
cd "$SCRATCH" || exit 1

awk '/^```sh/ { inside = 1; next } /^```/ { inside = 0 } inside' "$page" >examples
[ "$(grep -c '^lariat ' examples)" -ge 10 ] || fail "the examples were not found"
while read -r word line; do
    [ "$word" = lariat ] || fail "an example that is no lariat command: $word $line"
    # shellcheck disable=SC2086
    expect 0 "$LARIAT" $line </dev/null
done <examples

# Every option that --help lists.
for command in mesh run verify partition requirements predict fit demo-model info device doctor help 'bench kernel' 'bench step' 'bench comm' 'bench scaling' 'bench jitter' 'bench precision' 'bench implicit'; do
    # shellcheck disable=SC2086
    expect 0 "$LARIAT" $command --help
    grep -o '^  --[a-z-]*' "$SCRATCH/out" | while read -r option; do
        grep -q -e "\`$option" "$page" || echo "$command $option"
    done >>"$SCRATCH/undocumented"
done

# Every key, whatever its depth.
keys() {
    "$@" 2>/dev/null | grep -o '"[a-z0-9_]*":' | tr -d '":' | sort -u
}
# The second time against the first.
bench_twice() {
    "$LARIAT" bench "$@" --json >first.json
    "$LARIAT" bench "$@" --json --against first.json
}
for key in $(keys "$LARIAT" info demo/uterus.yaml --json) \
    $(keys "$LARIAT" run demo/uterus.yaml --steps 1 --json) \
    $(keys "$LARIAT" verify demo/uterus.yaml --grid 2x1x1 --steps 1 --json) \
    $(keys "$LARIAT" partition demo/uterus.yaml --grid 2x2x3 --method cut --json) \
    $(keys "$LARIAT" requirements demo/uterus.yaml --json) \
    $(keys "$LARIAT" predict demo/uterus.yaml --grid 2x1x1 --json) \
    $(keys "$LARIAT" predict --scale-to 27 --elements-per-processor 8 --json) \
    $(keys "$LARIAT" predict --critical --elements-per-processor 8 --json) \
    $(keys "$LARIAT" predict --list-machines --json) \
    $(keys bench_twice kernel --elements 8 --repeat 1) \
    $(keys bench_twice step demo/uterus.yaml --steps 1 --repeat 1) \
    $(keys bench_twice implicit --case loose) \
    $(keys bench_twice jitter --seconds 0.02 --repeat 1) \
    $(keys bench_twice precision --elements 8 --steps 20 --isa c) \
    $(keys "$LARIAT" bench comm --repeat 1 --json) \
    $(keys "$LARIAT" bench scaling --elements 8 --comm threads,mpi --quick --repeat 1 --json); do
    grep -q "\`$key\`" "$page" || echo "key $key"
done >>"$SCRATCH/undocumented"
[ ! -s "$SCRATCH/undocumented" ] || {
    fail "not in docs/cli.md:"
    cat "$SCRATCH/undocumented" >&2
}
finish "docs/cli.md: examples run, options and keys are all there"
