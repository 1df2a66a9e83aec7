"""class Simulation: the same bits as the command, states, tools, changes, what is refused."""

import array
import copy
import gc
import os
import pickle
import random
import re
import subprocess
import tempfile
import threading
import unittest

import lariat
from common import CELLS, EDGE, SCENE, WITHOUT_NUMPY, block, block_arrays, child, demo, numpy

LARIAT = os.environ.get("LARIAT_COMMAND")
FULL = bool(os.environ.get("LARIAT_TEST_FULL"))
# Where only the module is built with sanitizers: what takes seconds in the library.
LIBRARY_ONLY = bool(os.environ.get("LARIAT_TEST_SANITIZED")) and not FULL


class Bits(unittest.TestCase):
    @unittest.skipUnless(LARIAT, "LARIAT_COMMAND does not say where the command is")
    def test_the_hash_is_that_of_the_command_on_every_grid(self):
        scene = os.path.join(demo(), "uterus.yaml")
        said = subprocess.run([LARIAT, "run", scene, "--steps", "300"], check=True, text=True,
                              capture_output=True).stdout
        wanted = int(re.search(r"state hash +([0-9a-f]{16})", said).group(1), 16)
        model = lariat.Model(scene)
        for options in ({}, {"grid": "2x1x1"}, {"grid": "1x2x2", "threads": 2},
                        {"threads": 2}, {"isa": "c"}):
            with lariat.Simulation(model, **options) as sim:
                self.assertEqual(sim.advance(300), 300)
                self.assertEqual(sim.hash(), wanted, options)
                self.assertEqual(sim.options, options)

    def test_pieces_callbacks_and_seconds_are_the_same_steps(self):
        model, hashes = block(), []

        def look(sim):
            seen.append((sim.step, sim.positions()[100, 2]))
        for way in (lambda s: s.advance(100), lambda s: [s.advance(1) for _ in range(100)],
                    lambda s: s.advance(100, callback=look, every=7),
                    lambda s: s.advance(seconds=100 * s.time_step)):
            seen = []
            with lariat.Simulation(model) as sim:
                way(sim)
                self.assertEqual(sim.step, 100)
                self.assertAlmostEqual(sim.time, 100 * sim.time_step)
                hashes.append(sim.hash())
            if seen:
                self.assertEqual([step for step, _ in seen], [*range(7, 100, 7), 100])
        self.assertEqual(len(set(hashes)), 1)

    @unittest.skipIf(numpy is None, WITHOUT_NUMPY)
    def test_what_a_comparison_of_arrays_gives_ends_an_advance_too(self):
        with lariat.Simulation(block()) as sim:
            for answer, steps in ((numpy.bool_(False), 5), (numpy.bool_(True), 20), (0, 20)):
                self.assertEqual(sim.advance(20, callback=lambda s: answer, every=5), steps)
            self.assertFalse(sim.rest(callback=lambda s: numpy.bool_(False))["reached"])

    def test_jaws_take_the_steps_that_they_need(self):
        grasper = {"name": "g", "shape": "grasper", "radius": 0.002, "length": 0.015, "spread": 60,
                   "at": [-0.05, 0, 0.1], "towards": [1, 0, 0]}
        with lariat.Simulation(block(tools=[grasper])) as sim:
            sim.grasp("g")
            sim.advance(100)
            self.assertEqual(sim.tool_pose("g")["opening"], 0)
            sim.release("g")
            sim.advance(100)
            self.assertEqual(sim.tool_pose("g")["opening"], 1)
            with self.assertRaisesRegex(ValueError, "take .* steps"):
                sim.grasp("g", steps=1)

    def pull_and_stiffen(self, model, grip, to, grids):
        ends = set()
        for grid in grids:
            sim = lariat.Simulation(model, hands=1, **grid)
            sim.set_stiffness(0.1)
            sim.tool_move("hand", tuple(grip))
            sim.advance(2)
            sim.grasp("hand", tuple(grip))
            sim.tool_move("hand", tuple(to), steps=400)
            sim.advance(300)
            sim.set_stiffness(4)
            sim.advance(24)
            ends.add(sim.hash())
            sim.close()
        self.assertEqual(len(ends), 1)

    @unittest.skipIf(numpy is None, WITHOUT_NUMPY)
    @unittest.skipIf(LIBRARY_ONLY, "the library has no sanitizer")
    def test_tissue_that_becomes_stiff_while_it_is_pulled_flies_alike_on_every_grid(self):
        # Nodes at 30 m/s and more among crowded faces: too fast for lists that last some steps.
        model = lariat.Model(os.path.join(demo(), "uterus_live.yaml"))
        place = numpy.asarray(model.positions)
        faces = numpy.asarray(model.surface["faces"])
        generator = numpy.random.default_rng(13)
        grip = place[faces[generator.integers(len(faces))]].mean(0)
        to = grip + 0.05 * generator.normal(size=3)
        self.pull_and_stiffen(model, grip, to, ({}, {"grid": "2x1x1"}))

    def test_what_is_thrown_far_within_one_step_is_so_on_every_grid(self):
        # At rest, and in the next step, of 32 parts, farther than any list of contact reaches.
        model = block(contact=[{"self": True}], tools=[])
        grip = (EDGE * CELLS[0] / 2, EDGE * CELLS[1] / 2, EDGE * CELLS[2])
        to = (*grip[:2], grip[2] + 0.06)
        self.pull_and_stiffen(model, grip, to, ({}, {"grid": "1x1x1"}, {"grid": "2x1x1"},
                                                {"grid": "2x2x1", "threads": 2}))

    def throw_about(self, model, seed, options):
        # By gravity that goes in all directions, as soft and as hard as it may be.
        random_ = random.Random(seed)
        with lariat.Simulation(model, **options) as sim:
            for _ in range(8):
                sim.gravity = [random_.uniform(-300, 300), random_.uniform(-300, 300),
                               random_.uniform(-300, 100)]
                sim.set_stiffness(random_.choice((0.1, 0.5, 4)))
                try:
                    sim.advance(random_.randint(20, 100))
                except lariat.UnstableError as error:
                    return str(error)
            return sim.hash()

    def ends_alike(self, model, seeds):
        for seed in seeds if FULL else seeds[:1]:
            ends = {self.throw_about(model, seed, options) for options in (
                {}, {"search_always": True}, {"grid": "2x1x1"}, {"grid": "1x2x1", "threads": 2})}
            self.assertEqual(len(ends), 1, ends)

    @unittest.skipIf(LIBRARY_ONLY, "the library has no sanitizer")
    def test_bodies_that_crush_each_other_break_alike_however_contact_is_looked_for(self):
        lower, upper = block_arrays((3, 2, 3)), block_arrays((2, 4, 2))
        nodes = lower[0] + [[x, y, z + 3.05 * EDGE] for x, y, z in upper[0]]
        hexahedra = lower[1] + [[n + len(lower[0]) for n in h] for h in upper[1]]
        scene = {**SCENE, "tools": [], "damping": 5, "contact": [{"self": True}]}
        self.ends_alike(lariat.Model.from_arrays(nodes, hexahedra, scene,
                                                 sets={"floor": lower[2]["floor"]}), (2, 10, 42))

    @unittest.skipIf(LIBRARY_ONLY, "the library has no sanitizer")
    def test_a_sheet_that_folds_remembers_alike_what_lay_within_it(self):
        nodes, hexahedra, _ = block_arrays((4, 2, 1))
        scene = {key: value for key, value in SCENE.items() if key not in ("fix", "tools")}
        floor = {"faces": "all", "plane": {"through": [0, 0, 0], "normal": [0, 0, 1]}}
        scene.update(damping=5, contact=[{"self": True}, floor])
        self.ends_alike(lariat.Model.from_arrays(nodes, hexahedra, scene), (2, 11, 16))

    def test_springs_between_bodies_store_something_where_one_lies_on_the_other(self):
        lower, upper = block_arrays((2, 2, 2)), block_arrays((2, 2, 2))
        nodes = lower[0] + [[x, y, z + 2.05 * EDGE] for x, y, z in upper[0]]
        hexahedra = lower[1] + [[n + len(lower[0]) for n in h] for h in upper[1]]
        scene = {**SCENE, "tools": [], "damping": 50, "contact": [{"self": True}]}
        simulation = lariat.Simulation(lariat.Model.from_arrays(
            nodes, hexahedra, scene, sets={"floor": lower[2]["floor"]}))
        self.assertEqual(simulation.contact_springs(), 0)
        self.assertGreater(simulation.contact()["distance"], 0)
        while simulation.contact()["deepest"] == 0 and simulation.time < 5:
            simulation.advance(50)
        springs = simulation.contact_springs()
        self.assertGreater(springs, 0)
        self.assertLess(springs, simulation.energies()["strain"] + 1)


