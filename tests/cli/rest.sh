#!/bin/sh
# Runs that end at rest, those that never do, and what every run leaves behind.
. "$(dirname "$0")/lib.sh"
bar=$SCRATCH/bar.inp
cat >"$bar" <<'END'
*NODE
1, 0, 0, 0
2, 0.05, 0, 0
3, 0.05, 0.05, 0
4, 0, 0.05, 0
5, 0, 0, 0.05
6, 0.05, 0, 0.05
7, 0.05, 0.05, 0.05
8, 0, 0.05, 0.05
9, 0, 0, 0.1
10, 0.05, 0, 0.1
11, 0.05, 0.05, 0.1
12, 0, 0.05, 0.1
*ELEMENT, TYPE=C3D8
1, 1, 2, 3, 4, 5, 6, 7, 8
2, 5, 6, 7, 8, 9, 10, 11, 12
END
# scene NAME LINES...: a bar that hangs from its upper end, or falls.
scene() {
    name=$SCRATCH/$1.yaml
    shift
    printf '%s\n' "lariat: 1" "mesh: bar.inp" "gravity: [0, 0, -9.81]" \
        "materials: [{cells: all, law: neo-hookean, density: 1000, shear_modulus: 2.0e3, bulk_modulus: 2.0e4}]" \
        "$@" >"$name"
}
hold='fix: [{nodes: {box: [[-1, -1, 0.099], [1, 1, 1]]}, axes: xyz}]'

# A scene that asks for rest: damped by itself, the same step and bits on every grid.
scene hanging "duration: rest" "$hold"
expect 0 "$LARIAT" run "$SCRATCH/hanging.yaml" --out "$SCRATCH/hanging"
says '^rest  *yes; loads constant from 0 s, kinetic over strain energy '
complains 'note: .*hanging.yaml: duration: rest without a damping: it is '
expect 0 "$LARIAT" run "$SCRATCH/hanging.yaml" --json
has_keys rest.followed rest.reached --numbers rest.since rest.limit rest.kinetic_over_strain \
    rest.left
[ "$(value_of rest.reached)" = true ] || fail "not at rest"
steps=$(value_of steps) hash=$(value_of state_hash)
for division in "--grid 2x1x1" "--grid 1x1x2 --threads 2" "--grid 2x1x1 --comm shm" "--isa c"; do
    # shellcheck disable=SC2086
    expect 0 "$LARIAT" run "$SCRATCH/hanging.yaml" --json $division
    [ "$(value_of steps)$(value_of state_hash)" = "$steps$hash" ] || fail "rest with $division"
done
expect 0 "$LARIAT" info "$SCRATCH/hanging.yaml" --no-speed
says '^duration  *until it is at rest, one frame at the end'
expect 0 "$LARIAT" info "$SCRATCH/hanging.yaml" --no-speed --json
[ "$(value_of until_rest)" = true ] || fail "info does not say until_rest"

# What a run leaves: its last state, without `every` too, as a frame and to go on from.
[ -s "$SCRATCH/hanging/hanging_000000.vtu" ] || fail "no frame of the last state"
[ "$(head -c 8 "$SCRATCH/hanging/hanging.checkpoint")" = LARIATCP ] || fail "no checkpoint"
grep -q "\"state_hash\": \"*$(echo "$hash" | tr -d '"')" "$SCRATCH/hanging/run.json" || fail "run.json"
echo "no checkpoint" >"$SCRATCH/hanging/hanging.checkpoint"
expect 1 "$LARIAT" run "$SCRATCH/hanging.yaml" --steps 10 --out "$SCRATCH/hanging"
complains 'hanging.checkpoint: '

