#!/bin/sh
# Debian packages on a bare system: made, looked through by lintian, installed with apt into a system
# that debootstrap has just made, used, and taken away again, which leaves nothing.
#
#   deb_bare.sh SOURCE SCRATCH
#
# It needs the rights of root, debootstrap and a mirror ($MIRROR, else http://deb.debian.org/debian).
set -eu
source=$1 scratch=$2
mirror=${MIRROR:-http://deb.debian.org/debian}
fail() {
    echo "deb_bare: $*" >&2
    exit 1
}
skip() {
    echo "skipped: $*"
    exit 77
}
[ "$(id -u)" = 0 ] || skip "only root may make a system"
for tool in dh dh_python3 debootstrap chroot; do
    command -v $tool >/dev/null || skip "$tool is missing (tools/setup.sh deb; apt-get install debootstrap)"
done
suite=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)
[ -e "/usr/share/debootstrap/scripts/$suite" ] || skip "debootstrap does not know '$suite'"
[ -e "$source/web/dist/index.html" ] || skip "the viewer's page is not built"

rm -rf "$scratch"
mkdir -p "$scratch"
"$source/tools/deb.sh" >"$scratch/packages" 2>"$scratch/said" || { cat "$scratch/said" >&2; fail "no packages"; }
[ "$(wc -l <"$scratch/packages")" = 6 ] || fail "these are not six packages: $(cat "$scratch/packages")"
! grep '^E:' "$scratch/said" || fail "lintian found errors"

system=$scratch/system
debootstrap --variant=minbase "$suite" "$system" "$mirror" >"$scratch/debootstrap" 2>&1 ||
    skip "debootstrap could not make a system of $suite from $mirror"
mkdir "$system/packages"
xargs -a "$scratch/packages" cp -t "$system/packages"
cp /etc/resolv.conf "$system/etc/resolv.conf"
mount -t proc proc "$system/proc" || skip "/proc cannot be mounted here"
trap 'umount "$system/proc" && rm -rf "$system"' EXIT

cat >"$system/packages/use.sh" <<'END'
set -eu
export DEBIAN_FRONTEND=noninteractive
cd /root
apt-get -q update >/dev/null
apt-get -q install -y /packages/*.deb >/packages/apt 2>&1 || { tail -n 20 /packages/apt; exit 1; }
lariat demo-model demo
lariat run demo/uterus.yaml --time 0.02 --out results | grep '^state hash' | sed 's/.* //' >/packages/hash
lariat view demo/uterus_live.yaml --seconds 600 --port 0 >/packages/view 2>&1 &
view=$!
trap 'kill $view 2>/dev/null || true' EXIT
until grep -q '^http' /packages/view; do sleep 0.2; done
python3 - <<'PYTHON'
import urllib.request
import lariat
def page(url):
    with urllib.request.urlopen(url) as answer:
        return answer.read()
shown = page(next(line for line in open("/packages/view") if line.startswith("http")).strip())
assert b"<script" in shown, shown
sim = lariat.Simulation(lariat.Model("demo/uterus.yaml"))
sim.advance(seconds=0.02)
assert open("/packages/hash").read().strip() == f"{sim.hash():016x}", sim.hash()
with lariat.Simulation(lariat.Model("demo/uterus_live.yaml")) as live, lariat.Session(live) as session:
    with session.view(open=False) as mine:
        assert page(mine.url) == shown
PYTHON
kill $view
wait $view || true
trap - EXIT
rm -r demo results
apt-get -q purge -y lariat lariat-viewer liblariat0 liblariat-fit0 liblariat-dev python3-lariat >/packages/apt 2>&1 ||
    { tail -n 20 /packages/apt; exit 1; }
left=$(find / -xdev -path /packages -prune -o -iname '*lariat*' -print)
[ -z "$left" ] || { echo "left behind: $left"; exit 1; }
END
chroot "$system" sh /packages/use.sh || fail "see above"
echo "deb_bare: installed, used and removed in a bare $suite"
