"""Viewers that come and go during a soak: careful ones, slow ones, hostile ones, and those who only
watch. Each is a thread with a seed of its own; what it finds wrong it puts into a list.
"""
import json
import random
import threading
import time

import talk

FIELDS = ["none", "displacement", "von_mises", "pressure", "energy", "processor", "nothing"]


def near(chance, hello, beyond=0.2):
    """A point in the body's box, a little larger."""
    return [low + (high - low) * chance.uniform(-beyond, 1 + beyond)
            for low, high in zip(hello["lower"], hello["upper"])]


def size_of(hello):
    return max(high - low for low, high in zip(hello["lower"], hello["upper"]))


def turned(chance):
    axis = [chance.gauss(0, 1) for _ in range(4)]
    length = sum(x * x for x in axis) ** 0.5
    return [x / length for x in axis]


# ---- what can be asked for ------------------------------------------------------------------------

def look(chance, viewer):
    hello = viewer.hello
    what = chance.randrange(4)
    if what == 0:
        viewer.say(do="frame", field=chance.choice(FIELDS[:-1]))
    elif what == 1:
        viewer.say(do="forces", tool=chance.randrange(len(hello["tools"])),
                   after=chance.choice([0, 1, 10 ** 6, 2 ** 40]))
    elif what == 2:
        viewer.say(do="inspect", node=chance.randrange(hello["surface"]["nodes"]),
                   face=chance.randrange(hello["surface"]["faces"]), energy=chance.random() < 0.5)
    else:
        viewer.say(do="frame")


def pull(chance, viewer):
    hand = chance.randrange(4)
    what = chance.randrange(5)
    if what == 0:
        viewer.say(do="grab", hand=hand, point=near(chance, viewer.hello, 0.05))
    elif what < 4:
        viewer.say(do="pull", hand=hand, to=near(chance, viewer.hello, 0.4))
    else:
        viewer.say(do="release", hand=hand)


def move_tool(chance, viewer):
    message = {"do": "tool", "tool": chance.randrange(len(viewer.hello["tools"])),
               "position": near(chance, viewer.hello, 0.3)}
    if chance.random() < 0.5:
        message["orientation"] = turned(chance)
    if chance.random() < 0.5:
        message["opening"] = chance.random()
    viewer.say(**message)


def change_tools(chance, viewer):
    if chance.random() < 0.4:
        places = viewer.hello["spares"] + [0]
        viewer.say(do="remove_tool", tool=chance.choice(places))
        return
    size = size_of(viewer.hello) * chance.choice([1e-6, 0.02, 0.05, 0.1, 0.1, 0.2, 3])
    shape = chance.choice(["sphere", "capsule", "grasper"])
    message = {"do": "add_tool", "shape": shape, "radius": size}
    if shape != "sphere":
        message["length"] = size * chance.choice([1, 5, 10])
    viewer.say(**message)


def change_body(chance, viewer):
    what = chance.randrange(5)
    if what == 0:
        viewer.say(do="gravity", to=[chance.uniform(-15, 15) for _ in range(3)])
    elif what == 1:
        viewer.say(do="damping", value=chance.choice([0, 1, 20, 200, 1e6]))
    elif what == 2:
        viewer.say(do="stiffness", value=chance.uniform(0.1, 4))
    elif what == 3:
        viewer.say(do="activate", value=chance.uniform(0, 1))
    else:
        viewer.say(do=chance.choice(["gravity", "damping", "stiffness", "activate"]))


def steer(chance, viewer):
    what = chance.randrange(8)
    if what == 0:
        viewer.say(do="pause")
    elif what == 1:
        viewer.say(do="step", steps=chance.choice([1, 7, 1000]))
    elif what == 2:
        viewer.say(do="reset")
    elif what == 3:
        viewer.say(do="pace", value=chance.choice([0.3, 1, 1, 1, 1.5]))
    else:
        viewer.say(do="play")


def keep(chance, viewer):
    status = viewer.status or {"saved": [], "recordings": []}
    if chance.random() < 0.5:
        viewer.say(do="save")
    elif status["saved"] and chance.random() < 0.7:
        viewer.say(do="load", name=chance.choice(status["saved"]))
    else:
        viewer.say(do="load", **({"name": "none.checkpoint"} if chance.random() < 0.3 else {}))


def record(chance, viewer):
    """Only where the session is not recorded from the command line, which this would end."""
    names = (viewer.status or {"recordings": []})["recordings"]
    what = chance.randrange(6)
    if what < 2:
        viewer.say(do="record", on=what == 0)
    elif what < 4 and names:
        viewer.say(do="replay", name=chance.choice(names))
    elif what == 4:
        viewer.say(do="seek", time=chance.choice([0, 0.1, 1, 1e6]))
    else:
        viewer.say(do="replay")


# ---- viewers --------------------------------------------------------------------------------------

def busy(chance, viewer, seconds, acts):
    """Asks for something every 5 to 80 ms: less than 300 messages a second."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        chance.choice(acts)(chance, viewer)
        viewer.listen(chance.uniform(0.005, 0.08))


def slow(chance, viewer, seconds):
    """Asks for frames and does not read for some time; beyond 10 s it is closed for that."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        for _ in range(20):
            viewer.say(do="frame", field="von_mises")
        time.sleep(chance.uniform(0.1, min(14, seconds)))
        viewer.listen(0.2)


