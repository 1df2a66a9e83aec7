"""Rays, stress and strain, results on disk: right, the same on every grid, refused where they must be."""

import csv
import math
import os
import random
import subprocess
import tempfile
import threading
import unittest

import lariat
from common import EDGE, block, child, demo

NODES = [[EDGE * i, EDGE * j, EDGE * k] for k in (0, 1) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]


def cube(move, axes, count=1):
    """Cubes in a row, apart: their lower nodes held, the upper ones moved by `move` and held."""
    nodes = [[x + 3 * EDGE * c, y, z] for c in range(count) for x, y, z in NODES]
    scene = {"lariat": 1, "materials": [{"cells": "all", "law": "neo-hookean", "density": 1050,
                                         "shear_modulus": 2000.0, "bulk_modulus": 40000.0}],
             "fix": [{"nodes": "low", "axes": "xyz"},
                     {"nodes": "high", "axes": "xyz".replace(axes, "")}],
             "move": [{"nodes": "high", "axes": axes, "by": move, "over": 0.02}]}
    low = [n for n, place in enumerate(nodes) if place[2] == 0]
    return lariat.Model.from_arrays(
        nodes, [list(range(8 * c, 8 * c + 8)) for c in range(count)], scene,
        sets={"low": low, "high": [n for n in range(len(nodes)) if n not in low]})


