#!/bin/sh
# The demonstration organ from disk to results, and what stays the same.
. "$(dirname "$0")/lib.sh"
demo=$SCRATCH/deep/demo

expect 0 "$LARIAT" demo-model "$demo"
says 'lariat run'
scene=$demo/uterus.yaml

# What is printed to be typed can be typed, whatever the folder is called.
odd="$SCRATCH/an aunt's dé mo"
expect 0 "$LARIAT" demo-model "$odd"
grep '^    lariat run ' "$SCRATCH/out" | sed "s|lariat|\"$LARIAT\"|; s|\$| --steps 1|" >"$SCRATCH/typed"
expect 0 sh "$SCRATCH/typed"
[ -s "$odd/results/run.json" ] || fail "what demo-model prints: $(cat "$SCRATCH/typed")"

expect 0 "$LARIAT" info "$scene"
says '^mesh  *1840 elements'
says 'fundus: .* nodes'
says 'grasper: grasper, radius 0.002 m, length 0.02 m, spread 50 degrees, at '
expect 0 "$LARIAT" info "$demo/uterus_live.yaml"
says '^contact  *[0-9]* faces with each other'
expect 0 "$LARIAT" info "$demo/uterus_live.yaml" --json
has_keys contacts.0.kind contacts.0.through contacts.0.normal --numbers contacts.0.faces \
    contacts.0.against contacts.0.friction tools.0.friction
expect 0 "$LARIAT" info "$scene" --json
has_keys title file lower upper sets.0.name sets.0.kind materials.0.law contacts tools.0.name tools.0.shape tools.0.at tools.0.towards \
    notices --numbers tools.0.radius tools.0.length \
    tools.0.spread nodes \
    elements fixed_nodes volume mass shortest_edge scaled_jacobian.min scaled_jacobian.mean \
    scaled_jacobian.worst_element stable_step stable_step_element time_step duration \
    output_interval sets.0.count materials.0.shear_modulus mass_scaling.time_step \
    mass_scaling.largest_share mass_scaling.elements mass_scaling.added mass_scaling.share \
    mass_scaling.largest_factor mass_scaling.largest_factor_element \
    mass_scaling.stable_step_without mass_scaling.possible_step mass_scaling.slowing \
    mass_scaling.strained_share
[ "$(value_of elements)" = 1840 ] || fail "the organ has $(value_of elements) elements"

# Two families of fibres are told, and how many elements have directions.
artery=$(dirname "$0")/../../examples/scenes/artery.yaml
expect 0 "$LARIAT" info "$artery" --no-speed
says 'fibres (hgo, two families 58 degrees apart, dispersion 0.1, modulus'
says '^fibres  *128 elements have a direction'
expect 0 "$LARIAT" info "$artery" --no-speed --json
has_keys materials.0.fibres --numbers fibre_elements materials.0.fibre_families \
    materials.0.fibre_angle materials.0.fibre_dispersion
[ "$(value_of materials.0.fibre_families)" = 2 ] || fail "$(value_of materials.0.fibre_families) families"

expect 0 "$LARIAT" run "$scene" --steps 200 --json --out "$SCRATCH/results"
[ ! -s "$SCRATCH/err" ] || fail "messages during a good run"
has_keys title element grid scheme comm isa state_hash realtime interrupted --numbers elements \
    nodes steps time time_step stable_step threads wall_per_step_us.p50 wall_per_step_us.p99 \
    wall_per_step_us.p999 wall_per_step_us.max real_time_factor deadline_misses energy.kinetic \
    energy.strain energy.hourglass energy.external energy.damping energy.contact energy.viscous \
    contact.touching contact.deepest contact.deepest_ever contact.possible contact.boxed contact.tested \
    contact.searches wall_time ns_per_element frames
[ "$(value_of steps)" = 200 ] || fail "$(value_of steps) steps instead of 200"
value_of state_hash | grep -Eq '^"[0-9a-f]{16}"$' || fail "state_hash is $(value_of state_hash)"
cmp -s "$SCRATCH/out" "$SCRATCH/results/run.json" || fail "run.json differs from --json"
hash=$(value_of state_hash)

