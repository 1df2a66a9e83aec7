"""Threads, forks, Ctrl-C, exceptions in callbacks, closing in the middle: an exception, never a crash."""

import inspect
import os
import re
import threading
import time
import unittest

import lariat
from common import block, child

HEAD = "import os, sys, signal, threading, time, lariat\nfrom common import block\n"


class Callbacks(unittest.TestCase):
    def setUp(self):
        self.sim = lariat.Simulation(block())

    def test_exceptions_pass_through_and_false_ends(self):
        def fail(_):
            raise KeyError("mine")
        with self.assertRaisesRegex(KeyError, "mine"):
            self.sim.advance(100, callback=fail, every=10)
        self.assertEqual(self.sim.step, 10)
        self.assertEqual(self.sim.advance(100, callback=lambda s: s.step < 40, every=10), 30)
        self.assertEqual(self.sim.step, 40)

    def test_the_simulation_may_be_used_changed_and_advanced(self):
        def more(sim):
            sim.gravity = (0, 0, -1)
            sim.advance(1)
        self.sim.advance(20, callback=more, every=10)
        self.assertEqual(self.sim.step, 22)

    def test_what_is_no_vector_and_what_stays(self):
        for source in (b"abc", bytearray(b"abc"), "abc"):
            with self.assertRaisesRegex(TypeError, "sequence of 3 numbers"):
                self.sim.set_force(3, source)
        with self.assertRaisesRegex(TypeError, "cannot be deleted"):
            del self.sim.gravity
        with self.assertRaisesRegex(lariat.ArgumentError, "no parameter 'c9'"):
            self.sim.parameter(0, "c9")

    def test_options_that_are_none(self):
        model = block()
        for option, words in ({"scheme": "x"}, "no communication scheme x"), ({"pin": 9}, "pin is 9"):
            with self.assertRaisesRegex(lariat.ArgumentError, words):
                lariat.Simulation(model, **option)
        with self.assertRaisesRegex(lariat.ArgumentError, "hash_every: .* from 0 on, got -1"):
            lariat.Session(self.sim, hash_every=-1)

    def test_closing_in_the_middle(self):
        with self.assertRaisesRegex(lariat.StateError, "closed"):
            self.sim.advance(20, callback=lambda s: s.close(), every=10)


