#!/bin/sh
# lariat replay: a session again on other grids and by processes, as frames; and what is refused.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1
"$LARIAT" demo-model demo >/dev/null || exit 1
scene=demo/uterus_live.yaml

expect 2 "$LARIAT" replay
complains 'SCENE RECORDING is missing'
expect 2 "$LARIAT" replay some.recording
expect 2 "$LARIAT" replay $scene some.recording more
expect 2 "$LARIAT" replay $scene some.recording --every 0.1
complains '--out'
expect 1 "$LARIAT" replay $scene none.recording
complains 'none.recording'
expect 1 "$LARIAT" replay $scene $scene
complains 'is no recording'
silent

# Every option is in the page.
"$LARIAT" replay --help | grep -o '^  --[a-z-]*' | while read -r option; do
    grep -q -e "\`$option" "$SOURCE/docs/cli.md" || echo "$option"
done >undocumented
[ ! -s undocumented ] || fail "docs/cli.md lacks $(cat undocumented)"

# The script leads the probe onto the organ.
cat >probe.csv <<'CSV'
time,x,y,z
0,0,0,0.12
0.1,0,0,0.07
CSV
if "$LARIAT" view $scene --port 0 --seconds 0.1 2>&1 | grep -q 'no server for viewers'; then
    finish "lariat replay: nothing to play, this build has no libwebsockets for lariat view"
    exit 0
fi
expect 0 "$LARIAT" view $scene --port 0 --seconds 1 --pace 0.2 --record one.recording \
    --device probe=script:probe.csv --json
hash=$(value_of state_hash)

# The same on one processor, on several, and between processes.
expect 0 "$LARIAT" replay $scene one.recording
says 'hashes are equal'
[ ! -s err ] || fail "messages about arguments in their order"
expect 0 "$LARIAT" replay one.recording $scene
complains "note: the scene comes first, as for all commands: lariat replay $scene one.recording$"
expect 0 "$LARIAT" replay one.recording $scene --grid 2x1x1 --comm shm
[ "$(grep -c 'the scene comes first' err)" -eq 1 ] || fail "every process says the order"
for divided in '' '--grid 2x1x1 --threads 2' '--grid 1x2x1 --comm shm'; do
    # shellcheck disable=SC2086
    expect 0 "$LARIAT" replay $scene one.recording --json $divided
    has_keys recording title steps time_step hashes equal state_hash frames interrupted wall_time
    [ "$(value_of equal)" = true ] || fail "not equal"
    [ "$(value_of state_hash)" = "$hash" ] || fail "the last hash differs: $divided"
    [ "$(value_of hashes)" -gt 1 ] || fail "nothing was compared"
done
for key in $(grep -o '"[a-z0-9_]*":' out | tr -d '":' | sort -u); do
    grep -q "\`$key\`" "$SOURCE/docs/cli.md" || fail "docs/cli.md lacks the key $key"
done

# Recorded by processes, played by one.
expect 0 "$LARIAT" view $scene --port 0 --seconds 1 --pace 0.2 --record two.recording \
    --device probe=script:probe.csv --grid 2x1x1 --comm shm --json
hash=$(value_of state_hash)
expect 0 "$LARIAT" replay $scene two.recording --json --out frames --every 0.01
[ "$(value_of state_hash)" = "$hash" ] || fail "recorded by processes, the last hash differs"
[ "$(value_of frames)" -gt 1 ] || fail "no frames"
[ -s frames/uterus_live.pvd ] && [ -s frames/uterus_live_000001.vtu ] || fail "no series of frames"

# Frames between which no look falls: only start and end, which is where the steps are, on each grid.
for divided in '' '--grid 2x1x1' '--grid 2x1x1 --comm shm'; do
    # shellcheck disable=SC2086
    expect 0 "$LARIAT" replay $scene two.recording --json --out ends --every 100 $divided
    [ "$(value_of frames)" = 2 ] || fail "$(value_of frames) frames instead of start and end: $divided"
    tail -n 1 ends/probes.csv | cut -d , -f 1 |
        awk -v step="$(value_of time_step)" -v steps="$(value_of steps)" \
            '{ exit !(($1 - steps * step) ^ 2 < 1e-18) }' || fail "the last state is no frame: $divided"
    cat ends/*_000001.vtu | cksum >>sums
done
[ "$(sort -u sums | wc -l)" -eq 1 ] || fail "the last frame depends on the grid"

# A run that broke: again with the same fault, behind hashes that are all equal.
cp "$SOURCE/examples/beam.vtk" beam.vtk
sed 's/^fix:/load: [ { nodes: all, force: [0, 0, -1.0e5] } ]\nfix:/' "$SOURCE/examples/beam.yaml" \
    >violent.yaml
expect 3 "$LARIAT" view violent.yaml --port 0 --seconds 0.5 --record broken.recording
complains 'unstable at step'
fault=$(grep -o 'unstable at step.*' err)
for divided in '' '--grid 2x1x1' '--grid 2x1x1 --comm shm'; do
    # shellcheck disable=SC2086
    expect 0 "$LARIAT" replay violent.yaml broken.recording $divided
    says '^ended  *as the recording did, by a fault: '
    grep -qF "$fault" out || fail "another fault: $divided"
    says '^compared  *all [0-9]* hashes are equal'
done
expect 0 "$LARIAT" replay violent.yaml broken.recording --json
has_keys fault equal state_hash
expect 0 "$LARIAT" replay violent.yaml broken.recording --json --out fault --every 100
[ "$(value_of frames)" = 2 ] || fail "$(value_of frames) frames of a run that broke"

# Another model, and a file that was cut or altered.
expect 1 "$LARIAT" replay demo/uterus.yaml one.recording
complains 'one.recording'
head -c 20000 one.recording >cut.recording
expect 1 "$LARIAT" replay $scene cut.recording --json
complains 'cut off'
silent
finish "lariat replay: equal on every grid, and by processes"
