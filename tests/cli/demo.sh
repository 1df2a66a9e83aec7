#!/bin/sh
# A scene of the demonstration organ that somebody has edited stays.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1

expect 0 "$LARIAT" demo-model organ
[ ! -s err ] || fail "a new folder: $(cat err)"
cp organ/uterus.yaml as_written.yaml
expect 0 "$LARIAT" demo-model organ
[ ! -s err ] || fail "the same again: $(cat err)"

# One character, one more, one less: what is not the same stays.
for edit in 's/Uterus/Uterut/' '$a # mine' '$d'; do
    sed "$edit" as_written.yaml >organ/uterus.yaml
    cp organ/uterus.yaml edited.yaml
    rm organ/uterus.vtu organ/uterus_live.yaml
    expect 0 "$LARIAT" demo-model organ
    complains '^lariat demo-model: note: organ/uterus.yaml is there already and differs .*--force'
    [ "$(wc -l <err)" -eq 1 ] || fail "more than a line: $(cat err)"
    cmp -s organ/uterus.yaml edited.yaml || fail "an edited scene was replaced ($edit)"
    [ -s organ/uterus.vtu ] && [ -s organ/uterus_live.yaml ] || fail "the rest was not written"
done
: >organ/uterus.yaml
expect 0 "$LARIAT" demo-model organ
[ ! -s organ/uterus.yaml ] || fail "an empty scene was replaced"

expect 0 "$LARIAT" demo-model organ --force
[ ! -s err ] || fail "--force: $(cat err)"
cmp -s organ/uterus.yaml as_written.yaml || fail "--force has not replaced the scene"
finish "edited scenes of the demonstration stay"
