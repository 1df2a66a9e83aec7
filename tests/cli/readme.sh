#!/bin/sh
# README.md and docs/ tell the truth: quoted files are the files, commands run, the output shown is
# the output but for times, and every link leads somewhere.
. "$(dirname "$0")/lib.sh"
page=$SOURCE/README.md
mkdir "$SCRATCH/tree" && cd "$SCRATCH/tree" || exit 1

# quoted MARK: the block below the line `<!-- MARK -->`.
quoted() {
    awk -v mark="<!-- $1 -->" '
        $0 == mark { wanted = 1; next }
        wanted && /^```/ { if (inside) exit; inside = 1; next }
        inside' "$page"
}

# Files.
sed -n 's/^<!-- file: \(.*\) -->$/\1/p' "$page" >files
[ "$(wc -l <files)" -ge 2 ] || fail "README.md quotes fewer files than expected"
while read -r file; do
    quoted "file: $file" | cmp -s - "$SOURCE/$file" || fail "README.md does not quote $file as it is"
done <files

# What the demonstration prints; the instruction set and times are this machine's own.
stable() {
    sed -n 's/ (hex8, [a-z0-9]*)$//; /^Uterus\|^simulated\|^energy\|^state hash\|^results/p'
}
expect 0 "$LARIAT" demo-model out/demo
expect 0 "$LARIAT" run out/demo/uterus.yaml --out out/demo/results
stable <"$SCRATCH/out" >printed
quoted "run: demo" | stable >shown
[ "$(wc -l <shown)" -eq 5 ] || fail "the output of the demonstration was not found in README.md"
cmp -s printed shown || {
    fail "README.md shows another output of the demonstration; when physics or rows were changed" \
        "on purpose, put this into it (pictures: tools/render/pictures.sh):"
    sed 's/^/    /' printed >&2
}

# A scan of one's own: a liver like an egg, 1-byte labels in a NIfTI file of 40 x 30 x 26 voxels of
# 4 mm.
make_scan() {
    printf '\134\001\000\000'                            # length of the header
    head -c 36 /dev/zero
    printf '\003\000\050\000\036\000\032\000\001\000\001\000\001\000\001\000' # sizes
    head -c 14 /dev/zero
    printf '\002\000\010\000\000\000'                    # bytes, 8 bits
    for _ in 1 2 3 4; do printf '\000\000\200\100'; done # edges of voxels
    head -c 16 /dev/zero
    printf '\000\000\260\103'                            # where the voxels begin
    head -c 11 /dev/zero
    printf '\002'                                        # millimetres
    head -c 130 /dev/zero
    printf '\001\000'                                    # the rows that follow are the place
    head -c 24 /dev/zero
    printf '\000\000\200\100'
    head -c 16 /dev/zero
    printf '\000\000\200\100'
    head -c 16 /dev/zero
    printf '\000\000\200\100'
    head -c 20 /dev/zero
    printf 'n+1\000\000\000\000\000'
    awk 'BEGIN { for (k = 0; k < 26; k++) for (j = 0; j < 30; j++) for (i = 0; i < 40; i++)
        printf "%d", ((i - 20) / 16)^2 + ((j - 15) / 11)^2 + ((k - 13) / 9)^2 < 1 }' |
        tr '01' '\000\001'
}
make_scan | gzip >scan.nii.gz
[ "$(gzip -dc scan.nii.gz | wc -c)" -eq $((352 + 40 * 30 * 26)) ] || fail "the scan has another size"
echo '1,liver' >labels.csv

# Commands. What this build does not have is left out, as lariat doctor says it.
"$LARIAT" doctor --no-speed --json >doctor
there() {
    awk -v name="\"$1\"," '$2 == name { mine = 1 } mine && /"there"/ { exit !/true/ }' doctor
}
cp -r "$SOURCE/examples" examples # a copy: its meshes are named relative to it
awk '/^```sh/ { inside = 1; next } /^```/ { inside = 0 } inside' "$page" |
    sed -n 's/ *#.*//; s/^build\/lariat //p' >commands
[ "$(wc -l <commands)" -ge 3 ] || fail "the commands of README.md were not found"
port=$((20000 + $$ % 20000)) # for the device's: another test may be at the one of the page
sed -i "s/:9000/:$port/; /--device/s/--open/--port 0 --seconds 8/; s/--open/--port 0 --seconds 1/
    s/--push 0.02/& --seconds 4.5/" commands
grep -q '^mesh scan.nii.gz .*--label' commands || fail "README.md meshes no scan"
grep -q '^view liver/liver.yaml' commands || fail "README.md does not look at the liver"
viewer=
while read -r line; do
    case $line in
    view*--device*) # goes on until it is ended: the next command talks to it
        there viewer || continue
        # shellcheck disable=SC2086
        "$LARIAT" $line >viewed 2>&1 </dev/null &
        viewer=$!
        for _ in $(seq 200); do grep -q 'http' viewed && break; sleep 0.3; done
        continue
        ;;
    view* | device*) there viewer || continue ;;
    esac
    case $line in *scan.nii.gz* | *liver*) there nifti || continue ;; esac
    # shellcheck disable=SC2086
    expect 0 "$LARIAT" $line </dev/null
    case $line in device*) cp "$SCRATCH/out" felt ;; esac
done <commands
[ -z "$viewer" ] || wait "$viewer" || {
    fail "lariat view of README.md failed:"
    sed 's/^/    /' viewed >&2
}

# What the device feels beside its command: the same rows, and it touches the organ as often and
# as hard as it is shown, as far as a busy machine lets it.
shape() {
    sed 's/[0-9][0-9.]*/N/g; s/  */ /g'
}
# figure FILE SEDEXPRESSION
figure() {
    sed -n "s/$2/\1/p" "$1"
}
quoted "run: device" >shown
[ "$(wc -l <shown)" -eq 4 ] || fail "the report of the device was not found in README.md"
if there viewer; then
    shape <shown >shown.shape
    shape <felt | cmp -s - shown.shape || {
        fail "README.md shows another report of the device:"
        sed 's/^/    /' felt >&2
    }
    touched='.*touched in \([0-9]*\) %.*'
    echo "$(figure shown "$touched") $(figure felt "$touched")" |
        awk '{ exit !($1 >= 15 && $2 >= 15 && $1 - $2 < 25 && $2 - $1 < 25) }' || {
        fail "the device of README.md does not touch the organ as it is shown"
        sed 's/^/    /' felt >&2
    }
    # Where the engine is slower than real time the hand is faster than it is shown: at a tenth of
    # the pace ten times, and what it feels is a blow. Then the force must only be one.
    force='^force *largest \([0-9.]*\) N.*'
    sent='.* packets in \([0-9.]*\) s.*'
    steps='^engine *\([0-9]*\) steps.*'
    echo "$(figure shown "$force") $(figure felt "$force")" \
        "$(figure felt "$steps") $(figure felt "$sent")" |
        awk '{ behind = $3 < 5000 * $4
               exit !($1 > 0.05 && $2 > 0.05 && (behind || ($1 < 20 * $2 && $2 < 20 * $1))) }' || {
        fail "the device of README.md does not feel the organ as it is shown"
        sed 's/^/    /' felt >&2
    }
fi

# Links: the file is there, and so is the heading.
anchors() {
    grep '^#' "$1" | sed 's/^#* //' | tr 'A-Z' 'a-z' | sed 's/[^a-z0-9 _-]//g; s/ /-/g'
}
for from in "$page" "$SOURCE"/docs/*.md "$SOURCE"/tools/render/README.md "$SOURCE"/CONTRIBUTING.md; do
    grep -o ']([^)]*)' "$from" | sed 's/^](//; s/)$//' | grep -v '^http' | while read -r link; do
        file=${link%%#*}
        anchor=${link#"$file"}
        target=$(dirname "$from")/$file
        [ -n "$file" ] || target=$from
        [ -e "$target" ] || echo "$(basename "$from"): $link"
        [ -z "$anchor" ] || anchors "$target" | grep -qx -e "${anchor#\#}" ||
            echo "$(basename "$from"): $link"
    done
done >broken
[ ! -s broken ] || {
    fail "links that lead nowhere:"
    sed 's/^/    /' broken >&2
}
finish "README.md: quotes, output, commands and links hold"
