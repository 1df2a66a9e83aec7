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
finish "benchmark: keys and limits"
