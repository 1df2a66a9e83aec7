#!/bin/sh
# The benchmark's figures are there and possible; how good they are is not tested.
. "$(dirname "$0")/lib.sh"

expect 0 "$LARIAT" bench kernel --repeat 3 --json
has_head() {
    has_keys bench options build.version build.commit build.compiler build.flags machine.cpu \
        machine.isa machine.load_average date figures.0.name figures.0.unit figures.0.better \
        figures.0.judged --numbers machine.cores figures.0.value
    [ "$(value_of bench)" = "\"$1\"" ] || fail "the JSON says that it is of $(value_of bench)"
}
has_head kernel
has_keys shape precision isa --numbers ns_per_element elements peak_gflops fraction_of_peak \
    bytes_per_element scaled_jacobian_min ns_per_element_spread.min ns_per_element_spread.max \
    peak_gflops_spread.median ns_per_element_spread.p25 ns_per_element_spread.p75 \
    ns_per_element_spread.p95 samples steps_per_sample
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
has_head comm
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
has_head scaling
has_keys title elements nodes isa scheme pinned state_hash rows --numbers cores samples \
    warm_up_steps steps_per_sample core_to_core_ns.median
[ "$(grep -c '"us_per_step":' "$SCRATCH/out")" -eq 6 ] || fail "not six ways measured"
[ "$(grep -c '"missing":' "$SCRATCH/out")" -eq 1 ] || fail "mpi without mpirun"
grep '"\(over_plain\|speed_up\|efficiency\|us_per_step\)":' "$SCRATCH/out" |
    awk -F': *' '!($2 + 0 > 0) { exit 1 }' || fail "a figure that is not positive"
[ "$(grep -c '"better":' "$SCRATCH/out")" -eq 6 ] || fail "not a figure for each of them"
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

# Steps of a scene: those of a run.
expect 0 "$LARIAT" bench step "$SCRATCH/demo/uterus_live.yaml" --steps 20 --warm-up 5 --repeat 2 --json
has_head step
has_keys title isa state_hash --numbers elements nodes time_step samples warm_up_steps \
    steps_per_sample us_per_step us_per_step_spread.p95 single_steps_us.mean single_steps_us.p50 \
    single_steps_us.p99 single_steps_us.p999 single_steps_us.max saved_us.save saved_us.load saved_us.step_after ns_per_element real_time_factor \
    touching
hash=$(value_of state_hash)
[ "$(value_of warm_up_steps)+$(value_of steps_per_sample)" = 5+20 ] || fail "not 20 steps after 5"
expect 0 "$LARIAT" run "$SCRATCH/demo/uterus_live.yaml" --steps 25 --json
[ "$(value_of state_hash)" = "$hash" ] || fail "the timed steps are not those of a run"
# Without a scene the organ that demo-model writes.
expect 0 "$LARIAT" bench step --steps 7 --warm-up 0 --repeat 1 --json
hash=$(value_of state_hash)
expect 0 "$LARIAT" run "$SCRATCH/demo/uterus.yaml" --steps 7 --json
[ "$(value_of state_hash)" = "$hash" ] || fail "the demonstration organ is another one"
expect 0 "$LARIAT" bench step "$SCRATCH/demo/uterus.yaml" --steps 5 --repeat 1
says 'single steps'
expect 1 "$LARIAT" bench step nothing.yaml
complains 'nothing.yaml'
expect 2 "$LARIAT" bench step --steps 0

# Ticks by the clock.
expect 0 "$LARIAT" bench jitter --seconds 0.05 --repeat 2 --load 20 --json
has_head jitter
has_keys --numbers period_us load_us priority samples seconds_per_sample ticks misses missed skipped \
    late_us.p50 late_us.p99 late_us.p999 late_us.max done_us.p50 done_us.max \
    late_p50_us_spread.median late_p99_us_spread.max missed_spread.p95
expect 0 "$LARIAT" bench jitter --seconds 0.02 --repeat 1
says 'due to awake'
says 'misses'
expect 2 "$LARIAT" bench jitter --priority 100
expect 2 "$LARIAT" bench jitter --seconds 0

