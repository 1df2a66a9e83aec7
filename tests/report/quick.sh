#!/bin/sh
# `make report` in short: every run is made, every page written. Its figures mean nothing; that
# they are there, and where they are from, is what is looked at.
#
#   quick.sh LARIAT SCRATCH SOURCE
set -u
lariat=$1 scratch=$2 source=$3
for tool in gnuplot python3; do
    command -v $tool >/dev/null || {
        echo "skipped: no $tool"
        exit 77
    }
done
rm -rf "$scratch"
mkdir -p "$scratch"
# Python leaves nothing beside the sources.
export PYTHONDONTWRITEBYTECODE=1
"$source/tools/report/run.sh" --quick --lariat "$lariat" --work "$scratch/work" \
    --pages "$scratch/pages" 2>"$scratch/err" || {
    tail -n 5 "$scratch/err"
    echo "FAILED: run.sh"
    exit 1
}
python3 -B "$source/tests/report/pages.py" "$scratch/pages" || exit 1

# A run that fails is named, and no page is written from half of them.
printf '#!/bin/sh\ncase "$*" in *--thesis*) echo no clock >&2; exit 1 ;; esac\nexec %s "$@"\n' \
    "$lariat" >"$scratch/broken"
chmod +x "$scratch/broken"
if "$source/tools/report/run.sh" --quick --lariat "$scratch/broken" --work "$scratch/work" \
    --pages "$scratch/none" 2>"$scratch/err"; then
    echo "FAILED: a run that failed was not noticed"
    exit 1
fi
grep -q 'no clock' "$scratch/err" && grep -q 'the run requirements failed' "$scratch/err" || {
    echo "FAILED: the message does not name the run"
    exit 1
}
[ ! -e "$scratch/none/README.md" ] || {
    echo "FAILED: pages from half of the runs"
    exit 1
}
"$source/tools/report/run.sh" --fast 2>"$scratch/err"
[ $? -eq 2 ] && grep -q "unknown option '--fast'" "$scratch/err" || {
    echo "FAILED: an unknown option"
    exit 1
}
rm -rf "$scratch"
echo "report: every page, table and picture is there"
