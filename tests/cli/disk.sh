#!/bin/sh
# Folders and disks that cannot be written: a message, no success, nothing half-written. Run as
# root too, so it does not rely on permissions.
. "$(dirname "$0")/lib.sh"
scene=$SOURCE/examples/beam.yaml

: >"$SCRATCH/file"
for folder in "$SCRATCH/file" "$SCRATCH/file/below" /proc/none /dev/null; do
    expect 1 "$LARIAT" run "$scene" --steps 1 --out "$folder"
    complains "^lariat run: $folder: .*\(choose\|check\)"
    silent
    expect 1 "$LARIAT" demo-model "$folder"
    complains "^lariat demo-model: "
    silent
done

# Two runs at once in one folder: the second one is told, and the first one's results are whole.
"$LARIAT" run "$scene" --steps 1000000000 --out "$SCRATCH/shared" >/dev/null 2>&1 &
first=$!
tries=0
while [ ! -s "$SCRATCH/shared/probes.csv" ] && [ $tries -lt 100 ]; do
    sleep 0.1
    tries=$((tries + 1))
done
echo frame >"$SCRATCH/shared/beam_000000.vtu"
expect 1 "$LARIAT" run "$scene" --steps 1 --out "$SCRATCH/shared"
complains '^lariat run: .*shared: another run is writing its results there.*another folder'
silent
[ -e "$SCRATCH/shared/beam_000000.vtu" ] || fail "the second run has removed the first one's frames"
kill -KILL $first
wait $first 2>/dev/null
expect 0 "$LARIAT" run "$scene" --steps 1 --out "$SCRATCH/shared"

# A disk that is full for one file at a time.
if [ -c /dev/full ]; then
    full_for() {
        rm -rf "$SCRATCH/full"
        mkdir "$SCRATCH/full"
        ln -s /dev/full "$SCRATCH/full/$1"
        expect 1 "$LARIAT" run "$scene" --steps 10 --json --out "$SCRATCH/full"
        complains "$2"
        complains 'No space left'
    }
    full_for probes.csv 'probes\.csv: cannot be written'
    full_for beam_000000.vtu.part 'beam_000000\.vtu: cannot be written'
    [ ! -e "$SCRATCH/full/beam_000000.vtu" ] || fail "a half frame"
    [ ! -e "$SCRATCH/full/beam.pvd" ] || fail "a series without its frame"
    full_for beam.pvd.part 'beam\.pvd: cannot be written'
    [ ! -e "$SCRATCH/full/beam.pvd" ] || fail "a half series"
    full_for run.json.part 'run\.json: cannot be written'
    [ ! -e "$SCRATCH/full/run.json" ] || fail "a half run.json"

    # Standard output is a file like any other.
    for command in --help --version "info $scene" "run $scene --steps 1 --json"; do
        # shellcheck disable=SC2086
        "$LARIAT" $command >/dev/full 2>"$SCRATCH/err"
        [ $? -eq 1 ] || fail "success although standard output is full: $command"
        complains 'standard output cannot be written'
    done
fi

# A file system smaller than one frame (50 kB), which the run fills up; only root can make one.
mkdir "$SCRATCH/small"
if mount -t tmpfs -o size=32k none "$SCRATCH/small" 2>/dev/null; then
    trap 'umount "$SCRATCH/small" 2>/dev/null' EXIT
    expect 0 "$LARIAT" demo-model "$SCRATCH/demo"
    expect 1 "$LARIAT" run "$SCRATCH/demo/uterus.yaml" --steps 10 --out "$SCRATCH/small"
    complains 'No space left'
    left=$(find "$SCRATCH/small" -name '*.part' -o -name '*.vtu')
    umount "$SCRATCH/small"
    [ -z "$left" ] || fail "left on the full disk: $left"
else
    echo "skipped: no small file system can be mounted here"
fi

# A frame never overwrites the mesh that is simulated.
expect 0 "$LARIAT" run "$scene" --steps 1 --out "$SCRATCH/again"
printf '%s\n' 'lariat: 1' 'mesh: beam_000000.vtu' 'materials:' '  - { cells: all,' \
    '    law: neo-hookean, density: 1e3, shear_modulus: 4e3, bulk_modulus: 4e5 }' \
    >"$SCRATCH/again/beam.yaml"
