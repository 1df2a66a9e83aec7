"""class Model: files, arrays, what it says of itself."""

import array
import copy
import math
import os
import pickle
import unittest

import lariat
from common import SCENE, WITHOUT_NUMPY, block, block_arrays, demo, numpy


class Files(unittest.TestCase):
    def test_a_scene_is_read_and_says_what_it_is(self):
        model = lariat.Model(os.path.join(demo(), "uterus.yaml"))
        info = model.info
        self.assertEqual((info["nodes"], info["elements"]), (2567, 1840))
        self.assertEqual((model.node_count, model.element_count), (2567, 1840))
        self.assertEqual(info["materials"], len(model.materials))
        self.assertEqual(model.positions.shape, (2567, 3))
        self.assertEqual(model.hexahedra.shape, (1840, 8))
        self.assertIn("fundus", [s["name"] for s in model.sets])
        self.assertLess(0, info["time_step"])
        faces, nodes = model.surface["faces"], model.surface["nodes"]
        self.assertEqual(sorted({n for face in faces.tolist() for n in face}), nodes.tolist())

    def test_paths_may_be_bytes_and_path_objects(self):
        import pathlib
        path = pathlib.Path(demo()) / "uterus.yaml"
        self.assertEqual(lariat.Model(path).node_count, lariat.Model(os.fsencode(path)).node_count)

    def test_a_missing_file_is_an_os_error_that_names_it(self):
        with self.assertRaisesRegex(OSError, "none.yaml") as caught:
            lariat.Model("/nowhere/none.yaml")
        self.assertIsInstance(caught.exception, lariat.FileError)
        self.assertEqual(caught.exception.status, "io")

    def test_views_keep_the_model_alive_and_are_read_only(self):
        positions = lariat.Model(os.path.join(demo(), "uterus.yaml")).positions
        self.assertTrue(positions.readonly)
        self.assertLess(abs(positions[0, 0]), 1)
        with self.assertRaises(TypeError):
            positions[0, 0] = 1.0


