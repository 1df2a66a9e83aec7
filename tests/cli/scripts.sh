#!/bin/sh
# Scripts that once broke the demonstration organ: instruments pushed deep into it, jaws that close
# there, draw and open. They are played to their end, and no instrument comes inside.
PLAY=$5
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1
cases=$SOURCE/../shared/cases
if [ ! -f "$cases/grasper_deep.csv" ]; then
    finish "skipped: ../shared/cases is not there"
    exit 0
fi
"$LARIAT" demo-model demo >/dev/null || exit 1
scene=demo/uterus_live.yaml

# plays NAME OPTION...: the row says how it went. Nothing moves after 23 s.
plays() {
    name=$1
    shift
    expect 0 "$PLAY" $scene --seconds 23.5 --every 20 --inside "$@"
    says '^| no stop | inside 0.000 s '
    echo "$name: $(cat out)"
}
plays deep --device grasper="$cases/grasper_deep.csv"
in_short || plays both --device grasper="$cases/grasper.csv" --device probe="$cases/probe.csv"

# In a session, with a clock: it goes on, and does not go back.
if "$LARIAT" view $scene --port 0 --seconds 0.1 2>&1 | grep -q 'no server for viewers'; then
    finish "scripts of the demonstration organ, without a session: this build has no server"
    exit 0
fi
expect 0 "$LARIAT" view $scene --port 0 --seconds 10 --pace 0 --json \
    --device grasper=script:"$cases/grasper_deep.csv"
[ "$(value_of state)" = '"playing"' ] || fail "the state is $(value_of state)"
[ "$(value_of recoveries)" -eq 0 ] || fail "it went back $(value_of recoveries) times"
finish "scripts of the demonstration organ"