# Three ways of computing the same.
expect 0 "$LARIAT" bench precision --elements 8 --steps 200 --isa c --json
has_head precision
has_keys --numbers elements nodes steps time_step ns_per_element.double ns_per_element.mixed \
    stable_step_ratio.double stable_step_ratio.mixed stable_step_ratio.single
expect 0 "$LARIAT" bench precision "$SCRATCH/demo/uterus.yaml" --steps 20 --isa c
says 'mixed'
expect 2 "$LARIAT" bench precision --steps 19
expect 1 "$LARIAT" bench precision "$SCRATCH/demo/uterus_live.yaml" --steps 20
complains 'single precision knows no mass_scaling'

# Against an earlier run. A baseline whose figures no machine reaches, or every one.
earlier=$SCRATCH/earlier.json
baseline() { # FACTOR of every figure
    sed "s/^\( *\"value\": \).*,/\1$1,/" "$SCRATCH/kernel.json" >"$earlier"
}
kernel() {
    "$LARIAT" bench kernel --elements 8 --repeat 1 --isa c "$@"
}
expect 0 kernel --json
cp "$SCRATCH/out" "$SCRATCH/kernel.json"
expect 0 kernel --against "$SCRATCH/kernel.json" --tolerance 1000000
says 'ns_per_element .* ns'
says 'peak_gflops .* Gflop/s'
says "against $SCRATCH/kernel.json, measured 20"
baseline 1e-6
expect 1 kernel --against "$earlier"
complains "ns_per_element is .* % worse than in $earlier"
says 'worse'
expect 1 kernel --against "$earlier" --tolerance 5 --json
has_head kernel
has_keys against.file against.compared.0.failed --numbers against.tolerance \
    against.compared.0.earlier against.compared.0.ratio against.compared.0.worse
[ "$(value_of against.compared.0.failed)$(value_of against.compared.1.failed)" = truefalse ] ||
    fail "the time alone is worse"
baseline 1e9
expect 1 kernel --against "$earlier"
complains "peak_gflops is .* % worse than in $earlier"
# The same file with the machine's word on the processor changed.
sed 's/"cpu": ".*"/"cpu": "another"/' "$SCRATCH/kernel.json" >"$earlier"
expect 0 kernel --against "$earlier" --tolerance 1e6
complains 'note: .*another processor: another'
# What does not compare is refused before anything is measured.
expect 1 "$LARIAT" bench kernel --elements 9 --repeat 1 --isa c --against "$SCRATCH/kernel.json"
complains 'was measured with elements "8", and now it is 9'
silent
expect 1 "$LARIAT" bench jitter --against "$SCRATCH/kernel.json"
complains 'is of the benchmark kernel'
silent
head -c 700 "$SCRATCH/kernel.json" >"$earlier"
expect 1 kernel --against "$earlier"
complains "damaged.*$earlier:[0-9]*:"
echo '{"steps": 3}' >"$earlier"
expect 1 kernel --against "$earlier"
complains 'is not what a benchmark writes'
expect 1 kernel --against "$SCRATCH/missing.json"
complains 'missing.json'
expect 2 kernel --tolerance 3
complains '--against FILE'
expect 2 kernel --against "$earlier" --tolerance -1
# Steps not told are as many as then.
expect 0 "$LARIAT" bench step "$SCRATCH/demo/uterus.yaml" --repeat 1 --json
sed 's/^  "steps_per_sample": .*/  "steps_per_sample": 30,/' "$SCRATCH/out" >"$earlier"
expect 0 "$LARIAT" bench step "$SCRATCH/demo/uterus.yaml" --repeat 1 --json --against "$earlier" \
    --tolerance 1e6