class Arrays(unittest.TestCase):
    def test_lists_and_a_dict_do(self):
        model = block()
        self.assertEqual(model.info["title"], "Block")
        self.assertEqual(model.positions.tolist(), block_arrays()[0])
        self.assertEqual(model.hexahedra.tolist(), block_arrays()[1])
        self.assertEqual(model.tools[0]["name"], "probe")
        self.assertIn({"name": "top", "kind": "nodes", "count": 42}, model.sets)

    def test_mass_scaling_is_a_key_like_others(self):
        told = block().info["mass_scaling"]
        self.assertEqual((told["time_step"], told["elements"], told["added"]), (0, 0, 0))
        step = 1.01 * told["stable_step"]
        info = block(mass_scaling={"time_step": step, "largest_share": 0.1}).info
        told = info["mass_scaling"]
        self.assertAlmostEqual(info["stable_step"], step, delta=1e-12)
        self.assertLess(0, told["elements"])
        self.assertAlmostEqual(told["factor"], 1.01**2, delta=1e-9)
        self.assertAlmostEqual(told["added"], told["share"] * info["mass"], delta=1e-15)
        self.assertEqual(told["strained_share"], 0)
        strained = block(mass_scaling={"strained": 0.02})
        self.assertEqual(strained.info["mass_scaling"]["strained_share"], 0.02)
        with lariat.Simulation(strained) as sim:
            sim.advance(5)
            self.assertEqual(sim.info["heavier"], {"elements": 0, "share": 0, "mean_share": 0,
                                                   "largest_share": 0})
        with self.assertRaisesRegex(lariat.Error, "largest_share of 5 %"):
            block(mass_scaling={"time_step": 2 * step}).info

    def test_text_and_dict_are_the_same_model(self):
        import json
        nodes, hexahedra, sets = block_arrays()
        text = lariat.Model.from_arrays(nodes, hexahedra, json.dumps(SCENE).replace('"all"', "all"),
                                         sets=sets)
        hashes = []
        for model in (text, block()):
            sim = lariat.Simulation(model)
            sim.advance(50)
            hashes.append(sim.hash())
        self.assertEqual(hashes[0], hashes[1])

    def test_a_title_of_any_characters(self):
        self.assertEqual(block(title="Gebärmutter 子宮 \U0001f600").info["title"],
                         "Gebärmutter 子宮 \U0001f600")

    def test_sets_of_other_kinds_and_tags(self):
        nodes, hexahedra, sets = block_arrays()
        sets["half"] = ("elements", list(range(45)))
        sets["side"] = ("faces", [0, 6, 12])
        model = lariat.Model.from_arrays(nodes, hexahedra, SCENE, sets=sets, tags=[7] * 90)
        kinds = {s["name"]: s["kind"] for s in model.sets}
        self.assertEqual((kinds["half"], kinds["side"]), ("elements", "faces"))

    def test_buffers_without_numpy(self):
        nodes, hexahedra, sets = block_arrays()
        flat = array.array("d", [x for node in nodes for x in node])
        view = memoryview(flat).cast("B").cast("d", (len(nodes), 3))
        model = lariat.Model.from_arrays(view, hexahedra, SCENE, sets=sets)
        self.assertEqual(model.positions.tolist(), nodes)

    def test_names_with_control_characters(self):
        nodes, hexahedra, _ = block_arrays()
        for name in ("tab\tname", "tab\nname", "\x7f", "\x85"):
            with self.assertRaisesRegex(lariat.ArgumentError, "control character.*leave it out"):
                lariat.Model.from_arrays(nodes, hexahedra, sets={"good": [1], name: [1]})
            scene = {**SCENE, "materials": [{**SCENE["materials"][0], "name": name}]}
            with self.assertRaisesRegex(lariat.ArgumentError,
                                        r"scene\.materials\[0\]\.name.*control character"):
                lariat.Model.from_arrays(nodes, hexahedra, scene)

    def test_dicts_that_no_scene_can_be(self):
        nodes, hexahedra, _ = block_arrays()
        itself = {**SCENE}
        itself["tools"] = [itself]
        with self.assertRaisesRegex(lariat.ArgumentError, r"scene\.tools\[0\]: it contains itself"):
            lariat.Model.from_arrays(nodes, hexahedra, itself)
        with self.assertRaisesRegex(TypeError, r"scene\.fix: .*write a list"):
            lariat.Model.from_arrays(nodes, hexahedra, {**SCENE, "fix": {1, 2}})
        corner = [0, 0, 0]  # twice, and not in itself
        lariat.Model.from_arrays(nodes, hexahedra, {**SCENE, "fix": [
            {"nodes": {"box": [corner, corner]}, "axes": "xyz"}]}, sets={"floor": [1]})

    def test_pickles(self):
        for model in (block(), lariat.Model(os.path.join(demo(), "uterus.yaml"))):
            again = pickle.loads(pickle.dumps(model))
            self.assertEqual(again.positions.tolist(), model.positions.tolist())
            self.assertEqual(again.sets, model.sets)

    def test_two_families_of_fibres(self):
        nodes, hexahedra, sets = block_arrays()
        count = len(hexahedra)

        def scene(**directions):
            pair = {"law": "hgo", "part": "isochoric", "k1": 2e4, "k2": 0.8, "kappa": 0.1}
            return {**SCENE, "materials": [{**SCENE["materials"][0],
                                            "fibres": {**pair, **directions}}]}

        def hash_of(model):
            simulation = lariat.Simulation(model)
            simulation.advance(100)
            return simulation.hash()

        given = scene(direction="mesh", second="mesh")
        model = lariat.Model.from_arrays(nodes, hexahedra, given, sets=sets,
                                         fibres=[[0, 3, 4]] * count, fibres2=[[2, 0, 0]] * count)
        rule = lariat.Model.from_arrays(
            nodes, hexahedra, scene(direction={"axis": [0, 3, 4]}, second={"axis": [1, 0, 0]}),
            sets=sets)
        self.assertEqual(hash_of(model), hash_of(rule))
        self.assertEqual(hash_of(pickle.loads(pickle.dumps(model))), hash_of(rule))
        self.assertEqual(model.materials[0]["fibre_families"], 2)
        self.assertAlmostEqual(model.materials[0]["fibre_dispersion"], 0.1)
        told = lariat.info(model, speed=False)  # through a file
        self.assertEqual((told.fibre_elements, told.materials[0].fibre_families), (count, 2))
        self.assertAlmostEqual(told.materials[0].fibre_angle, 90)
        self.refuses(lariat.ModelError, "second: mesh, but no mesh has directions", scene=given,
                     fibres=[[0, 3, 4]] * count)

    def refuses(self, kind, words, nodes=None, hexahedra=None, scene=None, **others):
        whole_nodes, whole_hexahedra, sets = block_arrays()
        others.setdefault("sets", sets)
        with self.assertRaisesRegex(kind, words):
            lariat.Model.from_arrays(whole_nodes if nodes is None else nodes,
                                     whole_hexahedra if hexahedra is None else hexahedra,
                                     SCENE if scene is None else scene, **others)

    def test_what_cannot_be_says_what_was_expected(self):
        nodes, hexahedra, _ = block_arrays()
        bad = [list(n) for n in nodes]
        bad[5][1] = float("nan")
        self.refuses(ValueError, r"nodes: row 5 .*finite", nodes=bad)
        self.refuses(ValueError, r"nodes: row 0 .* 3 numbers", nodes=[[0, 0]])
        self.refuses(TypeError, r"nodes: expected an array of float64 of shape \[n, 3\]", nodes=7)
        self.refuses(TypeError, r"nodes: expected", nodes="abc")
        self.refuses(ValueError, r"\[n, 3\].*format 'd' of shape \[3\]",
                     nodes=array.array("d", [1, 2, 3]))
        self.refuses(TypeError, "hexahedra: row 0 .* no whole number", hexahedra=[[0.5] * 8])
        self.refuses(TypeError, "nodes: row 1 .* no number", nodes=[[0, 0, 0], [0, "x", 0]])
        self.refuses(ValueError, "hexahedra: row 0 .* too large", hexahedra=[[2**70] * 8])
        self.refuses(ValueError, "32-bit", hexahedra=[[2**40] * 8])
        self.refuses(lariat.ModelError, "node", hexahedra=hexahedra + [[9999] * 8])
        self.refuses(ValueError, "tags: expected one row for each of 90", tags=[1, 2])
        self.refuses(TypeError, "sets: expected a dict", sets=[1])
        self.refuses(TypeError, "names as keys", sets={3: [1]})
        self.refuses(ValueError, "character 0", sets={"a\0b": [1]})
        self.refuses(ValueError, "fibres: expected one row", fibres=[[1, 0, 0]])
        self.refuses(ValueError, "fibres2: expected one row", fibres2=[[1, 0, 0]])
        self.refuses(TypeError, "scene: expected a str", scene=5)
        self.refuses(TypeError, "scene.lariat: a value", scene={"lariat": {1, 2}})
        self.refuses(ValueError, "scene: there is a character 0", scene="lariat: 1\0")
        self.refuses(lariat.FormatError, "gravitas", scene={**SCENE, "gravitas": 1})
        self.refuses(lariat.ArgumentError, r"^scene\.damping: nan is not a finite number$",
                     scene={**SCENE, "damping": float("nan")})
        self.refuses(lariat.ArgumentError, r"^scene\.gravity\[2\]: -inf is not",
                     scene={**SCENE, "gravity": (0, 0, -math.inf)})
        self.refuses(lariat.ArgumentError, r"^scene\.materials\[0\]\.name: None is no value",
                     scene={**SCENE, "materials": [{**SCENE["materials"][0], "name": None}]})
        self.refuses(lariat.ArgumentError, r"^scene\.title: None", scene={**SCENE, "title": None})
        endless = {**SCENE}
        endless["sets"] = [endless]
        self.refuses(lariat.ArgumentError, r"^scene\.sets\[0\]: it contains itself", scene=endless)

    def test_what_is_wrong_in_a_dict_is_named_by_its_keys(self):
        material, tool = SCENE["materials"][0], SCENE["tools"][0]
        grasper = {"name": "g", "shape": "grasper", "radius": 0.002, "length": 0.02,
                   "at": [0.03, 0.025, 0.06]}
        for words, changes in (
                (r"gravitas: the key", {"gravitas": 1}), (r"damping: expected", {"damping": "20"}),
                (r"materials\[0\]\.shear_modulus: shear_modulus is -3",
                 {"materials": [{**material, "shear_modulus": -3}]}),
                (r"materials\[1\]\.name: a second",  {"materials": [material, material]}),
                (r"fix\[1\]\.nodes: the set", {"fix": [*SCENE["fix"], {"nodes": "x", "axes": "z"}]}),
                (r"tools\[0\]: the tool would", {"tools": [{**tool, "at": [0.03, 0.02, 0.01]}]}),
                (r"tools\[1\]\.at: expected", {"tools": [tool, {**tool, "name": "b", "at": [1, 2]}]}),
                (r"tools\[0\]\.spread: these jaws do not part.*radians, write 51.6",
                 {"tools": [{**grasper, "spread": 0.9}]}),
                (r"mesh: the mesh of this scene was given", {"mesh": "a.vtu"})):
            self.refuses(lariat.Error, rf"^scene\.{words}", scene={**SCENE, **changes})
        self.refuses(lariat.FormatError, "^scene: a scene needs the key", scene={})
        self.refuses(lariat.FormatError, "^scene:2:1: the key", scene="lariat: 1\ngravitas: 1\n")
        wide = block(tools=[{**grasper, "spread": 50}]).tools[0]["spread"]
        self.assertAlmostEqual(wide, math.radians(50))

    def test_what_is_found_later_is_named_by_its_keys(self):
        """When the dict has been read, as by Simulation: nobody has seen the lines of its text."""
        material, walls = SCENE["materials"][0], {"nodes": "floor", "axes": "z"}
        viscous = {"part": "whole", "terms": [{"g": 0.5, "time": 1e-9}]}
        for words, changes in (
                (r"damping: damping 1e\+06 1/s", {"damping": 1e6}),
                (r"time_step: time step 1 s is above", {"time_step": 1.0}),
                (r"mass_scaling: a stable step of", {"mass_scaling": {"time_step": 0.9}}),
                (r"springs\[0\]: springs of", {"springs": [{"nodes": "top", "stiffness": 1e9}]}),
                (r"load\[1\]\.force: a nodal force", {
                    "load": [{"nodes": "top", "force": [0, 0, f]} for f in (0.1, 1e12)]}),
                (r"move\[0\]: node 0 is moved along z and already fixed in scene\.fix\[0\];",
                 {"move": [{**walls, "by": 1, "over": 1}]}),
                (r"move\[1\]: node 0 is moved along z and already moved in scene\.move\[0\];",
                 {"fix": [], "move": [{**walls, "by": 1, "over": 1}] * 2}),
                (r"materials\[0\]\.viscous: viscous term 1", {
                    "materials": [{**material, "viscous": viscous}]})):
            with self.subTest(words):
                with self.assertRaisesRegex(lariat.ModelError, rf"^scene\.{words}"):
                    lariat.Simulation(block(**changes))
        model = block(time_step=1.0)
        for again in (pickle.loads(pickle.dumps(model)), copy.deepcopy(model)):
            with self.assertRaisesRegex(lariat.ModelError, r"^scene\.time_step: time step 1 s"):
                lariat.Simulation(again)
        nodes, hexahedra, sets = block_arrays()
        text = ("lariat: 1\ntime_step: 1.0\nmaterials: [{name: a, cells: all, law: neo-hookean, "
                "density: 1000, shear_modulus: 1.0e3, bulk_modulus: 1.0e4}]\n")
        with self.assertRaisesRegex(lariat.ModelError, "^model:2: time step 1 s"):
            lariat.Simulation(lariat.Model.from_arrays(nodes, hexahedra, text, sets=sets))

    def test_units_and_ratios_that_no_tissue_has(self):
        def tissue(density=1000, modulus=3e3, ratio=0.49):
            return [{"cells": "all", "law": "neo-hookean", "density": density,
                     "youngs_modulus": modulus, "poisson_ratio": ratio}]

        for words, material in (("density of 1e\\+30.*water has 1000", tissue(density=1e30)),
                                ("shear modulus of .*pascals", tissue(modulus=1e-30))):
            with self.assertRaisesRegex(lariat.ModelError, r"^scene\.damping: .*" + words):
                lariat.Simulation(block(damping=2.0, materials=material))
        self.assertEqual(block(materials=tissue(ratio=0.4999)).notices, [])
        notice, = block(materials=tissue(ratio=0.49999)).notices
        self.assertRegex(notice, r"^scene\.materials\[0\]\.poisson_ratio: 0\.49999 makes the time step "
                         r"10\.0 times shorter .*0\.49 to 0\.499")
        steps = [lariat.Simulation(block(materials=tissue(ratio=r))).time_step
                 for r in (0.499, 0.49999)]
        self.assertAlmostEqual(steps[0] / steps[1], 10, delta=0.1)

    def test_notices_about_a_dict_name_its_keys(self):
        probe = {"name": "p", "nodes": "top", "sum": "reaction"}
        notices = block(output={"probes": [probe]}).notices
        self.assertRegex(notices[0], r'^scene\.output\.probes\[0\].*the probe "p" sums reactions')

    def test_a_file_with_a_mesh_that_is_given(self):
        import tempfile
        with tempfile.TemporaryDirectory(prefix="lariat-test-") as folder:
            path = os.path.join(folder, "scene.yaml")
            with open(path, "w", encoding="utf-8") as file:
                file.write("lariat: 1\nmesh: given\n")
            with self.assertRaisesRegex(lariat.ModelError, "yaml:2:7: mesh: given stands for a mesh "
                                        "from arrays.*name its mesh file"):
                lariat.Model(path)

    def test_a_dict_that_changes_meanwhile(self):
        class Sly(int):
            def __index__(self):
                sets.clear()
                return 3
        nodes, hexahedra, sets = block_arrays()
        for n in range(50):
            sets[f"s{n}"] = [Sly()]
        lariat.Model.from_arrays(nodes, hexahedra, {k: SCENE[k] for k in ("lariat", "materials")},
                                 sets=sets)