class Rest(unittest.TestCase):
    def test_a_block_sags_to_the_same_rest_on_every_grid(self):
        model, steps, hashes = block(), set(), set()
        for options in ({}, {"grid": "2x1x1"}, {"threads": 2}):
            with lariat.Simulation(model, **options) as sim:
                rest = sim.rest()
                self.assertTrue(rest["reached"])
                self.assertEqual(rest["steps"], sim.step)
                self.assertLessEqual(rest["left"], rest["share"])
                self.assertLess(rest["kinetic"], 1e-9 * rest["strain"])
                steps.add(sim.step)
                hashes.add(sim.hash())
                top = sim.positions()[model.node_count - 1, 2]
                sim.advance(seconds=0.2)
                self.assertAlmostEqual(sim.positions()[model.node_count - 1, 2], top, places=8)
        self.assertEqual((len(steps), len(hashes)), (1, 1))

    def test_seconds_go_on_beyond_where_the_library_gives_up(self):
        with lariat.Simulation(block(damping=1e-6)) as sim:
            with self.assertRaisesRegex(lariat.ModelError, "not at rest after"):
                sim.rest()
            given_up = sim.step
            rest = sim.rest(seconds=given_up * sim.time_step)
            self.assertFalse(rest["reached"])
            self.assertEqual(sim.step, 2 * given_up)

    @unittest.skipUnless(LARIAT, "LARIAT_COMMAND does not say where the command is")
    def test_as_the_command_finds_it(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = os.path.join(folder, "cube.yaml")
            with open(os.path.join(folder, "cube.vtk"), "w", encoding="ascii") as file:
                file.write("# vtk DataFile Version 3.0\ncube\nASCII\nDATASET UNSTRUCTURED_GRID\n"
                           "POINTS 8 double\n0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\n"
                           "CELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n")
            with open(scene, "w", encoding="ascii") as file:
                file.write("lariat: 1\nmesh: cube.vtk\nscale: 0.01\ndamping: 30\n"
                           "materials: [ { cells: all, law: neo-hookean, density: 1050, "
                           "shear_modulus: 2.0e3, bulk_modulus: 2.0e4 } ]\n"
                           "gravity: [0, 0, -9.81]\n"
                           "fix: [ { nodes: { box: [[-1, -1, -0.001], [1, 1, 0.001]] }, axes: xyz } ]\n")
            said = subprocess.run([LARIAT, "run", scene, "--until-rest"], check=True, text=True,
                                  capture_output=True).stdout
            wanted = int(re.search(r"state hash +([0-9a-f]{16})", said).group(1), 16)
            sim = lariat.Simulation(lariat.Model(scene))
            self.assertEqual(sim.rest_damp(), 0)  # the scene has one
            self.assertTrue(sim.rest()["reached"])
            self.assertEqual(sim.hash(), wanted)
            with open(scene) as file:
                bare = file.read().replace("damping: 30\n", "")
            with open(scene, "w") as file:
                file.write(bare)
            said = subprocess.run([LARIAT, "run", scene, "--until-rest"], check=True, text=True,
                                  capture_output=True).stdout
            wanted = int(re.search(r"state hash +([0-9a-f]{16})", said).group(1), 16)
            sim = lariat.Simulation(lariat.Model(scene))
            self.assertGreater(sim.rest_damp(), 10)
            self.assertTrue(sim.rest()["reached"])
            self.assertEqual(sim.hash(), wanted)

    def test_ends(self):
        sim, looks = lariat.Simulation(block()), []
        rest = sim.rest(0.01)
        self.assertFalse(rest["reached"])
        self.assertAlmostEqual(sim.time, 0.01, delta=sim.time_step)
        rest = sim.rest(callback=lambda sim: looks.append(sim.step) or len(looks) < 3)
        self.assertEqual((rest["reached"], len(looks), looks[-1]), (False, 3, sim.step))
        self.assertTrue(sim.rest(callback=lambda sim: None)["reached"])
        # A callback that advances by itself, or has something to say against it all.
        sim.reset()
        self.assertTrue(sim.rest(callback=lambda sim: sim.advance(100) and None)["reached"])
        sim.reset()
        with self.assertRaises(ZeroDivisionError):
            sim.rest(callback=lambda sim: 1 / 0)
        for wrong in ({"seconds": -1}, {"seconds": float("nan")}):
            with self.assertRaises(lariat.ArgumentError):
                sim.rest(**wrong)
        with self.assertRaises(TypeError):
            sim.rest(callback=3)
        # What creeps is not at rest, however slowly, and what comes in waves never is.
        slow = dict(SCENE["materials"][0], viscous={"part": "isochoric",
                                                    "terms": [{"g": 4, "time": 1e5}]})
        with self.assertRaisesRegex(lariat.ModelError, "viscous terms still relax"):
            lariat.Simulation(block(materials=[slow], damping=100)).rest()
        wave = {"direction": [1, 0, 0], "speed": 1, "length": 0.02, "every": 0.2}
        waves = dict(SCENE["materials"][0], fibres={"direction": {"axis": [1, 0, 0]},
                                                    "active": {"along": 100, "wave": wave}})
        with self.assertRaisesRegex(lariat.ModelError, "again and again"):
            lariat.Simulation(block(materials=[waves])).rest(0.01)
        with self.assertRaisesRegex(lariat.StateError, "closed"):
            sim.rest(callback=lambda sim: sim.close())
        # What nothing damps swings on.
        swings = lariat.Simulation(block(damping=0))
        with self.assertRaisesRegex(lariat.ModelError, "not at rest after .*damping"):
            swings.rest()


class States(unittest.TestCase):
    def test_saved_in_memory_and_on_disk_and_in_pickles(self):
        model = block()
        sim, other = lariat.Simulation(model), lariat.Simulation(model, grid="2x1x1")
        sim.advance(40)
        saved = sim.save()
        self.assertEqual((saved.step, saved.time), (40, sim.time))
        copy = pickle.loads(pickle.dumps(sim))
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "state")
            sim.save(path)
            self.assertEqual(lariat.checkpoint_info(path)["step"], 40)
            sim.advance(40)
            for again in (sim, other, copy):
                if again is not copy:
                    again.load(path if again is other else saved)
                again.advance(40)
        self.assertEqual({sim.hash(), other.hash(), copy.hash()}, {sim.hash()})
        self.assertIs(sim.save(saved), saved)
        self.assertEqual(saved.step, 80)
        sim.reset()
        self.assertEqual((sim.step, sim.time), (0, 0))
        with self.assertRaises(TypeError):
            pickle.dumps(saved)

    def test_a_state_of_another_model_is_refused(self):
        saved = lariat.Simulation(block()).save()
        sim = lariat.Simulation(lariat.Model(os.path.join(demo(), "uterus.yaml")))
        with self.assertRaises(lariat.ArgumentError):
            sim.load(saved)
        with self.assertRaises(lariat.FileError):
            sim.load("/nowhere/state")

    def test_a_saved_state_outlives_its_simulation_and_needs_its_model(self):
        sim = lariat.Simulation(block())
        sim.advance(5)
        saved, hash_then, model = sim.save(), sim.hash(), sim.model
        sim.close()
        del sim
        again = lariat.Simulation(model)
        del model
        gc.collect()
        again.load(saved)
        self.assertEqual(again.hash(), hash_then)

    def test_a_saved_state_knows_what_was_asked_of_tools(self):
        jaws = {"name": "jaws", "shape": "grasper", "radius": 0.003, "length": 0.015,
                "spread": 60, "at": [0.03, 0.02, 0.08]}
        model = block(tools=[jaws])
        first, second = lariat.Simulation(model), lariat.Simulation(model)
        first.tool_move("jaws", (0.03, 0.02, 0.085), steps=100, opening=0.25)
        first.advance(5)
        second.load(first.save())
        third = pickle.loads(pickle.dumps(first))
        for sim in (first, second, third):
            sim.tool_move("jaws", (0.03, 0.02, 0.08), steps=50)
            sim.advance(200)
            self.assertEqual(sim.tool_pose("jaws")["opening"], 0.25)
        self.assertEqual({second.hash(), third.hash()}, {first.hash()})


