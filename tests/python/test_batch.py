"""Batches: the bits of single runs with any number of workers, arrays, resets, failures, misuse."""

import array
import gc
import os
import pickle
import threading
import time
import unittest

import lariat
from common import SCENE, WITHOUT_NUMPY, block, block_arrays, child, numpy

SANITIZED = os.environ.get("LARIAT_TEST_SANITIZED")


def pose(place, opening=False):
    return [*place, 1.0, 0.0, 0.0, 0.0] + ([1.0] if opening else [])


def lighter(density):
    nodes, hexahedra, sets = block_arrays()
    materials = [{**SCENE["materials"][0], "density": density}]
    return lariat.Model.from_arrays(nodes, hexahedra, {**SCENE, "materials": materials}, sets=sets)


def many_shapes(view):
    return view.shape, view.format, view.c_contiguous


def resident():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


class Bits(unittest.TestCase):
    """What a member does is what a single simulation does."""

    FACTORS = (0.5, 1.0, 1.5, 2.0, 0.8)

    def play(self, sims, advance, move):
        for i, sim in enumerate(sims):
            sim.set_stiffness(self.FACTORS[i])
            sim.set_force("top", (0, 0.01 * i, 0))
        for k in range(4):
            move([[pose((0.03, 0.025 + 0.001 * i, 0.037 - 0.001 * k))] for i in range(len(sims))])
            advance(100 + k)

    def alone(self):
        model, hashes, wrenches = block(), [], []
        for i, factor in enumerate(self.FACTORS):
            sim = lariat.Simulation(model)
            sim.set_stiffness(factor)
            sim.set_force("top", (0, 0.01 * i, 0))
            for k in range(4):
                sim.tool_move(0, (0.03, 0.025 + 0.001 * i, 0.037 - 0.001 * k), 50)
                sim.advance(100 + k)
            hashes.append(sim.hash())
            wrenches.append(sim.wrench(0))
        return tuple(hashes), wrenches

    def test_any_number_of_workers(self):
        hashes, wrenches = self.alone()
        self.assertNotEqual(wrenches[0], (0,) * 6)
        for workers in (1, 2, 8):
            with lariat.Batch(block(), len(self.FACTORS), workers=workers) as batch:
                self.play(batch, batch.advance, lambda p, b=batch: b.set_tool_poses(p, 50))
                self.assertEqual(batch.hashes(), hashes)
                self.assertEqual([tuple(w) for w in batch.wrenches().tolist()[0]], [wrenches[0]])
                self.assertEqual([tuple(w[0]) for w in batch.wrenches().tolist()], wrenches)
                self.assertEqual(batch.steps(), (406,) * 5)

    def test_models_of_one_mesh(self):
        models = [lighter(density) for density in (500.0, 1000.0, 2000.0)]
        alone = []
        for model in models:
            sim = lariat.Simulation(model)
            sim.advance(seconds=0.02)
            alone.append(sim.hash())
        batch = lariat.Batch(models, workers=2)
        batch.advance(seconds=0.02)
        self.assertEqual(batch.hashes(), tuple(alone))
        self.assertEqual(len(set(batch.steps())), 3)  # each its own step

    def test_members_are_simulations(self):
        sims = [lariat.Simulation(block()) for _ in range(3)]
        batch = lariat.Batch(sims)
        self.assertIs(batch[1], sims[1])
        self.assertIs(batch[-1], sims[2])
        self.assertRaisesRegex(IndexError, "no member -4", lambda: batch[-4])
        self.assertEqual((len(batch), list(batch)), (3, sims))
        batch.advance(10, members=[2, 0])
        self.assertEqual(batch.steps(), (10, 0, 10))
        self.assertEqual(sims[0].hash(), sims[2].hash())
        batch.close()
        self.assertEqual(sims[0].step, 10)

    def test_pickles_go_on_with_the_same_bits(self):
        batch = lariat.Batch(block(), 3, workers=2)
        self.play(list(batch)[:3], batch.advance, lambda p: batch.set_tool_poses(p, 50))
        other = pickle.loads(pickle.dumps(batch))
        self.assertEqual((other.hashes(), other.workers), (batch.hashes(), 2))
        self.assertIs(other[0].model, other[2].model)
        batch.advance(100)
        other.advance(100)
        self.assertEqual(other.hashes(), batch.hashes())

    def test_pickled_members_are_made_once_for_each_model_and_options(self):
        """A member that is made takes as long as a hundred that are cloned."""
        models, made, one = [block(), block(damping=30)], [], lariat.Simulation
        options = [{"spares": 1}, {"spares": 1, "hands": 1}, {"spares": 1, "grid": "2x1x1"}]
        sims = [one(model, **given) for given in options for model in models for _ in range(3)]
        tool = sims[0].add_tool("sphere", 0.004)
        sims[0].tool_move(tool, (0.03, 0.025, 0.08), steps=40)
        for i, sim in enumerate(sims):
            sim.advance(10 + i)
        batch = lariat.Batch(sims[:6])

        def make(*args, **given):
            made.append(given)
            return one(*args, **given)
        packed = pickle.dumps((batch, sims))
        try:
            lariat.Simulation = make
            again, copies = pickle.loads(packed)
        finally:
            lariat.Simulation = one
        self.assertEqual(len(made), 4 + 2 * 3)  # those with a grid have no clones
        self.assertEqual([s.hash() for s in copies], [s.hash() for s in sims])
        self.assertEqual([s.options for s in copies], [s.options for s in sims])
        self.assertEqual([len(s.tools) for s in copies], [len(s.tools) for s in sims])
        self.assertTrue(all(a is b for a, b in zip(again, copies)))