@unittest.skipUnless(numpy, WITHOUT_NUMPY)
class Numpy(unittest.TestCase):
    def test_arrays_in_and_out_without_a_copy(self):
        nodes, hexahedra, sets = block_arrays()
        sets = {name: numpy.array(index) for name, index in sets.items()}
        # Of one or two bytes below; this block has more nodes than a byte counts.
        kinds = "<i4 >i4 <u4 >u4 <i8 >i8 <u8 >u8 <i2 >i2 <u2 >u2".split()
        for kind in kinds:
            model = lariat.Model.from_arrays(numpy.array(nodes), numpy.array(hexahedra, kind),
                                             {**SCENE, "gravity": numpy.array([0, 0, -9.81])},
                                             sets=sets)
            positions = numpy.asarray(model.positions)
            self.assertEqual(positions.dtype, numpy.float64)
            self.assertFalse(positions.flags.writeable)
            self.assertTrue(numpy.array_equal(positions, nodes))
            self.assertEqual(positions.__array_interface__["data"],
                             numpy.asarray(model.positions).__array_interface__["data"])

    def test_integers_of_one_byte(self):
        nodes, hexahedra, _ = block_arrays()
        for kind in "bB":
            lariat.Model.from_arrays(nodes, hexahedra, SCENE, tags=numpy.ones(len(hexahedra), kind),
                                     sets={"floor": numpy.arange(3, dtype=kind)})
            model = lariat.Model.from_arrays(
                nodes, hexahedra, sets={"a": numpy.array([127, 0], kind)})
            self.assertEqual(model.sets[0]["count"], 2)
        with self.assertRaisesRegex(lariat.Error, "-1"):
            lariat.Model.from_arrays(nodes, hexahedra, sets={"a": numpy.array([-1], ">i2")})

    def test_what_is_masked_is_refused(self):
        nodes, hexahedra, _ = block_arrays()
        open_mask = numpy.ma.masked_array(nodes)
        self.assertEqual(lariat.Model.from_arrays(open_mask, hexahedra).node_count, len(nodes))
        for taken in ((numpy.ma.masked_greater(nodes, 0.03), hexahedra),
                      (nodes, numpy.ma.masked_greater(numpy.array(hexahedra), 9))):
            with self.assertRaisesRegex(lariat.ArgumentError, "masked.*filled"):
                lariat.Model.from_arrays(*taken)

    def test_the_wrong_kinds(self):
        nodes, hexahedra, _ = block_arrays()
        right, wide = numpy.array(nodes), numpy.array(hexahedra)

        def refused(words, nodes=right, hexahedra=wide):
            with self.assertRaisesRegex(ValueError, words):
                lariat.Model.from_arrays(nodes, hexahedra)
        refused("format 'f'.*astype", right.astype(numpy.float32))
        refused("float64", right.astype(">f8"))
        refused("contiguous", numpy.repeat(right, 2, axis=0)[::2])
        refused("contiguous", numpy.asfortranarray(right))
        refused(r"\[n, 3\]", right[:, :2].copy())
        refused("int32", hexahedra=wide.astype(float))
        refused("int32", hexahedra=wide.astype(bool))
        refused("32 bits", hexahedra=wide + 2**40)
        refused("32 bits", hexahedra=wide.astype(numpy.uint64) - 2**20)
        refused("int32", hexahedra=wide.astype(bool))


if __name__ == "__main__":
    unittest.main()