class Arrays(unittest.TestCase):
    def setUp(self):
        self.sim = lariat.Simulation(block())
        self.sim.advance(50)

    def test_positions_are_those_at_rest_and_displacements(self):
        u, x = self.sim.displacements().tolist(), self.sim.positions().tolist()
        for rest, moved, now in zip(self.sim.model.positions.tolist(), u, x):
            self.assertEqual(now, [a + b for a, b in zip(rest, moved)])
        self.assertEqual(self.sim.velocities().shape, (168, 3))
        self.assertEqual(self.sim.field("von_mises").shape, (168,))

    def test_out_is_filled(self):
        count = self.sim.model.node_count
        memory = memoryview(bytearray(24 * count)).cast("d", (count, 3))
        self.assertIs(self.sim.positions(memory), memory)
        self.assertEqual(memory.tolist(), self.sim.positions().tolist())
        flat = memoryview(bytearray(4 * count)).cast("f")
        self.assertIs(self.sim.field("energy", out=flat), flat)

    def test_what_out_may_be(self):
        count = self.sim.model.node_count
        for out, words in ((bytearray(24 * count), r"\[168, 3\]"), (array.array("d", [0] * 3), "got"),
                           (memoryview(bytes(24 * count)).cast("d", (count, 3)), "read only"),
                           (memoryview(bytearray(12 * count)).cast("f", (count, 3)), "float64")):
            with self.assertRaisesRegex(ValueError, "out: .*" + words):
                self.sim.positions(out)
        with self.assertRaisesRegex(TypeError, "out: expected an array"):
            self.sim.positions([[0, 0, 0]])
        with self.assertRaisesRegex(ValueError, "none; there are"):
            self.sim.field("colour")

    def test_energies_balance(self):
        e = self.sim.energies()
        held = sum(e[k] for k in ("kinetic", "strain", "hourglass", "damping", "contact", "viscous"))
        self.assertAlmostEqual(held, e["external"], delta=2e-2 * abs(e["external"]))

    @unittest.skipUnless(numpy, WITHOUT_NUMPY)
    def test_numpy_takes_them_without_a_copy(self):
        x = numpy.empty((self.sim.model.node_count, 3))
        self.assertIs(self.sim.positions(x), x)
        view = self.sim.positions()
        array_of_it = numpy.asarray(view)
        array_of_it[0, 0] = 5
        self.assertEqual(view[0, 0], 5)
        for bad in (x.T, x[::2], x.astype(numpy.float32), numpy.asfortranarray(x)):
            with self.assertRaises(ValueError):
                self.sim.positions(bad)
        self.assertTrue(numpy.allclose(x - numpy.asarray(self.sim.model.positions),
                                       numpy.asarray(self.sim.displacements())))