class Clones(unittest.TestCase):
    def test_they_go_on_with_the_same_bits_and_do_not_know_each_other(self):
        sim = lariat.Simulation(block(), hands=1)
        sim.tool_move(0, (0.03, 0.025, 0.035), 100)
        sim.grasp(1, (0.0, 0.0, 0.03))
        sim.advance(150)
        sim.set_stiffness(1.5)
        other = sim.clone()
        self.assertEqual((other.hash(), other.wrench(0), other.options),
                         (sim.hash(), sim.wrench(0), {"hands": 1}))
        self.assertEqual(other.stiffness(0), 1.5)
        third = other.clone()
        for one in (sim, other):
            one.advance(100)
        self.assertEqual(other.hash(), sim.hash())
        other.set_stiffness(0.5)
        other.advance(100)
        sim.advance(100)
        self.assertNotEqual(other.hash(), sim.hash())
        end = sim.hash()
        sim.close()
        del sim, other
        third.advance(200)
        self.assertEqual(third.hash(), end)

    def test_what_cannot_be(self):
        with self.assertRaisesRegex(lariat.UnsupportedError, "processors"):
            lariat.Simulation(block(), grid="2x1x1").clone()
        sim = lariat.Simulation(block())
        sim.close()
        self.assertRaises(lariat.StateError, sim.clone)