def bad_message(chance, hello):
    """What docs/viewer-protocol.md does not have: bytes, keys, types and numbers."""
    number = chance.choice([-1, 1e308, -1e308, 4294967296, 1e-320, 0, 99999999999999999999])
    bad = [
        b"", b"{", b"null", b"[]", b"{}", b'{"do":1}', b'{"do":"fly"}', b"\xff\xfe", b"\0" * 40,
        b'{"do":"frame","do":"frame"}', b'{"do":"frame","field":7}', b'{"do":"pace","value":NaN}',
        b'{"do":"pace","value":1e999}', b'{"do":"load","name":"../../etc/passwd"}',
        b'{"do":"replay","name":"a/b.recording"}', b'{"do":"play","x":1}',
        b'{"do":"grab","hand":4,"point":[0,0,0]}', b'{"do":"grab","hand":0,"point":[0,0]}',
        b"{" * 900, b'{"do":"' + b"a" * 900 + b'"}', b'{"do":"frame","field":"' + b"x" * 2000,
        json.dumps({"do": "tool", "tool": number, "position": [number] * 3}).encode(),
        json.dumps({"do": "inspect", "node": number, "face": number, "energy": True}).encode(),
        json.dumps({"do": "forces", "tool": 0, "after": number}).encode(),
        json.dumps({"do": "slice", "axis": number, "index": number}).encode(),
        json.dumps({"do": "step", "steps": number}).encode(),
        json.dumps({"do": "seek", "time": number}).encode(),
        json.dumps({"do": "gravity", "to": [number, 0, 0]}).encode(),
        json.dumps({"do": "damping", "value": number}).encode(),
        json.dumps({"do": "stiffness", "value": number, "material": number}).encode(),
        json.dumps({"do": "add_tool", "shape": "sphere", "radius": number}).encode(),
        json.dumps({"do": "add_tool", "shape": "none", "radius": 0.01}).encode(),
        json.dumps({"do": "add_tool", "shape": "capsule", "radius": 0.01, "length": number})
        .encode(),
        json.dumps({"do": "remove_tool", "tool": number}).encode(),
        json.dumps({"do": "pull", "hand": 0, "to": [number, 0, 0]}).encode(),
    ]
    return chance.choice(bad)


def hostile(chance, viewer, seconds):
    """Until it is thrown out, or for so long."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        what = chance.randrange(7)
        if what < 4:
            viewer.send_frame(1, bad_message(chance, viewer.hello))
        elif what == 4:
            viewer.send_frame(chance.choice([0, 2, 3, 8, 9, 10, 15]), chance.randbytes(
                chance.choice([0, 1, 100, 125, 70000])), final=chance.random() < 0.7)
        elif what == 5:
            viewer.send_raw(chance.randbytes(chance.choice([1, 2, 30, 5000])))
        else:
            for _ in range(400):
                viewer.say(do="frame")
        viewer.listen(0.05)


def noise(chance, port):
    """Connections that are none, or leave at once."""
    talk.http(port, chance.choice([
        b"", b"GET", b"GET / HTTP/1.1\r\n\r\n", b"GET /../../etc/passwd HTTP/1.1\r\nHost: x\r\n\r\n",
        b"POST / HTTP/1.1\r\nContent-Length: 99999999999\r\n\r\n" + b"x" * 1000,
        b"GET /" + b"a" * 20000 + b" HTTP/1.1\r\n\r\n", chance.randbytes(3000),
        b"GET /socket HTTP/1.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\r\n",
        f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode()]), timeout=1.0)


def life(chance, port, recorded, counts):
    """One viewer, from coming to going."""
    kind = chance.choice(["pulls", "pulls", "tinkers", "tinkers", "watches", "slow", "hostile",
                          "noise"])
    counts[kind] = counts.get(kind, 0) + 1
    seconds = chance.choice([0.1, 1, 3, 8, 15])
    if kind == "noise":
        noise(chance, port)
        return
    viewer = talk.Viewer(port, "?watch=1" if kind == "watches" else "")
    try:
        if not viewer.wait_for(lambda: viewer.hello and viewer.status, 30):
            raise talk.Wrong("no hello within half a minute")
        doing = [look, pull, move_tool]
        if kind == "tinkers":
            doing += [look, change_tools, change_body, steer, keep] + ([] if recorded else [record])
        if kind == "slow":
            slow(chance, viewer, seconds)
        elif kind == "hostile":
            hostile(chance, viewer, seconds)
        else:
            busy(chance, viewer, seconds,
                 doing + ([change_tools, keep] if kind == "watches" else []))
    finally:
        viewer.close()


class Crowd:
    """So many viewers at once, one after the other, until it is stopped."""

    def __init__(self, port, recorded, seed, places=4):
        self.port, self.recorded = port, recorded
        self.wrong, self.counts = [], {}
        self.over = threading.Event()
        self.threads = [threading.Thread(target=self._place, args=(random.Random(seed + i),))
                        for i in range(places)]
        for thread in self.threads:
            thread.start()

    def _place(self, chance):
        while not self.over.wait(chance.choice([0, 0.1, 1])):
            try:
                life(chance, self.port, self.recorded, self.counts)
            except (talk.Gone, OSError):
                pass  # thrown out, or refused: that may be
            except Exception as error:  # a thread that ends in silence would hide it
                self.wrong.append(f"{type(error).__name__}: {error}")

    def stop(self):
        self.over.set()
        for thread in self.threads:
            thread.join(60)
        return not any(thread.is_alive() for thread in self.threads)
