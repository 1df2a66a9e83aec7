#!/bin/sh
# What a container or a batch queue may lack: /dev, /proc, /sys, room in /dev/shm, a place that can
# be written. The message names it and what helps. Skipped where no user may mount.
. "$(dirname "$0")/lib.sh"
lacking() { # COMMAND...: with places of its own; $1 is the words of a shell that take them away
    places=$1
    shift
    unshare -r -m sh -c "$places"'; exec "$@"' sh "$@"
}
lacking true true 2>/dev/null && lacking 'mount -t tmpfs none /dev' true 2>/dev/null || {
    echo "container: skipped, for nothing may be mounted here"
    exit 77
}
beam=$SOURCE/examples/beam.yaml
has_ucx=$("$LARIAT" doctor --no-speed | grep -q 'yes *--comm ucx' && echo ucx)
for comm in shm tcp $has_ucx; do
    expect 1 lacking 'mount -t tmpfs none /dev' \
        "$LARIAT" run "$beam" --steps 1 --grid 2x1x1 --comm "$comm"
    complains 'no process for processor 1: there is no /dev/null; mount .*--comm threads'
done
if lacking 'mount -t tmpfs none /proc' true 2>/dev/null; then
    expect 1 lacking 'mount -t tmpfs none /proc' \
        "$LARIAT" run "$beam" --steps 1 --grid 2x1x1 --comm tcp
    complains 'there is no /proc/self/exe; mount'
fi
if "$LARIAT" view "$beam" --port 0 --seconds 0.1 >/dev/null 2>&1; then
    expect 1 lacking 'mount -t tmpfs none /dev' "$LARIAT" view "$beam" --port 0 --seconds 0.1
    complains 'needs /dev/urandom; mount /dev'
fi
mkdir "$SCRATCH/place"
read_only="mount -t tmpfs -o ro none $SCRATCH/place"
expect 1 lacking "$read_only" "$LARIAT" run "$beam" --steps 1 --out "$SCRATCH/place/r"
complains 'Read-only file system; mount it for writing'
expect 1 lacking "$read_only" "$LARIAT" run "$beam" --steps 1 --save "$SCRATCH/place/r.checkpoint"
complains 'Read-only file system; mount it for writing'
small='mount -t tmpfs -o size=16k none /dev/shm'
if lacking "$small" true 2>/dev/null; then
    expect 1 lacking "$small" "$LARIAT" verify "$beam" --grid 2x1x1 --comm shm
    complains 'could not be had: No space left on device; make room in /dev/shm'
    [ -z "$has_ucx" ] || {
        expect 1 lacking "$small" "$LARIAT" run "$beam" --steps 1 --grid 2x1x1 --comm ucx
        complains '/dev/shm has less than 8 MiB: make room there'
    }
fi
if lacking 'mount -t tmpfs none /sys' true 2>/dev/null; then
    expect 0 lacking 'mount -t tmpfs none /sys' "$LARIAT" run "$beam" --steps 1 --grid 2x1x1
    grep -q hwloc "$SCRATCH/err" && fail "hwloc speaks on standard error"
fi
finish "what a container lacks is named"