class States(unittest.TestCase):
    def test_reset_of_single_members(self):
        batch = lariat.Batch(block(), 4, workers=2)
        start = batch.hashes()[0]
        batch.advance(50)
        saved, then = batch[1].save(), batch.hashes()[0]
        batch.advance(50)
        end = batch.hashes()[0]
        batch.reset([1, 2], saved)
        self.assertEqual(batch.hashes(), (end, then, then, end))
        batch.reset([3])
        self.assertEqual(batch.hashes(), (end, then, then, start))
        batch.advance(50, members=[1])
        self.assertEqual(batch[1].hash(), end)
        states = batch.save()
        batch.reset()
        self.assertEqual(set(batch.hashes()), {start})
        batch.reset(state=states)
        self.assertEqual(batch.hashes(), (end, end, then, start))
        with self.assertRaisesRegex(ValueError, "4 are given for 2 members"):
            batch.reset([0, 1], states)
        with self.assertRaisesRegex(lariat.ArgumentError, "member 0: .*another model"):
            batch.reset([0], lariat.Simulation(block()).save())
        self.assertEqual(batch.hashes(), (end, end, then, start))

    def test_two_poses_for_one_tool_are_refused(self):
        batch = lariat.Batch(block(), 1)
        with self.assertRaisesRegex(lariat.ArgumentError, "^tools: tool 0 is there twice$"):
            batch.set_tool_poses([[[0, 0, 1, 1, 0, 0, 0]] * 2], tools=[0, "probe"])

    def test_saving_changes_nothing_that_tools_felt(self):
        batch = lariat.Batch(block(), 2)
        for sim in batch:
            sim.tool_move("probe", (0.03, 0.025, 0.035), steps=500)
        batch.advance(1000)
        felt = batch.wrenches().tolist()
        self.assertGreater(felt[0][0][2], 0)
        batch.save()
        self.assertEqual(batch.wrenches().tolist(), felt)

    def test_unstable_members_are_named_and_the_others_sound(self):
        batch, alone = lariat.Batch(block(), 5, workers=2), lariat.Simulation(block())
        for i in (3, 1):
            for node in range(130, 160):
                batch[i].set_force(node, (0, 0, 200))
        with self.assertRaisesRegex(lariat.UnstableError, "^member 1: .*1 more") as caught:
            batch.advance(2000)
        self.assertEqual(sorted(caught.exception.members), [1, 3])
        self.assertRegex(caught.exception.members[3], "node|element|step")
        self.assertEqual(caught.exception.status, "unstable")
        for keep in (batch.save, lambda: pickle.dumps(batch)):
            with self.assertRaisesRegex(lariat.UnstableError, "^member 1: its state is not kept, "
                                        "put it back with reset first: .*1 more") as caught:
                keep()
            self.assertEqual(sorted(caught.exception.members), [1, 3])
        poses = batch.tool_poses()
        with self.assertRaisesRegex(lariat.UnstableError, "^member 1: .*1 more") as caught:
            batch.set_tool_poses(poses)
        self.assertEqual(sorted(caught.exception.members), [1, 3])
        alone.advance(2000)
        for i in (0, 2, 4):
            self.assertEqual(batch[i].hash(), alone.hash())
        with self.assertRaises(lariat.UnstableError):
            batch.advance(1, members=[3])
        batch.reset([1, 3])
        batch.advance(2000, members=[3, 1])
        self.assertEqual(set(batch.hashes()), {alone.hash()})
        self.assertEqual([saved.step for saved in batch.save()], [2000] * 5)
        self.assertEqual(pickle.loads(pickle.dumps(batch)).hashes(), batch.hashes())

    def test_a_move_that_is_refused_names_the_member(self):
        batch = lariat.Batch(block(), 3)
        poses = [[pose((0.03, 0.025, 0.04))], [pose((0.03, 0.025, 0.9))], [pose((0.03, 0.025, 0.038))]]
        with self.assertRaisesRegex(lariat.ArgumentError, "member 1: .*take 215 steps") as caught:
            batch.set_tool_poses(poses, 2)
        self.assertEqual(list(caught.exception.members), [1])
        batch.advance(2)
        self.assertEqual([round(p[0][2], 6) for p in batch.tool_poses().tolist()],
                         [0.04, 0.04, 0.038])


