#!/bin/sh
# Abaqus and CalculiX decks as scenes: the same answers as a scene that says the same, and refusals
# by name and line. `mesh:` in a scene takes the mesh only.
. "$(dirname "$0")/lib.sh"
mesh() {
    cat <<'END'
*HEADING
A bar
*NODE, NSET=ALL
1, 0, 0, 0
2, 0.05, 0, 0
3, 0.05, 0.05, 0
4, 0, 0.05, 0
5, 0, 0, 0.05
6, 0.05, 0, 0.05
7, 0.05, 0.05, 0.05
8, 0, 0.05, 0.05
9, 0, 0, 0.1
10, 0.05, 0, 0.1
11, 0.05, 0.05, 0.1
12, 0, 0.05, 0.1
*ELEMENT, TYPE=C3D8, ELSET=BAR
1, 1, 2, 3, 4, 5, 6, 7, 8
2, 5, 6, 7, 8, 9, 10, 11, 12
*NSET, NSET=TOP
9, 10, 11, 12
*NSET, NSET=TIP
1, 2, 3, 4
*SURFACE, NAME=SIDE
1, S3
END
}
tissue() {
    cat <<'END'
*MATERIAL, NAME=SOFT
*HYPERELASTIC, NEO HOOKE
1000, 1e-4
*DENSITY
1000
*SOLID SECTION, ELSET=BAR, MATERIAL=SOFT
*BOUNDARY
TOP, 1, 3
END
}
scene() {
    cat <<'END'
lariat: 1
mesh: dynamic.inp
materials: [{cells: all, law: neo-hookean, density: 1000, shear_modulus: 2000, bulk_modulus: 20000}]
fix: [{nodes: TOP, axes: xyz}]
END
}
cd "$SCRATCH" || exit 1

# A dynamic deck: everything that it says is in the answer, and no more is taken into a scene.
{
    mesh
    tissue
    cat <<'END'
*AMPLITUDE, NAME=UP
0, 0, 0.5, 1
*INITIAL CONDITIONS, TYPE=VELOCITY
1, 1, 0.1
*STEP, NLGEOM
*DYNAMIC
0.01, 0.5
*CLOAD, AMPLITUDE=UP
TIP, 3, -0.1
*DSLOAD
SIDE, P, 20
*NODE FILE
U
*END STEP
END
} >dynamic.inp
{
    scene
    cat <<'END'
duration: 0.5
load:
  - {nodes: TIP, force: [0, 0, -0.4], curve: {points: [[0, 0], [0.5, 1]]}}
  - {faces: SIDE, pressure: 20}
initial: [{nodes: 1, velocity: [0.1, 0, 0]}]
END
} >same.yaml
expect 0 "$LARIAT" run same.yaml --json
answer=$(value_of state_hash)
expect 0 "$LARIAT" run dynamic.inp --json
complains 'note: dynamic.inp:[0-9]*: requests for results, \*NODE FILE here, were left out but for U'
[ "$(wc -l <"$SCRATCH/err")" = 1 ] || fail "more notes about a deck that is read whole"
[ "$(value_of state_hash)" = "$answer" ] || fail "the deck and the scene that says the same differ"
[ "$(value_of title)" = '"A bar"' ] || fail "the title is $(value_of title)"
expect 0 "$LARIAT" run dynamic.inp --grid 2x1x1 --json
[ "$(value_of state_hash)" = "$answer" ] || fail "another hash on two processors"

# A static one, to rest.
{
    mesh
    tissue
    printf '%s\n' '*STEP, NLGEOM' '*STATIC' '0.1, 1' '*DLOAD' 'BAR, GRAV, 9.81, 0, 0, -1' '*END STEP'
} >static.inp
{
    scene
    printf '%s\n' 'gravity: [0, 0, -9.81]' 'duration: rest' 'damping: 40'
} >rest.yaml
expect 0 "$LARIAT" run rest.yaml --json
answer=$(value_of energy.strain)
expect 0 "$LARIAT" run static.inp --json
complains 'note: static.inp:33: the step is static: Lariat follows it in time, with a damping of'
[ "$(value_of rest.reached)" = true ] || fail "the static deck is not at rest"
awk -v a="$(value_of energy.strain)" -v b="$answer" \
    'BEGIN { exit !(a > 0 && (a - b) ^ 2 < (1e-5 * a) ^ 2) }' || fail "strain energy at rest"
