#!/bin/sh
# Allocations that fail, one at a time: nothing crashes, hangs, or ends well with another result.
#
#   allocations.sh LARIAT JSON SCRATCH SOURCE LIBRARY [EVERY]
#
# With EVERY only each EVERY-th. LIBRARY is preloaded (failing_memory.c). Cores are not looked for:
# hwloc itself aborts when it has no memory.
. "$(dirname "$0")/lib.sh"
library=$5 every=${6:-1}
tried=0
cd "$SCRATCH" || exit 1

cat >small.yaml <<'END'
lariat: 1
mesh: small.msh
materials: [ { cells: all, law: neo-hookean, density: 1000, shear_modulus: 1.0e3, bulk_modulus: 1.0e5 } ]
fix: [ { nodes: { plane: { point: [0, 0, 0], normal: [0, 0, 1] } }, axes: xyz } ]
duration: 0.002
tools: [ { name: probe, shape: sphere, radius: 0.002, at: [0, 0, 0.1] } ]
contact: [ { self: true } ]
output: { every: 0.0005, probes: [ { node: 1 } ] }
END
# Cubes of 1 cm, so many along each axis.
awk 'BEGIN {
    n = 2; m = n + 1
    print "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" m * m * m
    for (k = 0; k < m; k++) for (j = 0; j < m; j++) for (i = 0; i < m; i++)
        print 1 + i + m * (j + m * k), i / 100, j / 100, k / 100
    print "$EndNodes\n$Elements\n" n * n * n
    for (k = 0; k < n; k++) for (j = 0; j < n; j++) for (i = 0; i < n; i++) {
        a = 1 + i + m * (j + m * k); b = a + m * m
        print ++e, 5, 2, 1, 1, a, a + 1, a + 1 + m, a + m, b, b + 1, b + 1 + m, b + m
    }
    print "$EndElements"
}' >small.msh
# The same as XML, and a recording.
expect 0 "$LARIAT" run small.yaml --steps 1 --out first
cp first/*_000000.vtu small.vtu
sed 's/small.msh/small.vtu/' small.yaml >xml.yaml
awk 'BEGIN {
    print "solid box"
    split("0 0 0,0 1 0,1 1 0;0 0 0,1 1 0,1 0 0;0 0 1,1 0 1,1 1 1;0 0 1,1 1 1,0 1 1;" \
          "0 0 0,1 0 0,1 0 1;0 0 0,1 0 1,0 0 1;0 1 0,0 1 1,1 1 1;0 1 0,1 1 1,1 1 0;" \
          "0 0 0,0 0 1,0 1 1;0 0 0,0 1 1,0 1 0;1 0 0,1 1 0,1 1 1;1 0 0,1 1 1,1 0 1", face, ";")
    for (f = 1; f <= 12; f++) {
        print "facet normal 0 0 0\nouter loop"
        split(face[f], corner, ",")
        for (c = 1; c <= 3; c++) {
            split(corner[c], x, " ")
            print "vertex", x[1] / 20, x[2] / 20, x[3] / 20
        }
        print "endloop\nendfacet"
    }
    print "endsolid box"
}' >box.stl

# What a command's answer is: without times, which differ, and what a session has done in them.
same='state_hash|steps|nodes|elements|searches'
answer() {
    grep -E "\"($same)\"" out
    for file in results/probes.csv results/*.vtu results/*.yaml; do
        [ ! -f "$file" ] || cksum "$file"
    done
}

# One run with the allocations from $1 on failing, $2 of them.
once() {
    at=$1 count=$2
    shift 2
    rm -rf results
    timeout -k 1 30 env LD_PRELOAD="$library" FAIL_AT="$at" FAIL_COUNT="$count" "$@" \
        >out 2>err </dev/null
    got=$?
    tried=$((tried + 1))
    if [ $got -eq 0 ]; then
        answer | cmp -s - wanted || fail "allocation $at ($count): another result: $*"
    elif [ $got -ge 124 ]; then
        fail "allocation $at ($count): exit status $got: $*"
    else
        grep -Eiq 'memory|not enough space' err || {
            fail "allocation $at ($count): exit status $got, and says something else: $*"
            head -n 3 err | sed 's/^/    /' >&2
        }
    fi
}

# sweep COMMAND...: every allocation of it, alone and with all that follow.
sweep() {
    rm -rf results
    expect 0 env LD_PRELOAD="$library" FAIL_TALLY="$SCRATCH/tally" "$@"
    answer >wanted
    last=$(cat tally)
    [ "$last" -gt 100 ] || fail "$last allocations are too few to be true: $*"
    echo "$last allocations: $*" | sed "s|$LARIAT|lariat|"
    for at in $(seq $((every - 1)) "$every" "$last"); do
        once "$at" 1 "$@"
        [ $((at / every % 8)) -ne 0 ] || once "$at" 1000000 "$@"
    done
}

sweep "$LARIAT" run small.yaml --steps 20 --out results --json
sweep "$LARIAT" run xml.yaml --steps 2 --json
sweep "$LARIAT" run small.yaml --steps 20 --grid 2x1x1 --threads 2 --no-pin --json
sweep "$LARIAT" run small.yaml --steps 20 --grid 2x1x1 --comm shm --no-pin --json
sweep "$LARIAT" run small.yaml --steps 20 --grid 2x1x1 --comm tcp --no-pin --json
sweep "$LARIAT" verify small.yaml --grid 2x1x1 --no-pin --json
sweep "$LARIAT" mesh box.stl --elements 40 --out results
if "$LARIAT" view small.yaml --seconds 0.1 --port 0 --record take.recording \
    >out 2>err </dev/null; then
    sweep "$LARIAT" replay small.yaml take.recording --out results --no-pin --json
    same='nodes|elements'
    sweep "$LARIAT" view small.yaml --seconds 0.1 --port 0 --json
fi
finish "ok: $tried runs without some of their memory"