class Arrays(unittest.TestCase):
    def setUp(self):
        self.batch = lariat.Batch(block(), 3, hands=1)
        self.batch.advance(20)

    def test_shapes(self):
        nodes = self.batch.node_count
        for call, shape in (("positions", (3, nodes, 3)), ("displacements", (3, nodes, 3)),
                            ("velocities", (3, nodes, 3)), ("wrenches", (3, 2, 6)),
                            ("tool_poses", (3, 2, 7)), ("tool_openings", (3, 2))):
            self.assertEqual(many_shapes(getattr(self.batch, call)()), (shape, "d", True), call)
        self.assertEqual(many_shapes(self.batch.held()), ((3, 2), "i", True))
        self.assertEqual(self.batch.positions().tolist()[2], self.batch[2].positions().tolist())
        self.assertEqual(self.batch.velocities().tolist()[1], self.batch[1].velocities().tolist())

    def test_out_of_ones_own(self):
        nodes = self.batch.node_count
        own = memoryview(bytearray(3 * nodes * 3 * 8)).cast("d", (3, nodes, 3))
        self.assertIs(self.batch.positions(own), own)
        self.assertEqual(own.tolist(), self.batch.positions().tolist())
        for shape, kind in (((3 * nodes, 3), "d"), ((3, nodes, 3), "l"), ((1, 3 * nodes, 3), "d")):
            with self.assertRaisesRegex(ValueError, rf"out: .*\[3, {nodes}, 3\], got"):
                self.batch.positions(memoryview(bytearray(3 * nodes * 3 * 8)).cast(kind, shape))
        with self.assertRaisesRegex(ValueError, "read only"):
            self.batch.positions(memoryview(bytes(3 * nodes * 3 * 8)).cast("d", (3, nodes, 3)))
        with self.assertRaises(TypeError):
            self.batch.positions(5)

    def test_poses_by_buffer_and_lists(self):
        flat = array.array("d", pose((0.03, 0.025, 0.039)) * 3)
        self.batch.set_tool_poses(memoryview(flat).cast("B").cast("d", (3, 1, 7)), 10, tools=["probe"])
        self.batch.advance(10)
        self.assertEqual([p[0][2] for p in self.batch.tool_poses().tolist()], [0.039] * 3)
        self.batch.set_tool_poses([[pose((0.03, 0.025, 0.04)), pose((0, 0, 0.2))]], 10, members=[1],
                                  openings=[[0, 1.0]])
        self.batch.advance(10)
        self.assertEqual([p[0][2] for p in self.batch.tool_poses().tolist()], [0.039, 0.04, 0.039])

    def test_what_learners_see_is_what_there_is(self):
        nodes = [5, 0, 167]
        self.batch.set_tool_poses([[pose((0.03, 0.025, 0.036))]] * 2, 60, tools=[0], members=[0, 2])
        self.batch.advance(100)
        rows = self.batch.observe(nodes).tolist()
        for i, row in enumerate(rows):
            sim, force = self.batch[i], self.batch[i].tool_force(0)
            places = sim.positions().tolist()
            self.assertEqual(row, [*sim.tool_pose(0)["position"], sim.tool_pose(0)["opening"],
                                   *sim.wrench(0), force["held"],
                                   *(k for n in nodes for k in places[n])])
        self.assertNotEqual(rows[0][4:7], [0, 0, 0])
        self.assertEqual(many_shapes(self.batch.observe(())), ((3, 11), "d", True))
        for wrong in ([-1], [10**6], [[1, 2]], "abc", 5):
            with self.assertRaises((ValueError, TypeError)):
                self.batch.observe(wrong)
        bare = {**SCENE, "tools": []}
        arrays = block_arrays()
        with self.assertRaisesRegex(ValueError, "no tool"):
            lariat.Batch(lariat.Model.from_arrays(*arrays[:2], bare, sets=arrays[2]), 1).observe([0])

    def test_hands_take_hold(self):
        top = [0.03, 0.02, 0.03]
        self.batch.set_tool_poses([[pose(top)]] * 2, tools=[1], openings=[[0.0]] * 2, members=[0, 2])
        held = self.batch.held().tolist()
        self.assertTrue(held[0][1] > 0 and held[2][1] == held[0][1] and held[1][1] == 0, held)

    @unittest.skipUnless(numpy, WITHOUT_NUMPY)
    def test_masks_are_not_numbers(self):
        with self.assertRaisesRegex(TypeError, "flatnonzero"):
            self.batch.advance(1, members=numpy.array([True, False, True]))
        self.batch.advance(1, members=numpy.flatnonzero([True, False, True]))
        self.assertEqual(self.batch.steps(), (21, 20, 21))

    @unittest.skipUnless(numpy, WITHOUT_NUMPY)
    def test_numpy(self):
        x = numpy.empty((3, self.batch.node_count, 3))
        self.assertIs(self.batch.positions(out=x), x)
        rest = numpy.asarray(self.batch[0].model.positions)
        self.assertTrue(numpy.allclose(x - rest, numpy.asarray(self.batch.displacements())))
        poses = numpy.asarray(self.batch.tool_poses())
        self.batch.set_tool_poses(poses[:1], 10, members=numpy.array([2]))
        for wrong in (poses.astype(numpy.float32), poses[:, ::-1], poses[:2], poses[:, :, :6],
                      numpy.full_like(poses, numpy.nan), poses.astype(object)):
            with self.assertRaisesRegex(ValueError, "poses: "):
                self.batch.set_tool_poses(wrong, 10)
        with self.assertRaises(TypeError):
            self.batch.set_tool_poses("no", 10)


class Closes:
    """A number that closes the batch when it is looked at."""

    def __init__(self, batch):
        self.batch = batch

    def __index__(self):
        self.batch.close()
        return 0

    def __float__(self):
        self.batch.close()
        return 0.03