# Any scene, on request; a time is then the most.
scene damped "damping: 20" "$hold"
expect 0 "$LARIAT" run "$SCRATCH/damped.yaml" --until-rest --json
[ "$(value_of rest.reached)" = true ] || fail "--until-rest"
expect 0 "$LARIAT" run "$SCRATCH/damped.yaml" --json
[ "$(value_of rest.followed)$(value_of time | cut -c 1)" = false1 ] || fail "a run without rest"
expect 4 "$LARIAT" run "$SCRATCH/damped.yaml" --until-rest --time 0.1 --json --out "$SCRATCH/damped"
[ "$(value_of rest.reached)" = false ] || fail "at rest after 0.1 s"
[ "$(value_of rest.limit)" = "$(value_of time)" ] || fail "limit $(value_of rest.limit) with --time 0.1"
[ -s "$SCRATCH/damped/damped_000000.vtu" ] || fail "no last state of a run that did not rest"
complains 'damped.yaml: not at rest after 0.0[0-9]* s, the limit of this run: .*; [a-z]'

expect 4 "$LARIAT" run "$SCRATCH/damped.yaml" --until-rest --steps 40 --json
[ "$(value_of rest.limit)$(value_of steps)" = "$(value_of time)40" ] || fail "limit with --steps"

# Who gave no damping gets one.
scene bare "$hold"
expect 0 "$LARIAT" run "$SCRATCH/bare.yaml" --until-rest
complains 'bare.yaml names no damping; it is [0-9.]* 1/s, as its slowest motion needs'
says '^rest  *yes'
scene undamped "damping: 0" "$hold"
expect 4 "$LARIAT" run "$SCRATCH/undamped.yaml" --until-rest

# A body that comes back to its own shape has no strain energy to compare its motion with.
scene returning "duration: rest" "damping: 20" "$hold" \
    'load: [{nodes: {box: [[-1, -1, -1], [1, 1, 0.001]]}, force: [0.002, 0, 0], curve: {points: [[0, 0], [0.1, 1], [0.2, 0]]}}]'
sed 's/gravity:.*/gravity: [0, 0, 0]/' "$name" >"$SCRATCH/back.yaml"
expect 0 "$LARIAT" run "$SCRATCH/back.yaml" --json
steps=$(value_of steps) hash=$(value_of state_hash)
expect 0 "$LARIAT" run "$SCRATCH/back.yaml" --json --grid 1x1x2 --isa c
[ "$(value_of steps)$(value_of state_hash)" = "$steps$hash" ] || fail "back in its shape on a grid"

# What never rests ends at its limit and says so.
scene swinging "damping: 0" "duration: rest" "$hold"
expect 4 "$LARIAT" run "$SCRATCH/swinging.yaml" --json
[ "$(value_of rest.limit)" = "$(value_of time)" ] || fail "limit without --time"
complains 'swinging.yaml: not at rest after [0-9.]* s, the limit of this run: its motion is still'
complains 'without damping nothing takes the motion away'
scene falling "damping: 20" "duration: rest"
expect 4 "$LARIAT" run "$SCRATCH/falling.yaml" --json
complains 'next to nothing strains it, .*; look whether something still falls or turns freely'
expect 2 "$LARIAT" run "$SCRATCH/falling.yaml" --until-rest --verify
complains 'give one of --verify and --until-rest'

# What helps is said: less damping where it creeps, more where it swings.
scene creeping "damping: 300" "$hold"
expect 4 "$LARIAT" run "$SCRATCH/creeping.yaml" --until-rest --time 2
complains 'it creeps: less damping'
scene swaying "damping: 1" "$hold"
expect 4 "$LARIAT" run "$SCRATCH/swaying.yaml" --until-rest --time 4
complains 'it swings: more damping'

# What creeps as its material does is not at rest, however slowly, and waves never let it rest.
scene viscous "$hold"
sed -i 's/bulk_modulus: 2.0e4/&, viscous: {part: isochoric, terms: [{g: 4, time: 1.0e+4}]}/' "$name"
expect 4 "$LARIAT" run "$name" --until-rest --json
complains 'viscous terms still relax, .*the scene without `viscous` .*comes to the same rest sooner'
sed -i 's/1.0e+4/0.02/' "$name"
expect 0 "$LARIAT" run "$name" --until-rest
says '^rest  *yes'
scene waves "$hold"
sed -i 's/bulk_modulus: 2.0e4/&, fibres: {direction: {axis: [0, 0, 1]}, active: {along: 100, wave: {direction: [0, 0, 1], speed: 1, length: 0.02, every: 0.2}}}/' "$name"
expect 1 "$LARIAT" run "$name" --until-rest
complains 'a wave or a curve comes again and again: leave out --until-rest'