class Changes(unittest.TestCase):
    def test_gravity_damping_stiffness_and_forces(self):
        sim = lariat.Simulation(block())
        self.assertEqual(sim.gravity, (0, 0, -9.81))
        sim.gravity = [0, -9.81, 0]
        self.assertEqual(sim.gravity, (0, -9.81, 0))
        sim.gravity = None
        self.assertEqual(sim.gravity, (0, 0, -9.81))
        sim.damping = 5
        self.assertEqual(sim.damping, 5)
        sim.set_stiffness(2, "soft")
        self.assertEqual(sim.stiffness(0), 2)
        sim.set_stiffness(0.5)
        self.assertEqual(sim.stiffness("soft"), 0.5)
        usual = sim.parameter("soft", "shear_modulus")
        sim.set_parameter("soft", "shear_modulus", 1.5 * usual)
        self.assertEqual(sim.parameter(0, "shear_modulus"), 1.5 * usual)
        sim.set_parameter(0)
        self.assertEqual(sim.parameter(0, "shear_modulus"), usual)
        sim.set_force("top", (0, 0, 0.01))
        sim.set_force(167, (0.5, 0, 0))
        self.assertEqual(sim.force(167), (0.5, 0, 0.01))
        sim.set_force(167)
        self.assertEqual(sim.force(167), (0, 0, 0.01))
        sim.clear_forces()
        self.assertEqual(sim.force(167), (0, 0, 0))

    def test_supports_come_and_go(self):
        sim = lariat.Simulation(block())
        self.assertEqual((sim.support(0), sim.support(167)), ("xyz", ""))
        sim.advance(200)
        before = [sim.positions()[167, k] for k in range(3)]
        sim.set_support("top", axes="xz")
        self.assertEqual(sim.support(167), "xz")
        sim.advance(100)
        now = [sim.positions()[167, k] for k in range(3)]
        self.assertEqual((now[0], now[2]), (before[0], before[2]))
        sim.set_support(167, False)
        sim.set_support(0, held=False, axes="z")
        self.assertEqual((sim.support(0), sim.support(167)), ("xy", ""))
        sim.advance(50)
        self.assertNotEqual(sim.positions()[167, 2], now[2])

    def test_a_muscle_is_as_active_as_it_is_told(self):
        muscle = {"direction": {"axis": [0, 0, 1]}, "active": {"along": 500}}
        sim = lariat.Simulation(block(materials=[{**SCENE["materials"][0], "fibres": muscle}]))
        self.assertEqual(sim.activation("soft"), 1)
        sim.activate(0)
        self.assertEqual(sim.activation(0), 0)
        sim.advance(100)
        tall = sim.positions()[167, 2]
        sim.activate(1, material="soft")
        sim.advance(100)
        self.assertLess(sim.positions()[167, 2], tall)
        for value in (-0.1, 1.5, float("nan")):
            with self.assertRaises(ValueError):
                sim.activate(value)
        with self.assertRaisesRegex(ValueError, "no material"):
            sim.activation(3)

    def test_what_is_refused(self):
        sim = lariat.Simulation(block())
        for call, words in ((lambda: sim.activate(0.5), "active"),
                            (lambda: sim.set_stiffness(9), "4"),
                            (lambda: sim.set_stiffness(1, "hard"), "none called 'hard'"),
                            (lambda: sim.stiffness(7), "no material"),
                            (lambda: sim.parameter(7, "c1"), "no material"),
                            (lambda: sim.set_parameter(None, "c1", 1), "no material None"),
                            (lambda: sim.set_parameter(0, "c1", 1), "shear_modulus, bulk_modulus"),
                            (lambda: sim.set_parameter(0, "bulk_modulus", 1e12), "divided"),
                            (lambda: sim.set_parameter(0, "bulk_modulus"), "neither"),
                            (lambda: sim.set_parameter(0, value=5), "neither"),
                            (lambda: sim.set_parameter(0, "bulk_modulus", -1), "positive"),
                            (lambda: sim.set_force("nowhere", (1, 0, 0)), "nowhere"),
                            (lambda: sim.set_force(99999, (1, 0, 0)), "99999"),
                            (lambda: sim.set_force(0, (1, 0)), "3 finite numbers"),
                            (lambda: sim.set_force(0, (1, 0, float("inf"))), "finite"),
                            (lambda: sim.force(-1), "no node"),
                            (lambda: sim.set_force("top\0", (1, 0, 0)), "character 0"),
                            (lambda: sim.set_stiffness(2, "soft\0"), "character 0"),
                            (lambda: sim.tool_pose("probe\0"), "character 0"),
                            (lambda: sim.support(99999), "no node 99999"),
                            (lambda: sim.set_support("nowhere"), "nowhere"),
                            (lambda: sim.set_support(99999), "99999"),
                            (lambda: sim.set_support(0, axes=""), "axes"),
                            (lambda: sim.set_support(0, axes="xx"), "'xx'"),
                            (lambda: sim.set_support(0, axes="w"), "'w'"),
                            (lambda: setattr(sim, "gravity", (1, 2)), "3 finite"),
                            (lambda: setattr(sim, "gravity", (0, 0, 1e6)), "1000"),
                            (lambda: setattr(sim, "damping", -1), "damping")):
            with self.assertRaisesRegex(ValueError, words):
                call()
        for call in (lambda: setattr(sim, "damping", "x"), lambda: setattr(sim, "gravity", 5),
                     lambda: delattr(sim, "damping"), lambda: sim.set_force(0.5, (0, 0, 1)),
                     lambda: sim.set_support(0.5), lambda: sim.set_support(0, True, 7),
                     lambda: sim.set_parameter(0, 7, 1), lambda: sim.set_parameter(0, "c1", "x"),
                     lambda: sim.set_stiffness(None)):
            with self.assertRaises(TypeError):
                call()


