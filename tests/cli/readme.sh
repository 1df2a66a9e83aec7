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

# Commands.
cp -r "$SOURCE/examples" examples # a copy: its meshes are named relative to it
awk '/^```sh/ { inside = 1; next } /^```/ { inside = 0 } inside' "$page" |
    sed -n 's/ *#.*//; s/^build\/lariat //p' >commands
[ "$(wc -l <commands)" -ge 3 ] || fail "the commands of README.md were not found"
port=$((20000 + $$ % 20000)) # for the device's: another test may be at the one of the page
sed -i "s/:9000/:$port/; s/--open/--port 0 --seconds 8/; s/--seconds 60/--seconds 1/" commands
viewer=
while read -r line; do
    case $line in
    view*) # goes on until it is ended: the next command talks to it
        # shellcheck disable=SC2086
        "$LARIAT" $line >viewed 2>&1 </dev/null &
        viewer=$!
        for _ in 1 2 3 4 5 6 7 8 9 10; do grep -q 'http\|libwebsockets' viewed || sleep 0.3; done
        continue
        ;;
    device*) grep -q libwebsockets viewed && continue ;;
    esac
    # shellcheck disable=SC2086
    expect 0 "$LARIAT" $line </dev/null
done <commands
wait "$viewer" || grep -q libwebsockets viewed || {
    fail "lariat view of README.md failed:"
    sed 's/^/    /' viewed >&2
}

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
