#!/bin/sh
# What a hostile or careless hand gives the command: a message, never a crash, a hang, a number
# that is none, or somebody's mesh overwritten.
. "$(dirname "$0")/lib.sh"
cp "$SOURCE/examples/beam.vtk" "$SCRATCH/beam.vtk"
beam=$SOURCE/examples/beam.yaml

# A pipe that nobody writes into, and the endless file.
for name in scene.yaml mesh.vtk mesh.vtu mesh.msh mesh.inp deck.feb; do
    mkfifo "$SCRATCH/$name"
    expect 1 timeout 20 "$LARIAT" info "$SCRATCH/$name"
    complains "$name: is not a regular file"
done
ln -s /dev/zero "$SCRATCH/zero.vtk"
expect 1 timeout 20 "$LARIAT" info "$SCRATCH/zero.vtk"
complains 'is not a regular file'

# A path as long as can be leaves room for what is wrong with it.
long=$(awk 'BEGIN { for (i = 0; i < 1200; i++) printf "x/" }')
for command in run info view; do
    expect 1 "$LARIAT" $command "$SCRATCH/${long}beam.yaml"
    complains "^lariat $command: $SCRATCH/x/x/.*\.\.\..*/x/beam.yaml: .*No such file"
done
expect 1 "$LARIAT" run "$beam" --steps 1 --out "$SCRATCH/beam.vtk/$long"
complains "^lariat run: .*/x/: .*Not a directory; choose another"

# A small stack: what a run keeps is elsewhere. Sanitizers need more for themselves.
if [ -z "${LARIAT_TEST_SANITIZED:-}" ]; then
    small() {
        expect 0 sh -c 'ulimit -s 256; exec "$@"' sh "$LARIAT" run "$beam" --steps 5 "$@"
    }
    small --save "$SCRATCH/small.checkpoint" --out "$SCRATCH/small"
    small --resume "$SCRATCH/small.checkpoint"
    small --grid 2x1x1 --comm shm --no-pin
    expect 0 sh -c 'ulimit -s 256; exec "$@"' sh "$LARIAT" demo-model "$SCRATCH/small_demo"
    for command in "doctor --no-speed" "fit $SOURCE/examples/fit_tension.yaml" \
        "requirements $beam --no-speed" "info $beam" "verify $beam --grid 2x1x1"; do
        # shellcheck disable=SC2086
        expect 0 sh -c 'ulimit -s 256; exec "$@"' sh "$LARIAT" $command
    done
fi
for command in "run $beam --steps 5" doctor "requirements $beam --no-speed"; do
    # shellcheck disable=SC2086
    expect 1 sh -c 'ulimit -s 64; exec "$@"' sh "$LARIAT" $command
    complains 'the stack may have 64 KiB only, .*raise the limit (ulimit -s)'
done

# A name that is too long for a state is found before the first step.
long=$(awk 'BEGIN { for (i = 0; i < 240; i++) printf "n" }')
cp "$beam" "$SCRATCH/$long.yaml"
expect 1 timeout 20 "$LARIAT" run "$SCRATCH/$long.yaml" --steps 1000000000 --out "$SCRATCH/named"
complains 'cannot be written: File name too long; choose a shorter name'
ln -s /nonexistent/folder "$SCRATCH/dangling"
expect 1 "$LARIAT" run "$beam" --steps 1 --out "$SCRATCH/dangling"
complains 'dangling: .* it is a link that leads nowhere; choose another'

# What a file says to the terminal is not passed on.
sed 's/^title:.*/title: "a\\e[31mred \\u009b1m"/' "$beam" >"$SCRATCH/red.yaml"
for command in info "run --steps 1"; do
    # shellcheck disable=SC2086
    expect 0 "$LARIAT" $command "$SCRATCH/red.yaml"
    says 'a?\[31mred'
    LC_ALL=C tr -d '\n -~' <"$SCRATCH/out" | grep -q . && fail "control characters: $command"
done
printf '\033[31mred,x\n' >"$SCRATCH/red.csv"
expect 1 "$LARIAT" device udp:127.0.0.1:9 --script "$SCRATCH/red.csv"
complains "red.csv:1: '?\[31mred' is no column"

# Loads and motions beyond all numbers. Each line is put into the scene of the beam.
violent() {
    printf '%s\n' "$2" | cat "$beam" - >"$SCRATCH/violent.yaml"
    rm -rf "$SCRATCH/results"
    expect "$1" "$LARIAT" run "$SCRATCH/violent.yaml" --time 0.05 --out "$SCRATCH/results"
    silent
}
for p in 1e12 1e30 1e200 1e308; do
    violent 3 "load: [ { faces: all, pressure: $p } ]"
    complains 'unstable at step 0 .*\(pressures on node\|node [0-9]* near\).*check the units'
    violent 3 "load: [ { faces: all, pressure: 1, curve: { points: [[0, 0], [0.01, $p]] } } ]"
    violent 3 "load: [ { nodes: all, force: [1, 0, 0], curve: { points: [[0, 0], [0.01, $p]] } } ]"
    complains 'unstable at step'
done
violent 3 'initial: [ { nodes: all, velocity: [1.0e308, 0, 0] } ]'
complains 'has left the range of numbers'
violent 3 'move: [ { nodes: { nearest: [0.04, 0, 0] }, axes: x, by: -1.0e308, over: 0.01 } ]'
complains 'is torn beyond the range of numbers\|has left the range of numbers'
expect 3 "$LARIAT" run "$SCRATCH/violent.yaml" --steps 1