class Tools(unittest.TestCase):
    def test_a_probe_presses_and_its_points_are_its_force(self):
        sim = lariat.Simulation(block())
        self.assertEqual([t["name"] for t in sim.tools], ["probe"])
        sim.tool_move("probe", (0.03, 0.025, 0.033), 500)
        sim.advance(700)
        touches, sums = sim.tool_touches("probe"), [0.0, 0.0, 0.0]
        self.assertGreater(len(touches), 3)
        for touch in touches:
            self.assertEqual(touch["kind"], "pressed")
            self.assertAlmostEqual(sum(touch["weights"]), 1)
            sums = [a + b for a, b in zip(sums, touch["force"])]
        pushed = sim.nodal_forces("tool", "probe")
        pressure = sim.contact_pressure()
        traction = sim.contact_pressure(traction=True)
        touched = [n for n in range(len(pressure)) if pressure[n] > 0]
        assert touched and len(touched) < len(pressure) / 2
        for n in range(len(pressure)):
            force = [pushed[n, i] for i in range(3)]
            assert (pressure[n] > 0) == (force != [0, 0, 0])
            assert all((traction[n, i] == 0) == (force[i] == 0) for i in range(3))
        self.assertEqual(pushed.shape, (sim.model.node_count, 3))
        sim.advance(1)
        force = sim.tool_force(0)
        for axis, (felt, summed) in enumerate(zip(force["force"], sums)):
            self.assertAlmostEqual(felt, summed, places=9)
            self.assertEqual(felt, -sum(pushed[n, axis] for n in range(sim.model.node_count)))
        self.assertEqual(sim.wrench("probe"), force["force"] + force["torque"])
        self.assertGreater(force["force"][2], 0)
        self.assertAlmostEqual(sim.tool_pose(0)["position"][2], 0.033, places=3)

    def test_forces_on_nodes_are_mass_times_acceleration(self):
        sim = lariat.Simulation(block())
        nodes = sim.model.node_count
        sim.tool_move("probe", (0.03, 0.025, 0.033), 500)
        sim.advance(500)
        before, total = sim.hash(), [0.0] * (3 * nodes)
        out = array.array("d", total)
        view = memoryview(out).cast("B").cast("d", (nodes, 3))
        for cause in ("elements", "tool", "bodies", "loads", "planes", "supports", "gravity",
                      "damping"):
            sim.nodal_forces(cause, "probe" if cause == "tool" else None, out=view)
            total = [a + b for a, b in zip(total, out)]
        self.assertEqual(sim.hash(), before)
        slow = sim.velocities()
        self.assertEqual(sim.info["step_parts"], 1)
        sim.advance(1)
        fast, seen = sim.velocities(), 0
        for n in range(nodes):
            rate = [(fast[n, i] - slow[n, i]) / sim.time_step for i in range(3)]
            if max(map(abs, rate)) < 0.1:
                continue
            seen += 1
            mass = max(((abs(a), f / a) for a, f in zip(rate, total[3 * n:3 * n + 3])))[1]
            self.assertTrue(0 < mass < sim.model.info["mass"])
            for i in range(3):
                self.assertAlmostEqual(total[3 * n + i], mass * rate[i], delta=1e-9)
        self.assertGreater(seen, 20)

    def test_causes_that_are_none(self):
        sim = lariat.Simulation(block())
        for call in (lambda: sim.nodal_forces("wind"), lambda: sim.nodal_forces("tool"),
                     lambda: sim.nodal_forces("loads", 0), lambda: sim.nodal_forces("tool", "none"),
                     lambda: sim.nodal_forces("tool", 9),
                     lambda: sim.nodal_forces("loads", out=[1.0])):
            with self.assertRaises((ValueError, TypeError)):
                call()

    def test_a_hand_lifts(self):
        sim = lariat.Simulation(block(tools=[]), hands=1)
        place = (0.03, 0.025, 3 * EDGE)
        sim.tool_move(0, place)
        self.assertGreater(sim.grasp(0, place), 0)
        sim.tool_move(0, (0.03, 0.025, 3 * EDGE + 0.005), 2000)
        sim.advance(2000)
        self.assertGreater(sim.tool_force(0)["held"], 0)
        self.assertLess(sim.wrench(0)[2], 0)
        sim.release(0)
        self.assertEqual(sim.grasp(0, (1, 1, 1)), 0)

    def test_tools_come_and_go(self):
        sim = lariat.Simulation(block(), spares=1)
        added = sim.add_tool("sphere", 0.008)
        self.assertEqual(sim.tools[added]["shape"], "sphere")
        sim.remove_tool(added)
        self.assertEqual(sim.tools[added]["shape"], "none")

    def test_what_is_refused(self):
        sim = lariat.Simulation(block())
        for call, words in ((lambda: sim.tool_pose("scalpel"), "none called 'scalpel'"),
                            (lambda: sim.tool_pose(1), "the simulation has 1"),
                            (lambda: sim.tool_move(0, (1, 2)), "position: expected 3"),
                            (lambda: sim.tool_move(0, (0, 0, float("nan"))), "position"),
                            (lambda: sim.tool_move(0, (0, 0, 9), 1), "radius"),
                            (lambda: sim.tool_move(0, (0, 0, 0), 0), "step"),
                            (lambda: sim.tool_move(0, (0, 0, 0), orientation=(1, 1, 1, 1)), "unit|quat"),
                            (lambda: sim.tool_move(0, (0, 0, 0), opening=float("nan")), "opening"),
                            (lambda: sim.grasp(0), ""), (lambda: sim.add_tool("sphere", 0.008), ""),
                            (lambda: sim.add_tool("saw", 0.01), "sphere")):
            with self.assertRaisesRegex(ValueError, words):
                call()
        for call in (lambda: sim.tool_pose(0.5), lambda: sim.tool_pose(None),
                     lambda: sim.tool_move(0), lambda: sim.tool_move(0, 5)):
            with self.assertRaises(TypeError):
                call()


