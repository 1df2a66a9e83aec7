#!/bin/sh
# A device, a session and the network between them, as a user puts them together: lariat view with a
# tool on UDP, lariat device, and the driver that docs/devices.md shows.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1
page=$SOURCE/docs/devices.md

# What is wrong is said before anything is sent.
expect 2 "$LARIAT" device
expect 2 "$LARIAT" device 127.0.0.1:9000
complains 'udp:127.0.0.1:9000'
expect 2 "$LARIAT" device udp:127.0.0.1:9 --circle 0.01 --push 0.01
complains 'exclude each other'
expect 2 "$LARIAT" device udp:127.0.0.1:9 --token 12345678901234567
complains '16 characters'
expect 1 "$LARIAT" device udp:127.0.0.1:9 --script missing.csv
complains 'missing.csv'
expect 1 "$LARIAT" device udp:127.0.0.1:9 --seconds 0.05
complains 'nobody at udp:127.0.0.1:9 answered'

# A beam of four elements, so that the engine keeps up wherever this runs, and a ball over it.
cp "$SOURCE/examples/beam.vtk" . || exit 1
cat >scene.yaml <<'END'
lariat: 1
mesh: beam.vtk
damping: 20
materials:
  - { cells: all, law: neo-hookean, density: 1050, youngs_modulus: 1.0e5, poisson_ratio: 0.45 }
sets:
  - { name: wall, nodes: { box: [[-0.001, -1, -1], [0.001, 1, 1]] } }
fix: [ { nodes: wall, axes: xyz } ]
tools:
  - { name: probe, shape: sphere, radius: 0.003, at: [0.03, 0.005, 0.02] }
END
expect 2 "$LARIAT" view scene.yaml --port 0 --seconds 0.1 \
    --device probe=udp:0.0.0.0:0
complains 'token='
expect 2 "$LARIAT" view scene.yaml --port 0 --seconds 0.1 --device probe=mouse:0
complains 'script:FILE.csv, udp:HOST:PORT or gamepad:N'

# Ends a session that this test has started, and waits for its report.
session=0
end_session() {
    [ "$session" -eq 0 ] || kill -INT "$session" 2>/dev/null
    wait "$session"
    session=0
}
trap 'end_session' EXIT

# begin_session DEVICE: a session with the probe on it; port: where the device is expected.
begin_session() {
    : >view.err # not the last one's port
    "$LARIAT" view scene.yaml --port 0 --seconds 60 --json --device "probe=$1" \
        >view.json 2>view.err &
    session=$!
    port=
    for _ in $(seq 200); do
        port=$(sed -n 's/.*device of probe is expected at port \([0-9]*\).*/\1/p' view.err)
        [ -z "$port" ] && sleep 0.25 || break
    done
    [ -n "$port" ] || fail "the session says no port: $(cat view.err)"
}

# A push against the organ is felt, and every packet is answered.
begin_session udp:127.0.0.1:0
expect 0 "$LARIAT" device "udp:127.0.0.1:$port" --push 0.01 --period 0.5 --seconds 1.5 --json
has_keys --numbers seconds sent answered lost strange steps round_trip_us.p50 round_trip_us.p99 \
    round_trip_us.p999 round_trip_us.max largest_force mean_force largest_torque touching holding
has_keys address
value_of largest_force | awk '{ exit !($1 > 0.01 && $1 <= 8.001) }' ||
    fail "the largest force is $(value_of largest_force) N"
value_of touching | awk '{ exit !($1 > 0) }' || fail "the tool never touched"
value_of strange | awk '{ exit !($1 == 0) }' || fail "answers that are none"
# SIGTERM ends it as Ctrl-C does.
"$LARIAT" device "udp:127.0.0.1:$port" --seconds 60 --json >"$SCRATCH/out" 2>"$SCRATCH/err" &
device=$!
sleep 1.5
kill -TERM $device
wait $device || fail "SIGTERM ended the device with $?"
has_keys --numbers sent answered
end_session
for key in devices answer_us received refused timeouts; do
    grep -q "\"$key\":" view.json || fail "the session's report lacks $key"
done
# Two devices have fallen silent, and what faded then is no answer.
awk '/"received":/ { received = $2 + 0 } /"answered":/ { answered = $2 + 0 }
    END { exit !(answered > 0 && answered <= received) }' view.json ||
    fail "more answers than positions: $(grep '"received"\|"answered"' view.json)"

# Every key is in docs/cli.md.
for key in address seconds sent answered lost strange steps round_trip_us largest_force mean_force \
    largest_torque touching holding; do
    grep -q "\`$key\`" "$SOURCE/docs/cli.md" || fail "docs/cli.md lacks the key $key"
done
"$LARIAT" device --help | grep -o '^  --[a-z-]*' | while read -r option; do
    grep -q -e "\`$option" "$SOURCE/docs/cli.md" || echo "$option"
done >undocumented
[ ! -s undocumented ] || fail "docs/cli.md lacks $(cat undocumented)"

# A token: who has it is answered.
begin_session udp:127.0.0.1:0,token=let-me-in
expect 1 "$LARIAT" device "udp:127.0.0.1:$port" --seconds 0.1
expect 1 "$LARIAT" device "udp:127.0.0.1:$port" --seconds 0.1 --token let-me-out
expect 0 "$LARIAT" device "udp:127.0.0.1:$port" --seconds 0.2 --token let-me-in
end_session

grep -q '"device": *"udp:127.0.0.1:0"' view.json || fail "the report names $(grep '"device"' view.json)"
! grep -q let-me-in view.json view.err || fail "the session's report tells the token"

# The driver of the page.
if command -v python3 >/dev/null; then
    begin_session udp:127.0.0.1:0
    awk '/^```python/ { inside = 1; next } /^```/ { inside = 0 } inside' "$page" |
        sed "s/9000/$port/" >driver.py
    expect 0 python3 driver.py
    says '^force ('
    end_session
fi

finish "a device on the network: felt, answered, refused without its token"
