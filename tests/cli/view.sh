#!/bin/sh
# lariat view: an address, a report, free ports, signals; and what makes no sense.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1
"$LARIAT" demo-model demo >/dev/null || exit 1
scene=demo/uterus_live.yaml

expect 2 "$LARIAT" view
complains 'SCENE is missing'
for wrong in '--port 65536' '--port x' '--pace -1' '--seconds 0' '--device='; do
    # shellcheck disable=SC2086
    expect 2 "$LARIAT" view $scene $wrong
    silent
done
expect 1 "$LARIAT" view none.yaml
complains 'none.yaml'

if "$LARIAT" view $scene --port 0 --seconds 0.1 2>&1 | grep -q 'no server for viewers'; then
    complains_about=$("$LARIAT" view $scene 2>&1)
    case $complains_about in *libwebsockets-dev*) ;; *) fail "how to get it is not said" ;; esac
    finish "lariat view: this build has no libwebsockets, and says how to get it"
    exit 0
fi

# For people.
expect 0 "$LARIAT" view $scene --port 0 --seconds 0.5 --save-folder "saved here/below"
says '^http://127.0.0.1:[0-9]*/$'
says '^real-time factor'
says '^ticks '
says '^tool  *probe: largest force 0 N, limit [0-9.]* N$'
says '^state hash  *[0-9a-f]\{16\}$'
[ -d "saved here/below" ] || fail "the folder for saved states was not made"

expect 0 "$LARIAT" view $scene --port 0 --seconds 0.2 --grid 1x1x1
says '^grid  *1x1x1: 1 processor, scheme'

# A scene's duration does not end it, and that is said; the end of a ramp is none.
{ cat $scene && echo 'load: [ { nodes: fundus, force: [0, 0, 0.001], over: 0.1 } ]'; } >demo/ramp.yaml
expect 0 "$LARIAT" view demo/ramp.yaml --port 0 --seconds 0.2 --pace 0
! grep -q 'view goes on' "$SCRATCH/err" || fail "the end of a ramp is taken for a duration"
sed 's/^title:/duration: 0.05\n&/' $scene >demo/short.yaml
expect 0 "$LARIAT" view demo/short.yaml --port 0 --seconds 0.4 --pace 0 --json
complains 'note: the scene lasts 0.05 s; view goes on'
awk "BEGIN { exit !($(value_of time) > 0.05) }" || fail "it ended at $(value_of time) s"

# Two addresses: one for who acts, one for who may only watch.
expect 0 "$LARIAT" view $scene --port 0 --seconds 0.3 --token for-the-surgeon --watch-token for-the-class
says '^http://127.0.0.1:[0-9]*/#token=for-the-surgeon$'
says '^http://127.0.0.1:[0-9]*/#token=for-the-class$'
says '^Who opens that one can only watch.$'
expect 2 "$LARIAT" view $scene --port 0 --seconds 0.3 --watch-token for-the-class
complains 'a watch token needs a token beside it'

# For machines.
expect 0 "$LARIAT" view $scene --port 0 --seconds 0.5 --json --grid 2x1x1 --pace 0
complains '^http://127.0.0.1:[0-9]*/$'
has_keys title url state message steps time real_time_factor ticks deadline_misses slow_motion \
    skipped recoveries recovery divided_steps most_parts heavier.elements heavier.largest_share tools viewers state_hash devices wall_per_tick_us.p999 wall_per_step_us.p50
[ "$(value_of grid)" = '"2x1x1"' ] || fail "the grid is $(value_of grid)"
[ "$(value_of steps)" -gt 0 ] || fail "nothing was simulated"
expect 0 "$LARIAT" view $scene --port 0 --seconds 0.3 --json --paused --device probe=udp:127.0.0.1:0
[ "$(value_of steps)" -eq 0 ] || fail "it did not wait for play"
[ "$(value_of state)" = '"paused"' ] || fail "the state is $(value_of state)"

# A short session: all of its ticks are in the percentiles, not the first one alone.
expect 0 "$LARIAT" view $scene --port 0 --seconds 0.05 --json --pace 0
awk "BEGIN { exit !($(value_of wall_per_tick_us.p50) < $(value_of wall_per_tick_us.p999)) }" ||
    fail "the median is as long as the longest: $(value_of wall_per_tick_us.p50) us"
[ "$(value_of state)" = '"playing"' ] || fail "at the end the state is $(value_of state)"