# In two parts the same, on any grid; what is saved is no scene, and says what to do with it.
half=$SCRATCH/half.checkpoint
expect 0 "$LARIAT" run "$scene" --steps 120 --save "$half"
for divided in '' '--grid 2x1x1'; do
    # shellcheck disable=SC2086
    expect 0 "$LARIAT" run "$scene" --steps 80 --json --resume "$half" $divided
    [ "$(value_of state_hash)" = "$hash" ] || fail "resumed, the hash is $(value_of state_hash)"
    [ "$(value_of steps)" = 200 ] || fail "resumed, it ends at step $(value_of steps)"
    echo "$(value_of real_time_factor) $(value_of wall_time) $(value_of time_step)" |
        awk '{ exit !($1 * $2 < 81 * $3) }' || fail "the 120 steps before count as this run's"
done
for command in run info view; do
    expect 1 "$LARIAT" $command "$half"
    complains 'half.checkpoint: is a saved state .* lariat run SCENE --resume .*half.checkpoint'
done
cp "$half" "$SCRATCH/a.recording"
expect 1 "$LARIAT" run "$SCRATCH/a.recording"
complains 'lariat replay SCENE .*a.recording'
expect 1 "$LARIAT" run "$scene" --resume "$scene"
complains 'uterus.yaml: is not a checkpoint of Lariat'
expect 1 "$LARIAT" run "$scene" --steps 10 --save "$scene"
complains 'is there and is not a checkpoint'
# In the folder of its first part the second one goes on behind that, and from an earlier moment once
# more; together they are what one run writes. Frames of another moment are of another run.
sed 's/every: .*/every: 0.0005/' "$scene" >"$demo/parts.yaml"
parts() {
    expect 0 "$LARIAT" run "$demo/parts.yaml" "$@"
}
parts --steps 100 --out "$SCRATCH/whole"
parts --steps 50 --out "$SCRATCH/parts" --save "$SCRATCH/early.checkpoint"
parts --steps 40 --out "$SCRATCH/parts" --resume "$SCRATCH/parts/parts.checkpoint"
complains "note: .*parts: goes on behind its frames up to 0.00"
parts --steps 50 --out "$SCRATCH/parts" --resume "$SCRATCH/early.checkpoint"
awk -F, 'NR == FNR { seen[$0] = 1; next } !($0 in seen)' "$SCRATCH/parts/probes.csv" \
    "$SCRATCH/whole/probes.csv" | grep . && fail "lines of the whole run that are missing in parts"
listed() {
    sed -n 's/.*timestep="\([^"]*\)".*/\1/p' "$SCRATCH/parts/$1.pvd"
}
[ "$(listed parts | sort -gu)" = "$(listed parts)" ] || fail "times of the frames: $(listed parts)"
[ "$(listed parts | wc -l)" = "$(find "$SCRATCH/parts" -name 'parts_*.vtu' | wc -l)" ] || fail "frames"
[ "$(listed parts | wc -l)" = "$(($(wc -l <"$SCRATCH/parts/probes.csv") - 1))" ] || fail "probes"
sed 's/name: cervix/name: os/' "$demo/parts.yaml" >"$demo/other.yaml"
mv "$demo/other.yaml" "$demo/parts.yaml"
expect 1 "$LARIAT" run "$demo/parts.yaml" --steps 1 --out "$SCRATCH/parts" --resume "$SCRATCH/parts/parts.checkpoint"
complains 'probes.csv: has other columns than the probes of this scene'
[ "$(listed parts | wc -l)" = "$(find "$SCRATCH/parts" -name 'parts_*.vtu' | wc -l)" ] || fail "frames went"
expect 0 "$LARIAT" run "$demo/parts.yaml" --steps 1 --out "$SCRATCH/whole" --resume "$SCRATCH/early.checkpoint"
grep -q 'goes on behind' "$SCRATCH/err" && fail "goes on behind another run"

