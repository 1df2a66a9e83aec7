#!/bin/sh
# A divided run is the same run: hash, frames, failures, interruption. Processors are threads here.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1
expect 0 "$LARIAT" demo-model demo
scene=demo/uterus.yaml
expect 0 "$LARIAT" run $scene --steps 60 --json --out alone
[ "$(value_of grid)$(value_of comm)$(value_of processors)" = '"1x1x1""none"1' ] || fail "not alone"
hash=$(value_of state_hash)

expect 0 "$LARIAT" partition $scene --grid 2x1x2 --method genetic --generations 5 --out found.dist \
    --threads 2 --scheme one --schedules plan --json
[ "$(value_of schedules.scheme)$(value_of threads)" = '"one"2' ] || fail "other schedules"
has_keys --numbers schedules.batches_mean schedules.batches_max schedules.waits_max \
    schedules.buffer_bytes_max
while read -r options; do
    # shellcheck disable=SC2086
    expect 0 "$LARIAT" run $scene --steps 60 --json $options
    [ "$(value_of steps)" = 60 ] || fail "$(value_of steps) steps with $options"
    [ "$(value_of state_hash)" = "$hash" ] || fail "$(value_of state_hash), not $hash: $options"
done <<END
--grid 1x1x1
--grid 2x1x1 --no-pin
--threads 2
--grid 2x2x1 --scheme local --channels concurrent --delays 7
--grid 1x2x2 --threads 3 --scheme two
--grid 2x1x1 --distribution random --scheme one
--grid 2x2x3 --distribution genetic --scheme local
--distribution found.dist
--schedules plan --delays 3
END
[ "$(value_of grid)$(value_of scheme)$(value_of comm)" = '"2x1x2""one""threads"' ] ||
    fail "the files' grid and scheme are not in the summary"
expect 0 "$LARIAT" run $scene --steps 5 --schedules plan
says '2x1x2: 4 processors of 2 threads, scheme one, by threads'

# The same frames and probes.
expect 0 "$LARIAT" run $scene --steps 60 --json --out divided --grid 2x2x1 --threads 2
for file in alone/*.vtu alone/*.pvd alone/probes.csv; do
    cmp -s "$file" "divided/${file#alone/}" || fail "${file#alone/} is another one"
done

# Steps that verify.
expect 0 "$LARIAT" run $scene --steps 3 --grid 2x1x1 --verify
says 'every force arrived'
expect 0 "$LARIAT" run $scene --steps 3 --grid 2x1x1 --verify --json
[ "$(value_of verify)" = true ] || fail "verify is not in the summary"

# Paced, unstable, interrupted.
expect 0 "$LARIAT" run $scene --time 0.01 --realtime --grid 2x1x1 --json
cp "$SOURCE/examples/beam.vtk" .
sed 's/^fix:/load: [ { nodes: all, force: [0, 0, -1.0e5] } ]\nfix:/' "$SOURCE/examples/beam.yaml" \
    >violent.yaml
expect 3 "$LARIAT" run violent.yaml --time 1 --json
sed 's/: .*//' err >where
expect 3 "$LARIAT" run violent.yaml --time 1 --json --grid 2x1x1 --out results
silent
complains ': unstable at step [0-9]* '
complains 'the last frame in results, number 0'
sed -n '1s/: .*//p' err | cmp -s - where || fail "not where one processor is unstable"
"$LARIAT" run "$SOURCE/examples/beam.yaml" --time 3600 --realtime --json --grid 2x1x1 --out stopped \
    >out 2>err &
pid=$!
for _ in $(seq 300); do
    [ -e stopped/probes.csv ] && break
    sleep 0.2
done
sleep 0.2
kill -INT $pid
wait $pid
status=$?
[ $status -eq 130 ] || fail "exit status $status instead of 130"
[ "$(value_of interrupted)" = true ] || fail "the summary does not say interrupted"

# What makes no sense.
refuse() {
    wanted=$1 sentence=$2
    shift 2
    expect "$wanted" "$LARIAT" run $scene --steps 1 "$@"
    complains "$sentence"
    silent
}
refuse 2 "'2x2' is no grid" --grid 2x2
refuse 2 'more processors\|too large' --grid 50x50x50
refuse 2 'at most 64 are started' --grid 20x20x2 --comm shm
expect 2 "$LARIAT" run "$SOURCE/examples/beam.yaml" --grid 10x10x10
complains 'elements'
refuse 2 'all, local, one, two' --grid 2x1x1 --scheme some
refuse 2 'scheme local' --grid 2x1x1 --channels concurrent
refuse 2 'say how many' --scheme local
refuse 2 'say how many' --comm tcp
refuse 2 'leave --grid out' --schedules plan --grid 2x1x2
refuse 1 'none.dist' --distribution none.dist
refuse 2 'is for the grid 2x1x2' --distribution found.dist --grid 2x2x1
refuse 1 'none/processor-0000.schedule' --schedules none
refuse 2 'contradict' --grid 2x1x1 --pin --no-pin
refuse 2 'leave --out out' --grid 2x1x1 --verify --out x
refuse 2 'from 1 to 16' --threads 17
finish "divided runs: hash $hash"