[ "$(value_of steps_per_sample)" = 30 ] || fail "not as many steps as in the earlier run"
# A way that was measured and is not any more.
expect 0 "$LARIAT" bench comm --quick --repeat 1 --backend threads --json
sed 's/"name": "threads: latency_ns"/"name": "pigeons: latency_ns"/' "$SCRATCH/out" >"$earlier"
expect 1 "$LARIAT" bench comm --quick --repeat 1 --backend threads --tolerance 1e6 --against "$earlier"
complains 'pigeons: latency_ns stands in .* and was not measured now'
says 'new'
expect 0 "$LARIAT" bench scaling --elements 8 --quick --repeat 1 --processors 1 --threads 1 --json
cp "$SCRATCH/out" "$earlier"
expect 0 "$LARIAT" bench scaling --elements 8 --quick --repeat 1 --processors 1 --threads 1 \
    --against "$earlier" --tolerance 1e6
says 'plain loop: us_per_step'
# Both ways of integrating: alike where loading is slow, and where there is no equilibrium one ends.
expect 0 "$LARIAT" bench implicit --step 0.02 --json
has_head implicit
awk -v apart="$(value_of apart)" 'BEGIN { exit !(apart != "" && apart >= 0 && apart < 0.01) }' ||
    fail "implicit and explicit answers differ: $(value_of apart)"
expect 0 "$LARIAT" bench implicit --case loose --static
grep -q 'The implicit way fails: .* finds no equilibrium' "$SCRATCH/out" ||
    fail "a loose piece was in equilibrium"
expect 2 "$LARIAT" bench implicit --case slow "$SCRATCH/demo/uterus.yaml"
expect 2 "$LARIAT" bench implicit --preconditioner icc
if "$LARIAT" bench implicit --solver bcgs --step 0.05 >"$SCRATCH/out" 2>"$SCRATCH/err"; then
    grep -q 'PETSc .* bcgs + jacobi' "$SCRATCH/out" || fail "bcgs was not PETSc's"
else
    grep -q 'install petsc-dev' "$SCRATCH/err" || fail "no PETSc, and no word of it"
fi
# The roofline: all shapes and instruction sets, a picture, and what contradicts it.
expect 0 "$LARIAT" bench kernel --sweep --elements 600 --repeat 1 --svg "$SCRATCH/roof.svg" --json
has_keys bandwidth sweep left_out
grep -q '</svg>' "$SCRATCH/roof.svg" || fail "the picture is not whole"
expect 0 "$LARIAT" bench kernel --sweep --elements 600 --repeat 1
says '^c  *general  *500 '
says '^memory: .* GB/s read by one core'
# What laws cost, beside neo-Hookean elements in turn: all there are, and together.
expect 0 "$LARIAT" bench kernel --law all --elements 64 --repeat 1 --json
has_keys isa shape laws.0.law laws.15.law --numbers elements laws.0.ratio laws.0.ratio_spread.min \
    laws.15.ns_per_element laws.15.ns_beside laws.15.bytes_per_element
[ "$(value_of laws.12.law)$(value_of laws.15.law)" = '"hgo-pair""viscous-3"' ] || fail "not all laws"
expect 0 "$LARIAT" bench kernel --law yeoh+hgo-pair+viscous-2 --elements 27 --shape box --repeat 1
says '^yeoh+hgo-pair+viscous-2  *[0-9.]* '
for law in marble ogden++yeoh ogden+; do
    expect 2 "$LARIAT" bench kernel --law "$law"
    complains 'there are all, neo-hookean, .*, viscous-3, active, or several'
done
expect 2 "$LARIAT" bench kernel --law ogden+yeoh
complains "'yeoh' is one too many"
expect 2 "$LARIAT" bench kernel --sweep --law ogden
complains 'leave --law out'
expect 2 "$LARIAT" bench kernel --sweep --shape box
complains 'leave --shape out'
expect 2 "$LARIAT" bench kernel --svg "$SCRATCH/none.svg"
complains 'picture of --sweep'
expect 1 "$LARIAT" bench kernel --sweep --elements 600 --repeat 1 --svg /nowhere/roof.svg
complains 'cannot be written'

finish "benchmark: keys and limits"
