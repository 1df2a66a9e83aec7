#!/bin/sh
# The sweep or the soak, where there are python3 and a server for viewers.
#
#   run.sh sweep|soak LARIAT SCRATCH SOURCE CASES|SECONDS
what=$1 lariat=$2 scratch=$3 source=$4 much=$5
command -v python3 >/dev/null || {
    echo "skipped: no python3"
    exit 77
}
if "$lariat" view 2>&1 --port 0 --seconds 0.1 "$source/examples/beam.yaml" |
    grep -q 'no server for viewers'; then
    echo "skipped: this build has no libwebsockets"
    exit 77
fi
here=$source/tests/adversary
if [ "$what" = soak ]; then
    exec python3 -B "$here/soak.py" "$lariat" "$scratch" "$source" --seconds "$much"
fi

# A command with faults of its own: each of them has to be found.
rm -rf "$scratch"
mkdir -p "$scratch"
for fault in 'echo nan' 'touch left.part' 'printf "\\033" >&2' 'echo x >$TMPDIR/left' 'exit 99' \
    'echo "runtime error: x" >&2'; do
    printf '#!/bin/sh\ncase $1 in mesh) %s ;; esac\nexec "%s" "$@"\n' "$fault" "$lariat" \
        >"$scratch/faulty"
    chmod +x "$scratch/faulty"
    if python3 -B "$here/sweep.py" "$scratch/faulty" "$scratch/planted" "$source" --cases 1 \
        --only solid >"$scratch/said" 2>&1 || ! grep -q '^FAILED: solid-0: ' "$scratch/said"; then
        cat "$scratch/said"
        echo "FAILED: not found: $fault"
        exit 1
    fi
done
exec python3 -B "$here/sweep.py" "$lariat" "$scratch/cases" "$source" --cases "$much"
