#!/bin/sh
# lariat predict: a scene on machines that are not here, files, growing bodies, and what it refuses.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1
expect 0 "$LARIAT" demo-model demo

expect 0 "$LARIAT" predict demo/uterus.yaml --grid 2x2x3 --threads 2 --json
has_keys scheme channels machine.name machine.element.source --numbers processors threads elements \
    nodes step_us alone_us real_time_factor speed_up efficiency occupation machine.latency.value \
    steps fastest_us slowest_us start_step_us occupation_from_start.99
[ "$(value_of processors)$(value_of threads)" = 122 ] || fail "not 12 processors with 2 threads"
expect 0 "$LARIAT" predict demo/uterus.yaml --grid 2x2x3 --threads 2 --trace step.csv --svg step.svg
says 'real-time factor'
says 'links that send'
grep -q '^link,11,-1,' step.csv || fail "no packets of processor 11 in the trace"
grep -q '^compute,0,1,' step.csv || fail "nothing computed by thread 1 in the trace"
grep -q '</svg>' step.svg || fail "the picture has no end"
grep -q 'time from the common start \[us\]' step.svg || fail "occupation is not from a common start"
grep -q 'the one before \[us\]' step.svg || fail "the picture's axis has no unit"
[ ! -e step.svg.part ] || fail "a half file is left"

# What is given goes before the machine; one processor is alone.
expect 0 "$LARIAT" predict demo/uterus.vtu --grid 1x1x1 --processor-speed 816MFLOPS --json
[ "$(value_of machine.element.value)$(value_of machine.element.source)" = '1"given"' ] ||
    fail "816 MFLOPS are one element per us"
awk "BEGIN { x = $(value_of efficiency) - 1; exit !(x * x < 1e-20) }" ||
    fail "one processor is not alone"
expect 0 "$LARIAT" predict demo/uterus.yaml --grid 2x1x1 --machine ethernet --latency 1000 --json
[ "$(value_of machine.latency.value | cut -d. -f1)" = 1000 ] || fail "not the latency given"
awk "BEGIN { exit !($(value_of step_us) > 1000) }" || fail "a step is shorter than the latency"
printf '# two lines are enough\nelement 1\nbandwidth 100\n' >mine.machine
expect 0 "$LARIAT" predict demo/uterus.yaml --grid 2x1x1 --machine mine.machine --scheme local \
    --channels concurrent
says 'mine.machine: from a file'

# Schedules and distributions of lariat partition.
expect 0 "$LARIAT" partition demo/uterus.yaml --grid 2x1x1 --method cut --out cut.dist --schedules plan
expect 0 "$LARIAT" predict demo/uterus.yaml --grid 2x1x1 --json
first=$(value_of step_us)
expect 0 "$LARIAT" predict demo/uterus.yaml --distribution cut.dist --json
[ "$(value_of step_us)" = "$first" ] || fail "the distribution's file gives another step"
expect 0 "$LARIAT" predict demo/uterus.yaml --schedules plan --json
[ "$(value_of step_us)" = "$first" ] || fail "the schedules' files give another step"

expect 0 "$LARIAT" predict --list-machines
says '^thesis: '
says 'thesis table 6.1'
expect 0 "$LARIAT" predict --scale-to 27,1000 --elements-per-processor 27 --json
has_keys scaling machine.name --numbers threads
expect 0 "$LARIAT" predict --scale-to 64 --elements-per-processor 8 --scheme two
says '^two  *64 '
expect 0 "$LARIAT" predict --critical --machine thesis --elements-per-processor 64
says '^thesis .*more ('

expect 2 "$LARIAT" predict
complains 'SCENE is missing'
expect 2 "$LARIAT" predict demo/uterus.yaml --machine abacus
complains 'there is no machine abacus'
expect 2 "$LARIAT" predict demo/uterus.yaml --processor-speed fast
complains 'fast is no speed'
expect 2 "$LARIAT" predict demo/uterus.yaml --processor-speed 0
expect 2 "$LARIAT" predict demo/uterus.yaml --critical
# The start is forgotten after some steps, in a large grid with slow links later than in eight.
expect 0 "$LARIAT" predict --scale-to 1000 --scheme local --machine ethernet --json
few=$(value_of scaling.0.step_us)
expect 0 "$LARIAT" predict --scale-to 1000 --scheme local --machine ethernet --steps 2 --json
[ "$few" != "$(value_of scaling.0.step_us)" ] || fail "--steps of --scale-to does nothing: $few"
expect 2 "$LARIAT" predict --critical --scale-to 10
expect 2 "$LARIAT" predict --scale-to 10,
complains 'no list'
expect 2 "$LARIAT" predict demo/uterus.yaml --check
expect 2 "$LARIAT" predict demo/uterus.yaml --measure --machine thesis
expect 2 "$LARIAT" predict demo/uterus.yaml --channels concurrent
expect 2 "$LARIAT" predict --scale-to 10 --channels concurrent
expect 0 "$LARIAT" predict --critical --machine thesis --elements-per-processor 27 --steps 4
expect 2 "$LARIAT" predict --list-machines --steps 4
complains '--steps belongs'
# A start that shows is said, and where: with two steps it always does.
expect 0 "$LARIAT" predict demo/uterus.yaml --grid 2x2x3 --threads 2 --steps 2
says 'not settled'
expect 0 "$LARIAT" predict --scale-to 8,27 --steps 2 --machine ethernet --scheme local
says '^local sequential, 27 processors, 2 steps: not settled'
expect 0 "$LARIAT" predict demo/uterus.yaml --grid 2x2x3 --threads 2
grep -q 'not settled' "$SCRATCH/out" && fail "the organ on the cluster settles"
expect 2 "$LARIAT" predict --critical --scheme two
complains 'tries all'
expect 2 "$LARIAT" predict demo/uterus.yaml --grid 2x2
complains "'2x2' is no grid"
silent
expect 1 "$LARIAT" predict demo/uterus.yaml --machine none.machine
complains 'none.machine'
expect 1 "$LARIAT" predict demo/uterus.yaml --grid 2x1x1 --svg none/step.svg
complains 'none/step.svg'
silent
# What is there and is no plain file stays what it is.
mkfifo pipe.svg
: >real.csv
ln -s real.csv link.csv
ln -s nowhere broken.svg
expect 1 timeout 20 "$LARIAT" predict demo/uterus.yaml --grid 2x1x1 --svg pipe.svg
complains 'pipe.svg: is there and is no plain file'
[ -p pipe.svg ] || fail "a pipe was replaced by a picture"
expect 1 "$LARIAT" predict demo/uterus.yaml --grid 2x1x1 --trace link.csv
complains 'link.csv: is there and is no plain file'
[ -L link.csv ] && [ ! -s real.csv ] || fail "a link was replaced or followed"
expect 1 "$LARIAT" predict demo/uterus.yaml --grid 2x1x1 --svg broken.svg
[ -L broken.svg ] || fail "a link to nothing was replaced"
if mknod null.svg c 1 3 2>/dev/null; then
    expect 1 "$LARIAT" predict demo/uterus.yaml --grid 2x1x1 --svg null.svg
    complains 'null.svg: is there and is no plain file'
    [ -c null.svg ] || fail "a device was replaced by a picture"
fi
silent
finish "predict: machines, files, growing bodies, refusals"