expect 0 "$LARIAT" run "$scene" --steps 200 --json --out "$SCRATCH/results"

# Frames, series and probes agree.
frames=$(value_of frames)
[ "$(find "$SCRATCH/results" -name 'uterus_*.vtu' | wc -l)" -eq "$frames" ] || fail "frames"
[ "$(grep -c '<DataSet' "$SCRATCH/results/uterus.pvd")" -eq "$frames" ] || fail "uterus.pvd"
[ "$(wc -l <"$SCRATCH/results/probes.csv")" -eq $((frames + 1)) ] || fail "probes.csv"
head -n 1 "$SCRATCH/results/probes.csv" | grep -q '^time \[s\],fundus x \[m\]' || fail "header"
find "$SCRATCH/results" -name '*.part' | grep -q . && fail "a part file is left"
expect 0 "$LARIAT" info "$SCRATCH/results/uterus_000000.vtu"
says '^mesh  *1840 elements'

# The same bits from every instruction set, and without results.
for isa in c auto; do
    expect 0 "$LARIAT" run "$scene" --steps 200 --json --isa $isa
    [ "$(value_of state_hash)" = "$hash" ] || fail "another hash with --isa $isa"
done
LARIAT_ISA=c
export LARIAT_ISA
expect 0 "$LARIAT" run "$scene" --steps 200 --json
[ "$(value_of state_hash)$(value_of isa)" = "$hash\"c\"" ] || fail "LARIAT_ISA=c"
LARIAT_ISA=z80
expect 2 "$LARIAT" run "$scene" --steps 1
complains "LARIAT_ISA=z80: expected one of auto, c, "
unset LARIAT_ISA

# The oracle elements run too; a step above the stable one is refused.
expect 0 "$LARIAT" run "$scene" --steps 2 --element hex8-full
says 'hex8-full'
expect 0 "$LARIAT" run "$scene" --steps 2 --element hex8-matrix --json
[ "$(value_of element)" = '"hex8-matrix"' ] || fail "element"
expect 1 "$LARIAT" run "$scene" --steps 1 --time-step 1
complains 'above the stable step'
expect 2 "$LARIAT" run "$scene" --steps 1 --time-step 1e-16

# Values of a scene that only show when it is compiled are named with their line; what the command
# line says is not.
refused() {
    printf '%s\n' "lariat: 1" "mesh: beam.vtk" "$1" \
        'materials: [{ cells: all, law: neo-hookean, density: 1000, shear_modulus: 2.0e3, bulk_modulus: 4.0e4 }]' \
        >"$SCRATCH/refused.yaml"
    expect 1 "$LARIAT" run "$SCRATCH/refused.yaml" --steps 1
    complains "refused.yaml:3$2"
}
cp "$SOURCE/examples/beam.vtk" "$SCRATCH/"
refused "time_step: 1.0e-16" ":12: time_step: expected auto, or 1e-15 s at least"
refused "time_step: 0.1" ": time step 0.1 s is above the stable step"
refused "damping: 1.0e6" ": damping 1e+06 1/s stops a node within less than one time step"
refused "load: [{nodes: {nearest: [1, 0, 0]}, force: [0, 0, 1.0e30]}]" ": a nodal force of 1e+30 N is far"
sed 's/^load.*/time_step: 1.0e-5/' "$SCRATCH/refused.yaml" >"$SCRATCH/right.yaml"
expect 1 "$LARIAT" run "$SCRATCH/right.yaml" --steps 1 --time-step 0.1
complains "right.yaml: time step 0.1 s is above"
expect 0 "$LARIAT" run "$scene" --time 0.001 --time-step 5e-5 --json
[ "$(value_of steps)" = 20 ] || fail "0.001 s in steps of 5e-5 s are $(value_of steps) steps"

# Pacing: 0.05 s take at least that long.
expect 0 "$LARIAT" run "$scene" --time 0.05 --realtime --json
has_keys --numbers deadline_misses
[ "$(value_of realtime)" = true ] || fail "realtime"
value_of wall_time | awk '{ exit !($1 >= 0.0499) }' || fail "paced in $(value_of wall_time) s"

