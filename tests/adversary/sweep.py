"""Adversarial cases, one after the other, against the real command: scenes, decks, meshes, images,
saved states, recordings, and sessions that are told anything.

    sweep.py LARIAT SCRATCH SOURCE [--cases N] [--from I] [--seed N] [--only KIND]

Case I depends on the seed and on I alone, so `--from I --cases 1` repeats it; its files stay in
SCRATCH when it fails. Every case must end by itself within a minute, with an exit status of
docs/cli.md; with a message that names a file where it fails; without a number that is none in
anything that it says or writes, a sanitizer's report, or a file left behind.
"""
import argparse
import collections
import os
import random
import re
import shutil
import signal
import struct
import subprocess
import sys
import time

import bots
import makers
import states
import talk

SECONDS = 120  # for a case; the machine may have other things to do
ENVIRONMENT = {"ASAN_OPTIONS": "exitcode=99:max_allocation_size_mb=1024:allocator_may_return_null=0"
                               ":intercept_tls_get_addr=0",
               "UBSAN_OPTIONS": "print_stacktrace=1:halt_on_error=1:exitcode=99",
               "LARIAT_ISA": "c"}
# Steps are few: what is looked for is not in the ten thousandth.
STEPS = ["--steps", "60"]


class Case:
    """One case in a folder of its own: runs commands, and says what is wrong with them."""

    def __init__(self, sweep, number, kind):
        self.sweep, self.lariat = sweep, sweep.lariat
        self.name = f"{kind}-{number}"
        self.chance = random.Random(f"{sweep.seed} {number}")
        self.folder = os.path.join(sweep.scratch, self.name)
        self.wrong = []
        self.statuses = []
        os.mkdir(self.folder)
        os.mkdir(self.path("tmp"))
        self.environment = {**os.environ, **ENVIRONMENT, "TMPDIR": self.path("tmp")}

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, data):
        with open(self.path(name), "wb") as file:
            file.write(data if isinstance(data, bytes) else data.encode())

    def fail(self, sentence):
        self.wrong.append(sentence)

    # ---- commands ------------------------------------------------------------------------------

    def run(self, *arguments, allowed=(0, 1, 3), about=""):
        """Runs the command and judges how it ends. `about`: a name that a failure has to tell."""
        what = " ".join(arguments)
        try:
            done = subprocess.run([self.lariat, *arguments], cwd=self.folder, check=False,
                                  env=self.environment, capture_output=True, timeout=SECONDS,
                                  stdin=subprocess.DEVNULL)
        except subprocess.TimeoutExpired:
            self.fail(f"has not ended after {SECONDS} s: {what}")
            return None
        out, err = (text.decode("utf-8", "replace") for text in (done.stdout, done.stderr))
        self.judge(done.returncode, out, err, allowed, what)
        if done.returncode == 1 and about not in err and not re.search("fix|label|a grid of", err):
            self.fail(f"does not name {about}: {err.strip()[:300]}")
        if done.returncode in (0, 4) and "--json" in arguments:
            self.judge_json(out, what)
        self.statuses.append(done.returncode)
        return done.returncode

    def judge(self, status, out, err, allowed, what):
        if status not in allowed:
            self.fail(f"exit status {status}: {what}: {err.strip()[-1500:]}")
        elif "Sanitizer" in err or "runtime error" in err:
            self.fail(f"a sanitizer's report: {what}: {err[:1500]}")
        elif status and not err.startswith("lariat "):
            self.fail(f"no message of its own: {what}: {err[:300]!r}")
        # Messages repeat what a file says: in quotes, and coordinates as they are.
        said = re.sub(r"'[^'\n]*'|\"[^\"\n]*\"|coordinate -?(nan|inf),", "", out + err)
        if re.search(r"(?<![\w/.'-])-?(?:nan|inf)(?![\w/.'-])", said, re.I):
            self.fail(f"a number that is none: {what}: {(out + err)[:500]}")
        if re.search(r"[\x00-\x08\x0b-\x1f\x7f]", out + err):
            self.fail(f"control characters: {what}: {(out + err)[:300]!r}")

    def judge_json(self, text, what):
        try:
            answer = talk.strict_json(text)
        except (ValueError, talk.Wrong) as error:
            self.fail(f"no JSON: {what}: {error}: {text[:300]!r}")
            return
        # A speed that could not be measured has none, and says why.
        holes = [hole for hole in nulls(answer) if not hole.startswith("speed.")]
        if holes:
            self.fail(f"null in {', '.join(holes)}: {what}")

    def judge_files(self):
        """What is left: no half files, nothing temporary, no number that is none in tables."""
        for folder, _, names in os.walk(self.folder):
            for name in names:
                path = os.path.join(folder, name)
                if name.endswith(".part") or folder == self.path("tmp") or name.startswith("core"):
                    self.fail(f"left behind: {os.path.relpath(path, self.folder)}")
                if name == "probes.csv":
                    with open(path, "rb") as file:
                        # The first line has names of the scene, the others only numbers.
                        if re.search(rb"(?i)nan|inf", b"".join(file.readlines()[1:])):
                            self.fail("a number that is none in probes.csv")
                if name == "run.json":
                    with open(path, "rb") as file:
                        self.judge_json(file.read().decode(), "run.json")


