"""How fast batches and environments are beside bare steps: medians of pairs measured in turn, and the
least of each, which other programs disturb less. What one thread does is measured by its processor
time, what several do by the clock.

    PYTHONPATH=build/python python3 tests/python/measure_batch.py [PAIRS]
"""

import statistics
import sys
import tempfile
import time

import numpy

import lariat
from lariat import envs

PAIRS = int(sys.argv[1]) if len(sys.argv) > 1 else 40
folder = tempfile.TemporaryDirectory(prefix="lariat-")
lariat.write_demo(folder.name)
ORGAN = lariat.Model(folder.name + "/uterus_live.yaml")


class Organ(envs.Env):
    """The demonstration organ, 1,840 elements, pressed by a ball."""

    class task_class(envs.Task):
        jaws, settle, horizon = False, 0.05, 10**9
        low, high = (-0.2,) * 3, (0.2,) * 3
        watched = tuple(range(0, 2567, 100))

        def model(self):
            return ORGAN

        def goal(self, random):
            return random.uniform(-1, 1, 3)

        def judge(self, seen):
            return -seen.tip[:, 0], seen.tip[:, 0] > 1


def timed(call, times=1, clock=time.thread_time):
    begin = clock()
    for _ in range(times):
        call()
    return (clock() - begin) / times


def pairs(one, other, count=PAIRS, times=1, clock=time.thread_time):
    """The least of both, the quotient of these, and the median of the pairs' quotients."""
    a, b = [], []
    for i in range(count):
        first = (timed(one, times, clock), timed(other, times, clock)) if i % 2 else (
            timed(other, times, clock), timed(one, times, clock))[::-1]
        a.append(first[0])
        b.append(first[1])
    return (min(a), min(b), min(b) / min(a), statistics.median(y / x for x, y in zip(a, b)))


def environment(kind):
    """Both on the same simulation: two of one model differ by some per cent, by where they lie in
    memory."""
    env, still = kind(), None
    env.reset(seed=0)
    still = numpy.zeros(env.action_space.shape, numpy.float32)
    steps = env._core.control_steps
    bare = env.simulation
    place = bare.tool_pose(0)["position"]

    def alone():
        bare.tool_move(0, place, steps)
        bare.advance(steps)

    a, b, least, median = pairs(alone, lambda: env.step(still))
    print(f"{kind.__name__:12} control step of {steps} steps: bare {1e3 * a:.3f} ms, environment "
          f"{1e3 * b:.3f} ms: {1 / b:.0f} a second, {100 * (least - 1):+.1f} %, median "
          f"{100 * (median - 1):+.1f} %")
    print(f"{'':12} reset {1e6 * min(timed(env.reset, 10) for _ in range(100)):.0f} us")


def workers(model, n, steps):
    """By the clock, and by processor time: of one thread, and of the one of two that took more, which
    is what the clock would say if nobody else computed."""
    one, two = (lariat.Batch(model, n, workers=w) for w in (1, 2))
    clock, processor = [], []
    for _ in range(PAIRS):
        first = time.perf_counter(), time.process_time()
        one.advance(steps)
        second = time.perf_counter(), time.process_time(), time.thread_time()
        two.advance(steps)
        whole, caller = time.process_time() - second[1], time.thread_time() - second[2]
        clock.append((second[0] - first[0]) / (time.perf_counter() - second[0]))
        processor.append((second[1] - first[1]) / max(caller, whole - caller))
    print(f"{n} members, {steps} steps, two workers: {statistics.median(clock):.2f} times as fast by the "
          f"clock (best {max(clock):.2f}), {statistics.median(processor):.2f} by processor time")


def batch_of_one(model, steps):
    bare, batch = lariat.Simulation(model), lariat.Batch(model, 1)
    a, b, _, _ = pairs(lambda: bare.advance(steps), lambda: batch.advance(steps), times=20)
    print(f"{steps} steps: Simulation {1e6 * a:.1f} us, Batch of one {1e6 * b:.1f} us")


print(ORGAN)
for kind in (Organ, *envs.TASKS):
    environment(kind)
batch_of_one(ORGAN, 1)
workers(ORGAN, 8, 211)
workers(envs.Palpate().simulation.model, 32, 39)
print(f"a simulation is made in {1e3 * min(timed(lambda: lariat.Simulation(ORGAN)) for _ in range(5)):.1f} ms, "
      f"a clone in {1e3 * min(timed(lariat.Simulation(ORGAN).clone) for _ in range(20)):.2f} ms")
batch = lariat.Batch(ORGAN, 16)
saved = batch[0].save()
print(f"reset of one member {1e6 * min(timed(lambda: batch.reset([3], saved), 10) for _ in range(100)):.0f} us, "
      f"all positions {1e6 * min(timed(batch.positions, 5) for _ in range(20)):.0f} us")
