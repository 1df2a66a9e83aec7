#!/bin/sh
# A body falls on another one, processors as processes: the same hash as on one, by all of them.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1
awk '
function brick(nx, ny, nz, h, x, y, z,    i, j, k, a, b, c, base) {
    base = n
    for (k = 0; k <= nz; k++) for (j = 0; j <= ny; j++) for (i = 0; i <= nx; i++)
        point[n++] = sprintf("%g %g %g", x + h * i, y + h * j, z + h * k)
    c = (nx + 1) * (ny + 1)
    for (k = 0; k < nz; k++) for (j = 0; j < ny; j++) for (i = 0; i < nx; i++) {
        a = base + i + (nx + 1) * j + c * k
        b = a + nx + 1
        cell[m++] = sprintf("8 %d %d %d %d %d %d %d %d", a, a + 1, b + 1, b, a + c, a + 1 + c,
                            b + 1 + c, b + c)
    }
}
BEGIN {
    brick(6, 4, 2, 0.01, 0, 0, 0)
    brick(4, 3, 2, 0.008, 0.013, 0.0071, 0.022)
    print "# vtk DataFile Version 3.0\nbricks\nASCII\nDATASET UNSTRUCTURED_GRID"
    print "POINTS " n " double"
    for (i = 0; i < n; i++) print point[i]
    print "CELLS " m " " 9 * m
    for (i = 0; i < m; i++) print cell[i]
    print "CELL_TYPES " m
    for (i = 0; i < m; i++) print 12
}' >bricks.vtk
cat >fall.yaml <<'END'
lariat: 1
mesh: bricks.vtk
gravity: [0, 0, -9.81]
damping: 3
materials:
  - { cells: all, law: neo-hookean, density: 1000, shear_modulus: 4.0e3, bulk_modulus: 4.0e4 }
sets:
  - { name: bottom, nodes: { box: [[-1, -1, -1], [1, 1, 0.001]] } }
  - { name: falling, nodes: { box: [[-1, -1, 0.021], [1, 1, 1]] } }
fix: [ { nodes: bottom, axes: xyz } ]
initial: [ { nodes: falling, velocity: [0.15, 0.05, -0.3] } ]
contact: [ { self: true } ]
END
expect 0 "$LARIAT" run fall.yaml --steps 150 --json
hash=$(value_of state_hash)
sed '/^contact/d' fall.yaml >through.yaml
expect 0 "$LARIAT" run through.yaml --steps 150 --json
[ "$(value_of state_hash)" != "$hash" ] || fail "contact changes nothing"

comms='shm tcp'
"$LARIAT" run fall.yaml --steps 1 --grid 1x1x1 --comm ucx >/dev/null 2>&1 && comms="$comms ucx"
for comm in $comms; do
    for how in '--grid 2x1x1' '--grid 1x1x2 --threads 2' '--grid 3x1x1 --scheme local'; do
        # shellcheck disable=SC2086
        expect 0 "$LARIAT" run fall.yaml --steps 150 --json --comm $comm $how
        [ "$(value_of state_hash)" = "$hash" ] || fail "$comm, $how: $(value_of state_hash)"
        [ ! -s err ] || fail "messages during a good run by $comm"
    done
done
export OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_hwloc_base_binding_policy=none
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
if timeout 60 mpirun -n 2 "$LARIAT" run fall.yaml --steps 150 --json --comm mpi --grid 2x1x1 \
    >out 2>err; then
    [ "$(value_of state_hash)" = "$hash" ] || fail "mpi: $(value_of state_hash)"
else
    echo "left out: mpi: $(tail -n 1 err)"
fi
# The organ falls on its side, and its creases fold shut: it goes on.
expect 0 "$LARIAT" demo-model organ
sed -e '/^fix:/,/^$/d' -e '/^tools:/,/^$/d' -e '/^gravity:/s/\[.*\]/[9.81, 0, 0]/' \
    -e '/^contact:/s/{ self: true }/&, { faces: all, plane: { through: [0.0615, 0, 0], normal: [-1, 0, 0] } }/' \
    organ/uterus_live.yaml >organ/side.yaml
grep -q plane organ/side.yaml || fail "the organ has no contact"
expect 0 "$LARIAT" run organ/side.yaml --time 0.16 --json
hash=$(value_of state_hash)
expect 0 "$LARIAT" run organ/side.yaml --time 0.16 --json --grid 2x1x1 --comm shm
[ "$(value_of state_hash)" = "$hash" ] || fail "the organ on two processors: $(value_of state_hash)"
# Lists of elements take no part in contact.
expect 0 "$LARIAT" verify fall.yaml --grid 2x1x1 --threads 2 --steps 20 --json
finish "contact between processes: the same hash"
