"""A session for a long time, with viewers and a device that come, go and misbehave, saves onto a
disk that fills up, loads and resets: nothing grows, nothing is left, every message is whole, and
what was recorded is the same on every grid.

    soak.py LARIAT SCRATCH SOURCE [--seconds N] [--seed N]

In less than a minute each recording is replayed on one processor and on one other grid, in turn.

First a small scene, recorded from the command line; then the same where viewers record and play;
then the demonstration organ, on processes. A recorded hash that is not found again is what `lariat
replay` ends with 1 for.
"""
import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import time

import bots
import talk

SMALL = """lariat: 1
mesh: block.inp
damping: 5
gravity: [0, 0, -9.81]
materials: [ { cells: all, law: neo-hookean, density: 1000, shear_modulus: 2e3, bulk_modulus: 5e4 } ]
fix: [ { nodes: bottom, axes: xyz } ]
contact: [ { self: true } ]
tools:
  - { name: probe, shape: sphere, radius: 0.005, at: [0.03, 0.02, 0.05] }
  - { name: grasper, shape: grasper, radius: 0.002, length: 0.01, at: [0.05, 0.02, 0.06] }
"""
GRIDS = [["--grid", "1x1x1"], ["--grid", "2x1x1", "--comm", "shm"], ["--grid", "2x2x1"],
         ["--threads", "2"]]


def write_block(path):
    """6 x 4 x 3 cubes of 1 cm."""
    lines = ["*NODE"]
    lines += [f"{1 + i + 7 * (j + 5 * k)}, {i / 100}, {j / 100}, {k / 100}"
              for k in range(4) for j in range(5) for i in range(7)]
    lines.append("*ELEMENT, TYPE=C3D8")
    number = 0
    for k in range(3):
        for j in range(4):
            for i in range(6):
                n, number = 1 + i + 7 * (j + 5 * k), number + 1
                corners = [n, n + 1, n + 8, n + 7, n + 35, n + 36, n + 43, n + 42]
                lines.append(", ".join(map(str, [number] + corners)))
    lines += ["*NSET, NSET=bottom, GENERATE", "1, 35, 1"]
    with open(path, "w", encoding="ascii") as file:
        file.write("\n".join(lines) + "\n")


# ---- what a process holds --------------------------------------------------------------------------

def family(pid):
    """A process and those that it has started."""
    found = [pid]
    for parent in found:
        try:
            for task in os.listdir(f"/proc/{parent}/task"):
                with open(f"/proc/{parent}/task/{task}/children", encoding="ascii") as children:
                    found += [int(child) for child in children.read().split()]
        except OSError:
            pass
    return found


def held(pid, folders):
    """Memory [kB], open files, threads; and half files in the folders."""
    memory = files = threads = 0
    for each in family(pid):
        try:
            with open(f"/proc/{each}/status", encoding="ascii", errors="replace") as status:
                for line in status:
                    if line.startswith("VmRSS:"):
                        memory += int(line.split()[1])
                    elif line.startswith("Threads:"):
                        threads += int(line.split()[1])
            files += len(os.listdir(f"/proc/{each}/fd"))
        except OSError:
            pass
    parts = sum(name.endswith(".part") for folder in folders for name in os.listdir(folder))
    return {"memory": memory, "files": files, "threads": threads, "parts": parts}


# ---- a device ---------------------------------------------------------------------------------------

def drive(device, chance, box, seconds):
    """A hand on a device: moves into the body and about, or does what no device should."""
    end, what = time.monotonic() + seconds, chance.randrange(6)
    place = [0.0, 0.0, 0.0]
    while time.monotonic() < end:
        if what == 0:
            break  # silence
        if what == 1:
            device.send(chance.randbytes(chance.choice([0, 3, 103, 104, 105, 1400])))
        elif what == 2:
            device.send(device.packet([chance.choice([float("nan"), 1e300, -99, 0, 5])] * 3))
        elif what == 3 and chance.random() < 0.02:
            device.renew()
            device.number = chance.choice([0, 2 ** 32 - 3, 12345])
        else:
            place = [0.98 * x + chance.gauss(0, 0.02) * box for x in place]
            device.send(device.packet(place, chance.random()))
        device.hear()
        time.sleep(0.002)
    time.sleep(max(0, end - time.monotonic()))


# ---- one session ------------------------------------------------------------------------------------

