"""lariat.mesh: from arrays and files to meshes and models, refusals, progress."""

import array
import math
import os
import pathlib
import pickle
import subprocess
import tempfile
import threading
import unittest
import warnings

import lariat
from common import WITHOUT_NUMPY, child, numpy

LARIAT = os.environ.get("LARIAT_COMMAND")
SIZE, VOXEL = 22, 0.002
AFFINE = [[VOXEL, 0, 0, -0.02], [0, VOXEL, 0, -0.02], [0, 0, VOXEL, -0.02], [0, 0, 0, 1]]


def ball_labels(format="B"):
    """Labels [i, j, k] of a ball of label 3 that is 7 above its middle, longer along k."""
    middle = (SIZE - 1) / 2
    labels = array.array(format, bytes(array.array(format).itemsize * SIZE ** 3))
    for i in range(SIZE):
        for j in range(SIZE):
            for k in range(SIZE):
                r = math.hypot(i - middle, j - middle, (k - middle) / 1.2)
                if r < 7.5:
                    labels[(i * SIZE + j) * SIZE + k] = 7 if k > middle else 3
    return memoryview(labels).cast("B").cast(format, (SIZE, SIZE, SIZE))


def ball_surface(radius=0.02, rows=10, columns=16, at=(0.0, 0.0, 0.0)):
    """A closed ball, from outside counter-clockwise, as nested lists."""
    vertices = [[at[0], at[1], at[2] - radius]]
    for r in range(1, rows):
        t = math.pi * r / rows
        vertices += [[at[0] + radius * math.sin(t) * math.cos(2 * math.pi * c / columns),
                      at[1] + radius * math.sin(t) * math.sin(2 * math.pi * c / columns),
                      at[2] - radius * math.cos(t)] for c in range(columns)]
    vertices.append([at[0], at[1], at[2] + radius])
    ring = lambda r, c: 1 + (r - 1) * columns + c % columns
    triangles = []
    for c in range(columns):
        triangles.append([0, ring(1, c + 1), ring(1, c)])
        triangles.append([len(vertices) - 1, ring(rows - 1, c), ring(rows - 1, c + 1)])
        for r in range(1, rows - 1):
            triangles.append([ring(r, c), ring(r, c + 1), ring(r + 1, c + 1)])
            triangles.append([ring(r, c), ring(r + 1, c + 1), ring(r + 1, c)])
    return vertices, triangles


def write_obj(path, vertices, triangles):
    with open(path, "w", encoding="utf-8") as file:
        for v in vertices:
            file.write("v {!r} {!r} {!r}\n".format(*v))
        for t in triangles:
            file.write("f {} {} {}\n".format(*(i + 1 for i in t)))


def write_nrrd(path, labels):
    """i runs fastest there; the world of the format points left and back."""
    size = labels.shape
    header = ("NRRD0004\ntype: uint8\ndimension: 3\nspace: right-anterior-superior\n"
              f"sizes: {size[0]} {size[1]} {size[2]}\nencoding: raw\nendian: little\n"
              "space units: \"m\" \"m\" \"m\"\n"
              f"space directions: ({VOXEL},0,0) (0,{VOXEL},0) (0,0,{VOXEL})\n"
              "space origin: (-0.02,-0.02,-0.02)\n\n")
    with open(path, "wb") as file:
        file.write(header.encode())
        file.write(bytes(labels[i, j, k] for k in range(size[2]) for j in range(size[1])
                         for i in range(size[0])))


def moved(model, steps=60):
    with lariat.Simulation(model) as sim:
        sim.advance(steps)
        return sim.hash()


