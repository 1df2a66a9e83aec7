#!/bin/sh
# Tetrahedra: refused by run, view and info with the command that makes hexahedra of them, and meshed
# by that. Mirrored meshes are turned and doubled nodes told, with a note.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1

# blocks TYPE DOUBLED MIRRORED: 4 x 4 x 4 cubes of 10 mm in two halves, left ("liver") and right
# ("left kidney"), each cube one C3D8 or six C3D4; the halves have nodes of their own, or not.
blocks() {
    awk -v type="$1" -v doubled="$2" -v mirrored="$3" '
    function node(i, j, k, half) { return 1 + i + 5 * (j + 5 * k) + 125 * half * doubled }
    function cube(i, j, k, half) {
        split(node(i, j, k, half) " " node(i + 1, j, k, half) " " node(i + 1, j + 1, k, half) " " \
            node(i, j + 1, k, half) " " node(i, j, k + 1, half) " " node(i + 1, j, k + 1, half) \
            " " node(i + 1, j + 1, k + 1, half) " " node(i, j + 1, k + 1, half), c, " ")
        if (type == "C3D8") {
            printf "%d, %d, %d, %d, %d, %d, %d, %d, %d\n", ++e, c[1], c[2], c[3], c[4], c[5], c[6], \
                c[7], c[8]
            return
        }
        for (t = 1; t <= 6; t++) {
            split(cut[t], s, " ")
            printf "%d, %d, %d, %d, %d\n", ++e, c[s[1]], c[s[2]], c[s[3]], c[s[4]]
        }
    }
    BEGIN {
        split("1 2 3 7,1 3 4 7,1 4 8 7,1 8 5 7,1 5 6 7,1 6 2 7", cut, ",")
        print "*NODE"
        for (h = 0; h <= doubled; h++) for (k = 0; k < 5; k++) for (j = 0; j < 5; j++)
            for (i = 0; i < 5; i++) printf "%d, %g, %g, %g\n", 1 + i + 5 * (j + 5 * k) + 125 * h, \
                (mirrored ? -10 : 10) * i, 10 * j, 10 * k
        for (h = 0; h < 2; h++) {
            print "*ELEMENT, TYPE=" type ", ELSET=" (h ? "left kidney" : "liver")
            for (k = 0; k < 4; k++) for (j = 0; j < 4; j++) for (i = 2 * h; i < 2 * h + 2; i++)
                cube(i, j, k, h)
        }
    }'
}
blocks C3D4 0 0 >organ.inp
blocks C3D4 1 0 >parted.inp
blocks C3D8 1 0 >doubled.inp
blocks C3D8 0 1 >mirrored.inp
cp organ.inp 'my organ.inp'
printf 'lariat: 1\nmesh: organ.inp\nscale: 0.001\nmaterials:\n  - { cells: all, law: neo-hookean, density: 1000, shear_modulus: 1e3, bulk_modulus: 1e4 }\n' >organ.yaml

# The refusal names the command, which then does it.
for command in run 'info --no-speed' view; do
    # shellcheck disable=SC2086
    expect 1 "$LARIAT" $command organ.inp
    complains 'organ.inp:[0-9]*: element 1 is a four-node tetrahedron.*: lariat mesh organ.inp$'
    silent
done
expect 1 "$LARIAT" run organ.yaml
complains 'lariat mesh .*organ.inp$'
expect 1 "$LARIAT" run 'my organ.inp'
complains "lariat mesh 'my organ.inp'\$"
expect 0 "$LARIAT" mesh organ.inp --scale 0.001 --elements 600
[ ! -s "$SCRATCH/err" ] || fail "messages while all was well: $(cat "$SCRATCH/err")"
says '^regions  *liver (1): [23][0-9][0-9] elements, .*, as liver'
says 'left kidney (2): [23][0-9][0-9] elements, .*, as kidney'
expect 0 "$LARIAT" run organ/organ.yaml --steps 10
expect 0 "$LARIAT" mesh organ.inp --scale 0.001 --elements 600 --json --out again
[ "$(value_of regions.1.name)" = '"left kidney"' ] || fail "region $(value_of regions.1.name)"
awk "BEGIN { exit !($(value_of quality.volume) > 6.39e-5 && $(value_of quality.volume) < 6.41e-5) }" ||
    fail "the mesh holds $(value_of quality.volume) m^3"
expect 0 "$LARIAT" mesh organ.inp --scale 0.001 --elements 600 --fuse --json --out fused
[ "$(value_of regions.0.name)" = '"organ"' ] || fail "region $(value_of regions.0.name)"

# Parts that were never merged hang together, with a note; a mesh of hexahedra is meshed again.
expect 0 "$LARIAT" mesh parted.inp --scale 0.001 --elements 600
complains 'note: 25 nodes of the file stand at the place of another one'
expect 0 "$LARIAT" mesh mirrored.inp --scale 0.001 --size 0.005

# What a mesh cannot have.
expect 1 "$LARIAT" mesh organ.inp --label 1
complains 'labels are for images'
expect 1 "$LARIAT" mesh organ.inp parted.inp
complains 'is a mesh, and other files are given besides'
echo '*NODE' >none.inp
expect 1 "$LARIAT" mesh none.inp
complains 'none.inp: holds no solid elements'

# Hexahedra that are mirrored, and halves that nothing connects.
expect 0 "$LARIAT" info mirrored.inp --no-speed
complains 'note: mirrored.inp: all elements are left-handed'
expect 0 "$LARIAT" run mirrored.inp --steps 5
complains 'left-handed'
expect 0 "$LARIAT" info doubled.inp --no-speed
complains 'note: doubled.inp: 25 nodes stand at the place of another one, and nothing connects them'
printf 'lariat: 1\nmesh: doubled.inp\nscale: 0.001\nmaterials:\n  - { cells: all, law: neo-hookean, density: 1000, shear_modulus: 1e3, bulk_modulus: 1e4 }\ncontact:\n  - { self: true }\n' >touching.yaml
expect 0 "$LARIAT" info touching.yaml --no-speed
! grep -q 'another one' "$SCRATCH/err" || fail "a note about bodies that touch each other"

# What others wrote.
tetrahedra=$SOURCE/../shared/data/volumes/liver_tet.msh
if [ -f "$tetrahedra" ]; then
    expect 0 "$LARIAT" mesh "$tetrahedra" --scale 0.05 --elements 1000
    says '^liver_tet: [0-9]* elements'
else
    echo "skipped: ../shared/data/volumes is not there"
fi
finish "mesh: other solids become hexahedra"
