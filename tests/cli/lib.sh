# What the tests of the command share. Sourced with: LARIAT (the command), JSON (json_check),
# SCRATCH (an empty folder, made new), SOURCE (the checkout).
set -u
LARIAT=$1 JSON=$2 SCRATCH=$3 SOURCE=$4
rm -rf "$SCRATCH"
mkdir -p "$SCRATCH" || exit 1
unset LARIAT_ISA
failures=0

# Whether what takes minutes is left to `make check-long`, which sets LARIAT_TEST_FULL; with a
# sanitizer (LARIAT_TEST_SANITIZED) also what takes half a minute there.
in_short() {
    [ -z "${LARIAT_TEST_FULL:-}" ]
}
in_short_if_sanitized() {
    [ -n "${LARIAT_TEST_SANITIZED:-}" ] && in_short
}

fail() {
    echo "FAILED: $*" >&2
    failures=$((failures + 1))
}

# expect STATUS COMMAND...: runs it, keeps $SCRATCH/out and $SCRATCH/err, compares the exit status.
# No output may hold a NaN or an infinity, but for messages that repeat a wrong argument.
expect() {
    wanted=$1
    shift
    "$@" >"$SCRATCH/out" 2>"$SCRATCH/err"
    got=$?
    if [ "$got" -ne "$wanted" ]; then
        fail "exit status $got instead of $wanted: $*"
        sed 's/^/    /' "$SCRATCH/err" >&2
    fi
    if [ "$wanted" -ne 2 ] && grep -Eiwq -e '-?nan|-?inf' "$SCRATCH/out" "$SCRATCH/err"; then
        fail "a number that is none: $*"
    fi
}

# The last command's standard output or error contains (a basic regular expression).
says() {
    grep -q -e "$1" "$SCRATCH/out" || fail "standard output lacks '$1'"
}
complains() {
    grep -q -e "$1" "$SCRATCH/err" || {
        fail "standard error lacks '$1':"
        sed 's/^/    /' "$SCRATCH/err" >&2
    }
}
silent() {
    [ ! -s "$SCRATCH/out" ] || fail "standard output is not empty"
}

# The last command's JSON has these keys; every one a number after --numbers.
has_keys() {
    "$JSON" "$@" <"$SCRATCH/out" || fail "JSON: $*"
}
value_of() {
    "$JSON" --print "$1" <"$SCRATCH/out"
}

finish() {
    [ "$failures" -eq 0 ] || {
        echo "$failures failed" >&2
        exit 1
    }
    rm -rf "$SCRATCH"
    echo "$1"
}

# A mesh of one element, written to the file.
one_element() {
    cat >"$1" <<'END'
# vtk DataFile Version 3.0
one element, 10 x 10 x 20 mm
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 8 double
0 0 0  0.01 0 0  0.01 0.01 0  0 0.01 0
0 0 0.02  0.01 0 0.02  0.01 0.01 0.02  0 0.01 0.02
CELLS 1 9
8 0 1 2 3 4 5 6 7
CELL_TYPES 1
12
END
}

# A mesh of one cube of 10 mm, written to the file: elements E, nodes x at x = 0.
one_cube() {
    cat >"$1" <<'END'
*NODE
1, 0, 0, 0
2, 0.01, 0, 0
3, 0.01, 0.01, 0
4, 0, 0.01, 0
5, 0, 0, 0.01
6, 0.01, 0, 0.01
7, 0.01, 0.01, 0.01
8, 0, 0.01, 0.01
*ELEMENT, TYPE=C3D8, ELSET=E
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=x
1, 4, 5, 8
END
}