sed 's/^\*DLOAD/*NODE PRINT, NSET=TOP\nRF\n&/' static.inp >probes.inp
expect 0 "$LARIAT" run probes.inp --out probes
tail -n 1 probes/probes.csv | awk -F, '{ exit !(($4 / (1000 * 9.81 * 2 * 0.05 ^ 3) - 1) ^ 2 < 1e-6) }' ||
    fail "the deck's probe: $(cat probes/probes.csv)"
expect 0 "$LARIAT" info static.inp --no-speed
says '^materials  *SOFT: neo-hookean, 2 elements, 1000 kg/m^3, shear modulus 2000 Pa'
says '^mesh .*of these 4 held'

# A viscous deck that ends while nodes are moved: their reactions are what brought them there, a tenth
# of them was missing; and a ramp in its last tenth is not followed by a body that swings as slowly as
# the whole deck.
{
    mesh
    tissue | sed 's/^\*DENSITY/*VISCOELASTIC, TIME=PRONY\n0.5, 0, 0.2\n&/'
    printf '%s\n' '*AMPLITUDE, NAME=LATE' '0, 0, 0.9, 0, 1, 1' '*STEP, NLGEOM' '*VISCO' '0.01, 1' \
        '*BOUNDARY, AMPLITUDE=LATE' 'TIP, 3, 3, 0.01' '*NODE PRINT, NSET=TOP' 'RF' \
        '*NODE PRINT, NSET=TIP' 'RF' '*END STEP'
} >late.inp
expect 0 "$LARIAT" run late.inp --out late
expect 0 "$LARIAT" run late.inp --out earlier --time 0.9998
paste -d, late/probes.csv earlier/probes.csv | tail -n 1 | awk -F, '
    function near(a, b, part) { return (a - b) ^ 2 < (part * b) ^ 2 }
    { exit !(near($4, -$7, 0.01) && near($7, $14, 0.005) && near($4, $11, 0.005)) }' ||
    fail "reactions at the end: $(cat late/probes.csv earlier/probes.csv)"

# Linear elasticity becomes the law that is there, and that is said.
{
    mesh
    printf '%s\n' '*MATERIAL, NAME=SOFT' '*ELASTIC' '3000, 0.25' '*DENSITY' '1000' \
        '*SOLID SECTION, ELSET=BAR, MATERIAL=SOFT'
} >elastic.inp
expect 0 "$LARIAT" info elastic.inp --no-speed
complains "note: elastic.inp:26: material 'SOFT' is linear elastic; Lariat takes the neo-Hookean"

# Decks have units of their own, here millimetres, tonnes and MPa: no word of metres and kg/m^3. A
# mesh alone has metres.
mesh | sed 's/0\.05/50/g; s/0\.1$/100/' >long.inp
expect 0 "$LARIAT" info long.inp --no-speed
complains 'note: the model is 100 m long; if the mesh is in millimetres, read it through a scene'
printf '%s\n' '*MATERIAL, NAME=SOFT' '*HYPERELASTIC, NEO HOOKE' '1e-3, 100' \
    '*SOLID SECTION, ELSET=BAR, MATERIAL=SOFT' '*STEP, NLGEOM' '*STATIC' '0.1, 1' '*DLOAD' \
    'BAR, P1, 1e-4' '*END STEP' >>long.inp
expect 0 "$LARIAT" info long.inp --no-speed
complains 'note: the deck has no units, and the model is 100 long: Lariat computes in'
complains 'note: long.inp:26: no \*DENSITY: the static answer does not depend on it, Lariat takes'
! grep -q 'kg/m\|millimetres\|pascals' "$SCRATCH/err" || fail "units of a deck: $(cat "$SCRATCH/err")"

# What is not read is refused by name and line; in a mesh it does not matter.
{
    cat static.inp
    printf '%s\n' '*PLASTIC'
} >plastic.inp
for command in run info view; do
    [ $command = view ] && set -- --port 0 --seconds 1 || set --
    expect 1 timeout 20 "$LARIAT" $command plastic.inp "$@"
    complains 'plastic.inp:39: \*PLASTIC is not read and would change the answer; remove it, or'
done
sed 's/dynamic.inp/plastic.inp/' same.yaml >mesh_only.yaml
expect 0 "$LARIAT" run mesh_only.yaml --json

# A mesh alone gets default tissue, as before, also where a mesh program names a material.
{
    mesh
    echo '*SOLID SECTION, ELSET=BAR, MATERIAL=Default-Steel'
} >bare.inp
expect 0 "$LARIAT" info bare.inp --no-speed
says 'shear modulus 4000 Pa'
finish "decks: what they say is computed"