# A cantilever 20 times as long as thick bends 20 times more slowly than a shear wave runs along it.
# Of one layer of elements it is held by their hourglass modes alone, and that is said.
beam() { # FILE CELLS
    awk -v n="$2" 'BEGIN {
        print "*NODE"
        for (k = 0; k <= n; k++) for (j = 0; j <= n; j++) for (i = 0; i <= 20; i++)
            print 1 + i + 21 * (j + (n + 1) * k) ", " i / 100 ", " j / (100 * n) ", " k / (100 * n)
        print "*ELEMENT, TYPE=C3D8"
        for (k = 0; k < n; k++) for (j = 0; j < n; j++) for (i = 0; i < 20; i++) {
            a = 1 + i + 21 * (j + (n + 1) * k); b = a + 21; c = a + 21 * (n + 1); d = c + 21
            print ++e ", " a ", " a + 1 ", " b + 1 ", " b ", " c ", " c + 1 ", " d + 1 ", " d
        }
    }' >"$1"
}
for cells in 2 1; do
    beam "$bar" $cells
    scene slender "duration: rest" 'fix: [{nodes: {plane: {point: [0, 0, 0], normal: [1, 0, 0]}}, axes: xyz}]'
    sed 's/-9.81/-0.005/' "$name" >"$SCRATCH/slender$cells.yaml"
    expect 0 "$LARIAT" run "$SCRATCH/slender$cells.yaml"
    complains "note: .*slender$cells.yaml: the body's slowest motion has 0.[0-9]* 1/s: its damping is"
    says '^rest  *yes'
    [ $cells = 1 ] || says '^hourglass  *24'
done
says '^hourglass  *99[0-9.]* % of strain and hourglass energy: .*two or more elements'
expect 0 "$LARIAT" run "$SCRATCH/slender1.yaml" --json
[ "$(value_of energy.hourglass_share | cut -c 1-4)" = 0.99 ] || fail "share of one layer"
# Bent and let back it is straight again: a share of nothing.
scene back "damping: 5" "duration: DURATION" 'fix: [{nodes: {plane: {point: [0, 0, 0], normal: [1, 0, 0]}}, axes: xyz}]' \
    'move: [{nodes: {plane: {point: [0.2, 0, 0], normal: [1, 0, 0]}}, axes: z, by: -0.02, curve: {points: [[0, 0], [1, 1], [2, 0]]}}]'
for end in 0.5 8; do
    sed "s/-9.81/0/; s/DURATION/$end/" "$name" >"$SCRATCH/bent.yaml"
    expect 0 "$LARIAT" run "$SCRATCH/bent.yaml"
    if [ $end = 8 ] && grep -q '^hourglass' "$SCRATCH/out"; then fail "hourglass energy of a straight beam: $(cat "$SCRATCH/out")"; fi
    [ $end = 8 ] || says '^hourglass  *88'
done
scene wrong "duration: soon"
expect 1 "$LARIAT" run "$SCRATCH/wrong.yaml"
complains 'wrong.yaml:5:11: duration: expected rest, or a number in seconds'

# Decks of FEBio's test suite: free displacements at rest as its gold standard has them.
decks=$SOURCE/../shared/data/bench/febio
if [ -r "$decks/mi27.feb" ]; then
    for deck in mi27 tu01; do
        expect 0 "$LARIAT" run "$decks/$deck.feb" --json
        [ "$(value_of rest.reached)" = true ] || fail "$deck is not at rest"
        expect 0 "$LARIAT" run "$decks/$deck.feb" --time 1 --json
        [ "$(printf %.3f "$(value_of time)")$(value_of rest.followed)" = 1.000false ] ||
            fail "$deck --time 1"
    done
else
    echo "skipped: no shared data"
fi
finish "rest: ends where nothing moves any more"