class Threads(unittest.TestCase):
    def test_many_take_up_one_state(self):
        model = block()
        first = lariat.Simulation(model)
        first.advance(20)
        state, ends, errors = first.save(), [], []
        first.advance(4)

        def tries():
            own = lariat.Simulation(model)
            try:
                for _ in range(50 if LIBRARY_ONLY else 500):
                    own.load(state)
                    own.advance(4)
                    ends.append(own.hash())
            except lariat.Error as error:
                errors.append(error)

        threads = [threading.Thread(target=tries) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(errors, [])
        self.assertEqual(set(ends), {first.hash()})


    def test_deep_copies_take_up_states(self):
        first = lariat.Simulation(block())
        first.advance(20)
        state, twin = first.save(), copy.deepcopy(first)
        self.assertIs(twin.model, first.model)
        twin.advance(7)
        twin.load(state)
        self.assertEqual(twin.hash(), first.hash())


class Arguments(unittest.TestCase):
    def test_of_a_simulation(self):
        model = block()
        for options, words in (({"grid": "x"}, "grid"), ({"element": "tet4"}, "tet4"),
                               ({"isa": "mmx"}, "mmx"), ({"threads": -1}, ""),
                               ({"time_step": -1.0}, ""), ({"time_step": float("nan")}, ""),
                               ({"hands": -1}, ""), ({"spares": 99}, ""), ({"grid": "2x1x1", "scheme": "no"}, "no")):
            with self.assertRaisesRegex(lariat.Error, words):
                lariat.Simulation(model, **options)
        for arguments in ((), ("organ.yaml",), (None,), (model, "2x1x1")):
            with self.assertRaises(TypeError):
                lariat.Simulation(*arguments)
        with self.assertRaises(TypeError):
            lariat.Simulation(model, colour="red")
        with self.assertRaises(TypeError):
            lariat.Saved()

    def test_of_advance(self):
        sim = lariat.Simulation(block())
        for arguments, options in (((), {}), ((1,), {"seconds": 1}), (("1",), {}), ((1.0,), {}),
                                   ((1, 2), {}), ((1,), {"steps": 1}), ((), {"minutes": 1}),
                                   ((1,), {"every": 1}), ((1,), {"callback": 5})):
            with self.assertRaises(TypeError):
                sim.advance(*arguments, **options)
        for arguments, options in (((-1,), {}), ((2**64,), {}), ((), {"seconds": -1.0}),
                                   ((), {"seconds": float("nan")}), ((), {"seconds": 1e300}),
                                   ((5,), {"callback": print, "every": 0})):
            with self.assertRaises(ValueError):
                sim.advance(*arguments, **options)
        self.assertEqual((sim.advance(0), sim.advance(True), sim.step), (0, 1, 1))


class Life(unittest.TestCase):
    def test_after_close_everything_is_refused(self):
        sim = lariat.Simulation(block())
        sim.close()
        sim.close()
        self.assertTrue(sim.closed)
        self.assertIn("closed", repr(sim))
        for name in dir(sim):
            if name.startswith("__") or name in ("model", "closed", "options", "close"):
                continue
            for arguments in ((), (0,), (0, (0, 0, 0)), ("sphere", 1.0)):
                try:
                    value = getattr(sim, name)
                    value(*arguments)
                except (lariat.StateError, TypeError, ValueError):
                    continue
                self.fail(f"{name}{arguments} of a closed simulation answers")
        self.assertRaises(lariat.StateError, lariat.Session, sim)

    def test_unstable_runs_say_so_and_can_be_taken_up_again(self):
        sim = lariat.Simulation(block(), time_step=0.0)
        for node in range(130, 160):
            sim.set_force(node, (0, 0, 200))
        with self.assertRaisesRegex(ArithmeticError, "step|element|node") as caught:
            sim.advance(20000)
        self.assertEqual(caught.exception.status, "unstable")
        why = str(caught.exception)
        changes = (lambda: setattr(sim, "gravity", None), lambda: setattr(sim, "damping", 1),
                   lambda: sim.set_stiffness(2), sim.clear_forces, lambda: sim.set_support(0),
                   lambda: sim.set_force(0, (0, 0, 1)), lambda: sim.add_tool("sphere", 0.01),
                   lambda: sim.tool_move(0, (0, 0, 1)), lambda: sim.grasp(0), sim.energies,
                   lambda: sim.set_parameter("soft", "shear_modulus", 2000))
        for change in changes:
            with self.assertRaisesRegex(lariat.UnstableError, r"reset\(\) or load\(\)") as again:
                change()
            self.assertTrue(str(again.exception).endswith(why))
        for call in (sim.clone, sim.save, lambda: sim.advance(0), lambda: pickle.dumps(sim)):
            with self.assertRaisesRegex(lariat.UnstableError, "^(the state|unstable) at step"):
                call()
        self.assertEqual(len(sim.positions()), sim.model.node_count)
        sim.reset()
        sim.advance(10)
        sim.set_stiffness(2)
        self.assertGreater(sim.energies()["strain"], 0)

    def test_no_steps_change_nothing_that_tools_felt(self):
        model = block()
        for options in ({}, {"grid": "2x1x1"}):
            with lariat.Simulation(model, **options) as sim:
                sim.tool_move("probe", (0.03, 0.025, 0.035), steps=500)
                sim.advance(1000)
                felt = sim.tool_force("probe")
                self.assertGreater(felt["depth"], 0)
                sim.advance(0)
                self.assertEqual(sim.tool_force("probe"), felt)

    def test_a_saved_state_says_what_differs(self):
        model = block()
        sim = lariat.Simulation(model, hands=1)
        saved = sim.save()
        others = {"it has 2 tools .hands count, too., the simulation 1$": lariat.Simulation(model),
                  "it has 0 spares, the simulation 2$": lariat.Simulation(model, hands=1, spares=2),
                  "time step is .* the simulation's 0.0001 s$":
                      lariat.Simulation(model, hands=1, time_step=1e-4),
                  "elements are hex8, the simulation's hex8-full":
                      lariat.Simulation(model, hands=1, element="hex8-full"),
                  "another model: its Model is another object.*at a path":
                      lariat.Simulation(block(), hands=1)}
        for words, other in others.items():
            for name, call in (("load", other.load), ("save", other.save)):
                with self.assertRaisesRegex(lariat.ArgumentError, f"^{name}: the Saved .*{words}"):
                    call(saved)
        nodes, hexahedra, sets = block_arrays((2, 2, 2))
        small = lariat.Model.from_arrays(nodes, hexahedra, SCENE, sets=sets)
        with self.assertRaisesRegex(lariat.ArgumentError, "168 nodes and 90 elements, the simulation "
                                    "27 and 8;"):
            lariat.Simulation(small).load(saved)
        with lariat.Session(lariat.Simulation(model)) as session:
            with self.assertRaisesRegex(lariat.ArgumentError, "^load: .*it has 2 tools"):
                session.load(saved)

    @unittest.skipIf(os.environ.get("LARIAT_TEST_SANITIZED"), "sanitizers keep what was freed")
    def test_ten_thousand_come_and_go_without_growth(self):
        def resident():
            with open("/proc/self/statm", encoding="ascii") as file:
                return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
        many = 10000 if FULL else 300
        model = block()
        for i in range(many + 100):
            if i == 100:
                before = resident()
            sim = lariat.Simulation(model)
            sim.advance(1)
            sim.save()
            sim.positions()
            del sim
            block() if i % 10 == 0 else None
        self.assertLess(resident() - before, 8 << 20)

    def test_exceptions_leave_nothing_behind(self):
        import sys
        model = block()
        count = sys.getrefcount(model)
        for _ in range(50):
            with self.assertRaises(lariat.Error):
                lariat.Simulation(model, grid="x")
            with self.assertRaises(TypeError):
                lariat.Simulation(model, grid=5)
        self.assertEqual(sys.getrefcount(model), count)

    def test_a_second_interpreter_gets_an_exception_or_the_module(self):
        status, said, error = child("import lariat, importlib, sys\n"
                                    "del sys.modules['lariat'], sys.modules['lariat._lariat']\n"
                                    "try:\n import lariat\nexcept ImportError as e: print(e)\n")
        self.assertEqual(status, 0, said + error)


if __name__ == "__main__":
    unittest.main()