def nulls(value, path=""):
    """Where a number is not finite: written as null."""
    if value is None:
        yield path
    items = value.items() if isinstance(value, dict) else \
        enumerate(value) if isinstance(value, list) else []
    for key, each in items:
        yield from nulls(each, f"{path}.{key}" if path else str(key))


# ---- the kinds of cases ------------------------------------------------------------------------------

WRITERS = {"inp": makers.Mesh.inp, "msh": makers.Mesh.msh, "vtk": makers.Mesh.vtk,
           "vtu": makers.Mesh.vtu, "feb": makers.Mesh.feb}


def run_scene(case, name, about=""):
    options = STEPS + case.chance.choice([[], [], ["--grid", "2x1x1", "--no-pin"],
                                          ["--threads", "2", "--no-pin"]])
    if case.chance.random() < 0.5:
        options += ["--out", "results"]
    case.run("run", name, "--json", *options, allowed=(0, 1, 3, 4), about=about)


def scene(case):
    chance = case.chance
    edge = chance.choice([0.01, 0.01, 0.01, 1, 1e-4])
    mesh = makers.Mesh(chance, [chance.randrange(1, 4) for _ in range(3)], edge)
    ending = chance.choice(list(WRITERS))
    case.write("mesh." + ending, WRITERS[ending](mesh))
    text = makers.scene(chance, "mesh." + ending, edge).encode()
    if chance.random() < 0.4:
        text = makers.mutate(chance, text)
    case.write("scene.yaml", text)
    if chance.random() < 0.3:
        case.run("info", "scene.yaml", "--json", allowed=(0, 1))
    run_scene(case, "scene.yaml")


def bad_mesh(case):
    """A mesh with something in it that cannot be, as a scene names it and alone."""
    chance = case.chance
    ending = chance.choice(list(WRITERS))
    data = WRITERS[ending](makers.some_mesh(chance)).encode()
    if chance.random() < 0.6:
        data = makers.mutate(chance, data)
    case.write("mesh." + ending, data)
    case.write("scene.yaml", makers.scene(chance, "mesh." + ending, 0.01))
    case.run("info", "mesh." + ending, "--json", allowed=(0, 1), about="mesh.")
    run_scene(case, "scene.yaml")


def deck(case):
    chance = case.chance
    seeds = case.sweep.seeds("inp") + case.sweep.seeds("feb")
    if chance.random() < 0.7:
        name, data = "deck.inp", makers.deck(chance, makers.some_mesh(chance, spoilt=0.05)).encode()
    else:
        path = chance.choice(seeds)
        name = "deck" + os.path.splitext(path)[1]
        with open(path, "rb") as file:
            data = file.read()
    if chance.random() < 0.3:
        data = makers.mutate(chance, data)
    case.write(name, data)
    run_scene(case, name, about=name)


def solid(case):
    """lariat mesh of tetrahedra, prisms, pyramids and hexahedra."""
    chance = case.chance
    ending = chance.choice(list(WRITERS))
    mesh = makers.some_mesh(chance, chance.choice(["tet", "tet", "prism", "pyramid", "hex"]))
    data = WRITERS[ending](mesh).encode()
    if chance.random() < 0.4:
        data = makers.mutate(chance, data)
    case.write("solid." + ending, data)
    make_mesh(case, "solid." + ending)


