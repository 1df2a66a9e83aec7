"""class Session and class View: real time, tools, snapshots; misuse."""

import os
import tempfile
import threading
import time
import unittest
import urllib.request

import lariat
from common import EDGE, block


def wait_until(condition, seconds=60):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            raise AssertionError("nothing came of it within a minute")
        time.sleep(0.002)


class Stopped(unittest.TestCase):
    """A run that has broken off: the class of errors that advance has, until it is taken up."""

    def test_what_would_change_it_is_refused_until_a_reset(self):
        sim = lariat.Simulation(block(), hands=1, spares=1)
        session = lariat.Session(sim, pace=0, stop_when_unstable=True)
        self.addCleanup(session.close)
        session.set_force("top", (0, 0, 250))
        wait_until(lambda: session.status()["state"] == "stopped")
        calls = (lambda: setattr(session, "gravity", None), lambda: setattr(session, "damping", 1),
                 lambda: session.set_stiffness(2), lambda: session.set_support(0),
                 lambda: session.set_force(0, (0, 0, 1)), session.clear_forces,
                 lambda: session.add_tool("sphere", 0.01), lambda: session.remove_tool(2),
                 lambda: session.grasp(1, (0, 0, 0.03)), lambda: session.release(1),
                 lambda: session.tool_move(0, (0, 0, 0.1)), session.play,
                 lambda: session.step(3))
        for call in calls:
            with self.assertRaisesRegex(lariat.UnstableError, "the run has broken off; reset"):
                call()
        session.close()
        with self.assertRaisesRegex(lariat.UnstableError, "the run has broken off"):
            sim.gravity = None
        session = lariat.Session(sim, pace=0)
        session.reset()
        session.step(3)
        wait_until(lambda: session.status()["step"] >= 3)
        session.close()
        sim.gravity = None


