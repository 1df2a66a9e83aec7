#!/bin/sh
# lariat verify: what it proves, and files that are damaged or foreign.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1
expect 0 "$LARIAT" demo-model demo
scene=demo/uterus.yaml

expect 0 "$LARIAT" run $scene --steps 30 --json
hash=$(value_of state_hash)
expect 0 "$LARIAT" verify $scene --steps 30 --grid 2x2x1 --threads 2 --scheme local --json
has_keys title grid scheme comm verified state_hash --numbers elements nodes processors threads \
    schedules.batches schedules.waits schedules.packets schedules.empty_packets schedules.vectors \
    schedules.sums schedules.spread passes verified_steps delays steps
[ "$(value_of state_hash)$(value_of verified)" = "${hash}true" ] || fail "another hash, or no word"
[ "$(value_of schedules.spread)" = 2 ] || fail "spread $(value_of schedules.spread), not 2"
expect 0 "$LARIAT" verify $scene --steps 5 --grid 2x1x1
for word in '^schedules ' '^proved ' '^verified ' '^compared ' 'no races' 'at most 1 step apart'; do
    says "$word"
done
expect 0 "$LARIAT" verify "$SOURCE/examples/beam.yaml" --grid 2x2x1 --distribution random --steps 5

# Files: good ones, then what can be wrong with them.
expect 0 "$LARIAT" partition $scene --grid 2x1x1 --method cut --schedules good
expect 0 "$LARIAT" verify $scene --schedules good --steps 5
spoil() {
    rm -rf bad
    cp -r good bad
    sed -i "$1" bad/processor-0001.schedule
    cmp -s good/processor-0001.schedule bad/processor-0001.schedule && fail "not spoilt: $1"
    expect 1 "$LARIAT" verify $scene --schedules bad --json
    silent
    complains "$2"
    expect 1 "$LARIAT" run $scene --schedules bad --steps 1
    complains "$2"
}
spoil 's/^processor 1$/processor one/' 'bad/processor-0001.schedule:3: '
spoil 's/^end$//' 'bad/processor-0001.schedule:'
spoil '/^mesh/s/.$/z/' 'bad/processor-0001.schedule:7: '
spoil 's/^  recover \([0-9]*\)  [0-9]* /  recover \1  99999 /' \
    'bad/processor-0001.schedule:[0-9]*: .*99999'
spoil '0,/stage 0 offset 0/s//stage 0 offset 64/' 'bad: .*processor 1, thread 0, batch'
rm bad/processor-0001.schedule
expect 1 "$LARIAT" verify $scene --schedules bad
complains 'bad/processor-0001.schedule: '
expect 1 "$LARIAT" verify "$SOURCE/examples/beam.yaml" --schedules good
complains 'good/processor-0000.schedule:'

expect 2 "$LARIAT" verify
complains 'SCENE is missing'
expect 2 "$LARIAT" verify $scene --grid 0x1x1
silent
finish "verify: proofs, lists, forces, damaged files"