class Rays(unittest.TestCase):
    def test_at_rest(self):
        sim = lariat.Simulation(block())
        hit = sim.ray((0.031, 0.022, 1), (0, 0, -2))
        self.assertAlmostEqual(hit["distance"], 0.97, places=12)
        self.assertEqual(hit["normal"], (0.0, 0.0, 1.0))
        self.assertEqual((hit["point"][:2], hit["body"]), ((0.031, 0.022), 0))
        faces, elements = sim.model.surface["faces"], sim.model.surface["elements"]
        self.assertEqual(elements[hit["face"]], hit["element"])
        corners = [sim.model.positions[faces[hit["face"], k], 0] for k in range(4)]
        self.assertTrue(min(corners) <= 0.031 <= max(corners))
        self.assertIsNone(sim.ray((0.031, 0.022, 1), (0, 0, -1), 0.96))
        self.assertIsNone(sim.ray((0.031, 0.022, 1), (0, 0, 1)))
        self.assertEqual(sim.ray((0.031, 0.022, 0.01), (0, 0, 1e-20))["normal"], (0, 0, 1))  # inside

    def test_none_slips_through_edges_and_corners(self):
        sim = lariat.Simulation(block())
        sim.advance(100)
        place = sim.positions()
        top = [n for n, rest in enumerate(sim.model.positions.tolist()) if rest[2] > 0.029]
        aims = [[(place[n, k] + place[m, k]) / 2 for k in range(3)] for n in top for m in top
                if all(0.005 < x < 0.045 for x in (*place.tolist()[n][:2], *place.tolist()[m][:2]))]
        origin = (0.0271, 0.0252, 0.3)
        hits = sim.rays([origin] * len(aims), [[a[k] - origin[k] for k in range(3)] for a in aims])
        self.assertGreater(len(aims), 100)
        for k, aim in enumerate(aims):
            self.assertGreaterEqual(hits["faces"][k], 0)
            self.assertAlmostEqual(hits["distances"][k], math.dist(origin, aim), places=4)

    def test_all_ways_are_the_same(self):
        model = lariat.Model(os.path.join(demo(), "uterus.yaml"))
        sims = [lariat.Simulation(model), lariat.Simulation(model, grid="2x1x1")]
        for sim in sims:
            sim.advance(300)
        place = sims[0].positions()
        nodes = list(model.surface["nodes"])
        middle = [sum(place[n, k] for n in nodes) / len(nodes) for k in range(3)]
        draw = random.Random(1)
        origins, directions = [], []
        for n in draw.sample(nodes, 200):  # at nodes, where many triangles meet
            away = [draw.gauss(0, 1) for _ in range(3)]
            origins.append([place[n, k] + away[k] for k in range(3)])
            directions.append([-a for a in away])
        origins += [middle] * 50
        directions += [[draw.gauss(0, 1) for _ in range(3)] for _ in range(50)]
        many = [sim.rays(origins, directions) for sim in sims]
        for name in many[0]:
            self.assertEqual(many[0][name].tobytes(), many[1][name].tobytes(), name)
        self.assertGreater(sum(face >= 0 for face in many[0]["faces"][:200]), 150)
        for k in range(0, 250, 5):
            one = sims[0].ray(origins[k], directions[k])
            if one is None:
                self.assertEqual((many[0]["faces"][k], many[0]["distances"][k]), (-1, math.inf))
                continue
            self.assertEqual((one["face"], one["distance"], one["element"], one["point"][0],
                              one["normal"][2]),
                             (many[0]["faces"][k], many[0]["distances"][k],
                              many[0]["elements"][k], many[0]["points"][k, 0],
                              many[0]["normals"][k, 2]))
        moved = model.rays(origins, directions, math.inf, sims[0].displacements())
        self.assertEqual(moved["distances"].tobytes(), many[0]["distances"].tobytes())
        self.assertNotEqual(model.rays(origins, directions)["distances"].tobytes(),
                            many[0]["distances"].tobytes())
        self.assertEqual(model.rays([], [])["points"].shape[0], 0)

    def test_directions_of_any_length(self):
        sim = lariat.Simulation(block())
        at, down = (0.02, 0.02, 1), sim.ray((0.02, 0.02, 1), (0, 0, -1))
        for length in (5e-324, 1e-200, 1e-100, 1e200, 1.7e308):
            self.assertEqual(sim.ray(at, (0, 0, -length)), down, length)
        for k in (-600, 600):
            self.assertEqual(sim.ray(at, (0.0, 2.0**(k - 8), -2.0**k)),
                             sim.ray(at, (0.0, 2.0**-8, -1.0)), k)
        with self.assertRaisesRegex(lariat.ArgumentError, "finite"):
            sim.model.rays([at], [(0, 0, -math.inf)])

    def test_bodies(self):
        sim = lariat.Simulation(cube(0, "z", count=3))
        for body in range(3):
            hit = sim.ray((3 * EDGE * body + 0.003, 0.004, 1), (0, 0, -1))
            self.assertEqual((hit["body"], hit["element"]), (body, body))

    def test_refusals(self):
        sim = lariat.Simulation(block())
        up = (0, 0, 1)
        for words, call in (("origin: expected 3", lambda: sim.ray((0, 0), up)),
                            ("origin: expected 3", lambda: sim.ray((0, 0, math.nan), up)),
                            ("cannot all be 0", lambda: sim.ray(up, (0, 0, 0))),
                            ("longest distance", lambda: sim.ray(up, up, -1)),
                            ("longest distance", lambda: sim.ray(up, up, math.nan)),
                            ("^directions: row 1", lambda: sim.rays([up, up], [up, (0, 0, 0)])),
                            ("one for each of 2", lambda: sim.rays([up, up], [up])),
                            ("origins: ", lambda: sim.rays([[1, 2]], [up])),
                            ("displacements: expected shape",
                             lambda: sim.model.rays([up], [up], 1, [up]))):
            with self.subTest(words), self.assertRaisesRegex(lariat.ArgumentError, words):
                call()
        with self.assertRaises(TypeError):
            sim.ray(3, up)
        with self.assertRaises(TypeError):
            sim.ray(up, up, "far")
        sim.close()
        for call in (lambda: sim.ray(up, up), lambda: sim.rays([up], [up])):
            with self.assertRaisesRegex(lariat.StateError, "closed"):
                call()


