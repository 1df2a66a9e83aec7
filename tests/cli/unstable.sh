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
grep -q 'none.checkpoint' "$SCRATCH/err" && fail "speaks of a state that was never there"

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
# A fibre that stiffens beyond all measure is named, and no smaller step is advised.
cat >"$SCRATCH/fibre.yaml" <<'END'
lariat: 1
mesh: one.vtk
materials:
  - { cells: all, name: tendon, law: neo-hookean, density: 1050, shear_modulus: 1.0e3, bulk_modulus: 1.0e4,
      fibres: { law: exp-pow, part: whole, ksi: 1, alpha: 1.0e4, beta: 2, direction: { axis: [0, 0, 1] } } }
fix: [ { nodes: { plane: { point: [0, 0, 0], normal: [0, 0, 1] } }, axes: xyz } ]
move: [ { nodes: { plane: { point: [0, 0, 0.02], normal: [0, 0, 1] } }, axes: z, by: 0.002, over: 0.5 } ]
END
expect 3 "$LARIAT" run "$SCRATCH/fibre.yaml" --time 0.5
complains 'exceeds the force limit .*; its fibres (material tendon, exp-pow) are stretched to 1.0[0-9]* times'
complains 'where the stress is [0-9.e+]* Pa, [0-9.e+]* times the shear modulus: check alpha, loads and motions; a'
complains '; a smaller time step does not help'
grep -q 'such as' "$SCRATCH/err" && fail "advises a smaller time step"

# A hollow cube that is blown up beyond what its wall bears; the same words whoever computes it.
awk 'BEGIN { printf "# vtk DataFile Version 3.0\nhollow\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 64 double\n"
    for (k = 0; k < 4; k++) for (j = 0; j < 4; j++) for (i = 0; i < 4; i++) print i / 100, j / 100, k / 100
    print "CELLS 26 234"
    for (k = 0; k < 3; k++) for (j = 0; j < 3; j++) for (i = 0; i < 3; i++) if (i != 1 || j != 1 || k != 1) {
        n = i + 4 * j + 16 * k
        print 8, n, n + 1, n + 5, n + 4, n + 16, n + 17, n + 21, n + 20 }
    print "CELL_TYPES 26"
    for (e = 0; e < 26; e++) print 12 }' >"$SCRATCH/hollow.vtk"
cat >"$SCRATCH/hollow.yaml" <<'END'
lariat: 1
mesh: hollow.vtk
damping: 20
materials: [ { cells: all, law: neo-hookean, density: 1050, shear_modulus: 1.0e4, bulk_modulus: 2.0e5 } ]
fix: [ { nodes: { box: [ [-1, -1, -1], [0.001, 1, 1] ] }, axes: xyz } ]
load: [ { faces: { box: [ [0.009, 0.009, 0.009], [0.021, 0.021, 0.021] ] }, pressure: 1.0e5, over: 0.5 } ]
END
expect 3 "$LARIAT" run "$SCRATCH/hollow.yaml" --time 1
complains 'it is stretched to [0-9.]* times its length where a pressure of [0-9.e+]* Pa acts: that may be'
complains 'more than the wall bears (its limit load); use a smaller pressure, or a thicker or stiffer wall'
grep -q 'such as' "$SCRATCH/err" && fail "advises a smaller time step"
cp "$SCRATCH/err" "$SCRATCH/one_computes"
expect 3 "$LARIAT" run "$SCRATCH/hollow.yaml" --time 1 --grid 2x1x1 --threads 2
cmp -s "$SCRATCH/err" "$SCRATCH/one_computes" ||
    fail "two processors say: $(cat "$SCRATCH/err")"
finish "an unstable run is reported"