class Misuse(unittest.TestCase):
    def test_numbers_that_run_code(self):
        place = [0.025, 0.04, 1.0, 0.0, 0.0, 0.0]
        for call in (lambda b, evil: b.set_tool_poses([[[evil, *place]]] * 2),
                     lambda b, evil: b.set_tool_poses([[[0.03, *place]]] * 2, tools=[evil]),
                     lambda b, evil: b.set_tool_poses([[[0.03, *place]]] * 2, evil),
                     lambda b, evil: b.set_tool_poses([[[0.03, *place]]] * 2, openings=[[evil]] * 2),
                     lambda b, evil: b.advance(evil), lambda b, evil: b.advance(seconds=evil),
                     lambda b, evil: b.advance(1, members=[evil]),
                     lambda b, evil: b.reset([evil])):
            batch = lariat.Batch(block(), 2)
            with self.assertRaises((lariat.StateError, ValueError)):
                call(batch, Closes(batch))
            self.assertTrue(batch.closed)

    def test_of_the_constructor(self):
        model, other = block(), lariat.Model.from_arrays(*block_arrays((2, 2, 2))[:2])
        sim, grid = lariat.Simulation(model), lariat.Simulation(model, grid="2x1x1")
        closed = lariat.Simulation(model)
        closed.close()
        for arguments, options in (((model,), {}), ((model, 0), {}), ((model, -1), {}), (([],), {}),
                                   (([model], 2), {}), (([model, other],), {}), (([sim, sim],), {}),
                                   (([grid],), {}), ((model, 1), {"workers": -1}),
                                   ((model, 1), {"workers": 10**9}), ((model, 1), {"element": "x"}),
                                   ((model, 1), {"hands": -1})):
            with self.assertRaises(ValueError, msg=(arguments, options)):
                lariat.Batch(*arguments, **options)
        for arguments, options in (((), {}), ((5,), {}), (("model", 3), {}), ((model, 1.5), {}),
                                   ((model, 1), {"grid": "2x1x1"}), ((model, 1), {"threads": 2}),
                                   ((model, 1), {"colour": 1}), (([sim],), {"hands": 1}),
                                   (([model, None],), {}), ((model, 1), {"workers": "2"})):
            with self.assertRaises(TypeError, msg=(arguments, options)):
                lariat.Batch(*arguments, **options)
        with self.assertRaisesRegex(lariat.StateError, "member 1: .*closed"):
            lariat.Batch([sim, closed])

    def test_of_the_calls(self):
        batch = lariat.Batch(block(), 2)
        for arguments, options in (((), {}), ((1,), {"seconds": 1}), ((1.5,), {}), (("1",), {}),
                                   ((1, 2), {}), ((1,), {"members": 5}), ((1,), {"members": ["a"]}),
                                   ((1,), {"members": "01"}), ((1,), {"other": 5}),
                                   ((1,), {"members": [True, False]})):
            with self.assertRaises(TypeError, msg=(arguments, options)):
                batch.advance(*arguments, **options)
        for arguments, options in (((-1,), {}), ((2**64,), {}), ((), {"seconds": -1.0}),
                                   ((), {"seconds": float("nan")}), ((), {"seconds": 1e300}),
                                   ((1,), {"members": [2]}), ((1,), {"members": [-1]}),
                                   ((1,), {"members": [0, 0]}), ((1,), {"members": [2**40]})):
            with self.assertRaises(ValueError, msg=(arguments, options)):
                batch.advance(*arguments, **options)
        batch.advance(3, members=[])
        for wrong in ([], [[pose((0, 0, 0))]], [[pose((0, 0, 0))], []], [[[0] * 7]] * 2,
                      [[pose((0, 0, float("inf")))]] * 2):
            with self.assertRaises(ValueError):
                batch.set_tool_poses(wrong)
        for wrong in (5, None, [5, 5], "ab"):
            with self.assertRaises((TypeError, ValueError)):
                batch.set_tool_poses(wrong)
        good = [[pose((0.03, 0.025, 0.04))]] * 2
        for options in ({"tools": [1]}, {"tools": ["none"]}, {"tools": [0] * 21},
                        {"openings": [[1.0]]}, {"openings": [[float("nan")]] * 2},
                        {"steps": 0}, {"steps": -1}):
            with self.assertRaises(ValueError, msg=options):
                batch.set_tool_poses(good, **options)
        for options in ({"tools": "probe"}, {"tools": 0}, {"openings": "x"}, {"steps": 1.0}):
            with self.assertRaises(TypeError, msg=options):
                batch.set_tool_poses(good, **options)
        for wrong in (5, "state", [5, 5]):
            with self.assertRaises(TypeError):
                batch.reset(state=wrong)
        self.assertRaises(IndexError, lambda: batch[2])
        self.assertEqual(batch.steps(), (0, 0))

    def test_after_close(self):
        batch = lariat.Batch(block(), 2)
        batch.close()
        batch.close()
        self.assertTrue(batch.closed)
        self.assertIn("closed", repr(batch))
        self.assertEqual(len(batch), 0)
        for call in (lambda: batch.advance(1), batch.positions, batch.hashes, batch.steps, batch.save,
                     batch.reset, batch.wrenches, lambda: batch[0], lambda: pickle.dumps(batch),
                     lambda: batch.set_tool_poses([])):
            self.assertRaises(lariat.StateError, call)
        batch = lariat.Batch(block(), 2)
        batch[1].close()
        with self.assertRaisesRegex(lariat.StateError, "member 1: .*closed"):
            batch.advance(1)
        self.assertEqual(batch[0].step, 0)
        batch.advance(1, members=[0])

    def test_members_that_are_elsewhere(self):
        batch = lariat.Batch(block(), 2)
        with lariat.Session(batch[1]):
            with self.assertRaisesRegex(lariat.StateError, "member 1: .*session"):
                batch.advance(1)
            batch.advance(1, members=[0])
        batch.advance(1)

    def test_a_second_thread_is_refused(self):
        batch, refused = lariat.Batch(block(), 4, workers=2), []
        alone = lariat.Simulation(block())
        thread = threading.Thread(target=batch.advance, args=(20000,))
        thread.start()
        while thread.is_alive() and len(refused) < 100:
            for call in (batch.positions, batch.hashes, batch.close, batch[2].hash, batch.save,
                         lambda: batch.reset([0])):
                if "computing" not in repr(batch[0]):
                    break
                try:
                    call()
                except lariat.StateError as error:
                    refused.append(str(error))
        thread.join()
        self.assertGreater(len(refused), 0)
        alone.advance(20000)
        self.assertEqual(set(batch.hashes()), {alone.hash()})

    def test_ctrl_c_and_fork(self):
        head = "import os, sys, signal, threading, lariat\nfrom common import block\n"
        for workers in (1, 2):
            status, said, error = child(
                head + f"batch = lariat.Batch(block(), 3, workers={workers})\n"
                "threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()\n"
                "try:\n    batch.advance(10**9)\n"
                "except KeyboardInterrupt:\n"
                "    sim = lariat.Simulation(batch[0].model); sim.advance(batch[0].step)\n"
                "    print(batch[0].hash() == sim.hash(), sim.step > 0); batch.advance(1)\n")
            self.assertEqual((status, said), (0, "True True\n"), error)
        status, said, error = child(
            head + "batch = lariat.Batch(block(), 3, workers=2); batch.advance(10)\n"
            "pid = os.fork()\n"
            "batch.advance(10)\n"
            "os.write(1, f'{batch.hashes()}\\n'.encode())\n"  # whole lines
            "del batch\n"
            "if pid: assert os.waitpid(pid, 0)[1] == 0\n")
        self.assertEqual(status, 0, error)
        self.assertEqual(len(set(said.splitlines())), 1)
        self.assertEqual(len(said.splitlines()), 2)

    def test_the_program_ends_while_it_computes(self):
        status, _, error = child(
            "import threading, time, lariat\nfrom common import block\n"
            "batch = lariat.Batch(block(), 3, workers=2)\n"
            "threading.Thread(target=batch.advance, args=(10**12,), daemon=True).start()\n"
            "time.sleep(0.2)\n")
        self.assertEqual(status, 0, error)

    def test_threads_sleep_between_calls(self):
        batch = lariat.Batch(block(), 4, workers=4)
        batch.advance(10)
        before = time.process_time()
        time.sleep(0.3)
        self.assertLess(time.process_time() - before, 0.05)

    @unittest.skipIf(SANITIZED, "sanitizers keep what was freed")
    def test_nothing_grows(self):
        full = bool(os.environ.get("LARIAT_TEST_FULL"))
        model = block()
        batch = lariat.Batch(model, 2, workers=2)
        saved = batch[0].save()
        out = memoryview(bytearray(2 * batch.node_count * 24)).cast("d", (2, batch.node_count, 3))
        for i in range(100000 if full else 3000):
            if i == 500:
                before = resident()
            batch.reset([i % 2], saved)
            batch.positions(out)
        for i in range(2500 if full else 100):
            with lariat.Batch(model, 4, workers=2) as more:
                more.advance(1)
                more.save()
            del more
        gc.collect()
        self.assertLess(resident() - before, 8 << 20)


if __name__ == "__main__":
    unittest.main()