# Slow motion: which of the two it is and what would help, and what is late in it is no miss.
expect 0 "$LARIAT" view $scene --port 0 --seconds 3 --pace 90
complains 'note: slow motion, [0-9.]* times real time: a step takes [0-9.]* [um]s and stands for [0-9.]* [um]s of the clock; what would hold: .*a pace of [0-9.]*'
says '^real-time factor.*because steps take longer than the time they stand for'
says '^ticks .*, 0 missed (0.000 %); [0-9]* more were late in slow motion$'
says "^a tick's forces *median [0-9.]* ms, .* longest [0-9.]* ms$"
expect 0 "$LARIAT" view $scene --port 0 --seconds 2 --pace 90 --json
[ "$(value_of slow_cause)" = '"step"' ] || fail "slow motion is because of $(value_of slow_cause)"
[ "$(value_of slow_ticks)" -gt 100 ] || fail "$(value_of slow_ticks) ticks were late in slow motion"
[ "$(value_of deadline_misses)" -eq 0 ] || fail "$(value_of deadline_misses) misses in slow motion"
awk "BEGIN { exit !($(value_of wall_per_tick_us.p50) < 20000) }" ||
    fail "the median of a tick is $(value_of wall_per_tick_us.p50) us"

# A block is torn by a load beside a hand that moves: the session goes back, on and on, and replays.
awk 'BEGIN {
    print "*NODE"
    for (k = 0; k < 4; k++) for (j = 0; j < 5; j++) for (i = 0; i < 7; i++)
        printf "%d, %g, %g, %g\n", 1 + i + 7 * (j + 5 * k), .01 * i, .01 * j, .01 * k
    print "*ELEMENT, TYPE=C3D8"
    for (k = 0; k < 3; k++) for (j = 0; j < 4; j++) for (i = 0; i < 6; i++) {
        n = 1 + i + 7 * (j + 5 * k)
        print ++e ", " n ", " n + 1 ", " n + 8 ", " n + 7 ", " n + 35 ", " n + 36 ", " n + 43 ", " n + 42
    }
    print "*NSET, NSET=bottom"
    for (n = 1; n <= 35; n++) print n ","
    print "*NSET, NSET=top\n123,"
}' >block.inp
cat >block.yaml <<EOF
lariat: 1
mesh: block.inp
damping: 0.5
materials: [ { cells: all, law: neo-hookean, density: 1000, shear_modulus: 500, bulk_modulus: 25e3 } ]
fix: [ { nodes: bottom, axes: xyz } ]
load: [ { nodes: top, force: [0, 0, -1e3], curve: { points: [[0, 0], [1.1, 0], [1.1, 1]] } } ]
EOF
awk 'BEGIN {
    print "time,x,y,z,opening\n0,.03,.02,.03,1\n.3,.03,.02,.03,1\n.31,.03,.02,.03,0\n.4,.03,.02,.03,0"
    for (t = .5; t < 20; t += .3) printf "%g,.03,.02,%g,0\n", t, n++ % 2 ? .032 : .028
}' >hand.csv
for grid in '' '--grid 2x1x1 --comm shm'; do
    # Two processors that share a busy core with other tests may need longer to reach the load.
    for patience in 4 20 60; do
        rm -f back.recording
        # shellcheck disable=SC2086
        expect 0 "$LARIAT" view block.yaml --port 0 --seconds $patience --pace 0 \
            --record back.recording --device hand=script:hand.csv --json $grid
        [ "$(value_of recoveries)" -eq 0 ] || break
    done
    complains 'the run became unstable and went back [0-9.]* s to .*: unstable at step'
    [ "$(value_of recoveries)" -gt 0 ] || fail "it went back $(value_of recoveries) times"
    [ "$(value_of state)" = '"playing"' ] || fail "the state is $(value_of state)"
    case $(value_of recovery) in '"went back'*) ;; *) fail "the last was $(value_of recovery)" ;; esac
    hash=$(value_of state_hash)
    expect 0 "$LARIAT" replay block.yaml back.recording --json
    [ "$(value_of state_hash)" = "$hash" ] || fail "it replays to $(value_of state_hash), not $hash"
done

# Every key is in the page.
expect 0 "$LARIAT" view $scene --port 0 --seconds 0.3 --json --paused --device probe=udp:127.0.0.1:0
for key in $(grep -o '"[a-z0-9_]*":' out | tr -d '":' | sort -u); do
    grep -q "\`$key\`" "$SOURCE/docs/cli.md" || fail "docs/cli.md lacks the key $key"
done
"$LARIAT" view --help | grep -o '^  --[a-z-]*' | while read -r option; do
    grep -q -e "\`$option" "$SOURCE/docs/cli.md" || echo "$option"
done >undocumented
[ ! -s undocumented ] || fail "docs/cli.md lacks $(cat undocumented)"

# A port that is taken: the next one. Ctrl-C: the report.
"$LARIAT" view $scene --port 0 >first 2>first.err &
first=$!
for _ in $(seq 1200); do
    grep -q '^http' first && break
    sleep 0.05
done
port=$(sed -n 's/^http:.*:\([0-9]*\)\/$/\1/p' first)
[ -n "$port" ] || fail "no address was printed"
expect 0 "$LARIAT" view $scene --port "$port" --seconds 0.2
complains "port $port is taken"
says "^http://127.0.0.1:"
kill -INT $first
wait $first
status=$?
[ $status -eq 0 ] || fail "Ctrl-C ends it with $status"
grep -q '^state hash' first || fail "there is no report after Ctrl-C"

