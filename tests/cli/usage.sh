#!/bin/sh
# Help, wrong usage, and what the messages suggest.
. "$(dirname "$0")/lib.sh"

expect 0 "$LARIAT" --version
says '^lariat [0-9]*\.[0-9]*\.[0-9]*$'
expect 0 "$LARIAT" --help
says 'demo-model'
says '4 a run that did not come to rest'
expect 2 "$LARIAT"
silent
complains 'Usage: lariat COMMAND'

for command in mesh info run view verify partition demo-model bench 'bench kernel'; do
    # shellcheck disable=SC2086
    expect 0 "$LARIAT" $command --help
    says "^Usage: lariat $command"
    says '^Examples:'
    says '  --help'
    # shellcheck disable=SC2086
    expect 2 "$LARIAT" $command --no-such-option
    complains 'unknown option --no-such-option'
    silent
done
expect 0 "$LARIAT" help run
says '^Usage: lariat run'

expect 2 "$LARIAT" rnu
complains 'did you mean run?'
expect 2 "$LARIAT" demo
complains 'did you mean demo-model?'
expect 2 "$LARIAT" xyzzy
complains 'lariat --help'
expect 2 "$LARIAT" help xyzzy
expect 2 "$LARIAT" bench kernl
complains 'did you mean kernel?'
expect 2 "$LARIAT" bench

beam=$SOURCE/examples/beam.yaml
expect 2 "$LARIAT" run
complains 'SCENE is missing'
expect 2 "$LARIAT" run "$beam" another.yaml
complains 'unexpected argument another.yaml'
expect 2 "$LARIAT" run "$beam" --jsno
complains 'did you mean --json?'
expect 2 "$LARIAT" run "$beam" --time
complains '--time needs a value'
expect 2 "$LARIAT" run x.yaml --out --json
complains '^lariat run: --out needs a value, and --json looks like an option; write --out DIR, or --out=--json'
[ ! -e ./--json ] || fail "a folder --json was made"
expect 2 "$LARIAT" run "$beam" --json=yes
complains '--json takes no value'
for wrong in '--time -1' '--time 0' '--time nan' '--time inf' '--time 1s' '--steps 0' \
    '--steps 1.5' '--steps 99999999999999999999' '--time-step 0' '--element tet' '--isa sse' '--out=' \
    '--time 1 --steps 1'; do
    # shellcheck disable=SC2086
    expect 2 "$LARIAT" run "$beam" $wrong
    silent
done
# A grid that is none, whichever command is asked for it.
for command in run verify partition predict requirements view; do
    for grid in foo 2x2 0x1x1 1025x1x1; do
        expect 2 "$LARIAT" $command "$beam" --grid $grid
        complains "^lariat $command: .*give 1 to 1024\|^lariat $command: '$grid' is no grid"
        silent
    done
done
expect 2 "$LARIAT" run "$beam" --grid 40x40x1
expect 2 "$LARIAT" run "$beam" --steps 1 --grid 2x1x1 --comm tcp --processor 5 --master localhost:1
complains 'they count from 0'
expect 2 "$LARIAT" run "$beam" --steps 1 --grid 2x1x1 --comm tcp --processor 1 --master foo
complains 'foo is no address; write host:port'
expect 2 "$LARIAT" run "$beam" --element tet
complains 'hex8, hex8-full, hex8-matrix'
expect 0 "$LARIAT" run --steps 1 --grid 1x1x1 --threads=1 -- "$beam"

cp "$beam" "$SCRATCH/--beam.yaml"
cp "$SOURCE/examples/beam.vtk" "$SCRATCH"
(cd "$SCRATCH" && "$LARIAT" run --steps 5 -- --beam.yaml >/dev/null) || fail "a file after --"

# Words in the environment that mean nothing: before all else, by every command.
for word in LARIAT_ISA=z80 LARIAT_GRID=two LARIAT_GRID=0x1x1 LARIAT_BLOCKS=fat LARIAT_UCX=pigeons; do
    for command in "run $beam --steps 1" "info $beam" "verify $beam --grid 2x1x1" doctor \
        "view $beam --port 0 --seconds 0.1" "bench kernel --elements 100" "mesh none.stl --real-time"; do
        # shellcheck disable=SC2086
        expect 2 env $word "$LARIAT" $command
        complains "${word%%=*}.*\(expected one of\|no grid\|grid\)"
        silent
    done
done
for word in LARIAT_GRID=auto LARIAT_GRID= LARIAT_BLOCKS=auto LARIAT_ISA= LARIAT_UCX=put; do
    expect 0 env $word "$LARIAT" run "$beam" --steps 1
done

expect 1 "$LARIAT" run "$SCRATCH/none.yaml"
complains '^lariat run: .*none\.yaml'
expect 1 "$LARIAT" info "$SCRATCH"
complains '^lariat info: '
expect 1 "$LARIAT" info "$beam.txt"
complains 'extension'
expect 2 "$LARIAT" bench kernel --elements 0
expect 2 "$LARIAT" bench kernel --shape ball
complains 'general, box'

finish "help and wrong usage are answered"
