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
value_of scaled_jacobian_min | awk '{ exit !($1 > 0.3 && $1 < 0.999) }' || fail "shapes"

expect 0 "$LARIAT" bench kernel --elements 27 --shape box --isa c --repeat 1 --json
[ "$(value_of elements)$(value_of isa)$(value_of shape)" = '27"c""box"' ] || fail "27 boxes, c"
value_of scaled_jacobian_min | awk '{ exit !($1 > 0.999999) }' || fail "boxes are no boxes"
expect 0 "$LARIAT" bench kernel --elements 1 --repeat 1
says 'of the peak'
finish "benchmark: keys and limits"