class Numbers(unittest.TestCase):
    """Numbers that are none, that are too large, or of another unit: which, and what was expected."""

    def setUp(self):
        self.sim = lariat.Simulation(block(), spares=2, hands=1)

    def refuses(self, words, call, kind=lariat.ArgumentError):
        with self.assertRaisesRegex(kind, words) as caught:
            call()
        self.assertNotRegex(str(caught.exception), r"lar_|LAR_|\bNULL\b|\binf\b(?<!got inf)")

    def test_rays(self):
        sim = self.sim
        self.refuses("^origin: .* none beyond 1e30$", lambda: sim.ray((1e300, 0, 0), (0, 0, 1)))
        self.refuses("^origins: row 1: .*1e30$",
                     lambda: sim.rays([(0, 0, 1), (1e300, 0, 0)], [(0, 0, 1)] * 2))
        self.refuses("^direction: .* cannot all be 0$", lambda: sim.ray((0, 0, 1), (0, 0, 0)))
        self.refuses("^directions: row 0: .* cannot all be 0$",
                     lambda: sim.model.rays([(0, 0, 1)], [(0, 0, 0)]))
        for longest in (-1, float("nan")):
            self.refuses("^longest: expected the longest distance, 0 or more, or None for any, got",
                         lambda: sim.ray((0, 0, 1), (0, 0, -1), longest))
        self.refuses("^longest: expected a number, got <class 'str'>",
                     lambda: sim.ray((0, 0, 1), (0, 0, -1), "x"), TypeError)
        far = [[0.0] * 3 for _ in range(sim.model.node_count)]
        far[7][2] = 1e300
        self.refuses("^displacements: row 7 ", lambda: sim.model.rays(
            [(0, 0, 1)], [(0, 0, -1)], displacements=far))

    def test_sizes_and_angles_of_tools(self):
        sim = self.sim
        with lariat.Session(lariat.Simulation(block(), spares=1)) as session:
            for add in (sim.add_tool, session.add_tool):
                self.refuses("^radius: expected metres, got 1e.300$", lambda: add("sphere", 1e300))
                self.refuses("^a length of 1000 mm is too large", lambda: add("capsule", 0.01, 1))
                self.refuses("^radius: .*finite", lambda: add("sphere", float("inf")))
                self.refuses("^length: .*finite", lambda: add("capsule", 0.01, float("nan")))
                self.refuses("^spread: .*radians.* got 50; math.radians",
                             lambda: add("grasper", 0.002, 0.02, 50))
                self.refuses("^spread: .*less than pi.* got -1$",
                             lambda: add("grasper", 0.002, 0.02, -1))
                self.refuses("^shape: expected a text", lambda: add(3, 0.01), TypeError)
                self.refuses("^radius: expected a number", lambda: add("sphere", "x"), TypeError)
            # Those of a scene are degrees: those of the model and of calls radians.
            self.assertGreater(sim.add_tool("grasper", 0.002, 0.02, 0.9), 0)

    def test_steps_and_seconds(self):
        sim = self.sim
        sim.advance(3)
        for call in (sim.advance, lambda n: sim.tool_move(0, (0, 0, 1), steps=n),
                     lambda n: sim.advance(1, callback=print, every=n)):
            self.refuses(r"at most 2\^53, got 18446744073709551615$", lambda: call(2**64 - 1))
            self.refuses(r"from 0 on, got -1$", lambda: call(-1))
            self.refuses("expected a whole number, got 1e.300$", lambda: call(1e300), TypeError)
        for call in (sim.advance, sim.rest):
            self.refuses("^seconds: expected at most .* steps., got 1e.300$",
                         lambda: call(seconds=1e300))
            self.refuses("^seconds: expected a finite number, got inf",
                         lambda: call(seconds=float("inf")))
        self.assertEqual(sim.step, 3)

    def test_options_are_named(self):
        model = self.sim.model
        for name, value, kind, words in (
                ("hands", 1.5, TypeError, "a whole number, got 1.5"),
                ("spares", 2**40, ValueError, "beyond all bounds"),
                ("time_step", "x", TypeError, "a number, got"), ("time_step", -1, ValueError, "got -1"),
                ("tick", float("inf"), ValueError, "finite"), ("tick", 1e300, ValueError, "1e6"),
                ("element", 3, TypeError, "a text"), ("grid", 2, TypeError, "a text")):
            self.refuses(f"^{name}: .*{words}", lambda: lariat.Simulation(model, **{name: value}), kind)
        self.refuses("^element: .*hex8, hex8-full, hex8-matrix$",
                     lambda: lariat.Simulation(model, element="hex"))
        for name, value in (("tick", -1), ("pace", 1e300), ("tool_speed", float("nan")),
                            ("hand_force", "x"), ("priority", 1.5), ("hash_every", 2**70)):
            self.refuses(f"^{name}: ", lambda: lariat.Session(self.sim, **{name: value}),
                         (ValueError, TypeError))
        self.refuses("^node: ", lambda: self.sim.force(10**30))
        self.refuses("^node: there is no node 168; the model has 168", lambda: self.sim.support(168))
        self.refuses("no steps|1e.09 times|below 1e.100",
                     lambda: self.sim.set_parameter("soft", "shear_modulus", 1e300))


