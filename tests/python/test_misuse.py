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

    def test_options_that_are_none(self):
        model = block()
        for option, words in ({"scheme": "x"}, "no communication scheme x"), ({"pin": 9}, "pin is 9"):
            with self.assertRaisesRegex(lariat.ArgumentError, words):
                lariat.Simulation(model, **option)
        with self.assertRaisesRegex(lariat.ArgumentError, "0 or more steps"):
            lariat.Session(self.sim, hash_every=-1)

    def test_closing_in_the_middle(self):
        with self.assertRaisesRegex(lariat.StateError, "closed"):
            self.sim.advance(20, callback=lambda s: s.close(), every=10)


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
