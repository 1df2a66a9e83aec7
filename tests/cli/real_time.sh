#!/bin/sh
# How many elements keep the clock: lariat info says it, lariat mesh --real-time makes that mesh.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1
"$LARIAT" demo-model demo >/dev/null || exit 1
expect 0 "$LARIAT" info demo/uterus.yaml --json
"$JSON" --print speed <out | grep -q 'real_time_elements' || fail "info does not say how many hold"
expect 0 "$LARIAT" info demo/uterus.yaml
says 'elements of this body keep the clock with a third in reserve'

# A block of 40 mm as a closed surface.
cat >block.obj <<END
v 0 0 0
v 40 0 0
v 40 40 0
v 0 40 0
v 0 0 40
v 40 0 40
v 40 40 40
v 0 40 40
f 4 3 2 1
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
END
expect 0 env TMPDIR="$SCRATCH" "$LARIAT" mesh block.obj --scale 0.001 --real-time --json
has_keys elements speed
complains '^lariat mesh: note: [0-9]* elements: .* times as fast as real time$'
[ -f block/block.yaml ] || fail "there is no scene"
ls -d lariat-mesh-* >/dev/null 2>&1 && fail "what was tried is left"
expect 2 "$LARIAT" mesh block.obj --real-time --elements 300
complains 'leave --elements out'
expect 2 "$LARIAT" mesh block.obj --real-time --size 0.01
complains 'leave --size out'
expect 1 env TMPDIR=/nowhere "$LARIAT" mesh block.obj --scale 0.001 --real-time --out other
complains 'set TMPDIR'
[ ! -d other ] || fail "a mesh that could not be tried is written"
finish "elements that keep the clock"
