"""Saved states and recordings for the sweep: right ones, made by the command itself, and such whose
words say something else while their checksums are right: docs/formats.md.
"""
import glob
import os
import random
import signal
import struct
import subprocess

import bots
import makers
import talk

SCENE = """lariat: 1
mesh: block.inp
damping: 5
materials: [ { cells: all, law: neo-hookean, density: 1000, shear_modulus: 2e3, bulk_modulus: 5e4 } ]
fix: [ { nodes: base, axes: xyz } ]
sets: [ { name: base, nodes: { box: [[-1, -1, -1], [1, 1, 0.001]] } } ]
contact: [ { self: true } ]
tools:
  - { name: probe, shape: sphere, radius: 0.005, at: [0.01, 0.01, 0.04] }
  - { name: jaws, shape: grasper, radius: 0.002, length: 0.01, at: [0.01, 0.01, 0.06] }
"""
MASK = (1 << 64) - 1


def hash_word(value, word):
    x = ((value ^ word) + 0x9E3779B97F4A7C15) & MASK
    x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9 & MASK
    x = (x ^ x >> 27) * 0x94D049BB133111EB & MASK
    return x ^ x >> 31


def hash_words(words, value=0):
    for word in words:
        value = hash_word(value, word)
    return value


def words_of(data):
    return list(struct.unpack(f"<{len(data) // 8}Q", data[:len(data) // 8 * 8]))


def bytes_of(words):
    return struct.pack(f"<{len(words)}Q", *[word & MASK for word in words])


def some_word(chance, old):
    """Another number in the place of one: whole numbers and doubles that lie at a border."""
    doubles = [0.0, -0.0, 1.0, -1.0, 1e-300, 1e300, -1e308, 1e-3, float("nan"), float("inf"), 0.5]
    return chance.choice([
        0, 1, 2, old + 1, old - 1, old ^ 1 << chance.randrange(64), 255, 1 << 31, 1 << 32, 1 << 63,
        MASK, struct.unpack("<Q", struct.pack("<d", chance.choice(doubles)))[0],
        struct.unpack("<Q", struct.pack("<d", chance.uniform(-1, 1)))[0]]) & MASK


# ---- right ones -----------------------------------------------------------------------------------

def make_stock(lariat, folder):
    """A scene, and of it states and recordings of a run and of a session. Returns their bytes."""
    mesh = makers.Mesh(random.Random(1), [2, 2, 2], 0.01)
    for name, text in (("block.inp", mesh.inp()), ("scene.yaml", SCENE)):
        with open(os.path.join(folder, name), "w", encoding="ascii") as file:
            file.write(text)
    subprocess.run([lariat, "run", "scene.yaml", "--steps", "50", "--save", "run.checkpoint"],
                   cwd=folder, check=True, stdout=subprocess.DEVNULL)
    for version in range(2):
        view = talk.Session([lariat, "view", "scene.yaml", "--port", "0", "--json", "--save-folder",
                             f"saved{version}", "--record", f"{version}.recording"], folder)
        if not view.begin():
            raise RuntimeError(view.errors())
        use(view.port, version)
        view.end(signal.SIGINT)
    found = []
    for ending in ("checkpoint", "recording"):
        files = sorted(glob.glob(os.path.join(folder, "**", "*." + ending), recursive=True))
        found.append([])
        for name in files:
            with open(name, "rb") as file:
                found[-1].append(file.read())
    return found


def use(port, version):
    """Tools, settings, a pull, saves: what a state and a recording can hold."""
    viewer, chance = talk.Viewer(port), random.Random(version)
    viewer.wait_for(lambda: viewer.hello)
    viewer.say(do="grab", hand=0, point=[0.01, 0.01, 0.02])
    if version:
        viewer.say(do="add_tool", shape="capsule", radius=0.003, length=0.02)
        viewer.say(do="gravity", to=[0, 0, -5])
        viewer.say(do="stiffness", value=2, material=0)
        viewer.say(do="damping", value=9)
    for _ in range(30):
        viewer.say(do="pull", hand=0, to=[0.01, 0.01, 0.02 + chance.uniform(0, 0.01)])
        bots.move_tool(chance, viewer)
        viewer.listen(0.01)
    viewer.say(do="save")
    viewer.wait_for(lambda: any(text["kind"] == "saved" for text in viewer.texts))
    viewer.close()


# ---- others ---------------------------------------------------------------------------------------

def whole_hash(words):
    """The hash of the state that a checkpoint's words have, as far as they are its words."""
    nodes, tools, holds = words[3], words[17] & 0xFFFFFFFF, words[17] >> 32
    at = (1168 if words[1] & 0xFFFFFFFF == 5 else 752) // 8 + 49 * tools + 9 * holds
    value = hash_word(0, words[12])
    for n in range(nodes):
        place = at + nodes + 3 * n
        value = hash_words(words[place:place + 3] + words[place + 3 * nodes:place + 3 * nodes + 3],
                           value)
        if 0 < words[at + n] < 1 << 63:
            value = hash_word(value, words[at + n])
    return value


def spoil_words(chance, words, first=1):
    for _ in range(chance.choice([1, 1, 1, 2, 5])):
        # The beginning holds counts, and is small beside the rest.
        most = len(words) if chance.random() < 0.5 else min(len(words), 160)
        at = chance.randrange(first, max(first + 1, most))
        words[at] = some_word(chance, words[at])


def mend_checkpoint(words, with_hash):
    words[2] = 8 * len(words)
    if with_hash:
        try:
            words[16] = whole_hash(words)
        except (IndexError, MemoryError, OverflowError):
            pass
    words[-1] = hash_words(words[:-1])
    return words


def spoil_checkpoint(chance, data):
    what = chance.randrange(10)
    if what == 0:
        return data
    if what < 3:
        return makers.mutate(chance, data)
    words = words_of(data)
    spoil_words(chance, words)
    if what == 3:
        del words[chance.randrange(20, len(words)):]
    if words[3] > 10000:  # whose hash would take hours
        return bytes_of(mend_checkpoint(words, False))
    return bytes_of(mend_checkpoint(words, what > 5))


def spoil_recording(chance, data):
    what = chance.randrange(10)
    if what == 0:
        return data
    if what < 3:
        return makers.mutate(chance, data)
    words = words_of(data)
    head, records, at = words[:11], [], 12
    while at + 2 < len(words):
        length = (words[at + 1] + 7) // 8
        records.append(words[at:at + 2 + length])
        at += 3 + length
    if chance.random() < 0.2:
        head[chance.randrange(1, 11)] = some_word(chance, 3)
    for _ in range(chance.choice([0, 1, 1, 3])):
        one = chance.choice([record for record in records if record[0] != 1] or records)
        place = chance.randrange(len(one))
        one[place] = some_word(chance, one[place])
    if chance.random() < 0.3:
        state = chance.choice([record for record in records if record[0] == 1] or [[0] * 40])
        if len(state) > 30:
            inner = state[3:]
            spoil_words(chance, inner)
            if inner[3] < 10000:
                state[3:] = mend_checkpoint(inner, True)
    if chance.random() < 0.2:
        i, j = chance.randrange(len(records)), chance.randrange(len(records))
        records[i], records[j] = records[j], records[i]
    chain = hash_words(head)
    out = head + [chain]
    for record in records:
        chain = hash_words(record, chain)
        out += record + [chain]
    return bytes_of(out)