class Images(unittest.TestCase):
    def test_labels_become_what_their_file_becomes(self):
        labels = ball_labels()
        options = {"label": [3, "top"], "elements": 300, "title": "ball"}
        meshing = lariat.mesh(labels, affine=AFFINE, names={3: "liver", 7: "top"}, **options)
        with tempfile.TemporaryDirectory() as folder:
            path, names = os.path.join(folder, "ball.nrrd"), os.path.join(folder, "names.csv")
            write_nrrd(path, labels)
            with open(names, "w", encoding="utf-8") as file:
                file.write("3,liver\n7,top\n")
            again = lariat.mesh(path, names=names, **options)
            written = lariat.Model(again.write(os.path.join(folder, "out")))
            self.assertEqual(moved(meshing.model()), moved(written))
            self.assertIsNotNone(written.embedded)
        self.assertEqual(meshing.nodes.tolist(), again.nodes.tolist())
        self.assertEqual(meshing.hexahedra.tolist(), again.hexahedra.tolist())
        self.assertEqual([(r["name"], r["tag"], r["tissue"]) for r in meshing.regions],
                         [("liver", 3, "liver"), ("top", 7, "soft tissue")])
        self.assertEqual(sorted(set(meshing.tags.tolist())), [3, 7])
        self.assertEqual(len(meshing.tags), meshing.info["elements"])
        self.assertLess(0.9, meshing.info["quality"]["above_02"])
        self.assertIn("support", meshing.sets)

    def test_every_kind_of_integer_and_scale(self):
        wanted = lariat.mesh(ball_labels(), affine=AFFINE, fuse=True, elements=200).nodes.tolist()
        millimetres = [[1000 * x for x in row] for row in AFFINE[:3]]
        for format in "bHiQ":
            got = lariat.mesh(ball_labels(format), affine=millimetres, scale=0.001, fuse=True,
                              elements=200).nodes.tolist()
            self.assertLess(max(abs(a - b) for p, q in zip(wanted, got) for a, b in zip(p, q)),
                            1e-12)

    @unittest.skipUnless(numpy, WITHOUT_NUMPY)
    def test_any_order_of_axes_in_memory(self):
        labels = numpy.asarray(ball_labels())
        wanted = lariat.mesh(labels, affine=AFFINE, elements=200)
        for same in (numpy.asfortranarray(labels), numpy.repeat(labels, 2, axis=1)[:, ::2]):
            got = lariat.mesh(same, affine=numpy.array(AFFINE), elements=200)
            self.assertTrue(numpy.array_equal(wanted.nodes, got.nodes))
        got = lariat.mesh(labels > 0, affine=AFFINE, elements=200)
        self.assertEqual(got.info["regions"], 1)

    def test_voxels_as_they_are(self):
        meshing = lariat.mesh(ball_labels(), affine=AFFINE, voxel=True, fix="bottom")
        self.assertAlmostEqual(meshing.info["size"], VOXEL)
        self.assertEqual(meshing.info["fix"], "bottom")
        self.assertIn("mesh: given", meshing.scene)

    def refused(self, words, *arguments, error=ValueError, **options):
        with self.assertRaisesRegex(error, words):
            lariat.mesh(*arguments, **options)

    def test_what_is_none_is_refused(self):
        labels = ball_labels()
        self.refused("affine: an array of labels needs it", labels)
        self.refused(r"expected shape \[4, 4\]", labels, affine=AFFINE[:2])
        if numpy is not None:
            self.refused(r"\[4, 4\] or \[3, 4\], got \[3, 3\]; the fourth", labels,
                         affine=numpy.eye(3))
            self.refused("source: .*masked", numpy.ma.masked_less(numpy.asarray(labels), 1),
                         affine=AFFINE)
        self.refused("must be 0 0 0 1", labels, affine=AFFINE[:3] + [[0, 0, 1, 1]])
        self.refused("not finite", labels, affine=[[math.nan] * 4] * 3)
        self.refused("voxels are 0 m long", labels, affine=[[0, 0, 0, 0]] * 3)
        self.refused("array of integers", memoryview(bytes(400)), affine=AFFINE)
        self.refused("astype", ball_labels("d"), affine=AFFINE)
        wrong = ball_labels("i")
        wrong[1, 2, 3] = -1
        self.refused(r"voxel \(1, 2, 3\) is not between", wrong, affine=AFFINE)
        self.refused("9", labels, affine=AFFINE, label=9)
        self.refused("spleen", labels, affine=AFFINE, label="spleen")
        self.refused("label", labels, affine=AFFINE, label=3.5, error=TypeError)
        self.refused("names", labels, affine=AFFINE, names={"liver": 3})
        self.refused("names", labels, affine=AFFINE, names={70000: "liver"})
        self.refused("size and number", labels, affine=AFFINE, elements=10, size=0.01)
        self.refused("size", labels, affine=AFFINE, size=math.nan)
        self.refused("too large|more elements", labels, affine=AFFINE, size=1.0)
        self.refused("fix|left", labels, affine=AFFINE, fix="sideways")
        self.refused("progress", labels, affine=AFFINE, progress=3, error=TypeError)
        self.refused("source", 3, error=TypeError)
        self.refused("no file in the list", [])
        self.refused("affine: it belongs to an array", "ball.nrrd", affine=AFFINE)
        self.refused("none.stl", "/nowhere/none.stl", error=OSError)