# A process is lost: who, and an end within two seconds.
"$LARIAT" view $scene --port 0 --grid 2x1x1 --comm shm --json >out 2>err &
zero=$!
one=
for _ in $(seq 1200); do
    if grep -q '^http' err; then
        for stat in /proc/[0-9]*/stat; do
            read -r pid _ _ parent _ 2>/dev/null <"$stat" && [ "$parent" = $zero ] && one=$pid
        done
        break
    fi
    sleep 0.05
done
sleep 0.3
[ -n "$one" ] && kill -KILL "$one" || fail "no process to lose"
for _ in $(seq 30); do
    [ "$(cut -d ' ' -f 3 /proc/$zero/stat 2>/dev/null)" = Z ] && break
    sleep 0.1
done
[ "$(cut -d ' ' -f 3 /proc/$zero/stat 2>/dev/null)" = Z ] || [ ! -e /proc/$zero ] || {
    fail "it goes on without its other process"
    kill -KILL $zero
}
wait $zero
status=$?
[ $status -eq 1 ] || fail "a lost process ends it with $status"
complains '^lariat view: processor 1 is lost: '
complains 'processor 1 was ended by signal 9'
! grep -q 'reset takes it up' err || fail "reset is offered in vain"

# Others may come in with a token only.
expect 2 "$LARIAT" view $scene --port 0 --seconds 0.2 --listen 0.0.0.0
complains 'token'
expect 2 "$LARIAT" view $scene --port 0 --seconds 0.2 --token short
complains '8 to 128'
expect 0 "$LARIAT" view $scene --port 0 --seconds 0.2 --token a-long-enough-one
says '/#token=a-long-enough-one$'
expect 1 "$LARIAT" view $scene --port 0 --viewer "$SCRATCH/none"
complains "$SCRATCH/none"
expect 2 "$LARIAT" view $scene --port 0 --device "nothing=script:x.csv"
complains 'there is no such tool; there are: '
for incomplete in probe probe=; do
    expect 2 "$LARIAT" view $scene --port 0 --device $incomplete
    complains 'TOOL=DEVICE'
done

# A state of a session, which has hands, is taken up where it was; one of a run has none.
expect 0 "$LARIAT" run $scene --steps 500 --save half.checkpoint
expect 0 "$LARIAT" view $scene --port 0 --seconds 0.3 --paused --json --resume half.checkpoint
[ "$(value_of steps)" -eq 500 ] || fail "it begins at step $(value_of steps)"
complains 'half.checkpoint has no hands'
expect 1 "$LARIAT" view $scene --port 0 --seconds 0.3 --resume none.checkpoint
complains 'none.checkpoint'
expect 1 "$LARIAT" view demo/uterus.yaml --port 0 --seconds 0.3 --resume half.checkpoint
complains 'half.checkpoint: was saved from another model'
expect 1 "$LARIAT" view half.checkpoint --port 0
complains 'half.checkpoint: is a saved state .* lariat run SCENE --resume half.checkpoint, or with lariat view'

# What is recorded from the command line is there.
expect 0 "$LARIAT" view $scene --port 0 --seconds 0.3 --record way.recording
[ -s way.recording ] || fail "nothing was recorded"
expect 1 "$LARIAT" view $scene --port 0 --seconds 0.1 --record way.recording
complains 'way.recording is there already; --force replaces it'
expect 0 "$LARIAT" view $scene --port 0 --seconds 0.1 --record way.recording --force
for force in '' --force; do
    expect 1 "$LARIAT" view $scene --port 0 --seconds 0.1 --record demo $force
    complains 'demo is a folder; give --record a file'
done
# A command line that is refused leaves none, and replaces none.
cp way.recording kept.recording
expect 2 "$LARIAT" view $scene --port 0 --seconds 0.1 --record no.recording --device typo=script:x.csv
[ ! -e no.recording ] || fail "a recording of nothing was left"
expect 2 "$LARIAT" view $scene --port 0 --record way.recording --force --device typo=script:x.csv
cmp -s way.recording kept.recording || fail "a recording was replaced by nothing"
# On a disk that fills up recording ends, which is told while the session goes on; only root can
# make one.
mkdir small
if mount -t tmpfs -o size=64k none small 2>/dev/null; then
    expect 1 "$LARIAT" view $scene --port 0 --seconds 2 --record small/way.recording
    [ ! -e small/way.recording ] || fail "what is not even a whole state was left"
    umount small
    complains '^lariat view: note: recording has ended: small/way.recording: .*No space left'
else
    echo "skipped: no small file system can be mounted here"
fi

finish "lariat view: address, report, ports, signals, refusals"