class Texts(unittest.TestCase):
    """Texts that are none, and the library's words in those of Python."""

    def test_half_of_a_pair_of_surrogates_and_a_zero(self):
        sim, bad = lariat.Simulation(block(), spares=1), "a\ud800"
        session = lariat.Session(lariat.Simulation(block()))
        self.addCleanup(session.close)
        calls = {
            "tool": lambda t: sim.tool_pose(t), "material": lambda t: sim.stiffness(t),
            "where": lambda t: sim.set_force(t), "axes": lambda t: sim.set_support(0, axes=t),
            "name": lambda t: sim.field(t), "cause": lambda t: sim.nodal_forces(t),
            "shape": lambda t: sim.add_tool(t, 0.01), "device": lambda t: session.attach(0, t),
            "grid": lambda t: lariat.Simulation(sim.model, grid=t), "target": sim.save,
            "source": sim.load, "path": lariat.Model, "folder": lariat.write_demo,
            "address": lambda t: session.view(open=False, address=t),
            "scene.title": lambda t: block(title=t), "model": lariat.info,
            "title": lambda t: lariat.mesh([[0, 0, 0]], [[0, 0, 0]], title=t)}
        for name, call in calls.items():
            with self.assertRaisesRegex(lariat.ArgumentError,
                                        f"^{re.escape(name)}: character 1 of the text.*surrogates"):
                call(bad)
            if name not in ("scene.title", "model"):
                with self.assertRaisesRegex(lariat.ArgumentError, f"^{name}: .*character 0"):
                    call("a\0b")

    def test_empty_paths_and_other_things(self):
        sim = lariat.Simulation(block())
        for call in (lariat.Model, sim.save, sim.load, lariat.checkpoint_info):
            with self.assertRaisesRegex(lariat.ArgumentError, "expected a path, got ''"):
                call("")
        with self.assertRaisesRegex(TypeError, "^source: expected a Saved, or the path"):
            sim.load(3)
        with self.assertRaisesRegex(TypeError, "^target: expected a Saved, or a path"):
            sim.save(3)

    def test_no_name_of_c_reaches_python(self):
        sim, grid = lariat.Simulation(block(), spares=1), lariat.Simulation(block(), grid="2x1x1")
        alone = lariat.Simulation(block())
        with lariat.Session(lariat.Simulation(block(), spares=1)) as session:
            for call, words in (
                    (lambda: sim.set_force("none", (0, 0, 1)), "Model.sets lists"),
                    (lambda: sim.set_support("none"), "Model.sets lists"),
                    (lambda: session.set_support("none"), "Model.sets lists"),
                    (lambda: sim.set_force(10**6, (0, 0, 1)), r"clear_forces\(\) removes all"),
                    (lambda: sim.set_stiffness(2, 7), "; None means all"),
                    (lambda: sim.tool_move(1, (0, 0, 1)), "add one with add_tool"),
                    (lambda: session.tool_move(1, (0, 0, 1)), "add one with add_tool"),
                    (lambda: alone.add_tool("sphere", 0.01), "make the Simulation with spares="),
                    (lambda: session.attach(0, ""), "^device: "),
                    (lambda: lariat.Simulation(sim.model, time_step=1), "time_step=0"),
                    (lambda: lariat.Model("a.checkpoint"), r"load\(\) it there; as a command"),
                    (lambda: lariat.mesh([[0, 0, 0]], [[0, 0, 0]], elements=-1), "^elements: "),
                    (lambda: lariat.mesh([[0, 0, 0]], [[0, 0, 0]], size=-1), "^size: "),
                    (grid.clone, "with save and load")):
                with self.assertRaisesRegex(lariat.Error, words) as caught:
                    call()
                self.assertNotRegex(str(caught.exception), "lar_|LAR_|NULL|options|, and -1")


class Sly:
    """A number that does something when it is read."""

    def __init__(self, do):
        self.do = do

    def __index__(self):
        self.do()
        return 0

    def __float__(self):
        self.do()
        return 0.0


