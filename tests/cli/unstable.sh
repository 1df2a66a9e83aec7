#!/bin/sh
# A run that cannot end well says where, when and why, keeps its last state, and exits with 3.
. "$(dirname "$0")/lib.sh"
cp "$SOURCE/examples/beam.vtk" "$SCRATCH/beam.vtk"
sed 's/^fix:/load: [ { nodes: all, force: [0, 0, -1.0e5] } ]\nfix:/' "$SOURCE/examples/beam.yaml" \
    >"$SCRATCH/violent.yaml"
grep -q 'force' "$SCRATCH/violent.yaml" || fail "the scene has no load"

expect 3 "$LARIAT" run "$SCRATCH/violent.yaml" --time 1 --json --out "$SCRATCH/results"
silent
complains '^lariat run: unstable at step [0-9]* ([0-9.e-]* s): '
complains ': \(element\|node\) [0-9]* near (.*) m '
complains 'use a smaller time step, such as 0.00012 s'
complains 'the last frame in .*results, number 0'
[ -s "$SCRATCH/results/violent_000000.vtu" ] || fail "the last state was not written"
[ -s "$SCRATCH/results/violent.pvd" ] || fail "the series was not written"
[ ! -e "$SCRATCH/results/run.json" ] || fail "a summary of a failed run"
grep -Eiw 'nan|inf' "$SCRATCH/results/probes.csv" && fail "numbers that are none in probes.csv"
expect 0 "$LARIAT" info "$SCRATCH/results/violent_000000.vtu"

# A state that was there before is somebody's: it stays, and is not taken for the broken run's.
expect 0 "$LARIAT" run "$SOURCE/examples/beam.yaml" --steps 2 --save "$SCRATCH/last.checkpoint"
cp "$SCRATCH/last.checkpoint" "$SCRATCH/before"
expect 3 "$LARIAT" run "$SCRATCH/violent.yaml" --time 1 --save "$SCRATCH/last.checkpoint"
complains 'last.checkpoint stays as it was before this run'
cmp -s "$SCRATCH/last.checkpoint" "$SCRATCH/before" || fail "the state of another run was changed"
expect 3 "$LARIAT" run "$SCRATCH/violent.yaml" --time 1 --save "$SCRATCH/none.checkpoint"
grep -q 'none.checkpoint' err && fail "speaks of a state that was never there"

for element in hex8-full hex8-matrix; do
    expect 3 "$LARIAT" run "$SCRATCH/violent.yaml" --time 1 --element $element
    complains 'unstable at step'
done

# An element that is pulled long and thin is strained, not squeezed.
one_element "$SCRATCH/one.vtk"
cat >"$SCRATCH/one.yaml" <<'END'
lariat: 1
mesh: one.vtk
materials: [ { cells: all, law: neo-hookean, density: 1050, shear_modulus: 1.0e3, bulk_modulus: 4.0e4 } ]
fix:
  - { nodes: { plane: { point: [0, 0, 0], normal: [0, 0, 1] } }, axes: z }
  - { nodes: { nearest: [0, 0, 0] }, axes: xy }
  - { nodes: { nearest: [0.01, 0, 0] }, axes: y }
move: [ { nodes: { plane: { point: [0, 0, 0.02], normal: [0, 0, 1] } }, axes: z, by: 3, over: 0.05 } ]
END
expect 3 "$LARIAT" run "$SCRATCH/one.yaml" --time 0.1
complains 'is strained so much that the time step has become too large for it'
finish "an unstable run is reported"
