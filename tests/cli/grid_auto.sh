#!/bin/sh
# Which grid run, view and replay take when nobody says (lariat.h, lar_grid_choose).
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1
unset LARIAT_GRID
"$LARIAT" demo-model demo >/dev/null || exit 1
scene=demo/uterus.yaml
cores=$(nproc)

# What is over at once is not divided; the report says why.
expect 0 "$LARIAT" run $scene --steps 50 --json
has_keys grid grid_reason state_hash
hash=$(value_of state_hash)
[ "$(value_of processors)" -eq 1 ] || fail "50 steps by $(value_of processors) processors"
expect 0 "$LARIAT" run $scene --steps 50
if [ "$cores" -gt 1 ]; then
    says '^grid  *1x1x1: it is over in '
    expect 0 taskset -c 0 "$LARIAT" run $scene --steps 50
fi
says '^grid  *1x1x1: there is one core'

# What takes an hour is tried; where one ends that is too short for that, only the machine knows.
"$LARIAT" run $scene --time 3600 --out tried --json >out 2>err &
pid=$!
for _ in $(seq 600); do # its second frame: it moves
    [ -e tried/uterus_000001.vtu ] && break
    sleep 0.1
done
kill -INT $pid
wait $pid
[ "$cores" -eq 1 ] || "$JSON" --print grid_reason <out | grep -q 'a step takes ' ||
    fail "nothing was measured: $("$JSON" --print grid_reason <out)"

# Tried or not, it comes to the same bits.
expect 0 "$LARIAT" run $scene --time 3 --json
[ "$(value_of processors)" -le "$cores" ] || fail "more processors than cores"
long=$(value_of state_hash)
expect 0 "$LARIAT" run $scene --time 3 --grid 1x1x1 --json
[ "$(value_of state_hash)" = "$long" ] || fail "the chosen grid has another hash"
[ "$(value_of grid_reason)" = '""' ] || fail "a grid that was asked for has a reason"

# Asked for by name, and by the environment.
expect 0 "$LARIAT" run $scene --steps 50 --grid auto --scheme local --json
[ "$(value_of state_hash)" = "$hash" ] || fail "--grid auto has another hash"
expect 0 env LARIAT_GRID=1x2x1 "$LARIAT" run $scene --steps 50 --json
[ "$(value_of grid)" = '"1x2x1"' ] || fail "LARIAT_GRID is not followed: $(value_of grid)"
[ "$(value_of state_hash)" = "$hash" ] || fail "LARIAT_GRID has another hash"
expect 0 env LARIAT_GRID=1x2x1 "$LARIAT" run $scene --steps 50 --grid 1x1x2 --json
[ "$(value_of grid)" = '"1x1x2"' ] || fail "--grid does not go before LARIAT_GRID"
expect 2 env LARIAT_GRID=two "$LARIAT" run $scene --steps 50
complains "LARIAT_GRID: 'two' is no grid"
expect 2 "$LARIAT" run $scene --steps 50 --grid auto --comm shm
complains 'with communication by shm say which'
expect 2 "$LARIAT" run $scene --steps 50 --grid auto --schedules nowhere
complains 'leave --grid out'
finish "the grid that nobody asked for"
