#!/bin/sh
# A machine that has just booted: its clock begins near zero, and who waits has not waited since the
# beginning of time. Several processors by every backend, and a session with a device. Skipped where
# a clock may not be moved (a namespace of time).
#     just_booted.sh LARIAT SCRATCH
LARIAT=$1
SCRATCH=$2
rm -rf "$SCRATCH"
mkdir -p "$SCRATCH"
cd "$SCRATCH" || exit 1

# booted COMMAND...: half a second after the machine was switched on
booted() {
    read -r up rest </proc/uptime
    unshare --time --monotonic "-${up%.*}" "$@"
}
booted true 2>/dev/null || {
    echo "just_booted: skipped, for no clock may be moved here"
    exit 77
}

"$LARIAT" demo-model demo >/dev/null || exit 1
expected=$("$LARIAT" run demo/uterus.yaml --steps 100 --grid 1x1x1 | grep 'state hash')
for comm in threads shm tcp; do
    booted "$LARIAT" run demo/uterus.yaml --steps 100 --grid 2x1x1 --comm "$comm" >out 2>err || {
        echo "just_booted: --comm $comm: $(cat err)" >&2
        exit 1
    }
    [ "$(grep 'state hash' out)" = "$expected" ] || {
        echo "just_booted: --comm $comm: another hash" >&2
        exit 1
    }
done
printf 'time,x,y,z\n0,0.045,-0.045,0.075\n1,0.03,-0.045,0.07\n' >probe.csv
booted "$LARIAT" view demo/uterus_live.yaml --port 0 --grid 2x1x1 --seconds 1 \
    --device probe=script:probe.csv >out 2>err || {
    echo "just_booted: view: $(cat err)" >&2
    exit 1
}
