#!/bin/sh
# What bears too little because it is thin: flat elements of nearly incompressible tissue that
# pressure may fold, and layers that cannot escape where springs of contact press them.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1

# A strip of NX x NY x NZ elements, LX x LY x LZ, from z = Z0 on, in millimetres, as elements of one
# tag; nodes from FIRST on.
strip() {
    awk -v nx="$1" -v ny="$2" -v nz="$3" -v lx="$4" -v ly="$5" -v lz="$6" -v z0="$7" -v first="$8" \
        -v set="$9" 'BEGIN {
        print "*NODE"
        for (k = 0; k <= nz; k++) for (j = 0; j <= ny; j++) for (i = 0; i <= nx; i++)
            printf "%d, %.9g, %.9g, %.9g\n", first + i + (nx + 1) * (j + (ny + 1) * k),
                1e-3 * lx * i / nx, 1e-3 * ly * j / ny, 1e-3 * (z0 + lz * k / nz)
        print "*ELEMENT, TYPE=C3D8, ELSET=" set
        for (k = 0; k < nz; k++) for (j = 0; j < ny; j++) for (i = 0; i < nx; i++) {
            n = first + i + (nx + 1) * (j + (ny + 1) * k); up = (nx + 1) * (ny + 1)
            printf "%d, %d, %d, %d, %d, %d, %d, %d, %d\n", n, n, n + 1, n + nx + 2, n + nx + 1,
                n + up, n + up + 1, n + up + nx + 2, n + up + nx + 1
        }
    }'
}

# pressed BY NAME: a pad of 2 mm whose top is led down by BY, and slips sideways.
pressed() {
    cat >"$2.yaml" <<END
lariat: 1
mesh: square.inp
duration: 0.05
damping: 100
materials: [ { cells: all, law: neo-hookean, density: 1000, shear_modulus: 1e4, bulk_modulus: 1e5 } ]
sets:
  - { name: low, nodes: { box: [[-1, -1, -1], [1, 1, 1e-6]] } }
  - { name: high, nodes: { box: [[-1, -1, 1.999e-3], [1, 1, 1]] } }
fix: [ { nodes: low, axes: xyz } ]
move: [ { nodes: high, axes: z, by: $1, over: 0.04 } ]
END
}

# pad BULK NAME: bonded between plates, pressed by 5 %.
pad() {
    cat >"$2.yaml" <<END
lariat: 1
mesh: pad.inp
duration: rest
materials: [ { cells: all, law: neo-hookean, density: 1000, shear_modulus: 1e5, bulk_modulus: $1 } ]
sets:
  - { name: low, nodes: { box: [[-1, -1, -1], [1, 1, 1e-6]] } }
  - { name: high, nodes: { box: [[-1, -1, 1.999e-3], [1, 1, 1]] } }
fix: [ { nodes: all, axes: y }, { nodes: low, axes: xyz }, { nodes: high, axes: x } ]
move: [ { nodes: high, axes: z, by: -1e-4, over: 0.02 } ]
END
}
strip 4 1 4 20 5 2 0 1 pad >pad.inp
strip 8 1 4 20 2.5 2 0 1 pad >pad_five.inp
pad 1e7 flat
pad 2e6 soft
sed 's/pad.inp/pad_five.inp/' flat.yaml >five.yaml
expect 0 "$LARIAT" run flat.yaml
says '^flat elements  *[1-9][0-9]* of nearly incompressible tissue are under up to [1-9]'
expect 0 "$LARIAT" run flat.yaml --json
[ "$(value_of flat.elements)" -gt 8 ] || fail "flat elements in JSON"
for name in soft five; do
    expect 0 "$LARIAT" run $name.yaml
    ! grep -q '^flat elements' "$SCRATCH/out" || fail "flat elements in $name.yaml"
done

# Two layers that only their thickness may change, from one another by nothing.
{
    strip 2 2 2 2 2 1 0 1 low
    strip 2 2 2 2 2 1 1 101 high
} >layers.inp
cat >layers.yaml <<'END'
lariat: 1
mesh: layers.inp
duration: rest
materials: [ { cells: all, law: neo-hookean, density: 1000, youngs_modulus: 5e6, poisson_ratio: 0.495 } ]
sets:
  - { name: below, nodes: { box: [[-1, -1, -1], [1, 1, 1e-6]] } }
  - { name: above, nodes: { box: [[-1, -1, 1.999e-3], [1, 1, 1]] } }
  - { name: one, faces: { all: [ { set: low }, { surface: true } ] } }
  - { name: two, faces: { all: [ { set: high }, { surface: true } ] } }
fix: [ { nodes: all, axes: xy }, { nodes: below, axes: z } ]
move: [ { nodes: above, axes: z, by: -4e-6, over: 0.005 } ]
contact: [ { between: [one, two] } ]
END
sed 's/duration: rest/duration: 0.03\ndamping: 2000/' layers.yaml >moving.yaml
expect 0 "$LARIAT" run moving.yaml
says 'its springs store up to .* of what the bodies do'
expect 0 "$LARIAT" run moving.yaml --json
moving=$(value_of energy.strain)
awk -v springs="$(value_of contact.springs)" -v strain="$moving" \
    'BEGIN { exit !(springs > 0.5 * strain) }' || fail "springs of contact in JSON"
# Where only the state at rest counts they are 16 times as stiff: twice the force.
expect 0 "$LARIAT" run layers.yaml --json
awk -v springs="$(value_of contact.springs)" -v strain="$(value_of energy.strain)" \
    -v moving="$moving" 'BEGIN { exit !(springs < 0.2 * strain && strain > 3 * moving) }' ||
    fail "springs of contact at rest store $(value_of contact.springs) J"
[ "$(value_of contact.distance)" = 0 ] || fail "a contact distance of bodies that touch"

# What is pressed flat is crushed, whatever forces say; by a quarter nothing is.
strip 4 4 3 4 4 2 0 1 square >square.inp
pressed -2e-3 crushed
pressed -5e-4 sound
expect 0 "$LARIAT" run crushed.yaml
says '^crushed  *[1-9][0-9]* elements have a corner with less than a fifth .*, [0-9]* of them inside out, down to -'
expect 0 "$LARIAT" run crushed.yaml --json
[ "$(value_of crushed.elements)" -gt 12 ] && [ "$(value_of crushed.inside_out)" -gt 0 ] ||
    fail "crushed elements in JSON"
expect 0 "$LARIAT" run sound.yaml --json
[ "$(value_of crushed.elements)" = 0 ] && [ "$(value_of crushed.least)" = 1 ] ||
    fail "a sound pad has crushed elements"
expect 0 "$LARIAT" run sound.yaml
! grep -q '^crushed' "$SCRATCH/out" || fail "a sound pad is said to be crushed"

# Half a millimetre apart they push each other before they touch.
{
    strip 2 2 2 2 2 1 0 1 low
    strip 2 2 2 2 2 1 1.5 101 high
} >apart.inp
sed 's/layers.inp/apart.inp/; s/1.999e-3/2.499e-3/' layers.yaml >apart.yaml
expect 0 "$LARIAT" run apart.yaml
says 'bodies push each other from 0.[0-9]* mm on, before they touch'
finish "what is thin"