class Closing(unittest.TestCase):
    def test_while_a_number_is_read(self):
        """What is freed meanwhile is not used."""
        model = block()
        for call in (lambda s, n: s.advance(seconds=n), lambda s, n: s.rest(seconds=n),
                     lambda s, n: s.tool_pose(n), lambda s, n: s.remove_tool(n),
                     lambda s, n: s.tool_move(n, (0, 0, 1)), lambda s, n: s.tool_touches(n),
                     lambda s, n: s.nodal_forces("tool", n), lambda s, n: s.force(n),
                     lambda s, n: s.set_stiffness(n), lambda s, n: s.ray((n, 0, 0), (0, 0, 1))):
            sim = lariat.Simulation(model, hands=1)
            with self.assertRaisesRegex(lariat.StateError, "closed"):
                call(sim, Sly(sim.close))
        for call in (lambda s, n: s.step(n), lambda s, n: s.set_pace(n), lambda s, n: s.seek(n),
                     lambda s, n: s.snapshot(n), lambda s, n: s.tool_force(n), lambda s, n: s.felt(n),
                     lambda s, n: s.force_history(0, n), lambda s, n: s.add_tool("sphere", n),
                     lambda s, n: s.tool_move(0, (n, 0, 1)), lambda s, n: s.view(open=False, port=n)):
            session = lariat.Session(lariat.Simulation(model, hands=1))
            with self.assertRaisesRegex(lariat.StateError, "closed"):
                call(session, Sly(session.close))
        batch = lariat.Batch(model, 2)
        with self.assertRaisesRegex(lariat.StateError, "closed"):
            batch.set_tool_poses([[[0, 0, 1, 1, 0, 0, 0]]] * 2, tools=[Sly(batch.close)])