def image(case):
    chance = case.chance
    what = chance.randrange(4)
    name, data = ("scan.nrrd", makers.nrrd(chance)) if what < 2 else ("scan.nii", makers.nifti(chance))
    if name == "scan.nii" and data[:2] == b"\x1f\x8b":
        name += ".gz"
    if chance.random() < 0.4:
        data = makers.mutate(chance, data)
    case.write(name, data)
    make_mesh(case, name)


def make_mesh(case, name):
    chance = case.chance
    options = ["--elements", str(chance.choice([20, 40, 60]))]
    if name.startswith("solid") and chance.random() < 0.8:
        options += ["--scale", chance.choice(["1", "0.001", "5"])]
    if chance.random() < 0.3:
        options += chance.choice([["--fuse"], ["--voxel"], ["--principal"], ["--label", "1"],
                                  ["--fix", "bottom"]])
    status = case.run("mesh", name, *options, "--title", "made", "--out", "made", allowed=(0, 1, 2),
                      about=name)
    if status == 0:
        case.run("run", "made/made.yaml", "--steps", "5", "--json", allowed=(0,))
    elif os.path.exists(case.path("made")):
        case.fail(f"a folder is left by what failed: {os.listdir(case.path('made'))}")


def take_scene(case):
    for name in ("block.inp", "scene.yaml"):
        shutil.copy(os.path.join(case.sweep.stock, name), case.folder)


def checkpoint(case):
    chance = case.chance
    take_scene(case)
    case.write("at.checkpoint",
               states.spoil_checkpoint(chance, chance.choice(case.sweep.checkpoints)))
    if chance.random() < 0.7:
        case.run("run", "scene.yaml", "--resume", "at.checkpoint", "--json", *STEPS, "--out", "results")
    else:
        case.run("view", "scene.yaml", "--resume", "at.checkpoint", "--json", "--port", "0",
                 "--seconds", "0.2")


def recording(case):
    chance = case.chance
    take_scene(case)
    case.write("a.recording", states.spoil_recording(chance, chance.choice(case.sweep.recordings)))
    options = chance.choice([[], [], ["--grid", "2x1x1", "--no-pin"], ["--out", "results"]])
    case.run("replay", "scene.yaml", "a.recording", "--json", *options)


def session(case):
    """A session that is told anything by a viewer, over HTTP and by a device."""
    take_scene(case)
    os.mkdir(case.path("saved"))
    if case.chance.random() < 0.5:  # a folder in which others have left something
        for name in ("a.recording", "b.checkpoint"):
            kind = states.spoil_recording if name[0] == "a" else states.spoil_checkpoint
            stock = case.sweep.recordings if name[0] == "a" else case.sweep.checkpoints
            case.write("saved/" + name, kind(case.chance, case.chance.choice(stock)))
    view = talk.Session([case.lariat, "view", "scene.yaml", "--port", "0", "--json", "--save-folder",
                         "saved", "--record", "all.recording", "--device",
                         "probe=udp:127.0.0.1:0,rate=" + case.chance.choice(["1", "500", "100000"])],
                        case.folder, case.environment)
    try:
        if not view.begin(SECONDS):
            case.fail(f"no address: {view.errors()[:1000]}")
            return
        tell_anything(case, view)
    except talk.Wrong as wrong:
        case.fail(f"what it sends: {wrong}")
    finally:
        status = view.end(signal.SIGINT, SECONDS)
        with open(view.out_path, encoding="utf-8", errors="replace") as out:
            text = out.read()
        case.judge(status, text, view.errors(), (0, 1, 3), "view")
    case.statuses.append(status)
    if text:
        case.judge_json(text, "view")
        replayed = subprocess.run([case.lariat, "replay", "scene.yaml", "all.recording", "--json"],
                                  cwd=case.folder, env=case.environment, capture_output=True,
                                  check=False, timeout=SECONDS)
        if replayed.returncode == 1 and b"cut off" not in replayed.stderr:
            case.fail(f"does not replay: {replayed.stderr.decode()[:1000]}")


