"""info, requirements, predict, fit, profiles: the command as a child, scenes and tables in memory."""

import array
import os
import pickle
import shutil
import subprocess
import sys
import tempfile
import threading
import unittest
import warnings

import lariat
from common import SCENE, WITHOUT_NUMPY, block, block_arrays, child, demo, numpy

NODES = [[0.01 * i, 0.01 * j, 0.02 * k] for k in (0, 1) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
BAR = {
    "lariat": 1,
    "materials": [{"cells": "all", "name": "gel", "law": "neo-hookean", "density": 1050,
                   "shear_modulus": 1.0e3, "bulk_modulus": 4.0e4}],
    "fix": [{"nodes": "low", "axes": "z"}, {"nodes": {"nearest": [0, 0, 0]}, "axes": "xy"},
            {"nodes": {"nearest": [0.01, 0, 0]}, "axes": "y"}],
    "move": [{"nodes": "high", "axes": "z", "by": 0.002, "over": 1}],
}
# Force of a neo-Hookean bar that keeps its volume, G = 2000 Pa: G A (s - 1 / s^2).
PULLED = [0.001, 0.002, 0.003, 0.004]
FORCE = [2000 * 1e-4 * (s - 1 / s ** 2) for s in (1 + d / 0.02 for d in PULLED)]


def bar(**changes):
    return lariat.Model.from_arrays(NODES, [list(range(8))], {**BAR, **changes},
                                    sets={"low": [0, 1, 2, 3], "high": [4, 5, 6, 7]})


def experiment(scene=None, **changes):
    return {"parameters": [{"material": "gel", "parameter": "shear_modulus", "guess": 1500,
                            "bounds": [100, 1e5]}],
            "experiments": [{"kind": "tension", "name": "a pull", "scene": scene or bar(),
                             "data": {"displacement": PULLED, "force": FORCE}, **changes}]}


class Quick(unittest.TestCase):
    def setUp(self):
        """Nothing stays in the folder for temporary files, which is this test's own."""
        demo()
        folder = tempfile.TemporaryDirectory(prefix="lariat-test-")
        before, tempfile.tempdir = tempfile.tempdir, folder.name

        def look():
            tempfile.tempdir = before
            with folder:
                self.assertEqual(os.listdir(folder.name), [])
        self.addCleanup(look)

    def test_info_of_paths_models_and_dicts(self):
        path = os.path.join(demo(), "uterus.yaml")
        told = lariat.info(path, speed=False)
        self.assertEqual((told.nodes, told.elements, told.title), (2567, 1840, "Uterus"))
        self.assertGreater(told.quality.above_02, 0.99)
        self.assertFalse(hasattr(told, "speed"))
        self.assertEqual(told, lariat.info(lariat.Model(path), speed=False))
        self.assertEqual(told, pickle.loads(pickle.dumps(told)))
        self.assertIn("nodes=2567", repr(told))
        self.assertEqual(vars(told)["nodes"], 2567)
        scene = {**SCENE, "mesh": os.path.relpath(os.path.join(demo(), "uterus.vtu")), "fix": []}
        self.assertEqual(lariat.info(scene, speed=False).nodes, 2567)
        self.assertTrue(hasattr(lariat.info(block()), "speed"))

    def test_a_model_of_arrays_comes_back_as_it_was(self):
        nodes, hexahedra, sets = block_arrays()
        count = len(hexahedra)
        sets = {**sets, "a side, 1": ("elements", [0, 1, 2]), "grüße": ("faces", [4, 10])}
        model = lariat.Model.from_arrays(
            nodes, hexahedra, {**SCENE, "title": 'say "mesh: given"'}, sets=sets,
            tags=[e % 3 for e in range(count)], fibres=[[0, 0, 1]] * count)
        told = lariat.info(model, speed=False)
        self.assertEqual((told.nodes, told.elements, told.title, told.lower, told.upper),
                         (len(nodes), count, 'say "mesh: given"', [0, 0, 0], [0.06, 0.05, 0.03]))
        self.assertEqual([(s.name, s.kind, s.count) for s in told.sets],
                         [(s["name"], s["kind"], s["count"]) for s in model.sets])
        from lariat._scenes import Folder
        with Folder() as folder:
            name = folder.model(model)
            again = lariat.Model(os.path.join(folder.path, name))
            for one, other in ((model.positions, again.positions),
                               (model.hexahedra, again.hexahedra)):
                self.assertEqual(one.tobytes(), other.tobytes())
            sim, same = lariat.Simulation(model), lariat.Simulation(again)
            sim.advance(50)
            same.advance(50)
            self.assertEqual(sim.hash(), same.hash())
        for text in ("lariat: 1\nmaterials: [{cells: all, law: neo-hookean, density: 1000, "
                     "shear_modulus: 1.0e3, bulk_modulus: 1.0e4}]\n",
                     "%YAML 1.1\n---\nmesh: given # here\nlariat: 1\nmaterials: [{cells: all, law: "
                     "neo-hookean, density: 1000, shear_modulus: 1.0e3, bulk_modulus: 1.0e4}]\n",
                     " { lariat: 1, materials: [{cells: all, law: neo-hookean, density: 1000, "
                     "shear_modulus: 1.0e3, bulk_modulus: 1.0e4}] }"):
            model = lariat.Model.from_arrays(nodes, hexahedra, text)
            self.assertEqual(lariat.info(model, speed=False).materials[0].density, 1000)
        self.assertEqual(lariat.info(lariat.Model.from_arrays(nodes, hexahedra)).nodes, len(nodes))

    def test_requirements_and_predict(self):
        need = lariat.requirements(block(), grid="2x1x1", speed=False)
        self.assertEqual(need.grid, [2, 1, 1])
        self.assertGreater(need.needs[0].operations_per_step, 1000)
        self.assertFalse(hasattr(lariat.requirements(thesis=True, speed=False), "title"))
        with tempfile.TemporaryDirectory(prefix="lariat-test-") as folder:
            trace = os.path.join(folder, "trace.csv")
            told = lariat.predict(block(), "2x1x1", machine="infiniband", trace=trace, latency=2.5)
            self.assertTrue(os.path.getsize(trace))
        self.assertEqual((told.processors, told.machine.latency.value), (2, 2.5))
        self.assertGreater(told.step_us, 2.5)
        names = [m.name for m in lariat.predict(list_machines=True).machines]
        self.assertIn("thesis", names)
        rows = lariat.predict(scale_to=[8, 27], elements_per_processor=8, scheme="all").scaling
        self.assertEqual([row.processors for row in rows], [8, 27])

    def test_refusals(self):
        missing = os.path.join(demo(), "nowhere.yaml")
        model = block()
        for kind, words, call in (
                (lariat.FileError, "nowhere.yaml", lambda: lariat.info(missing)),
                (lariat.FileError, "nowhere.yaml", lambda: lariat.fit(missing)),
                (lariat.FormatError, "^model: a scene needs the key .materials",
                 lambda: lariat.info({"lariat": 1, "mesh": os.path.join(demo(), "uterus.vtu")})),
                (lariat.FormatError, "^model.gravitas: the key", lambda: lariat.info(
                    {**SCENE, "mesh": os.path.join(demo(), "uterus.vtu"), "gravitas": 1})),
                (lariat.ModelError, "^model.mesh: given stands for",
                 lambda: lariat.info({**SCENE, "mesh": "given"})),
                (lariat.FileError, "nowhere.stl: cannot",
                 lambda: lariat.info(model, against="/nowhere.stl", speed=False)),
                (lariat.Error, r"^experiment.experiments\[0\].scene: scene.gravitas: the key",
                 lambda: lariat.fit(experiment({**SCENE, "gravitas": 1}))),
                (lariat.Error, r"^experiment.experiments\[0\].kind: ",
                 lambda: lariat.fit(experiment(kind="tensions"))),
                (lariat.Error, r"^experiment.experiments\[0\]: the scene has 0 entries",
                 lambda: lariat.fit(experiment(bar(move=[])))),
                (lariat.ArgumentError, "^latency nan: ",
                 lambda: lariat.predict(model, latency=float("nan"))),
                (lariat.ArgumentError, r"predict\(list_machines=True\)",
                 lambda: lariat.predict(model, machine="none")),
                (lariat.ArgumentError, "^model is missing; give one, or scale_to", lariat.predict),
                (TypeError, "got None", lambda: lariat.info(None)),
                (lariat.ArgumentError, "scale -1", lambda: lariat.info(model, against="x", scale=-1)),
                (lariat.ArgumentError, "character 0", lambda: lariat.predict(model, "2\0")),
                (lariat.ArgumentError, "expected a path", lambda: lariat.info("")),
                (lariat.Error, "no grid", lambda: lariat.predict(model, "axb")),
                (lariat.ArgumentError, "which model", lariat.requirements),
                (TypeError, "expected a Model", lambda: lariat.info(3)),
                (TypeError, "expected a path or a dict", lambda: lariat.fit(None)),
                (TypeError, "progress: ", lambda: lariat.fit(missing, progress=3)),
                (lariat.ArgumentError, "list of dicts", lambda: lariat.fit({"experiments": 3})),
                (lariat.Error, 'key "parameters"', lambda: lariat.fit({"experiments": []})),
                (TypeError, r'data\["force"\]: expected',
                 lambda: lariat.fit(experiment(data={"force": "abc"}))),
                (lariat.ArgumentError, r'data\["force"\]: row 1 is nan',
                 lambda: lariat.fit(experiment(data={"force": [1, float("nan")]}))),
                (lariat.ArgumentError, "expected 4 rows",
                 lambda: lariat.fit(experiment(data={"displacement": PULLED, "force": [1]}))),
                (lariat.ArgumentError, "name of a column",
                 lambda: lariat.fit(experiment(data={"a,b": [1]}))),
                (lariat.ArgumentError, "no column", lambda: lariat.fit(experiment(data={}))),
                (TypeError, "nothing that scenes", lambda: lariat.fit(experiment(noise=object()))),
                (lariat.ArgumentError, r"^experiment\.experiments\[0\]\.noise: inf is not",
                 lambda: lariat.fit(experiment(noise=float("inf")))),
                (lariat.Error, r"^experiment\.experiments\[0\]\.data: the column force is missing, "
                 r"which tension needs; .* in experiment\.experiments\[0\]$",
                 lambda: lariat.fit(experiment(data={"stretch": [1, 2]}))),
                (lariat.Error, r"^experiment\.experiments\[0\]\.data, row 2: displacement is 7 m, "
                 "and the body of the scene is only",
                 lambda: lariat.fit(experiment(data={"displacement": [0.001, 0.002, 7],
                                                     "force": [1, 2, 3]}))),
                (lariat.Error, r"scene\.time_step: time step 1 s is above",
                 lambda: lariat.fit(experiment(bar(time_step=1.0)))),
                (lariat.Error, "image", lambda: lariat.profiles(
                    demo(), {"mm_per_pixel": 0.1, "axis_pixel": 5, "rim_pixel": 5,
                             "radius_mm": 1}))):
            with self.subTest(words), self.assertRaisesRegex(kind, words):
                call()

    def test_answers_name_keys_of_a_dict_and_no_files(self):
        told = lariat.requirements(block(damping=1e7)).why_not
        self.assertRegex(told, r"^scene\.damping: damping 1e\+07 1/s stops")
        probe = {"name": "p", "nodes": {"nearest": [0, 0, 0]}, "sum": "reaction"}
        scene = {**SCENE, "mesh": os.path.join(demo(), "uterus.vtu"), "fix": [], "tools": [],
                 "output": {"probes": [probe]}}
        self.assertRegex(lariat.info(scene, speed=False).notices[0],
                         r"^model\.output\.probes\[0\]: the probe")

    def test_millimetres_are_a_warning(self):
        nodes, hexahedra, _ = block_arrays()
        large = lariat.Model.from_arrays([[1000 * x for x in n] for n in nodes], hexahedra)
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            lariat.info(large, speed=False)
        self.assertEqual([w.category for w in said], [UserWarning])
        self.assertIn("millimetres", str(said[0].message))
        self.assertEqual(said[0].filename, __file__)


    def test_profiles_fail_as_all_else(self):
        with tempfile.TemporaryDirectory(prefix="lariat-test-") as folder:
            with self.assertRaises(lariat.FormatError) as raised:
                lariat.profiles(folder, {"no key": 1})
            self.assertEqual(raised.exception.status, "format")
            with self.assertRaises(lariat.FileError) as raised:
                lariat.profiles(folder, os.path.join(folder, "none.yaml"))
            self.assertIsInstance(raised.exception, OSError)


def can_fit():
    try:
        lariat.fit(experiment())
    except lariat.Error as error:
        if "without cminpack" in str(error):
            return False
        raise
    return True


class Fits(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if not can_fit():
            raise unittest.SkipTest("built without cminpack")

    def test_from_arrays(self):
        told = []
        with tempfile.TemporaryDirectory(prefix="lariat-test-") as folder:
            out = os.path.join(folder, "out")
            fit = lariat.fit(experiment(), out=out, progress=told.append)
            found = fit["shear_modulus"]
            self.assertEqual(sorted(os.listdir(out)), ["1_a_pull.svg", "fit.json", "gel.tissue.yaml"])
            self.assertEqual((found.tissue, fit.experiments[0].picture),
                             (os.path.join(out, "gel.tissue.yaml"), os.path.join(out, "1_a_pull.svg")))
            tissue = bar(materials=[{"cells": "all", "law": "neo-hookean", "density": 1050,
                                     "shear_modulus": found.value, "bulk_modulus": 4.0e4}])
            self.assertEqual(tissue.node_count, 8)
        self.assertLess(abs(found.value / 2000 - 1), 0.05)  # it is a little compressible
        self.assertTrue(found.low < found.value < found.high and found.told and fit.converged)
        self.assertIs(fit["gel", "shear_modulus"], found)
        self.assertEqual((fit.untold, fit.interrupted, list(found.correlation)), ([], False, [1.0]))
        left = fit.experiments[0]
        self.assertEqual(list(left.measured), FORCE)
        self.assertEqual(list(left.residuals), [m - f for m, f in zip(left.model, FORCE)])
        self.assertIsInstance(left.model, array.array)
        self.assertEqual(fit, pickle.loads(pickle.dumps(fit)))
        for key in ("c1", ("liver", "shear_modulus")):
            with self.assertRaises(KeyError):
                fit[key]
        self.assertGreaterEqual(len(told), 2)
        self.assertEqual(set(told[0]), {"doing", "residual", "runs", "remaining"})
        self.assertEqual(told[-1]["runs"], fit.runs)
        if numpy is not None:
            self.assertEqual(numpy.asarray(left.model).shape, (4,))

    def test_of_files_with_one_model_in_two_experiments(self):
        with tempfile.TemporaryDirectory(prefix="lariat-test-") as folder:
            table = os.path.join(folder, "pull.csv")
            with open(table, "w", encoding="utf-8") as file:
                file.write("displacement,force\n" + "".join(
                    f"{d!r},{f!r}\n" for d, f in zip(PULLED, FORCE)))
            model = bar()
            both = experiment(model)
            both["experiments"].append({"kind": "tension", "name": "again", "scene": model,
                                        "data": table, "noise": 0.001})
            fit = lariat.fit(both)
        self.assertEqual([e.values for e in fit.experiments], [4, 4])
        self.assertEqual(fit.experiments[0].scene, fit.experiments[1].scene)
        self.assertIsNone(fit.parameters[0].tissue)

    @unittest.skipIf(numpy is None, WITHOUT_NUMPY)
    def test_of_numpy(self):
        fit = lariat.fit(experiment(data={"displacement": numpy.array(PULLED),
                                          "force": numpy.array(FORCE)}, noise=numpy.float64(1e-3)))
        self.assertTrue(fit.converged)

    def test_failures_have_the_kinds_of_all_others(self):
        def fails(kind, sentence, *args, **keywords):
            with self.assertRaisesRegex(kind, sentence) as raised:
                lariat.fit(*args, **keywords)
            self.assertEqual(raised.exception.status, kind.status)

        no_such = experiment()
        no_such["parameters"][0]["material"] = "liver"
        unknown = {**experiment(), "parametres": []}
        falls = experiment(data={"displacement": PULLED, "force": [-f for f in FORCE]})
        missing = experiment(data="missing.csv")
        fails(lariat.ModelError, "liver", no_such)
        fails(lariat.FormatError, "parametres", unknown)
        fails(lariat.ModelError, "opposite sign", falls)
        fails(lariat.FileError, "missing.csv", missing)
        with tempfile.NamedTemporaryFile() as file:
            fails(lariat.FileError, "as a folder", experiment(), out=file.name)

    def test_unstable_guess(self):
        with self.assertRaises(lariat.Error):
            lariat.fit(experiment(bar(time_step=1.0e-2)))

    def test_callbacks_end_it(self):
        fit = lariat.fit(experiment(), progress=lambda now: False)
        self.assertTrue(fit.interrupted and not fit.converged)
        self.assertEqual([note.split()[0] for note in fit.notes], ["interrupted"])
        self.assertFalse(fit.experiments[0].systematic)
        self.assertNotEqual(fit.parameters[0].low, fit.parameters[0].low)  # nan
        with self.assertRaisesRegex(ZeroDivisionError, "division"):
            lariat.fit(experiment(), progress=lambda now: 1 / 0)
        self.assertEqual(children(), [])

    def test_other_threads_run(self):
        fits = []
        thread = threading.Thread(target=lambda: fits.append(lariat.fit(experiment())))
        thread.start()
        turns = 0
        while thread.is_alive():
            turns += 1
        thread.join()
        self.assertTrue(fits[0].converged)
        self.assertGreater(turns, 1000)


def children():
    with open(f"/proc/self/task/{os.getpid()}/children", encoding="ascii") as file:
        return file.read().split()


class Children(unittest.TestCase):
    def runs(self, code):
        status, said, error = child("import os, signal, threading, time, lariat, test_study\n" + code)
        self.assertEqual(status, 0, said + error)
        return said

    def test_ctrl_c(self):
        if not can_fit():
            self.skipTest("built without cminpack")
        interrupt = "os.kill(os.getpid(), signal.SIGINT)"
        self.assertEqual(self.runs(  # with an answer
            "import sys\n"
            f"def press(now):\n    {interrupt}\n    time.sleep(0.1)\n"
            "fit = lariat.fit(test_study.experiment(), progress=press)\n"
            "print(fit.interrupted, test_study.children())\n"), "True []\n")
        self.assertEqual(self.runs(  # before there is one
            f"threading.Timer(1, lambda: {interrupt}).start()\n"
            "slow = test_study.bar(time_step=1e-9)\n"
            "try:\n    lariat.fit(test_study.experiment(slow))\n"
            "except KeyboardInterrupt:\n    print('stopped', test_study.children())\n"),
            "stopped []\n")

    def test_programs_of_another_version_are_refused(self):
        with tempfile.TemporaryDirectory(prefix="lariat-test-") as folder:
            package = os.path.join(folder, "a", "b", "c", "d", "lariat")
            shutil.copytree(os.path.dirname(lariat.__file__), package)
            where = os.path.join(folder, "bin")
            os.mkdir(where)
            fake = os.path.join(where, "lariat")

            def says(path):
                done = subprocess.run(
                    [sys.executable, "-B", "-c", "import sys; sys.path.insert(0, sys.argv[1])\n"
                     "import lariat\nassert lariat.__file__.startswith(sys.argv[1])\n"
                     "import sysconfig; sysconfig.get_path = lambda name: sys.argv[1]\n"
                     "try:\n    print(lariat.info('x.yaml'))\n"
                     "except lariat.UnsupportedError as error: print(error)", os.path.dirname(package)],
                    env={**os.environ, "PATH": path, "LD_LIBRARY_PATH": os.path.dirname(
                        os.path.dirname(os.path.dirname(lariat.__file__)))},
                    capture_output=True, text=True, check=False)
                return done.stdout + done.stderr
            self.assertIn("neither beside the module nor on the PATH", says(where))
            with open(fake, "w", encoding="ascii") as file:
                file.write("#!/bin/sh\necho lariat 0.0.1\n")
            os.chmod(fake, 0o755)
            self.assertIn("bin/lariat is of version 0.0.1, and this module of version "
                          + lariat.__version__, says(where))
            with open(fake, "w", encoding="ascii") as file:
                file.write("#!/bin/sh\nexit 3\n")
            self.assertIn("another program", says(where))


if __name__ == "__main__":
    unittest.main()