expect 1 "$LARIAT" run "$SCRATCH/again/beam.yaml" --steps 1 --out "$SCRATCH/again"
complains 'will not be overwritten'
expect 0 "$LARIAT" run "$SCRATCH/again/beam.yaml" --steps 1 --out "$SCRATCH/elsewhere"

# What an earlier run left does not look like that of a later one which ends early; what other
# scenes left stays, and so does the state that a run goes on from.
later=$SCRATCH/later organ=$SCRATCH/organ
expect 0 "$LARIAT" demo-model "$organ"
expect 0 "$LARIAT" run "$scene" --steps 1 --out "$later"
expect 0 "$LARIAT" run "$organ/uterus.yaml" --time 0.2 --out "$later"
frames() {
    find "$later" -name "$1_*.vtu" | wc -l
}
many=$(frames uterus)
expect 0 "$LARIAT" run "$organ/uterus.yaml" --resume "$later/uterus.checkpoint" --steps 1 \
    --out "$later"
[ "$(frames uterus)" -eq "$((many + 1))" ] || fail "a run that goes on has $(frames uterus) frames"
expect 0 "$LARIAT" run "$organ/uterus.yaml" --steps 1 --out "$later"
[ "$(frames uterus)" -lt "$many" ] || fail "frames of a longer run"
[ "$(frames beam)" -gt 0 ] || fail "another scene's frames are gone"
sed 's/force: \[[^]]*\]/force: [40, 100, 120]/' "$organ/uterus.yaml" >"$organ/broken"
mv "$organ/broken" "$organ/uterus.yaml"
expect 3 "$LARIAT" run "$organ/uterus.yaml" --time 0.2 --out "$later"
[ ! -e "$later/run.json" ] || fail "run.json of an earlier run"
[ ! -e "$later/uterus.checkpoint" ] || fail "the state of an earlier run"

# What a process has left that was killed while it saved goes with the next save; what is new, of
# somebody who lives, or no part, stays.
for part in 999999999-1.part $$-1.part 999999999-2.other; do
    : >"$SCRATCH/state.$part"
    touch -d '1 hour ago' "$SCRATCH/state.$part"
done
: >"$SCRATCH/state.999999999-3.part"
expect 0 "$LARIAT" run "$scene" --steps 1 --save "$SCRATCH/state"
[ ! -e "$SCRATCH/state.999999999-1.part" ] || fail "a part of a killed process is left"
[ "$(find "$SCRATCH" -maxdepth 1 -name 'state.*' | wc -l)" -eq 3 ] || fail "another's file is gone"

# --save is looked at before the first step: these runs would take minutes. What is there stays.
echo 'a,b' >"$SCRATCH/notes.csv"
for path in "$SCRATCH/notes.csv" "$SCRATCH/notes.csv/below" "$SCRATCH/none/x" "$SCRATCH" /dev/null \
    /proc/none; do
    expect 1 timeout 20 "$LARIAT" run "$scene" --time 1e6 --grid 1x1x1 --save "$path"
    complains "^lariat run: $path: .*\(choose\|check\)"
    silent
done
[ "$(cat "$SCRATCH/notes.csv")" = a,b ] || fail "what is no checkpoint was touched"
expect 0 "$LARIAT" run "$scene" --steps 1 --out "$SCRATCH/fresh" --save "$SCRATCH/fresh/x"
[ -s "$SCRATCH/fresh/x" ] || fail "--save into the folder of --out"
[ -z "$(find "$SCRATCH" -name 'x.??????' -o -name 'state.??????')" ] || fail "a trial is left"

# When it fails at the end all the same, what was computed is told; files may not grow here.
cp "$SCRATCH/state" "$SCRATCH/kept"
for json in '' --json; do
    # shellcheck disable=SC2086
    expect 1 sh -c 'ulimit -f 16; exec "$@"' sh "$LARIAT" run "$organ/uterus.yaml" --steps 10 $json \
        --grid 1x1x1 --save "$SCRATCH/state"
    complains '^lariat run: .*/state: cannot be written: '
    complains '^lariat run: .*/state stays as it was before this run'
    [ -n "$json" ] || says '^state hash '
    [ -z "$json" ] || silent
done
complains '^state hash '
cmp -s "$SCRATCH/kept" "$SCRATCH/state" || fail "the earlier state is gone"

finish "full disks and wrong folders are reported"
