#!/bin/sh
# The benchmark's figures are there and possible; how good they are is not tested.
. "$(dirname "$0")/lib.sh"

expect 0 "$LARIAT" bench kernel --repeat 3 --json
has_keys shape precision isa --numbers ns_per_element elements peak_gflops fraction_of_peak \
    bytes_per_element scaled_jacobian_min ns_per_element_spread.min ns_per_element_spread.max \
    peak_gflops_spread.median samples steps_per_sample
[ "$(value_of elements)$(value_of shape)" = '1840"general"' ] || fail "not 1840 general elements"
# Steps and peak are timed in turns: what else runs on the machine may slow only the one, to several
# times its share. A wrong unit would show as a factor of a thousand.
value_of fraction_of_peak | awk '{ exit !($1 > 0.01 && $1 < 10) }' || fail "impossible share"
# What does not depend on the machine is held exactly: the share follows from the two figures beside it.
echo "$(value_of fraction_of_peak) $(value_of ns_per_element) $(value_of peak_gflops)" |
    awk '{ d = $1 * $2 * $3 / 816 - 1; exit !(d < 1e-12 && d > -1e-12) }' ||
    fail "the share is not 816 operations in that time over that peak"
value_of scaled_jacobian_min | awk '{ exit !($1 > 0.3 && $1 < 0.999) }' || fail "shapes"

expect 0 "$LARIAT" bench kernel --elements 27 --shape box --isa c --repeat 1 --json
[ "$(value_of elements)$(value_of isa)$(value_of shape)" = '27"c""box"' ] || fail "27 boxes, c"
value_of scaled_jacobian_min | awk '{ exit !($1 > 0.999999) }' || fail "boxes are no boxes"
expect 0 "$LARIAT" bench kernel --elements 1 --repeat 1
says 'of the peak'

expect 0 "$LARIAT" bench comm --quick --repeat 2 --json
has_keys packet_bytes samples cores portion_ns rows
[ "$(grep -c '"latency_ns_spread":' "$SCRATCH/out")" -ge 5 ] || fail "fewer than five ways measured"
[ "$(grep -c '"slowdown":' "$SCRATCH/out")" -ge 16 ] || fail "not every size of every way"
grep '"[a-z_]*_\(ns\|mb_s\|bytes\|hand\)":' "$SCRATCH/out" | grep -v '{\|"delay_ns"' |
    awk -F': *' '!($2 + 0 > 0) { exit 1 }' || fail "a figure that is not positive"
expect 0 "$LARIAT" bench comm --quick --repeat 1 --bytes 1 --backend tcp,shm
says 'by hand'
says 'slow-down of the computation'
! grep -q 'threads' "$SCRATCH/out" || fail "a backend that was not asked for"
expect 2 "$LARIAT" bench comm --backend pigeons
complains 'no communication backend pigeons'
expect 2 "$LARIAT" bench com
complains 'did you mean comm'
expect 2 "$LARIAT" bench comm --bytes 0

expect 0 "$LARIAT" bench scaling --elements 64 --quick --repeat 2 --comm threads,shm,tcp,mpi --json
has_keys title elements nodes isa scheme pinned state_hash rows --numbers cores samples \
    warm_up_steps steps_per_sample core_to_core_ns.median
[ "$(grep -c '"us_per_step":' "$SCRATCH/out")" -eq 6 ] || fail "not six ways measured"
[ "$(grep -c '"missing":' "$SCRATCH/out")" -eq 1 ] || fail "mpi without mpirun"
grep '"\(over_plain\|speed_up\|efficiency\|us_per_step\)":' "$SCRATCH/out" |
    awk -F': *' '!($2 + 0 > 0) { exit 1 }' || fail "a figure that is not positive"
# A scene, whose processes read it themselves; the state is the one that a run comes to.
expect 0 "$LARIAT" demo-model "$SCRATCH/demo"
expect 0 "$LARIAT" bench scaling "$SCRATCH/demo/uterus.yaml" --grid 1x1x1,1x2x1 --comm shm \
    --scheme local --threads 3 --no-pin --quick --repeat 1 --json
hash=$(value_of state_hash) steps=$(($(value_of warm_up_steps) + $(value_of steps_per_sample)))
[ "$(grep -c '"us_per_step":' "$SCRATCH/out")" -eq 4 ] || fail "not four ways measured"
expect 0 "$LARIAT" run "$SCRATCH/demo/uterus.yaml" --steps $steps --json
[ "$(value_of state_hash)" = "$hash" ] || fail "the benchmark computes something else"
expect 0 "$LARIAT" bench scaling --quick --repeat 1 --processors 1 --threads 1
says 'plain loop'
! grep -q 'by threads' "$SCRATCH/out" || fail "a way that was not asked for"
expect 2 "$LARIAT" bench scaling --comm pigeons
complains 'no communication by pigeons'
expect 2 "$LARIAT" bench scaling --processors 1,two
complains 'two'
expect 2 "$LARIAT" bench scaling --processor 1 --grid 2x1x1 --comm shm
complains 'belong together'
expect 2 "$LARIAT" bench scaling scene.yaml --elements 8
complains 'its own elements'
expect 1 "$LARIAT" bench scaling nothing.yaml --quick
complains 'nothing.yaml'
finish "benchmark: keys and limits"