class Surfaces(unittest.TestCase):
    def test_a_surface_becomes_what_its_file_becomes(self):
        vertices, triangles = ball_surface()
        meshing = lariat.mesh(vertices, triangles, title="liver", elements=300)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "liver.obj")
            write_obj(path, vertices, triangles)
            self.assertEqual(meshing.nodes.tolist(),
                             lariat.mesh(path, elements=300).nodes.tolist())
        self.assertEqual(meshing.regions[0]["tissue"], "liver")
        volume = 4 / 3 * math.pi * 0.02 ** 3
        self.assertLess(abs(meshing.info["quality"]["volume"] / volume - 1), 0.1)
        self.assertLess(0, len(meshing.surface["triangles"]))

    def test_several_in_each_other(self):
        meshing = lariat.mesh({"liver": ball_surface(20), "tumour": ball_surface(9)}, scale=0.001,
                              size=0.004)
        self.assertEqual([r["name"] for r in meshing.regions], ["liver", "tumour"])
        self.assertEqual(set(meshing.tags.tolist()), {1, 2})
        model = pickle.loads(pickle.dumps(meshing.model()))
        self.assertEqual(moved(model), moved(meshing.model()))

    def test_a_scene_of_ones_own(self):
        meshing = lariat.mesh(*ball_surface(), elements=200)
        scene = {"lariat": 1, "materials": [{"cells": "all", "law": "neo-hookean", "density": 1000,
                                             "shear_modulus": 1000.0, "bulk_modulus": 10000.0}],
                 "fix": [{"nodes": "support", "axes": "xyz"}]}
        self.assertLess(0, meshing.model(scene).info["fixed_nodes"])
        self.assertIn("Meshing", repr(meshing))

    def test_fibres_by_a_rule(self):
        surface = ball_surface()
        self.assertIsNone(lariat.mesh(*surface, elements=200).fibres)
        meshing = lariat.mesh(*surface, elements=200, title="muscle", fibres="axis: [0, 0, 2]",
                              fibres_in="muscle")
        self.assertEqual(meshing.fibres.shape, (len(meshing.tags), 3))
        self.assertGreater(abs(meshing.fibres[0, 2]), 0)
        self.assertEqual(meshing.fibres[0, 0], 0)
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(moved(meshing.model()), moved(lariat.Model(meshing.write(folder))))
        with self.assertRaisesRegex(ValueError, "bone"):
            lariat.mesh(*surface, elements=200, fibres="axis: [0, 0, 2]", fibres_in="bone")
        with self.assertRaises(ValueError):
            lariat.mesh(*surface, elements=200, fibres="sideways")
        with self.assertRaisesRegex(ValueError, "no fibres are asked for"):
            lariat.mesh(*surface, elements=200, fibres_in="muscle")

    def test_arrays_outlive_the_meshing(self):
        nodes = lariat.mesh(*ball_surface(), elements=200).nodes
        self.assertTrue(nodes.readonly)
        self.assertLess(abs(nodes[0, 0]), 0.03)

    def test_what_is_none_is_refused(self):
        vertices, triangles = ball_surface()
        for words, source in {
            "not closed|open": (vertices, triangles[1:]),
            "four triangles": (vertices, triangles[:3]),
            "there are": (vertices[:-1], triangles),
            "not finite": ([[math.inf, 0, 0]] + vertices[1:], triangles),
            "no sequence of 3": ([v[:2] for v in vertices], triangles),
        }.items():
            with self.assertRaisesRegex(ValueError, words):
                lariat.mesh(*source)
        with self.assertRaisesRegex(TypeError, "vertices, triangles"):
            lariat.mesh({"liver": vertices})
        with self.assertRaisesRegex(ValueError, "empty"):
            lariat.mesh({})
        for options in ({"label": 3}, {"names": {3: "liver"}}, {"fuse": True}):
            with self.assertRaises(ValueError):
                lariat.mesh(vertices, triangles, **options)
        with self.assertRaises(TypeError):
            lariat.Meshing()