# Damping that would turn velocities around in every step.
for c in 1.0e6 1.0e30 1.0e308; do
    sed "s/^damping:.*/damping: $c/" "$beam" >"$SCRATCH/damped.yaml"
    expect 1 "$LARIAT" run "$SCRATCH/damped.yaml" --steps 10
    complains 'use a damping below .* 1/s or a time_step below'
done

# A material whose frequency is no number, also for the elements that could do without it.
sed 's/youngs_modulus: 1.0e5, poisson_ratio: 0.45/shear_modulus: 1e-10, bulk_modulus: 1e20/' "$beam" \
    >"$SCRATCH/ratio.yaml"
for element in hex8 hex8-full hex8-matrix; do
    expect 1 "$LARIAT" run "$SCRATCH/ratio.yaml" --steps 10 --json --element $element
    complains 'has no finite frequency'
    silent
done

# Frames spare every mesh of the scene, not only its first.
expect 0 "$LARIAT" run "$beam" --steps 1 --out "$SCRATCH/again"
cp "$SCRATCH/again/beam_000000.vtu" "$SCRATCH/again/first.vtu"
printf '%s\n' 'lariat: 1' 'mesh: [first.vtu, beam_000000.vtu]' 'materials:' '  - { cells: all,' \
    '    law: neo-hookean, density: 1e3, shear_modulus: 4e3, bulk_modulus: 4e5 }' \
    >"$SCRATCH/again/beam.yaml"
expect 1 "$LARIAT" run "$SCRATCH/again/beam.yaml" --steps 1 --out "$SCRATCH/again"
complains 'will not be overwritten'
cmp -s "$SCRATCH/again/beam_000000.vtu" "$SCRATCH/again/first.vtu" || fail "a mesh was overwritten"

rm -rf "$SCRATCH/linked"
mkdir "$SCRATCH/linked"
ln -s "$SCRATCH/beam.vtk" "$SCRATCH/linked/probes.csv"
cp "$beam" "$SCRATCH/beam.yaml"
expect 1 "$LARIAT" run "$SCRATCH/beam.yaml" --steps 1 --out "$SCRATCH/linked"
complains 'will not be overwritten'
cmp -s "$SCRATCH/beam.vtk" "$SOURCE/examples/beam.vtk" || fail "the mesh behind a link was lost"

# A pipe in the place of a result.
rm "$SCRATCH/linked/probes.csv"
mkfifo "$SCRATCH/linked/probes.csv"
expect 1 timeout 20 "$LARIAT" run "$SCRATCH/beam.yaml" --steps 1 --out "$SCRATCH/linked"
complains 'probes.csv: cannot be opened'

# Results, report and state take the place of no link, and nothing is computed first.
for name in beam.pvd beam_000000.vtu run.json beam.checkpoint; do
    rm -rf "$SCRATCH/linked"
    mkdir "$SCRATCH/linked"
    : >"$SCRATCH/behind"
    ln -s "$SCRATCH/behind" "$SCRATCH/linked/$name"
    expect 1 "$LARIAT" run "$SCRATCH/beam.yaml" --steps 1 --out "$SCRATCH/linked"
    complains "$name: is there and is no plain file"
    [ -L "$SCRATCH/linked/$name" ] && [ ! -s "$SCRATCH/behind" ] || fail "$name: not the link it was"
done
ln -sf "$SCRATCH/behind" "$SCRATCH/state"
expect 1 "$LARIAT" run "$SCRATCH/beam.yaml" --steps 1 --save "$SCRATCH/state"
complains 'state: is there and is no plain file'

# Many frames: the series is not written anew for each, but complete at the end.
printf 'output: { every: 1.0e-9, fields: [] }\n' | cat "$beam" - >"$SCRATCH/beam.yaml"
expect 0 "$LARIAT" run "$SCRATCH/beam.yaml" --steps 2500 --out "$SCRATCH/many"
[ "$(grep -c '<DataSet' "$SCRATCH/many/beam.pvd")" -eq 2501 ] || fail "frames missing in the series"
rm -rf "$SCRATCH/many"

# A limit on the size of files is a full disk, not a crash.
(
    ulimit -f 1
    "$LARIAT" run "$beam" --steps 10 --out "$SCRATCH/limited" >"$SCRATCH/out" 2>"$SCRATCH/err"
)
[ $? -eq 1 ] || fail "no plain failure where files may not grow"
complains 'cannot be written: File too large; .*(ulimit -f)'
[ -z "$(find "$SCRATCH/limited" -name '*.part')" ] || fail "a half frame is left"

# Closed streams: no message ends up in a result.
"$LARIAT" run "$SCRATCH/violent.yaml" --time 0.05 --out "$SCRATCH/closed" <&- >&- 2>&-
[ $? -eq 3 ] || fail "exit status with closed streams"
grep -q lariat "$SCRATCH/closed/probes.csv" && fail "a message in probes.csv"
"$LARIAT" info "$beam" >&- 2>"$SCRATCH/err"
[ $? -eq 1 ] || fail "success although standard output is closed"
complains 'standard output cannot be written'

finish "hostile input is refused"