class Tensors(unittest.TestCase):
    def pulled(self, move, axes):
        sim = lariat.Simulation(cube(move, axes))
        sim.advance(seconds=0.03)
        return sim

    def test_stretch(self):
        sim = self.pulled(0.1 * EDGE, "z")
        strain, stress = sim.strains(), sim.stresses()
        self.assertEqual((strain.shape, stress.shape, strain.format), ((1, 6), (1, 6), "d"))
        self.assertAlmostEqual(strain[0, 2], (1.1 ** 2 - 1) / 2, places=12)
        for k in (0, 1, 3, 4, 5):
            self.assertAlmostEqual(strain[0, k], 0, places=12)
        self.assertGreater(stress[0, 2], stress[0, 0])
        self.assertAlmostEqual(stress[0, 0], stress[0, 1], places=8)
        xx, yy, zz, xy, yz, zx = (stress[0, k] for k in range(6))
        mises = math.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2)
                          + 3 * (xy ** 2 + yz ** 2 + zx ** 2))
        self.assertAlmostEqual(sim.field("von_mises")[0] / mises, 1, places=6)
        self.assertAlmostEqual(sim.field("pressure")[0] / (-(xx + yy + zz) / 3), 1, places=6)

    def test_shear_of_each_axis(self):
        for axes, place in (("x", 5), ("y", 4)):  # zx and yz
            sim = self.pulled(0.2 * EDGE, axes)
            strain, stress = sim.strains(), sim.stresses()
            self.assertAlmostEqual(strain[0, place], 0.1, places=12)
            self.assertAlmostEqual(strain[0, 2], 0.02, places=12)
            self.assertGreater(stress[0, place], 300)
            self.assertAlmostEqual(stress[0, 9 - place], 0, places=8)

    def test_logarithmic_strain(self):
        # Stretched by 1.2: the others' axes are held. Sheared by 0.2: by the principal stretches.
        sim = self.pulled(0.2 * EDGE, "z")
        self.assertAlmostEqual(sim.strains(logarithmic=True)[0, 2], math.log(1.2), places=12)
        for axes, place in (("x", 5), ("y", 4)):
            strain = self.pulled(0.2 * EDGE, axes).strains(logarithmic=True)
            # C = ((1, g), (g, 1 + g^2)): stretches l and 1 / l with l - 1 / l = g, and its axes.
            g = 0.2
            stretch = (g + math.sqrt(g * g + 4)) / 2
            turn = 0.5 * math.atan2(2 * g, -g * g)
            part = math.log(stretch)
            low = 0 if axes == "x" else 1
            self.assertAlmostEqual(strain[0, place], part * math.sin(2 * turn), places=12)
            self.assertAlmostEqual(strain[0, low], part * math.cos(2 * turn), places=12)
            self.assertAlmostEqual(strain[0, 2], -part * math.cos(2 * turn), places=12)
            self.assertEqual(strain[0, 1 - low], 0)
        # A body that is only turned has none of either kind; a small strain is the same by both.
        sim = lariat.Simulation(block())
        sim.advance(20)
        small = sim.strains(), sim.strains(logarithmic=True)
        worst = max(abs(small[0][e, k]) for e in range(sim.model.element_count) for k in range(6))
        self.assertGreater(worst, 0)
        for e in range(sim.model.element_count):
            for k in range(6):
                self.assertLess(abs(small[0][e, k] - small[1][e, k]), 4 * worst * worst)

    def test_grids_and_out(self):
        model = lariat.Model(os.path.join(demo(), "uterus.yaml"))
        sims = [lariat.Simulation(model, **options) for options in
                ({}, {"grid": "2x1x1"}, {"threads": 2})]
        for sim in sims:
            sim.advance(300)
        for call in ("stresses", "strains"):
            told = [getattr(sim, call)() for sim in sims]
            self.assertEqual(len({array.tobytes() for array in told}), 1, call)
            self.assertNotEqual(told[0].tobytes(), bytes(told[0].nbytes))
        out = sims[0].stresses()
        again = memoryview(bytearray(out.nbytes)).cast("d", out.shape)
        self.assertIs(sims[0].stresses(out=again), again)
        self.assertEqual(again.tobytes(), out.tobytes())
        with self.assertRaisesRegex((lariat.ArgumentError, TypeError), "out"):
            sims[0].strains(out=sims[0].displacements())
        sims[0].close()
        with self.assertRaisesRegex(lariat.StateError, "closed"):
            sims[0].stresses()
        with lariat.Session(lariat.Simulation(model)) as session:
            with self.assertRaises(lariat.StateError):
                session.simulation.strains()


