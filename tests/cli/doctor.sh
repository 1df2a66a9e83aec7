#!/bin/sh
# lariat doctor tells the truth about the build, and sensible figures of the machine.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1

expect 0 "$LARIAT" doctor --no-speed --json
has_keys version commit compiler flags features cpu cores usable_cores isa load memory free_memory \
    real_time_priority clock_tick
has_keys --numbers cores usable_cores clock_tick
value_of usable_cores | awk '{ exit !($1 >= 1) }' || fail "$(value_of usable_cores) cores"
[ "$(value_of version)" = "\"$("$LARIAT" --version | cut -d ' ' -f 2)\"" ] || fail "another version"
mv out told

# there NAME: what doctor says of a feature.
there() {
    awk -v name="\"$1\"," '$2 == name { mine = 1 } mine && /"there"/ { sub(",", "", $2); print $2; exit }' told
}
# agree NAME COMMAND...: the command succeeds where the feature is there, and only there.
agree() {
    name=$1
    shift
    "$@" >tried 2>&1 && worked=true || worked=false
    [ "$(there "$name")" = $worked ] || {
        fail "doctor says '$(there "$name")' of $name, and trying says $worked:"
        sed 's/^/    /' tried >&2
    }
}
expect 0 "$LARIAT" demo-model organ
agree viewer "$LARIAT" view organ/uterus_live.yaml --port 0 --seconds 0.1
agree ucx "$LARIAT" run "$SOURCE/examples/beam.yaml" --steps 1 --grid 2x1x1 --comm ucx
agree metis "$LARIAT" partition organ/uterus.yaml --grid 2x1x1 --method metis
if [ "$(there petsc)" = true ]; then
    agree petsc "$LARIAT" bench implicit --case loose --solver cg
fi
# The page is there when it was built into the checkout, and there is who serves it.
built=false
[ "$(there viewer)" = false ] || [ ! -e "$SOURCE/web/dist/index.html" ] || built=true
[ "$(there page)" = $built ] || fail "doctor says '$(there page)' of the page"
# A command that has left its build folder serves no page out of the checkout.
elsewhere=$(mktemp -d)
cp "$LARIAT" "$elsewhere/lariat"
expect 0 "$elsewhere/lariat" doctor --no-speed --json
rm -r "$elsewhere"
mv told told_here && mv out told
[ "$(there page)" = false ] || fail "a page out of a folder that the command has left"
mv told_here told
# An instruction set that is not there is named; neon and avx512 are of no common machine.
for isa in neon avx512; do
    LARIAT_ISA=$isa "$LARIAT" run "$SOURCE/examples/beam.yaml" --steps 1 >tried 2>&1 && continue
    export LARIAT_ISA=$isa
    expect 1 "$LARIAT" doctor
    says 'instruction set *none: the variable LARIAT_ISA asks for one that this machine lacks'
    complains "$isa"
    unset LARIAT_ISA
done
# What cannot be read says so in other words than what there is no reader for.
echo none >bad.nii
"$LARIAT" mesh bad.nii --list >tried 2>&1
case $(there nifti) in
true) ! grep -q libnifti-dev tried || fail "doctor says there is NIfTI: $(cat tried)" ;;
false) grep -q libnifti-dev tried || fail "doctor says there is no NIfTI: $(cat tried)" ;;
*) fail "doctor says nothing of nifti" ;;
esac

# For people: each line, and what to do where there is a no.
expect 0 "$LARIAT" doctor
for line in 'instruction set' 'cores' 'memory' 'priority' 'timer' 'in real time .*elements' 'in memory .*million'; do
    says "$line"
done
[ "$(grep -c '^  no ' out)" -eq "$(grep -c '^ *to get it: apt-get install' out)" ] ||
    fail "something is missing and there is no word how to get it"
[ "$(grep -c '^  yes \|^  no ' out)" -eq "$(grep -c '"there"' told)" ] || fail "other features"

# Measured: what it says an organ of the demonstration's size may have.
expect 0 "$LARIAT" doctor --json
has_keys --numbers wakes_late_us.p50 wakes_late_us.p99 wakes_late_us.p999 wakes_late_us.max missed \
    wall_per_step_us time_step elements bytes_per_element real_time_elements
value_of real_time_elements | awk '{ exit !($1 >= 10 && $1 < 1e7) }' ||
    fail "$(value_of real_time_elements) elements in real time"
value_of elements | grep -qx 1840 || fail "not the demonstration organ"
# Where the organ's own step takes 80 % of its time, it holds the organ's own number.
step=$(value_of wall_per_step_us) time_step=$(value_of time_step)
value_of real_time_elements |
    awk -v s="$step" -v h="$time_step" '{ w = 1840 * (0.8 * h / (1e-6 * s))^0.75
        exit !($1 > 0.99 * w - 1 && $1 < 1.01 * w + 1) }' || fail "it does not follow from the step"

# Every key and option is in docs/cli.md.
grep -o '"[a-z0-9_]*":' out told | sed 's/.*"\(.*\)":/\1/' | sort -u | while read -r key; do
    grep -q "\`$key\`" "$SOURCE/docs/cli.md" || echo "$key"
done >undocumented
"$LARIAT" doctor --help | grep -o '^  --[a-z-]*' | while read -r option; do
    grep -q -e "\`$option" "$SOURCE/docs/cli.md" || echo "$option"
done >>undocumented
[ ! -s undocumented ] || fail "docs/cli.md lacks $(tr '\n' ' ' <undocumented)"

expect 2 "$LARIAT" doctor organ
expect 2 "$LARIAT" doctor --jsno
finish "doctor: what it says of the build is so"
