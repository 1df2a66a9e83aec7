#!/bin/sh
# `make demo` builds what the demo needs and no tests, says how far it is and how long it will take,
# and shows something also where this build has no viewer.
#
#   demo.sh SOURCE BUILD SCRATCH
set -eu
source=$1 build=$2 scratch=$3
rm -rf "$scratch"
mkdir -p "$scratch/bin" "$scratch/tools" "$scratch/build"
failures=0
fail() {
    echo "demo: $*" >&2
    failures=$((failures + 1))
}

# ---- what is built ----
grep -q '^	@tools/build.sh demo ' "$source/Makefile" || fail "make demo does not build the preset demo"
targets=$(tr -d '\n' <"$source/CMakePresets.json" |
    sed -n 's/.*"name": "demo",[^}]*"targets": \[\([^]]*\)\].*/\1/p' | tr -d '",')
case $targets in *lariat*) ;; *) fail "the preset demo does not build lariat" ;; esac
if command -v ninja >/dev/null && [ -e "$build/build.ninja" ]; then
    for target in $targets; do
        [ "$target" != viewer ] || ninja -C "$build" -t query viewer >/dev/null 2>&1 || continue
        ninja -C "$build" -t commands "$target"
    done >"$scratch/commands"
    grep -q 'cli/main.c' "$scratch/commands" || fail "lariat is not built"
    ! grep -q ' [^ ]*/tests/[^ ]*\.c' "$scratch/commands" || fail "tests are built for the demo"
    steps=$(grep -c . "$scratch/commands")
    # Each source of the command is a step; with the tests there would be a thousand.
    [ "$steps" -lt 500 ] || fail "the demo takes $steps steps"
fi

# ---- progress ----
cp "$source/tools/build.sh" "$source/tools/demo.sh" "$scratch/tools/"
cat >"$scratch/bin/cmake" <<'END'
#!/bin/sh
# As ninja prints it: %f of %t steps done.
line() {
    printf '%s %s\n' "$(printf '%s' "$NINJA_STATUS" | sed "s/%f/$1/; s/%t/$2/")" "$3"
}
n=1
while [ $n -le "${STEPS:-100}" ]; do
    line $n "${STEPS:-100}" "Building C object $n.c.o"
    [ $n -ne 30 ] || sleep 3
    n=$((n + 1))
done
[ -z "${BROKEN:-}" ] || { echo 'FAILED: thing.c.o'; echo 'thing.c:1: error: no such thing'; exit 1; }
END
chmod +x "$scratch/bin/cmake"
PATH="$scratch/bin:$PATH" "$scratch/tools/build.sh" demo 2 2>"$scratch/said" >"$scratch/out" ||
    fail "tools/build.sh failed"
grep -q '^build: step 1 of 100, .*left$\|^build: step 1 of 100, nearly done$' "$scratch/said" ||
    fail "no estimate at the beginning: $(cat "$scratch/said")"
grep -q '^build: step 40 of 100, .*\(left\|done\)$' "$scratch/said" || fail "no progress in between"
grep -q '^build: 100 steps in [0-9]* s$' "$scratch/said" || fail "no last word"
[ "$(wc -l <"$scratch/said")" -le 10 ] || fail "too many lines without a terminal"
! grep -q 'Building' "$scratch/said" || fail "every step is told"
# Nothing to do: nothing is said.
PATH="$scratch/bin:$PATH" STEPS=2 "$scratch/tools/build.sh" demo 2 2>"$scratch/said"
[ ! -s "$scratch/said" ] || fail "words about two steps: $(cat "$scratch/said")"
# What the compiler says, and the failure, come through.
if PATH="$scratch/bin:$PATH" BROKEN=yes STEPS=3 "$scratch/tools/build.sh" demo 2 2>"$scratch/said"; then
    fail "a broken build is a success"
fi
grep -q '^thing.c:1: error' "$scratch/said" || fail "the compiler's words are lost"

# ---- with and without a viewer ----
cat >"$scratch/build/lariat" <<'END'
#!/bin/sh
echo "$*" >>called
[ "$1" = doctor ] || exit 0
printf '      "name": "viewer",\n      "gives": "x",\n      "there": %s,\n' "$THERE"
printf '      "name": "page",\n      "gives": "x",\n      "there": %s,\n' "$PAGE"
END
chmod +x "$scratch/build/lariat"
# show VIEWER PAGE: true or false
show() {
    rm -f "$scratch/called"
    THERE=$1 PAGE=$2 DISPLAY='' WAYLAND_DISPLAY='' "$scratch/tools/demo.sh" 5 >"$scratch/shown" ||
        fail "make demo fails where there is a viewer: $1, and its page: $2"
}
show true true
grep -q '^view out/demo/uterus_live.yaml .*--seconds 5$' "$scratch/called" || fail "no viewer"
# lacks VIEWER PAGE WORDS: the organ is pulled by a force, and it is said what is missing.
lacks() {
    show "$1" "$2"
    grep -q '^run out/demo/uterus.yaml' "$scratch/called" || fail "nothing is shown without $3"
    ! grep -q '^view' "$scratch/called" || fail "a viewer without $3 is called"
    grep -q "$3" "$scratch/shown" || fail "no word what is missing: $3"
}
lacks false false 'libwebsockets-dev'
lacks true false 'nodejs npm'

[ $failures -eq 0 ] || exit 1
rm -rf "$scratch"
echo "demo: what it needs, how far it is, and something to see"