class Threads(unittest.TestCase):
    def test_a_second_thread_is_refused_and_the_bits_stay(self):
        model = block()
        sim, alone = lariat.Simulation(model), lariat.Simulation(model)
        calls = [lambda: sim.advance(1), sim.positions, sim.hash, sim.energies, sim.close, sim.save,
                 sim.reset, lambda: sim.step, lambda: sim.tool_touches(0), lambda: sim.time,
                 lambda: sim.tool_force(0), lambda: lariat.Session(sim), lambda: sim.set_force(0)]
        wrong, refused, begun = [], [], threading.Event()

        def compute():
            begun.set()
            sim.advance(20000)
        thread = threading.Thread(target=compute)
        thread.start()
        begun.wait()
        while thread.is_alive() and not sim_is_busy(sim):
            pass
        while thread.is_alive() and len(refused) < 200:
            for call in calls:
                if not thread.is_alive() or not sim_is_busy(sim):
                    break
                try:
                    call()
                    wrong.append(call)
                except lariat.StateError:
                    refused.append(call)
            repr(sim)
        thread.join()
        # Whoever came after the end was let in, rightly: one call at most.
        self.assertLessEqual(len(wrong), 1)
        self.assertGreater(len(refused), 0)
        if not wrong:
            alone.advance(20000)
            self.assertEqual(sim.hash(), alone.hash())

    def test_others_run_meanwhile(self):
        sim, counted = lariat.Simulation(block()), [0]
        done = threading.Event()

        def count():
            while not done.is_set():
                counted[0] += 1
        thread = threading.Thread(target=count)
        thread.start()
        before = counted[0]
        sim.advance(5000)
        during = counted[0] - before
        done.set()
        thread.join()
        self.assertGreater(during, 0)

    def test_one_model_and_many_threads(self):
        model, hashes = block(), []

        def run():
            with lariat.Simulation(model) as sim:
                sim.advance(200)
                hashes.append(sim.hash())
        threads = [threading.Thread(target=run) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual((len(hashes), len(set(hashes))), (8, 1))


def sim_is_busy(sim):
    return "computing" in repr(sim)


class Processes(unittest.TestCase):
    def runs(self, code, status=0):
        got, said, error = child(HEAD + code)
        self.assertEqual(got, status, said + error)
        return said

    def test_ctrl_c(self):
        for options in ("", ", grid='2x1x1'"):
            said = self.runs(f"sim = lariat.Simulation(block(){options})\n"
                             "threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()\n"
                             "try:\n    sim.advance(10**9)\n"
                             "except KeyboardInterrupt:\n"
                             "    step = sim.step\n"
                             "    again = lariat.Simulation(sim.model)\n"
                             "    again.advance(step)\n"
                             "    print('stopped', sim.hash() == again.hash(), step > 0)\n")
            self.assertEqual(said, "stopped True True\n")

    def test_fork(self):
        # The sanitizer's memory has a lock that a fork copies as it is; threads that have begun
        # ask for none.
        said = self.runs("model = block()\n"
                         "plain = lariat.Simulation(model)\n"
                         "grid = lariat.Simulation(model, grid='2x1x1')\n"
                         "held = lariat.Simulation(model)\n"
                         "session = lariat.Session(held)\n"
                         "plain.advance(10); grid.advance(10)\n"
                         "time.sleep(0.3)\n"
                         "sys.stdout.flush()\n"
                         "pid = os.fork()\n"
                         "if pid == 0:\n"
                         "    words = []\n"
                         "    plain.advance(10)\n"
                         "    for call in (lambda: grid.advance(1), grid.close, session.snapshot,\n"
                         "                 session.close, held.save, lambda: session.status()):\n"
                         "        try:\n            call(); words.append('none')\n"
                         "        except lariat.StateError as e: words.append('fork' in str(e))\n"
                         "    fresh = lariat.Simulation(model, grid='2x1x1'); fresh.advance(20)\n"
                         "    print(words, fresh.hash() == plain.hash())\n"
                         "    del grid, session, held, fresh\n"
                         "    sys.exit(0)\n"
                         "print(os.waitpid(pid, 0)[1]); plain.advance(10); grid.advance(10)\n"
                         "print(plain.hash() == grid.hash())\n")
        self.assertEqual(said.splitlines()[1:], ["0", "True"])
        self.assertNotIn("none", said)
        self.assertIn("True] True", said)

    def test_the_program_ends_while_everything_is_open(self):
        self.runs("import tempfile\n"
                  "path = tempfile.mkdtemp() + '/recording'\n"
                  "sim = lariat.Simulation(block(), grid='2x1x1')\n"
                  "session = lariat.Session(sim, record=path)\n"
                  "time.sleep(0.2)\n"
                  "sys.modules['kept'] = (sim, session)\n")
        self.runs("sim = lariat.Simulation(block())\n"
                  "threading.Thread(target=sim.advance, args=(10**12,), daemon=True).start()\n"
                  "time.sleep(0.1)\n")

    def test_spawned_workers_take_pickles(self):
        self.runs("import multiprocessing\n"
                  "if __name__ == '__main__':\n"
                  "    sim = lariat.Simulation(block()); sim.advance(10)\n"
                  "    import pickle\n"
                  "    assert pickle.loads(pickle.dumps(sim)).hash() == sim.hash()\n")

    def test_it_is_there_at_once_and_without_numpy(self):
        status, said, error = child("import sys, lariat\nprint('numpy' in sys.modules)\n")
        self.assertEqual((status, said), (0, "False\n"), error)


class Words(unittest.TestCase):
    """Everything has a docstring and a line in the stub, and the stub nothing else."""

    def test_docstrings_and_stub(self):
        with open(os.path.join(os.path.dirname(lariat.__file__), "__init__.pyi"),
                  encoding="utf-8") as file:
            stub = file.read()
        bodies = dict(re.findall(r"^class (\w+)[^\n]*:\n((?:    .*\n|\n)+)", stub, re.M))
        for name, thing in vars(lariat).items():
            if name.startswith("_") or inspect.ismodule(thing):
                continue
            self.assertTrue(thing.__doc__, name)
            self.assertRegex(stub, rf"\b(def|class) {name}\b")
            if not inspect.isclass(thing) or issubclass(thing, Exception):
                continue
            members = {m for m in vars(thing) if not m.startswith("_")}
            told = set(re.findall(r"^    (?:def )?(\w+)[(:]", bodies[name], re.M))
            self.assertEqual(members, {m for m in told if not m.startswith("_")}, name)
            for member in members:
                self.assertTrue(getattr(thing, member).__doc__, f"{name}.{member}")
        self.assertTrue(os.path.exists(os.path.join(os.path.dirname(lariat.__file__), "py.typed")))


if __name__ == "__main__":
    unittest.main()
