"""What calls cost that are made often: least and median of many, which other programs disturb.

    PYTHONPATH=build/python python3 tests/python/measure_calls.py
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time

import lariat


def timed(name, call, times, unit=1e6, what="us"):
    """One line: the least and the median of `times` calls."""
    took = []
    for _ in range(times + times // 10 + 1):
        begin = time.perf_counter()
        call()
        took.append(time.perf_counter() - begin)
    took = took[times // 10 + 1:]
    print(f"{name:40} {unit * min(took):9.3f} {unit * statistics.median(took):9.3f} {what}")


def resident():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def growth(name, call, times):
    for _ in range(100):
        call()
    before = resident()
    for _ in range(times):
        call()
    print(f"{name:40} {1e-3 * (resident() - before):9.0f} kB more after {times}")


def child(code):
    subprocess.run([sys.executable, "-c", code], check=True, env=os.environ)


def first_step(scene):
    model = lariat.Model(scene)
    with lariat.Simulation(model) as sim:
        sim.advance(1)


folder = tempfile.TemporaryDirectory(prefix="lariat-")
lariat.write_demo(folder.name)
scene = folder.name + "/uterus_live.yaml"

print(f"{'':40} {'least':>9} {'median':>9}")
timed("an interpreter that does nothing", lambda: child("pass"), 20, 1e3, "ms")
timed("and one that imports lariat", lambda: child("import lariat"), 20, 1e3, "ms")
timed("organ: read, created, first step", lambda: first_step(scene), 20, 1e3, "ms")

organ = lariat.Simulation(lariat.Model(scene))
organ.advance(500)
saved = organ.save()
positions = organ.positions()
timed("organ: saved in memory", lambda: organ.save(saved), 3000)
timed("organ: taken up again", lambda: organ.load(saved), 3000)
timed("organ: reset", organ.reset, 3000)
timed("organ: cloned, and closed", lambda: organ.clone().close(), 200)
timed("organ: all positions, into `out`", lambda: organ.positions(out=positions), 1000)

cube = lariat.Simulation(lariat.Model.from_arrays(
    [[0.01 * x, 0.01 * y, 0.01 * z]
     for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], [list(range(8))]))
timed("one element: a step, of 8 in a call", lambda: cube.advance(8), 3000, 1e6 / 8)
timed("one element: a call of one step", lambda: cube.advance(1), 20000)
timed("a call that computes nothing", lambda: cube.advance(0), 20000)

growth("organ: resets", organ.reset, 10**5)
growth("organ: clones, and closed", lambda: organ.clone().close(), 10**3)
growth("one element: created, and closed", lambda: lariat.Simulation(cube.model).close(), 10**4)
