#!/bin/sh
# docs/fit.md tells the truth from frames to a pulled organ: its commands run, one after the other, and
# what they find holds the truth that the page names.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1
"$LARIAT" doctor --no-speed --json >doctor
there() {
    awk -v name="\"$1\"," '$2 == name { mine = 1 } mine && /"there"/ { exit !/true/ }' doctor
}
for feature in fit png; do
    there $feature || {
        echo "skipped: built without what $feature needs"
        exit 77
    }
done
cp -r "$SOURCE/examples" examples
awk '/^## From frames/ { mine = 1; next } /^## / { mine = 0 }
    mine && /^```sh/ { inside = 1; next } /^```/ { inside = 0 } mine && inside' \
    "$SOURCE/docs/fit.md" >commands
[ "$(grep -c '^lariat ' commands)" -ge 4 ] || fail "the commands of docs/fit.md were not found"
while read -r word line; do
    case $word in
    lariat)
        # shellcheck disable=SC2086
        expect 0 "$LARIAT" $line </dev/null
        ;;
    sed) eval "sed $line" || fail "sed $line" ;;
    *) fail "a command that is neither lariat nor sed: $word $line" ;;
    esac
done <commands
# Truth within the intervals, as profiles and as tissue.
awk -F, '$1 + 0 == $1 { rows++; if ($4 > 3e-5) wide++ } END { exit rows < 360 || wide > 0 }' \
    measured/profiles.csv || fail "fewer points than frames show, or errors of more than 30 um"
for truth in shear_modulus:2700 g1:0.9 time1:0.3; do
    grep "^# ${truth%:*}: fitted" fitted/tissue.tissue.yaml |
        awk -v truth="${truth#*:}" '{ exit !($7 <= truth && truth <= $9 + 0) }' ||
        fail "${truth%:*}: $(grep "^# ${truth%:*}" fitted/tissue.tissue.yaml) instead of ${truth#*:}"
done
grep -q '</svg>' measured/profiles.svg || fail "no picture of the profiles"
ls organ/results/*.vtu >/dev/null || fail "the organ was not pulled"
finish "docs/fit.md: from frames to a pulled organ"