class Sessions(unittest.TestCase):
    def setUp(self):
        self.sim = lariat.Simulation(block(), hands=1, spares=1)
        self.session = lariat.Session(self.sim)
        self.addCleanup(self.session.close)

    def test_a_step_is_one_at_least(self):
        with self.assertRaisesRegex(lariat.ArgumentError, "one at least, got 0"):
            self.session.step(0)

    def test_it_runs_and_the_simulation_is_its_own_until_it_is_closed(self):
        wait_until(lambda: self.session.status()["step"] > 20)
        for call in (lambda: self.sim.advance(1), self.sim.positions, self.sim.save,
                     self.sim.close, lambda: self.sim.step, lambda: lariat.Session(self.sim)):
            with self.assertRaisesRegex(lariat.StateError, "session"):
                call()
        self.assertGreater(self.sim.time_step, 0)
        shot = self.session.snapshot()
        self.assertEqual(shot["displacements"].shape, (168, 3))
        self.session.close()
        self.assertGreaterEqual(self.sim.step, shot["step"])
        self.sim.advance(1)
        with self.assertRaisesRegex(lariat.StateError, "closed"):
            self.session.snapshot()

    def test_calls_that_only_ask_return_none_and_check_what_they_are_given(self):
        for call in (self.session.play, self.session.pause, lambda: self.session.step(1),
                     lambda: self.session.set_pace(1)):
            self.assertIsNone(call())
        for words, call in (("no recording is being played", lambda: self.session.seek(1)),
                            ("^seconds: .* from 0", lambda: self.session.seek(-1)),
                            ("^pace: .* to 1e6", lambda: self.session.set_pace(1e300)),
                            ("^steps: expected at most", lambda: self.session.step(2**64 - 1)),
                            ("^timeout: .* got nan", lambda: self.session.snapshot(float("nan"))),
                            ("^after: .* from 0 on", lambda: self.session.force_history(0, -1))):
            with self.assertRaisesRegex(lariat.ArgumentError, words):
                call()
        with self.assertRaisesRegex(TypeError, "^timeout: expected a number"):
            self.session.snapshot("x")

    def test_the_snapshot_is_the_state_of_its_hash(self):
        self.session.pause()
        wait_until(lambda: self.session.status()["state"] == "paused")
        shot = self.session.snapshot()
        self.session.close()
        self.assertEqual((self.sim.step, self.sim.hash()), (shot["step"], shot["hash"]))
        self.assertEqual(self.sim.displacements().tolist(), shot["displacements"].tolist())
        self.assertGreater(len(shot["tools"]), 1)
        self.assertEqual({tuple(sorted(t)) for t in shot["tools"]}, {("force", "pose", "torque")})

    def test_a_probe_presses_and_a_hand_lifts(self):
        self.session.tool_move("probe", (0.03, 0.025, 0.033))
        wait_until(lambda: self.session.tool_force("probe")["touching"] > 0)
        self.assertGreater(len(self.session.tool_touches("probe")), 0)
        self.assertEqual(len(self.session.wrench("probe")), 6)
        # What the hand feels is the coupling's, which comes to bear what the tissue does.
        wait_until(lambda: self.session.wrench("probe")[2] > 0 and abs(
            self.session.felt("probe")[2] / self.session.wrench("probe")[2] - 1) < 0.1)
        self.assertEqual(self.session.felt(1), (0.0,) * 6)
        with self.assertRaisesRegex(lariat.ArgumentError, "tool"):
            self.session.felt("nobody's")
        place = (0.01, 0.01, 3 * EDGE)
        self.assertGreater(self.session.grasp(1, place), 0)
        self.session.tool_move(1, (0.01, 0.01, 3 * EDGE + 0.003))
        wait_until(lambda: self.session.wrench(1)[2] < 0)
        self.assertGreater(self.session.tool_force(1)["held"], 0)
        self.session.release(1)
        wait_until(lambda: self.session.tool_force(1)["held"] == 0)
        forces, last = self.session.force_history("probe")
        self.assertEqual((forces.shape[1], last > 0), (3, True))
        self.assertEqual(self.session.tools[0]["name"], "probe")
        self.assertGreater(self.session.tool_load("probe")["limit"], 0)
        self.assertIsNone(self.session.device("probe"))

    def test_changes_and_states(self):
        saved_by = lariat.Simulation(self.sim.model, hands=1, spares=1)
        saved = saved_by.save()
        self.session.gravity = (0, -9.81, 0)
        wait_until(lambda: self.session.gravity == (0, -9.81, 0))
        self.session.set_force("top", (0, 0, 0.001))
        self.session.set_support("top", axes="xy")
        self.session.set_support(167, False)
        self.session.set_stiffness(2.0, "soft")
        self.session.set_parameter("soft", "shear_modulus", 1500.0)
        added = self.session.add_tool("sphere", 0.008)
        self.session.remove_tool(added)
        self.session.save(saved)
        self.session.reset()
        self.session.load(saved)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "recording")
            self.session.record(path)
            self.session.record(None)
            self.session.save(os.path.join(folder, "state"))
            self.session.load(os.path.join(folder, "state"))
            self.session.replay(path)
            self.session.seek(0.0)
            self.session.replay(None)
        self.session.set_pace(0.5)
        self.session.step(3)
        wait_until(lambda: self.session.status()["state"] == "paused")
        self.session.play()

    def test_what_is_refused(self):
        for call in (lambda: self.session.tool_move("none", (0, 0, 0)), lambda: self.session.tool_pose(50),
                     lambda: self.session.set_pace(-1), lambda: self.session.snapshot(-1),
                     lambda: self.session.attach("probe", "telepathy:1")):
            with self.assertRaises(ValueError):
                call()
        for call in (lambda: self.session.step("x"), lambda: self.session.save(None),
                     lambda: lariat.Session(None), lambda: self.session.tool_move("probe", None)):
            with self.assertRaises(TypeError):
                call()
        with self.assertRaises(OSError):
            self.session.save("/nowhere/state")

    def test_many_threads_may_ask_and_close_waits_for_nobody(self):
        failures = []

        def ask():
            try:
                while True:
                    self.session.snapshot()
                    self.session.tool_force("probe")
                    self.session.grasp(1, (0.01, 0.01, 3 * EDGE))
                    self.session.release(1)
            except lariat.StateError:
                pass
            except Exception as error:  # pylint: disable=broad-except
                failures.append(error)
        threads = [threading.Thread(target=ask) for _ in range(4)]
        for thread in threads:
            thread.start()
        time.sleep(0.2)
        wait_until(self.closed_at_last)
        for thread in threads:
            thread.join()
        self.assertEqual(failures, [])

    def closed_at_last(self):
        try:
            self.session.close()
        except lariat.StateError:
            return False
        return True

    def test_left_open_it_ends_with_its_last_name(self):
        sim = lariat.Simulation(self.sim.model)
        session = lariat.Session(sim)
        del session
        self.assertGreaterEqual(sim.advance(1), 1)


class Views(unittest.TestCase):
    def test_the_page_is_served_until_the_session_ends(self):
        with lariat.Simulation(block()) as sim, lariat.Session(sim) as session:
            try:
                view = session.view(open=False)
            except lariat.UnsupportedError as error:
                self.skipTest(str(error))
            with urllib.request.urlopen(view.url, timeout=30) as answer:
                self.assertEqual(answer.status, 200)
            self.assertIn(view.url, view._repr_html_())
            self.assertEqual(view.viewers, 0)
            with self.assertRaisesRegex(lariat.StateError, "close that view first"):
                session.view(open=False)
            view.close()
            again = session.view(open=False)
            session.close()
            self.assertEqual(again.url, "")
            again.close()

    def test_an_address_for_others_needs_a_token(self):
        with lariat.Simulation(block()) as sim, lariat.Session(sim) as session:
            with self.assertRaises((ValueError, lariat.UnsupportedError)):
                session.view(open=False, address="0.0.0.0")
            with self.assertRaises(TypeError):
                session.view(open=False, port="x")


if __name__ == "__main__":
    unittest.main()