# A node that is hit faster than the step can follow: the account says so, and a smaller step closes it.
cp "$SOURCE/examples/beam.vtk" "$SCRATCH/"
cat >"$SCRATCH/hit.yaml" <<'END'
lariat: 1
mesh: beam.vtk
duration: 0.2
materials: [{ cells: all, law: neo-hookean, density: 1000, shear_modulus: 2.0e3, bulk_modulus: 4.0e4 }]
fix: [{ nodes: { plane: { point: [0, 0, 0], normal: [1, 0, 0] } }, axes: xyz }]
initial: [{ nodes: { nearest: [1, 0, 0] }, velocity: [0, 0, 10] }]
END
expect 0 "$LARIAT" run "$SCRATCH/hit.yaml"
says '^account  *OPEN by .* --time-step 0.00018 close it'
expect 0 "$LARIAT" run "$SCRATCH/hit.yaml" --time-step 2e-5
! grep -q '^account' "$SCRATCH/out" || fail "$(grep '^account' "$SCRATCH/out")"
expect 0 "$LARIAT" run "$SCRATCH/hit.yaml" --json
has_keys --numbers account.open account.share
value_of account.share | awk '{ exit !($1 > 0.01 && $1 < 1) }' || fail "share $(value_of account.share)"

# Foam is softer under a tool's springs than they are: the summary says how deep it is in the tool,
# and nothing where the step is so short that they are hard.
cat >"$SCRATCH/foam.yaml" <<'END'
lariat: 1
mesh: beam.vtk
duration: 0.1
damping: 50
materials: [{ cells: all, law: coupled-neo-hookean, density: 80, youngs_modulus: 1.0e5, poisson_ratio: 0.2 }]
fix: [{ nodes: { plane: { point: [0, 0, 0], normal: [0, 0, 1] } }, axes: xyz }]
tools: [{ name: bar, shape: capsule, radius: 0.006, length: 0.03, towards: [0, 1, 0],
          path: [[0, 0.02, 0.02, 0.0161], [0.05, 0.02, 0.02, 0.014]] }]
END
expect 0 "$LARIAT" run "$SCRATCH/foam.yaml"
says '^ *tissue is [0-9.]* mm deep in it, 0.[0-9]* of its radius: .* --time-step [0-9.e-]*, shows how much'
expect 0 "$LARIAT" run "$SCRATCH/foam.yaml" --json
deep=$(value_of tools.0.depth)
expect 0 "$LARIAT" run "$SCRATCH/foam.yaml" --time-step 1.5e-5
! grep -q 'deep in it' "$SCRATCH/out" || fail "$(grep 'deep in it' "$SCRATCH/out")"
expect 0 "$LARIAT" run "$SCRATCH/foam.yaml" --time-step 1.5e-5 --json
value_of tools.0.depth | awk '{ exit !($1 > 0 && $1 < 0.5 * deep) }' deep="$deep" ||
    fail "as deep with hard springs: $(value_of tools.0.depth)"

