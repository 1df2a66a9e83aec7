#!/bin/sh
# lariat requirements: the thesis's tables, a model's, what it refuses.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1
expect 0 "$LARIAT" demo-model demo

# The thesis's quantities: its numbers stand beside what its formulas give.
expect 0 "$LARIAT" requirements --thesis
says 'TABLE 4.1 .*(formula)'
says '^  total  *5424  *6024$'
says '^  total  *1161  *1407$'
says 'explicit, vector .* 37.85 M  *378.5 G  *38 M  *379 G$'
says 'explicit, hourglass .* 1.551 M  *15.51 G  *1.6 M  *16 G$'
says '^  implicit  *477.8 k  *191.1 M  *477 k  *191 M$'
says '^  explicit  *5.46 k  *436.8 M  *5.5 k  *437 M$'
says 'all to all 296 in all, local only 216; the thesis: 296 and 216'
says 'OUR KERNELS.*(counted from the code'
expect 0 "$LARIAT" requirements --thesis --json
has_keys methods table_4_1 table_4_2 --numbers quantities.n_el quantities.df_eav \
    equations.matrix_operations table_3_1.vectors_all table_3_1.vectors_local
[ "$(value_of equations.matrix_operations)" = 91584 ] || fail "eq. 4.4"
[ "$(value_of equations.vector_operations)" = 20544 ] || fail "eq. 4.10"

# The demonstration organ is known, also as a bare mesh; 12 processors without being asked.
expect 0 "$LARIAT" requirements demo/uterus.yaml
says '^Uterus: 1840 elements, 3 x 2 x 2 processors$'
says 'model  *thesis$'
says '(counted from the schedules)'
says '(counted; step and cores measured on one core of this machine, now)'
says 'the thesis says 36'
expect 0 "$LARIAT" requirements demo/uterus.vtu --no-speed --grid 2x2x2 --json
has_keys demonstration sent needs shapes --numbers quantities.n_pav quantities.dt_ex \
    thesis_quantities.n_pav elements_max
[ "$(value_of demonstration)$(value_of quantities.n_p)$(value_of elements_max)" = true8230 ] ||
    fail "not the organ on 8 processors"
grep -q '"cores"\|"peak_gflops"' "$SCRATCH/out" && fail "measured, though --no-speed"

# A distribution from a file: n_pav is that of partition, the bytes are those of its vectors.
expect 0 "$LARIAT" partition demo/uterus.yaml --grid 2x2x1 --method cut --out cut.dist --json
n_pav=$(value_of n_pav)
expect 0 "$LARIAT" requirements demo/uterus.yaml --distribution cut.dist --iterations 50 \
    --implicit-step 0.001 --no-speed --json
[ "$(value_of quantities.n_pav)" = "$n_pav" ] || fail "n_pav is not that of partition"
[ "$(value_of quantities.n_it)$(value_of quantities.dt_im)" = 500.001 ] || fail "n_it, dt_im"

# Another model has no thesis beside it, unless that is asked for.
cat >other.yaml <<'END'
lariat: 1
title: Half as stiff
mesh: demo/uterus.vtu
time_step: 5.0e-5
materials:
  - { cells: all, law: mooney-rivlin, density: 1050, shear_modulus: 1.0e3, bulk_modulus: 2.0e4 }
END
one_cube cube.inp
expect 0 "$LARIAT" requirements other.yaml --no-speed
says '^Half as stiff'
says 'dt_ex .* 50.00'
expect 0 "$LARIAT" requirements cube.inp --no-speed
says '^cube.inp: 1 elements, 1 x 1 x 1 processors$'
grep -q 'thesis: step' "$SCRATCH/out" && fail "the thesis beside a cube"
expect 0 "$LARIAT" requirements cube.inp --thesis
says 'thesis: step, second'

# A model that cannot be stepped is told about, and the rest stands.
sed 's/time_step: 5.0e-5/time_step: 0.5/' other.yaml >fast.yaml
expect 0 "$LARIAT" requirements fast.yaml
says 'Not measured: .*above the stable step'
expect 0 "$LARIAT" requirements fast.yaml --json
has_keys why_not

expect 2 "$LARIAT" requirements
complains 'which model'
silent
expect 2 "$LARIAT" requirements --thesis --grid 2x2x2
complains 'divide a model; name one'
expect 2 "$LARIAT" requirements demo/uterus.yaml --iterations 0
expect 2 "$LARIAT" requirements demo/uterus.yaml --grid 2x2 --json
complains "'2x2' is no grid"
silent
expect 2 "$LARIAT" requirements cube.inp --grid 2x1x1
expect 2 "$LARIAT" requirements demo/uterus.yaml --grid 2x2x2 --distribution cut.dist
complains 'is for the grid 2x2x1'
expect 1 "$LARIAT" requirements none.yaml
complains 'none.yaml'
finish "requirements: the thesis's tables, a model's, refusals"