ACTS = [bots.look, bots.pull, bots.pull, bots.move_tool, bots.change_tools, bots.change_tools,
        bots.change_body, bots.change_body, bots.steer, bots.keep, bots.record]


def tell_anything(case, view):
    chance = case.chance
    device = talk.Device(view.device_ports()[0])
    viewer = None
    try:
        for _ in range(40):
            if chance.random() < 0.3:
                device.send(chance.choice([
                    device.packet([chance.uniform(-0.1, 0.1) for _ in range(3)], chance.random()),
                    makers.mutate(chance, device.packet([0, 0, 0]), 1), chance.randbytes(104),
                    struct.pack("<26f", *[float("nan")] * 26)]))
                device.hear()
            try:
                if not viewer:
                    viewer = talk.Viewer(view.port, chance.choice(["", "", "", "?watch=1"]), SECONDS)
                    viewer.wait_for(lambda: viewer.hello and viewer.status, SECONDS)
                if chance.random() < 0.85:
                    chance.choice(ACTS)(chance, viewer)
                elif chance.random() < 0.7:
                    viewer.send_frame(1, bots.bad_message(chance, viewer.hello))
                else:
                    bots.noise(chance, view.port)
                viewer.listen(0.01)
            except (talk.Gone, OSError):
                viewer = None
    finally:
        device.close()
        if viewer:
            viewer.close()


KINDS = collections.OrderedDict(
    scene=scene, deck=deck, bad_mesh=bad_mesh, solid=solid, image=image, checkpoint=checkpoint,
    recording=recording, session=session)
# In this order again and again: sessions take longest, and are fewest.
ORDER = ["scene", "deck", "solid", "checkpoint", "image", "recording", "scene", "bad_mesh", "deck",
         "checkpoint", "solid", "recording", "scene", "image", "session"]


class Sweep:
    def __init__(self, settings):
        self.lariat, self.source = os.path.abspath(settings.lariat), settings.source
        self.scratch, self.seed = os.path.abspath(settings.scratch), settings.seed
        self.stock = os.path.join(self.scratch, "stock")
        os.makedirs(self.stock)
        self.checkpoints, self.recordings = states.make_stock(self.lariat, self.stock)

    def seeds(self, name):
        folder = os.path.join(self.source, "tests", "fuzz", "seeds", name)
        return [os.path.join(folder, file) for file in sorted(os.listdir(folder))]

    def try_one(self, number, kind):
        """One case; whether it is well. Its folder stays when it is not."""
        case = Case(self, number, kind)
        try:
            KINDS[kind](case)
            case.judge_files()
        except Exception as error:  # a case that this program cannot judge is no good case
            case.fail(f"{type(error).__name__}: {error}")
        for sentence in case.wrong:
            print(f"FAILED: {case.name}: {sentence}", file=sys.stderr, flush=True)
        if not case.wrong:
            shutil.rmtree(case.folder)
        return not case.wrong, case.statuses


def main():
    parser = argparse.ArgumentParser()
    for name in ("lariat", "scratch", "source"):
        parser.add_argument(name)
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--from", type=int, default=0, dest="first")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", choices=list(KINDS))
    settings = parser.parse_args()
    shutil.rmtree(settings.scratch, ignore_errors=True)
    sweep = Sweep(settings)
    begun, failed = time.monotonic(), 0
    ended = collections.defaultdict(collections.Counter)
    for number in range(settings.first, settings.first + settings.cases):
        kind = settings.only or ORDER[number % len(ORDER)]
        well, statuses = sweep.try_one(number, kind)
        failed += not well
        ended[kind].update(statuses)
    for kind, statuses in ended.items():
        print(f"{kind}: exit statuses " +
              ", ".join(f"{status}: {count}" for status, count in sorted(
                  statuses.items(), key=lambda item: str(item[0]))))
    print(f"{settings.cases} cases in {time.monotonic() - begun:.0f} s, {failed} failed")
    if failed:
        return 1
    shutil.rmtree(sweep.scratch)
    return 0


if __name__ == "__main__":
    sys.exit(main())