# What a tool feels in the end is of the last step: drawn out again it feels nothing, and pressed and
# kept what the last row of a probe says.
for last in "0.08, 0.02, 0.02, 0.018" "0.08, 0.02, 0.02, 0.014"; do
    sed "s/0.014\]\]/0.014], [$last]]/" "$SCRATCH/foam.yaml" >"$SCRATCH/out_again.yaml"
    echo 'output: { probes: [ { tool: bar, name: bar } ] }' >>"$SCRATCH/out_again.yaml"
    expect 0 "$LARIAT" run "$SCRATCH/out_again.yaml" --json --out "$SCRATCH/again${last##* }"
    tail -1 "$SCRATCH/again${last##* }/probes.csv" | awk -F, '{ exit !(($NF - z) ^ 2 <= 1e-6 * z ^ 2) }' \
        z="$(value_of tools.0.force.2)" ||
        fail "$(value_of tools.0.force.2) N, and $(tail -1 "$SCRATCH/again${last##* }/probes.csv")"
done

# Rounding of a strain energy that large moduli leave next to nothing of is no matter of the step.
one_cube "$SCRATCH/cube.inp"
cat >"$SCRATCH/tiny.yaml" <<'END'
lariat: 1
mesh: cube.inp
damping: 3000
duration: 0.02
materials: [{ cells: all, law: coupled-neo-hookean, density: 1800, youngs_modulus: 1.86e10, poisson_ratio: 0.3 }]
fix: [{ nodes: x, axes: xyz }]
load: [{ nodes: { nearest: [1, 1, 1] }, force: [0, 0, -1.0e-3], over: 0.001 }]
END
expect 0 "$LARIAT" run "$SCRATCH/tiny.yaml"
says '^account  *open by no more than rounding makes of strain energy here'
! grep -q 'time-step' "$SCRATCH/out" || fail "$(grep 'time-step' "$SCRATCH/out")"
expect 0 "$LARIAT" run "$SCRATCH/tiny.yaml" --json
value_of account.rounding | awk '{ exit !($1 > 0 && $1 < 1e-4) }' || fail "$(value_of account.rounding)"
sed 's/1.0e-3/1.0e3/' "$SCRATCH/tiny.yaml" >"$SCRATCH/large.yaml"
expect 0 "$LARIAT" run "$SCRATCH/large.yaml"
! grep -q '^account' "$SCRATCH/out" || fail "$(grep '^account' "$SCRATCH/out")"

# A muscle that shortens has a strain energy below zero, and all that is in the account sums up to
# about nothing: a share is one of what goes in and out.
one_cube "$SCRATCH/cube.inp"
cat >"$SCRATCH/muscle.yaml" <<'END'
lariat: 1
mesh: cube.inp
damping: 30
duration: 1
materials: [{ cells: all, law: mooney-rivlin, density: 1000, c1: 500, c2: 0, bulk_modulus: 1.0e5,
  fibres: { direction: {axis: [1, 0, 0]}, active: {along: 1.0e3} } }]
fix: [{ nodes: x, axes: xyz }]
END
expect 0 "$LARIAT" run "$SCRATCH/muscle.yaml"
! grep -q '^account' "$SCRATCH/out" || fail "muscle: $(grep '^account' "$SCRATCH/out")"
expect 0 "$LARIAT" run "$SCRATCH/muscle.yaml" --json
value_of account.share | awk '{ exit !($1 < 1e-3) }' || fail "muscle: $(value_of account.share)"

# A run goes on to the scene's duration, and no farther.
for every in "" "output: {every: 0.02}" "output: {every: 5}"; do
    sed -e 's/duration: 1/duration: 0.05/' -e '$a\' -e "$every" "$SCRATCH/muscle.yaml" >"$SCRATCH/short.yaml"
    expect 0 "$LARIAT" run "$SCRATCH/short.yaml" --time 0.04 --save "$SCRATCH/short.checkpoint"
    expect 0 "$LARIAT" run "$SCRATCH/short.yaml" --resume "$SCRATCH/short.checkpoint" --json \
        --save "$SCRATCH/short.checkpoint"
    value_of time | awk '{ exit !($1 > 0.049 && $1 < 0.051) }' || fail "resumed to $(value_of time)"
    steps=$(value_of steps) hash=$(value_of state_hash)
    expect 0 "$LARIAT" run "$SCRATCH/short.yaml" --resume "$SCRATCH/short.checkpoint" --json
    [ "$(value_of steps)$(value_of state_hash)" = "$steps$hash" ] || fail "went beyond its duration"
    complains 'note: .*short.checkpoint: 0.0[45][0-9]* s are simulated already, the scene.s duration'
    expect 0 "$LARIAT" run "$SCRATCH/short.yaml" --resume "$SCRATCH/short.checkpoint" --steps 7 --json
    [ "$(value_of steps)" = $((steps + 7)) ] || fail "--steps beyond the duration"
done

# Slips of units, and a time that is no number of steps, are doubted.
sed 's/density: 1000/density: 1.0e-6/' "$SCRATCH/hit.yaml" >"$SCRATCH/light.yaml"
expect 0 "$LARIAT" run "$SCRATCH/light.yaml" --steps 1
complains "note: material without a name has a density of 1e-06; densities are in kg/m^3"
sed 's/2.0e3/2.0/; s/4.0e4/40/' "$SCRATCH/hit.yaml" >"$SCRATCH/soft.yaml"
expect 0 "$LARIAT" run "$SCRATCH/soft.yaml" --time 1e-4
complains "note: material without a name has a shear modulus of 2; moduli are in pascals"
complains 'note: 0.0001 s are no whole number of steps of .*; the run is .* s long'

# A table for people.
expect 0 "$LARIAT" run "$scene" --steps 10
says '^state hash  *[0-9a-f]'
# Taken up again where nodes go far within an interval: which corners are near a barrier is known of
# the place where it is taken up, and was known of another one to the run that went on. A chain of
# four elements, drawn together across its fibres, whose corners fall from two thirds of their volume
# to below a third in five steps.
{
    printf '# vtk DataFile Version 3.0\nchain\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 26 double\n'
    for x in 1.09 -0.02 0.14 9.34 -0.56 -0.1 10.19 9.97 -1.46 -0.48 8.97 1.29 -0.1 -1.38 8.9 11.1 1.37 11.15 11.3 \
        9.31 11.35 1.29 9.17 10.28 19.71 10.65 -1.29 18.73 21.24 -1.24 10.47 19.94 0.13 20.74 10.39 9.22 18.69 \
        19.65 9.69 8.84 18.81 9.03 31.02 20.61 0.17 31.48 30.83 -0.77 20.9 31.34 -0.69 29.74 21.08 8.64 30.68 \
        28.89 9.31 20.11 29.99 10.61 38.85 30.04 -1.44 40.84 40.22 -1.05 31.13 41.5 0.27 39.2 30.37 9.23 40.23 \
        38.95 10.25 30.8 39.53 9.84; do echo "${x}e-3"; done
    echo 'CELLS 4 36'
    echo '8 0 1 2 3 4 5 6 7  8 10 13 6 2 9 12 11 8  8 9 14 15 16 12 17 18 19  8 21 24 25 22 20 23 18 15'
    echo 'CELL_TYPES 4'
    echo '12 12 12 12'
} >"$SCRATCH/chain.vtk"
cat >"$SCRATCH/chain.yaml" <<'END'
lariat: 1
mesh: chain.vtk
materials:
  - { name: muscle, cells: { list: [0, 2] }, law: holmes-mow, density: 1050, mu: 2000, beta: 0.7, lambda: 3000,
      fibres: { active: { across: 4000 }, direction: { axis: [1, 0.3, 0.2] } } }
  - { name: rest, cells: { list: [1, 3] }, law: yeoh, density: 1300, c1: 900, c2: 200, c3: 50, bulk_modulus: 15000 }
springs: [ { nodes: { list: [12, 7, 14, 5, 18] }, stiffness: 2 } ]
gravity: [0, 0, -9.81]
damping: 2
duration: 0.08
END
expect 0 "$LARIAT" run "$SCRATCH/chain.yaml" --steps 60 --json
whole=$(value_of state_hash)
for step in 33 34 36 38 50; do
    rm -f "$SCRATCH/chain.checkpoint"
    expect 0 "$LARIAT" run "$SCRATCH/chain.yaml" --steps $step --save "$SCRATCH/chain.checkpoint"
    expect 0 "$LARIAT" run "$SCRATCH/chain.yaml" --resume "$SCRATCH/chain.checkpoint" --steps $((60 - step)) --json
    [ "$(value_of state_hash)" = "$whole" ] || fail "resumed at $step, the hash is $(value_of state_hash)"
done

finish "demo model: $frames frames, hash $hash"