def write_tissue(folder, name, shear, law="neo-hookean", more=""):
    """A tissue file with a comment; its path."""
    path = os.path.join(folder, name)
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"# Measured on a day in May.\nlariat-tissue: 1\nlaw: {law}\ndensity: 1000\n"
                   f"shear_modulus: {shear}\nbulk_modulus: {10 * shear}\n{more}")
    return path


class Tissues(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def in_folder(self, name):
        return os.path.join(self.folder, name)

    def moduli(self, *source, **options):
        meshing = lariat.mesh(*source, elements=200, **options)
        return {r["name"]: r["shear_modulus"] for r in meshing.regions}

    @unittest.skipUnless(LARIAT, "LARIAT_COMMAND does not say where the command is")
    def test_files_are_those_of_the_command(self):
        write_nrrd(self.in_folder("ball.nrrd"), ball_labels())
        with open(self.in_folder("names.csv"), "w", encoding="utf-8") as file:
            file.write("3,liver\n7,left kidney\n")
        soft, stiff = write_tissue(self.folder, "soft.yaml", 500), write_tissue(
            self.folder, "stiff.yaml", 900, more="fibres:\n  law: exp-pow\n  part: isochoric\n"
            "  ksi: 500\n  alpha: 1\n  beta: 2\n")
        subprocess.run(
            [LARIAT, "mesh", self.in_folder("ball.nrrd"), "--names", self.in_folder("names.csv"),
             "--elements", "300", "--title", "ball", "--out", self.in_folder("command"),
             "--fibres", "axis: [0, 0, 1]", "--fibres-in", "left kidney",
             "--tissue", soft, "--tissue", "left kidney=" + stiff],
            check=True, stdout=subprocess.DEVNULL)
        meshing = lariat.mesh(
            self.in_folder("ball.nrrd"), names=self.in_folder("names.csv"), elements=300,
            title="ball", fibres="axis: [0, 0, 1]", fibres_in="left kidney",
            tissue={None: pathlib.Path(soft), "left kidney": stiff.encode()})
        os.rename(soft, soft + ".gone")  # read once, while the mesh is made
        meshing.write(self.in_folder("module"))
        for name in ("ball.yaml", "ball.vtu", "ball_surface.vtp"):
            with open(self.in_folder("command/" + name), "rb") as one, \
                    open(self.in_folder("module/" + name), "rb") as other:
                self.assertEqual(one.read(), other.read(), name)
        self.assertIn("shear_modulus: 900", meshing.scene)
        self.assertEqual(meshing.scene.count("# Measured on a day in May."), 2)
        self.assertEqual([(r["shear_modulus"], r["bulk_modulus"], r["source"])
                          for r in meshing.regions], [(500, 5000, soft), (900, 9000, stiff)])
        self.assertEqual(moved(meshing.model()),
                         moved(lariat.Model(self.in_folder("command/ball.yaml"))))

    def test_of_which_regions(self):
        one, two = (write_tissue(self.folder, name, shear)
                    for name, shear in (("a=b.yaml", 500), ("two.yaml", 900)))
        both = {"liver": ball_surface(), "rib": ball_surface(0.01)}
        literature = self.moduli(both)
        self.assertEqual(self.moduli(both, tissue=one), {**literature, "liver": 500})
        self.assertEqual(self.moduli(both, tissue={"rib": two}), {**literature, "rib": 900})
        self.assertEqual(self.moduli(both, tissue={"liver": two, None: one, "rib": two}),
                         {"liver": 500, "rib": 900})
        self.assertEqual(self.moduli(both, tissue={}), literature)
        labels = {"affine": AFFINE, "fix": "bottom"}
        self.assertEqual(self.moduli(ball_labels(), tissue={"label_3": one, "label_7": two},
                                     **labels), {"label_3": 500, "label_7": 900})

    def test_what_is_none_is_refused(self):
        soft, slip = write_tissue(self.folder, "soft.yaml", 500), write_tissue(
            self.folder, "slip.yaml", 500, law="neo-hokean")
        fibrous = write_tissue(self.folder, "fibrous.yaml", 500, more="fibres: { law: exp-pow, "
                               "part: isochoric, ksi: 500, alpha: 1, beta: 2 }\n")
        fault = (ValueError, TypeError, OSError)
        for words, tissue in {
            r"no\.yaml: cannot be opened": self.in_folder("no.yaml"),
            r"slip\.yaml:3:6: the law \"neo-hokean\" is unknown": slip,
            r"fibrous\.yaml: it has fibres; say along what they run in liver": fibrous,
            "for \"kidney\", but the regions are liver; name one": {"kidney": soft},
            "expected a path or a dict of regions to paths, got <class 'list'>": [soft],
            "tissue: expected a path, got <class 'NoneType'>": {"liver": None},
            "tissue: expected names of regions .*, got 3": {3: soft},
            "a region that is called 'a=b' cannot": {"a=b": soft},
            "a region that is called '' cannot": {"": soft},
            "character 0": {"liver": soft + "\0"},
            "character 0|null": {"li\0ver": soft},
            "at most 255": {str(number): soft for number in range(256)},
        }.items():
            with self.subTest(words), self.assertRaisesRegex(fault, words):
                lariat.mesh(*ball_surface(), elements=200, title="liver", tissue=tissue)
        with self.assertRaises(lariat.FileError):
            lariat.mesh(*ball_surface(), elements=200, tissue=self.in_folder("no.yaml"))


class Units(unittest.TestCase):
    def test_a_body_in_millimetres_is_doubted(self):
        vertices, triangles = ball_surface(20)
        with self.assertWarnsRegex(UserWarning, "scale=0.001"):
            lariat.mesh(vertices, triangles, elements=200)
        with self.assertWarnsRegex(UserWarning, "liver"):
            lariat.mesh(*ball_surface(2), elements=200, title="liver")
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            lariat.mesh(vertices, triangles, elements=200, scale=0.001)
            with self.assertRaises(UserWarning):
                lariat.mesh(vertices, triangles, elements=200)


class Progress(unittest.TestCase):
    def test_it_is_told_and_can_stop(self):
        told = []
        lariat.mesh(*ball_surface(), elements=200, progress=lambda *s: told.append(s))
        self.assertLess(3, len({what for what, _ in told}))
        self.assertTrue(all(0 <= part <= 1 for _, part in told))
        with self.assertRaisesRegex(lariat.ArgumentError, "stopped while the mesh was fitted"):
            lariat.mesh(*ball_surface(), progress=lambda what, part: what != "fitting")

    def test_its_exceptions_come_out(self):
        def fail(what, part):
            raise KeyError(what)
        with self.assertRaises(KeyError):
            lariat.mesh(*ball_surface(), progress=fail)

    def test_others_run_meanwhile(self):
        def work(into):
            into.append(lariat.mesh(*ball_surface(), elements=300).nodes.tolist())
        made = []
        threads = [threading.Thread(target=work, args=(made,)) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(made[0], made[1])
        self.assertEqual(made[0], made[2])

    @unittest.skipIf(os.environ.get("LARIAT_TEST_SANITIZED"), "another process has no sanitizer")
    def test_control_c(self):
        status, out, _ = child(
            "import os, signal, threading\nimport lariat, test_meshing\n"
            "threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()\n"
            "try:\n"
            "    while True: lariat.mesh(*test_meshing.ball_surface(), elements=20000)\n"
            "except KeyboardInterrupt:\n    print('stopped')\n")
        self.assertEqual((status, out), (0, "stopped\n"))


if __name__ == "__main__":
    unittest.main()