class Soak:
    def __init__(self, settings):
        self.lariat, self.scratch = settings.lariat, os.path.abspath(settings.scratch)
        self.seed = settings.seed
        self.short, self.played = settings.seconds < 60, 0
        self.failures = []
        self.mounted = []

    def fail(self, sentence):
        print(f"FAILED: {sentence}", file=sys.stderr, flush=True)
        self.failures.append(sentence)

    def small_disk(self, name, size):
        """A folder on a disk of so many megabytes; where none can be mounted, a limit instead."""
        path = os.path.join(self.scratch, name)
        os.mkdir(path)
        mount = shutil.which("mount")
        if mount and os.geteuid() == 0 and subprocess.run(
                [mount, "-t", "tmpfs", "-o", f"size={size}m", "none", path], check=False,
                capture_output=True).returncode == 0:
            self.mounted.append(path)
            return path, []
        print("note: no small disk can be mounted here; --save-most takes its place")
        return path, ["--save-most", str(size / 1000)]

    def run(self, name, scene, seconds, options, recorded, disk):
        """One `lariat view` for so many seconds. Returns its report."""
        folder, limits = self.small_disk(name + "_saved", disk)
        session = talk.Session(
            [self.lariat, "view", scene, "--port", "0", "--json", "--save-folder", folder,
             "--device", "probe=udp:127.0.0.1:0,rate=2000"] + limits + options, self.scratch,
            name=name)
        if not session.begin():
            self.fail(f"{name}: no address: {session.errors()}")
            session.end(signal.SIGKILL)
            return None
        try:
            samples = self.live(name, session, seconds, folder, recorded)
        except BaseException:
            session.end(signal.SIGKILL)
            raise
        status = session.end(signal.SIGINT)
        if status not in (0, 3):
            self.fail(f"{name}: ends with {status}: {session.errors()[-2000:]}")
        left = [file for file in os.listdir(folder) if file.endswith(".part")]
        if left:
            self.fail(f"{name}: left behind: {left}")
        self.judge(name, samples)
        try:
            return session.report()
        except (ValueError, talk.Wrong) as error:
            self.fail(f"{name}: its report: {error}")
            return None

    def live(self, name, session, seconds, folder, recorded):
        """Viewers and a device, and what is held meanwhile; first and last with nobody there."""
        chance, samples = random.Random(self.seed), []
        time.sleep(1)
        samples.append(held(session.process.pid, [folder]))
        device = talk.Device(session.device_ports()[0])
        crowd = bots.Crowd(session.port, recorded, self.seed * 1000)
        end, told = time.monotonic() + seconds, time.monotonic()
        while time.monotonic() < end and session.process.poll() is None:
            try:
                drive(device, chance, 0.02, 2)
                self.play_on(session)
            except talk.Wrong as wrong:
                crowd.wrong.append(str(wrong))
            samples.append(held(session.process.pid, [folder]))
            self.make_room(chance, folder)
            if time.monotonic() > told + 60:
                told = time.monotonic()
                print(f"{name}: {end - told:.0f} s to go, {samples[-1]}, {crowd.counts}", flush=True)
        if not crowd.stop():
            self.fail(f"{name}: a viewer does not end")
        for wrong in sorted(set(crowd.wrong)):
            self.fail(f"{name}: {wrong} ({crowd.wrong.count(wrong)} times)")
        print(f"{name}: viewers {crowd.counts}, answers to the device {device.answers}")
        device.close()
        self.play_on(session)
        time.sleep(3)
        samples.append(held(session.process.pid, [folder]))
        return samples

    @staticmethod
    def make_room(chance, folder):
        """Now and then somebody tidies up, so that both a full disk and room come again."""
        if chance.random() < 0.03:
            for file in os.listdir(folder):
                if chance.random() < 0.5 and not file.endswith(".part"):
                    os.remove(os.path.join(folder, file))

    @staticmethod
    def play_on(session):
        """Paused by one and stopped by another, a session goes on when somebody looks after it."""
        try:
            viewer = talk.Viewer(session.port)
            viewer.wait_for(lambda: viewer.status)
            if viewer.status["state"] == "stopped":
                viewer.say(do="reset")
            if viewer.status["state"] != "playing":
                viewer.say(do="play")
            if viewer.status["lost"]:
                raise talk.Wrong("a processor is lost")
            viewer.listen(0.1)
            viewer.close()
        except (talk.Gone, OSError):
            pass

    def judge(self, name, samples):
        """Nobody there at the end as at the beginning; and the memory of the last fifth of the time
        is what it was in the second fifth, when every buffer had been used once."""
        first, last = samples[0], samples[-1]
        fifth = max(1, len(samples) // 5)
        early = sorted(s["memory"] for s in samples[fifth:2 * fifth])[fifth // 2]
        late = sorted(s["memory"] for s in samples[-fifth - 1:-1])[fifth // 2]
        print(f"{name}: {len(samples)} samples; memory {first['memory']} kB at first, {early} kB, "
              f"later {late} kB, at the end {last['memory']} kB; files {first['files']}, at most "
              f"{max(s['files'] for s in samples)}, at the end {last['files']}; threads "
              f"{first['threads']}, at most {max(s['threads'] for s in samples)}, at the end "
              f"{last['threads']}", flush=True)
        for what in ("files", "threads", "parts"):
            if last[what] > first[what]:
                self.fail(f"{name}: {what}: {last[what]} at the end, {first[what]} at first")
        if late > 1.05 * early + (4096 if len(samples) > 100 else 16384):
            self.fail(f"{name}: memory grew from {early} to {late} kB")

    # ---- what was recorded --------------------------------------------------------------------------

    def replays(self, name, scene, recording, wanted):
        grids = GRIDS
        if self.short:
            grids = [GRIDS[0], GRIDS[1 + self.played % (len(GRIDS) - 1)]]
            self.played += 1
        for grid in grids:
            done = subprocess.run(
                [self.lariat, "replay", scene, recording, "--json", "--no-pin"] + grid,
                cwd=self.scratch, capture_output=True, check=False)
            said = done.stderr.decode("utf-8", "replace")
            if done.returncode:
                self.fail(f"{name}: replay {' '.join(grid)} of {recording} ends with "
                          f"{done.returncode}: {said[-500:]}")
                continue
            found = talk.strict_json(done.stdout.decode())["state_hash"]
            wanted = wanted or found
            if found != wanted:
                self.fail(f"{name}: {recording} {' '.join(grid)} replays to {found}, not {wanted}")

    def small_scene(self):
        write_block(os.path.join(self.scratch, "block.inp"))
        with open(os.path.join(self.scratch, "small.yaml"), "w", encoding="ascii") as file:
            file.write(SMALL)
        return "small.yaml"

    def recorded(self, seconds):
        """Recorded from the beginning to the end: the report's hash is that of every replay."""
        scene = self.small_scene()
        report = self.run("recorded", scene, seconds,
                          ["--record", "small.recording", "--grid", "2x1x1", "--no-pin"], True, 1)
        if report:
            begun = time.monotonic()
            self.replays("recorded", scene, "small.recording", report["state_hash"])
            size = os.path.getsize(os.path.join(self.scratch, "small.recording"))
            print(f"recorded: {report['ticks']} ticks, {report['recoveries']} times gone back, "
                  f"{size} bytes, the hash {report['state_hash']} on other grids in "
                  f"{time.monotonic() - begun:.0f} s", flush=True)

    def by_viewers(self, name, scene, seconds, options, disk):
        """Recorded by viewers: whatever is whole in the folder at the end."""
        report = self.run(name, scene, seconds, options, False, disk)
        folder = os.path.join(self.scratch, name + "_saved")
        files = sorted(file for file in os.listdir(folder) if file.endswith(".recording"))
        same = 0
        for path in (os.path.join(folder, file) for file in files):
            tried = subprocess.run([self.lariat, "replay", scene, path, "--no-pin"],
                                   cwd=self.scratch, capture_output=True, check=False)
            if tried.returncode == 1 and b"cut off" in tried.stderr:
                continue  # it was being written when the disk was full
            self.replays(name, scene, path, None)
            same += 1
        if report:
            print(f"{name}: {report['ticks']} ticks, {report['recoveries']} times gone back; {same} "
                  f"of {len(files)} recordings are whole, and the same on other grids",
                  flush=True)

    def organ_scene(self):
        subprocess.run([self.lariat, "demo-model", "demo"], cwd=self.scratch, check=True,
                       stdout=subprocess.DEVNULL)
        return "demo/uterus_live.yaml"


def main():
    parser = argparse.ArgumentParser()
    for name in ("lariat", "scratch", "source"):
        parser.add_argument(name)
    parser.add_argument("--seconds", type=float, default=30)
    parser.add_argument("--seed", type=int, default=1)
    settings = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # so that what is mounted is let go
    shutil.rmtree(settings.scratch, ignore_errors=True)
    os.makedirs(settings.scratch)
    soak = Soak(settings)
    try:
        first = min(settings.seconds / 3, 150)
        others = (settings.seconds - first) / 2
        soak.recorded(first)
        soak.by_viewers("small", soak.small_scene(), others, ["--grid", "2x1x1", "--no-pin"], 6)
        soak.by_viewers("organ", soak.organ_scene(), others,
                        ["--grid", "2x1x1", "--comm", "shm", "--no-pin"], 8)
    finally:
        for path in soak.mounted:
            subprocess.run(["umount", path], check=False)
    if soak.failures:
        print(f"{len(soak.failures)} failed", file=sys.stderr)
        return 1
    shutil.rmtree(settings.scratch)
    print(f"ok: a soak of {settings.seconds:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