class OnDisk(unittest.TestCase):
    def test_as_the_command_writes_it(self):
        command = os.environ["LARIAT_COMMAND"]
        scene = os.path.join(demo(), "uterus.yaml")
        with tempfile.TemporaryDirectory(prefix="lariat-test-") as folder:
            here, there = os.path.join(folder, "here"), os.path.join(folder, "there")
            model = lariat.Model(scene)
            sim = lariat.Simulation(model)
            self.assertEqual(model.output_interval, 0.02)
            with lariat.Results(sim, here) as results:
                results.add()
                sim.advance(211, callback=lambda sim: results.add(), every=211)
            self.assertTrue(results.closed)
            subprocess.run([command, "run", scene, "--steps", "211", "--out", there], check=True,
                           capture_output=True)
            frames = sorted(n for n in os.listdir(there) if n.endswith(".vtu"))
            self.assertEqual(sorted(n for n in os.listdir(here) if n.endswith(".vtu")), frames)
            for name in frames:
                with open(os.path.join(here, name), "rb") as one, \
                        open(os.path.join(there, name), "rb") as other:
                    self.assertEqual(one.read(), other.read(), name)
            with open(os.path.join(here, "probes.csv"), encoding="utf-8") as file:
                self.assertGreaterEqual(len(list(csv.reader(file))), 3)

    def test_refusals(self):
        sim = lariat.Simulation(block())
        with tempfile.TemporaryDirectory(prefix="lariat-test-") as folder:
            results = lariat.Results(sim, folder, surface=True)
            results.add()
            results.close()
            results.close()
            for call in (results.add, results.__enter__):
                with self.assertRaisesRegex(lariat.StateError, "closed"):
                    call()
            with self.assertRaises(TypeError):
                lariat.Results(block(), folder)
            with self.assertRaises(TypeError):
                lariat.Results(sim, 3)
            with self.assertRaises(lariat.FileError):
                lariat.Results(sim, "/proc/nowhere")
            open_ones = lariat.Results(sim, folder)
            session = lariat.Session(sim)
            with self.assertRaises(lariat.StateError):
                open_ones.add()
            session.close()
            open_ones.add()
            sim.close()
            with self.assertRaisesRegex(lariat.StateError, "closed"):
                open_ones.add()
            open_ones.close()
            with self.assertRaises(lariat.StateError):
                lariat.Results(sim, folder)

    def test_threads_and_forks(self):
        sim = lariat.Simulation(lariat.Model(os.path.join(demo(), "uterus.yaml")))
        wrong = []
        with tempfile.TemporaryDirectory(prefix="lariat-test-") as folder, \
                lariat.Results(sim, folder) as results:
            def write():
                for _ in range(20):
                    try:
                        results.add()
                    except lariat.StateError:
                        pass
                    except Exception as error:  # pylint: disable=broad-except
                        wrong.append(error)
            threads = [threading.Thread(target=write) for _ in range(3)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
        self.assertEqual(wrong, [])
        with tempfile.TemporaryDirectory(prefix="lariat-test-") as folder:
            status, said, error = child(
                "import os, lariat\nfrom common import block\n"
                f"results = lariat.Results(lariat.Simulation(block()), {folder!r})\n"
                "results.add()\n"
                "if os.fork() == 0:\n"
                "    try: results.add()\n"
                "    except lariat.StateError as e: print('fork' in str(e), flush=True)\n"
                "    del results\n    os._exit(0)\n"
                "os.wait()\nresults.add()\nresults.close()\n")
        self.assertEqual((status, said), (0, "True\n"), error)


if __name__ == "__main__":
    unittest.main()
