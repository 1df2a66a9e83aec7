/* Scenes that are wrong: the place and the words of every message, and files that mean harm. */
#include "model/wrong_scene.h"

static void test_root(void **state) {
    (void)state;
    static const wrong_scene whole[] = {
        {"", "1:1", "there is nothing in this file"},
        {"# nothing\n", "1:1", "there is nothing in this file"},
        {"- lariat\n", "1:1", "this is no scene"},
        {"lariat: 1\nmesh: bare.vtu\nmaterials: [{cells: all, law: neo-hookean, density: 1, "
         "shear_modulus: 1, bulk_modulus: 9}]\nfix: [{nodes: base, axes: x}]\n",
         "4:15",
         "the set \"base\" is unknown, the mesh has no sets; define it, for example "
         "sets: [ { name: base, nodes: { box: "},
        {"hello\n", "1:1", "this is no scene"},
        {"mesh: a.vtu\n", "1:1", "needs the key \"lariat\"; add it, for example lariat: 1"},
        {"lariat: 2\n", "1:9", "write lariat: 1, or take a newer program"},
        {"lariat: '1'\n", "1:9", "found \"1\""},
        {"lariat: 1\ntitle: x\n", "1:1", "needs the key \"mesh\""},
        {"lariat: 1\nmesh: brick.vtu\n", "1:1", "needs the key \"materials\""},
        {"lariat: 1\nlariat: 1\n", "2:1", "the key \"lariat\" stands here twice, first in line 1"},
        {"lariat: 1\nmesh: bad.vtu\nmaterials: []\n", "2:7", "bad.vtu: cannot be opened"},
        {"lariat: 1\nmesh: []\nmaterials: []\n", "2:7", "name at least one file"},
        {"lariat: 1\nmesh: given\nmaterials: []\n", "2:7", "name its mesh file, for example"},
        {"lariat: 1\nmesh:\nmaterials: []\n", "2:6", "mesh: expected the name of a mesh file"},
        {"lariat: 1\nmesh: {file: brick.vtu, tag: low}\nmaterials: []\n", "2:30",
         "tag: expected an integer"},
        {"lariat: 1\nmesh: {file: brick.vtu, tag: 3000000000}\nmaterials: []\n", "2:30",
         "too large"},
        {"lariat: 1\nmesh: {tag: 1}\nmaterials: []\n", "2:7", "needs the key \"file\""},
        {"lariat: 1\nmesh: [brick.vtu, {fil: two.vtu}]\nmaterials: []\n", "2:20",
         "did you mean file?"},
    };
    static const wrong_scene extra[] = {
        {"gravty: [0, 0, 1]\n", "4:1",
         "the key \"gravty\" is unknown; did you mean gravity? a scene may have the keys: lariat, "
         "title, mesh, scale, gravity, time_step, damping, materials, sets, fix, move, load, "
         "initial, contact, tools, output, duration"},
        {"colour: red\n", "4:1",
         "the key \"colour\" is unknown; a scene may have the keys: lariat"},
        {"scale: 0\n", "4:8", "scale is 0; it must be more than zero"},
        {"scale: mm\n", "4:8", "scale: expected a number, metres per unit"},
        {"gravity: -9.81\n", "4:10", "gravity: expected three numbers in m/s^2"},
        {"gravity: [0, -9.81]\n", "4:10", "found a list"},
        {"gravity: {over: 1}\n", "4:10", "gravity needs the key \"acceleration\""},
        {"gravity: {acceleration: [0, 0, 1], in: 1}\n", "4:36", "\"in\" is unknown"},
        {"gravity: {acceleration: [0, 0, 1], over: -1}\n", "4:42", "over is -1"},
        {"gravity: [{acceleration: [0, 0, 1]}, {acceleration: [1, 0, 1]}]\n", "4:38",
         "gravity along z stands in two entries"},
        {"gravity: [{acceleration: [0, 0, 1]}, 3]\n", "4:38", "3"},
        {"gravity: [0, 0, down]\n", "4:17", "found \"down\""},
        {"gravity: [0, 0, .inf]\n", "4:17", "\".inf\" is not a finite number"},
        {"gravity: [0, nan, 0]\n", "4:14", "\"nan\" is not a finite number"},
        {"gravity: [0, 1e999, 0]\n", "4:14", "\"1e999\" is not a finite number"},
        {"time_step: fast\n", "4:12", "time_step: expected auto, or a number in seconds"},
        {"time_step: -1.0e-4\n", "4:12", "more than zero"},
        {"time_step: 1.0e-16\n", "4:12", "time_step: expected auto, or 1e-15 s at least"},
        {"damping: -2\n", "4:10", "damping is -2; it must not be negative"},
        {"damping: {}\n", "4:10", "found a mapping"},
        {"springs: {}\n", "4:10", "springs: expected a list"},
        {"springs: [{nodes: all}]\n", "4:11", "a springs entry needs nodes or faces, and the"},
        {"springs: [{nodes: all, stiffness_per_area: 1}]\n", "4:11",
         "of faces, stiffness_per_area"},
        {"springs: [{nodes: all, stiffness: 0}]\n", "4:35", "stiffness is 0; it must be more than"},
        {"springs: [{nodes: all, stiffness: soft}]\n", "4:35",
         "stiffness: expected a number in N/m, for example 50, but found \"soft\""},
        {"springs: [{nodes: all, stifness: 1}]\n", "4:24", "did you mean stiffness?"},
        {"duration: 0\n", "4:11", "more than zero"},
        {"duration: 2 s\n", "4:11",
         "duration: expected rest, or a number in seconds (SI units), for example 0.2, but found "
         "\"2 s\""},
        {"title: []\n", "4:8", "title: expected a text, but found a list"},
        {"mass_scaling: 1e-4\n", "4:15", "mass_scaling as a mapping, {time_step: ...}"},
        {"mass_scaling: {}\n", "4:15", "mass_scaling needs the key \"time_step\""},
        {"mass_scaling: {step: 1e-4}\n", "4:16", "may have the keys: time_step, largest_share"},
        {"mass_scaling: {strained: 0}\n", "4:26", "more than zero"},
        {"mass_scaling: {strained: 0.5}\n", "4:26", "strained is 0.5; expected a part of"},
        {"mass_scaling: {strained: yes}\n", "4:26", "up to 0.2"},
        {"mass_scaling: {strained: 0.1, largest_share: 0.1}\n", "4:15", "the key \"time_step\""},
        {"mass_scaling: {time_step: auto}\n", "4:27", "expected a number in seconds up to 1"},
        {"mass_scaling: {time_step: .nan}\n", "4:27", "not a finite number"},
        {"mass_scaling: {time_step: -1e-4}\n", "4:27", "more than zero"},
        {"mass_scaling: {time_step: 2}\n", "4:27", "time_step is 2; expected a number in seconds"},
        {"mass_scaling: {time_step: 1e-4, largest_share: 0}\n", "4:48", "more than zero"},
        {"mass_scaling: {time_step: 1e-4, largest_share: 5}\n", "4:48", "largest_share is 5"},
        {"mass_scaling: {time_step: 1e-4, largest_share: 5 %}\n", "4:48", "expected a part of"},
        {"time_step: 2e-4\nmass_scaling: {time_step: 1e-4}\n", "5:27",
         "stable up to 0.0001 s, and the scene's time_step is 0.0002 s"},
    };
    REFUSES(whole, "");
    REFUSES(extra, BASE);
}

static void test_yaml(void **state) {
    (void)state;
    static const wrong_scene extra[] = {
        {"title: &a x\n", "4:8", "anchors (&name) are not read"},
        {"title: *a\n", "4:8", "aliases (*name) are not read"},
        {"title: !!str x\n", "4:8", "tags (!name) are not read"},
        {"fix: !list []\n", "4:6", "tags (!name) are not read"},
        {"output: &o {every: 1}\n", "4:9", "anchors"},
        {"---\nlariat: 1\n", "4:1", "a second document begins here"},
        {"[1]: 2\n", "4:1", "a key must be a word"},
        {"{a: 1}: 2\n", "4:1", "a key must be a word"},
        {"fix: [\n", "5:1", "this is not YAML"},
        {"title: \"x\n", "5:1", "this is not YAML"},
        {"\tfix: []\n", "4:1", "begins with a tab"},
        {"title: \"a\\0b\"\n", "4:8", "zero character"},
        {"output: {every: 1, every: 2}\n", "4:20", "the key \"every\" stands here twice"},
        {"title: \xff\xfe\n", "4:8", "this is not YAML"},
    };
    REFUSES(extra, BASE);
}

static void test_materials(void **state) {
    (void)state;
#define M "lariat: 1\nmesh: brick.vtu\nmaterials:\n"
    static const wrong_scene table[] = {
        {"  - {law: neo-hookean}\n", "4:5", "a material needs the key \"cells\""},
        {"  - {cells: all, density: 1}\n", "4:5", "needs the key \"law\""},
        {"  - {cells: all, law: neo-hookean}\n", "4:5", "for example density: 1050"},
        {"  - {cells: all, law: neo-hokean, density: 1}\n", "4:23",
         "the law \"neo-hokean\" is unknown; did you mean neo-hookean? the laws are: neo-hookean, "
         "coupled-neo-hookean, mooney-rivlin, yeoh, arruda-boyce, veronda-westmann, holmes-mow, "
         "ogden"},
        {"  - {cells: all, law: gent, density: 1}\n", "4:23", "the laws are: neo-hookean"},
        {"  - {cells: all, law: ogden, density: 1}\n", "4:5",
         "or c1, m1 and bulk_modulus (c2, m2, c3 and m3 may be left out), and nothing besides"},
        {"  - {cells: all, law: ogden, density: 1, c1: 4, m1: 2, c2: 3, bulk_modulus: 9}\n", "4:5",
         "m2 is missing, the power of the term of c2; add it"},
        {"  - {cells: all, law: ogden, density: 1, c1: 4, m1: 0, bulk_modulus: 9}\n", "4:5",
         "m1 of the law ogden is 0; it is the power of the term of c1 and must be between 0.01 "
         "and 100, or between -0.01 and -100"},
        {"  - {cells: all, law: neo-hookean, density: 1, youngs_modulus: 1.0e300, "
         "poisson_ratio: 0.3}\n",
         "4:5", "the shear modulus is 3.84615e+299 Pa; it must be positive and below 1e+100"},
        {"  - {cells: all, law: ogden, density: 1, c1: 4, m1: 1e5, bulk_modulus: 9}\n", "4:5",
         "m1 of the law ogden is 100000"},
        {"  - {cells: all, law: ogden, density: 1, c1: 4, m1: .inf, bulk_modulus: 9}\n", "4:53",
         "is not a finite number"},
        {"  - {cells: all, law: ogden, density: 1, c1: 4, m1: 2, c3: -9, m3: 1, bulk_modulus: 9}\n",
         "4:5", "the shear modulus is -2.5 Pa"},
        {"  - {cells: all, law: arruda-boyce, density: 1, mu: 4, N: 0, bulk_modulus: 9}\n", "4:59",
         "N is 0; it must be more than zero"},
        {"  - {cells: all, law: arruda-boyce, density: 1, mu: 4, N: x, bulk_modulus: 9}\n", "4:59",
         "a number without a unit"},
        {"  - {cells: all, law: veronda-westmann, density: 1, c1: 4, c2: 4e3, bulk_modulus: 9}\n",
         "4:5",
         "c2 of the law veronda-westmann is 4000; it has no unit and must be between 0.001 "
         "and 1000"},
        {"  - {cells: all, law: holmes-mow, density: 1, mu: 4, lambda: 3}\n", "4:5",
         "or mu, lambda and beta, and nothing besides"},
        {"  - {cells: all, law: neo-hookean, density: -1}\n", "4:45",
         "density is -1; it must be more than zero"},
        {"  - {cells: all, law: neo-hookean, density: 1, shear_modulus: \"4 kPa\", "
         "bulk_modulus: 1}\n",
         "4:63",
         "shear_modulus: expected a number in pascal (SI units), for example 4.0e3, but found \"4 "
         "kPa\""},
        {"  - {cells: all, law: neo-hookean, density: 1, shear_modulus: 4 kPa, bulk_modulus: 1}\n",
         "4:63", "expected a number in pascal (SI units), for example 4.0e3"},
        {"  - {cells: all, law: neo-hookean, density: 1, shear_modulus: '4e3', bulk_modulus: 1}\n",
         "4:63", "expected a number in pascal"},
        {"  - {cells: all, law: neo-hookean, density: 1, shear_modulus: -4, bulk_modulus: 1}\n",
         "4:63", "shear_modulus is -4"},
        {"  - {cells: all, law: neo-hookean, density: 1, shear_modulus: 4, bulk_modulus: 0}\n",
         "4:80", "bulk_modulus is 0"},
        {"  - {cells: all, law: neo-hookean, density: 1, youngs_modulus: 4, poisson_ratio: 0.5}\n",
         "4:82", "poisson_ratio is 0.5; it must lie between -1 and 0.5"},
        {"  - {cells: all, law: neo-hookean, density: 1, youngs_modulus: 4, poisson_ratio: -1}\n",
         "4:82", "poisson_ratio is -1"},
        {"  - {cells: all, law: neo-hookean, density: 1, youngs_modulus: 4}\n", "4:5",
         "either shear_modulus and bulk_modulus, or youngs_modulus and poisson_ratio"},
#define VISCOUS(law, viscous) "  - {cells: all, " law ", density: 1, viscous: {" viscous "}}\n"
#define SOFT                  "law: yeoh, shear_modulus: 4, bulk_modulus: 9"
        {VISCOUS(SOFT, "terms: [{g: 1, time: 1}]"), "4:85", "viscous needs the key \"part\""},
        {VISCOUS(SOFT, "part: whole"), "4:85", "terms: [{g: 0.5, time: 0.1}]"},
        {VISCOUS(SOFT, "part: shear, terms: [{g: 1, time: 1}]"), "4:92",
         "the parts are: isochoric, whole"},
        {VISCOUS(SOFT, "part: whole, terms: []"), "4:106", "0 viscous terms; give one to 6"},
        {VISCOUS(SOFT, "part: whole, terms: [{g: 1, tau: 1}]"), "4:114", "tau"},
        {VISCOUS(SOFT, "part: whole, terms: [{g: -1, time: 1}]"), "4:111", "g is -1"},
        {VISCOUS(SOFT, "part: whole, terms: [{g: .nan, time: 1}]"), "4:111",
         "\".nan\" is not a finite number"},
        {VISCOUS(SOFT, "part: whole, terms: [{g: 1, time: 0}]"), "4:120", "time is 0"},
        {VISCOUS(SOFT, "part: whole, terms: [{g: 1, time: 1e13}]"), "4:5",
         "the relaxation time of viscous term 1 is 1e+13 s"},
        {VISCOUS(SOFT, "part: whole, terms: [{g: 1e5, time: 1}]"), "4:5",
         "at once the material is 100001 times as stiff as in the end"},
        {VISCOUS(SOFT, "part: whole, g0: 0, terms: [{g: 1, time: 1}]"), "4:103", "g0 is 0"},
        {VISCOUS("law: holmes-mow, mu: 4, lambda: 3, beta: 1",
                 "part: isochoric, terms: [{g: 1, time: 1}]"),
         "4:5", "the law holmes-mow has no isochoric part that could relax alone"},
        {"  - {cells: all, law: neo-hookean, density: 1, mu: 4, lambda: 3}\n", "4:5",
         "the law neo-hookean needs"},
        {"  - {cells: all, law: mooney-rivlin, density: 1, c1: 4, c2: 3}\n", "4:5",
         "or c1, c2 and bulk_modulus"},
        {"  - {cells: all, law: coupled-neo-hookean, density: 1, mu: 4}\n", "4:5",
         "or mu and lambda"},
        {"  - {cells: all, law: coupled-neo-hookean, density: 1, mu: 4, lambda: -9}\n", "4:5",
         "the bulk modulus is"},
        {"  - {cells: all, law: mooney-rivlin, density: 1, c1: 4, c2: -9, bulk_modulus: 1}\n",
         "4:5", "the shear modulus is"},
        {"  - {cells: all, law: yeoh, density: 1, c1: 4, c2: 3, bulk_modulus: 9}\n", "4:5",
         "or c1, c2, c3 and bulk_modulus, and nothing besides"},
        {"  - {cells: all, law: mooney-rivlin, density: 1, c1: 4, c2: 3, c3: 1, bulk_modulus: 9}\n",
         "4:5", "or c1, c2 and bulk_modulus, and nothing besides"},
        {"  - {cells: all, law: yeoh, density: 1, c1: 0, c2: 3, c3: 1, bulk_modulus: 9}\n", "4:45",
         "c1 is 0; it must be more than zero"},
        {"  - {cells: all, law: yeoh, density: 1, c1: 1, c2: .nan, c3: 1, bulk_modulus: 9}\n",
         "4:52", "is not a finite number"},
        {"  - {cells: all, law: yeoh, density: 1, c1: 1, c2: 1, c3: -1e300, bulk_modulus: 9}\n",
         "4:5", "c3 of the law yeoh is -1e+300 Pa"},
        {"  - {cells: all, law: yeoh, density: 1, c1: 1, c2: 1, c3: 1, bulk_modulus: 1e999}\n",
         "4:76", "is not a finite number"},
        {"  - {cells: all, law: neo-hookean, density: 1, shear_modulus: 4,5, bulk_modulus: 9}\n",
         "4:65", "decimals have a point"},
        {"  - {cells: all, shearmodulus: 1}\n", "4:18", "did you mean shear_modulus?"},
        {"  - {name: a, cells: all, law: neo-hookean, density: 1, shear_modulus: 4, bulk_modulus: "
         "5}\n  - {name: a, cells: 2, law: neo-hookean, density: 1, shear_modulus: 4, "
         "bulk_modulus: 5}\n",
         "5:12", "a second material is called \"a\""},
        {"  - all\n", "4:5", "expected a material as a mapping"},
        {"  all\n", "4:3", "materials: expected a list of materials"},
        {"  - {cells: 3, law: neo-hookean, density: 1, shear_modulus: 4, bulk_modulus: 1}\n",
         "4:13", "no element has the tag 3; the tags in the mesh are 1, 2"},
        {"  - {cells: uper, law: neo-hookean, density: 1, shear_modulus: 4, bulk_modulus: 1}\n",
         "4:13",
         "the set \"uper\" is unknown; did you mean upper? the sets are: bottom, lid, upper"},
        {"  - {cells: upper, law: neo-hookean, density: 1, shear_modulus: 4, bulk_modulus: 1}\n",
         "4:3", "element 101 (tag 1) has no material"},
        {"  []\n", "4:3", "element 101 (tag 1) has no material"},
    };
    REFUSES(table, M);
}

static void test_sets(void **state) {
    (void)state;
    static const wrong_scene table[] = {
        {"sets: {name: a}\n", "4:7", "sets: expected a list of sets"},
        {"sets: [{nodes: all}]\n", "4:8", "a set needs the key \"name\""},
        {"sets: [{name: a}]\n", "4:8", "\"nodes\", \"elements\" or \"faces\""},
        {"sets: [{name: a, nodes: all, faces: all}]\n", "4:30", "one of the three"},
        {"sets: [{name: all, nodes: all}]\n", "4:15", "choose another name"},
        {"sets: [{name: bottom, nodes: all}]\n", "4:15", "already a node set named \"bottom\""},
        {"sets: [{name: a, nodes: {boks: 1}}]\n", "4:26", "did you mean box?"},
        {"sets: [{name: a, nodes: {}}]\n", "4:25", "a selector has one key and this one has 0"},
        {"sets: [{name: a, nodes: {tag: 1, list: [1]}}]\n", "4:25", "this one has 2"},
        {"sets: [{name: a, nodes: {box: [1, 2]}}]\n", "4:32", "three numbers in metres"},
        {"sets: [{name: a, nodes: {box: [[0, 0, 0]]}}]\n", "4:31", "two opposite corners"},
        {"sets: [{name: a, nodes: {box: [[0, 0, 0], [1, -1, 1]]}}]\n", "4:31", "along y"},
        {"sets: [{name: a, nodes: {box: [[1, 1, 1], [2, 2, 2]]}}]\n", "4:25",
         "this selects no node at all"},
        {"sets: [{name: a, faces: {nearest: 3}}]\n", "4:35", "three numbers in metres"},
        {"sets: [{name: a, nodes: {nearest: [1.5e308, -1.5e308, 0]}}]\n", "4:35",
         "this place is too far away"},
        {"sets: [{name: a, faces: {list: [1]}}]\n", "4:32", "faces have no numbers"},
        {"sets: [{name: a, faces: {sphere: {center: [0, 0, 0], radius: 0.001}}}]\n", "4:25",
         "this selects no boundary face"},
        {"sets: [{name: a, faces: 3}]\n", "4:25", "a number alone says too little"},
        {"sets: [{name: a, elements: 3}]\n", "4:28", "a number alone says too little"},
        {"sets: [{name: a, nodes: {sphere: {radius: 1}}}]\n", "4:34", "needs the key \"center\""},
        {"sets: [{name: a, nodes: {sphere: {center: [0, 0, 0], radius: -1}}}]\n", "4:62",
         "more than zero"},
        {"sets: [{name: a, nodes: {plane: {point: [0, 0, 0], normal: [0, 0, 0]}}}]\n", "4:60",
         "no direction"},
        {"sets: [{name: a, nodes: {plane: {point: [0, 0, 0]}}}]\n", "4:33",
         "needs the key \"normal\""},
        {"sets: [{name: a, nodes: {plane: {point: [0, 0, 0], normal: [0, 0, 1], tolerance: "
         "-1}}}]\n",
         "4:82", "not be negative"},
        {"sets: [{name: a, nodes: {list: [1, 99]}}]\n", "4:36",
         "there is no node 99 in the mesh; its 27 nodes have numbers from 1 to 27"},
        {"sets: [{name: a, elements: {list: [1]}}]\n", "4:36",
         "there is no element 1 in the mesh; its 8 elements have numbers from 101 to 108"},
        {"sets: [{name: a, nodes: {list: [x]}}]\n", "4:33", "the number of a node or element"},
        {"sets: [{name: a, nodes: {tag: 5}}]\n", "4:31", "no element has the tag 5"},
        {"sets: [{name: a, nodes: {surface: false}}]\n", "4:35", "expected true"},
        {"sets: [{name: a, nodes: {all: []}}]\n", "4:31", "the list is empty"},
        {"sets: [{name: a, nodes: {any: bottom}}]\n", "4:31", "a list of selectors"},
        {"sets: [{name: a, nodes: {not: all}}]\n", "4:25", "this selects no node"},
        {"sets: [{name: a, nodes: {set: b}}, {name: b, nodes: all}]\n", "4:31",
         "the set \"b\" is defined only in line 4; move it up"},
        {"sets: [{name: a, nodes: {not: {set: nowhere}}}]\n", "4:37", "the set \"nowhere\" is"},
        {"sets: [{name: a, nodes: [[1]]}]\n", "4:26", "found a list"},
        {"sets: [{name: a, nodes: []}]\n", "4:25", "this selects no node"},
    };
    REFUSES(table, BASE);
}

static void test_supports(void **state) {
    (void)state;
    static const wrong_scene table[] = {
        {"fix: {nodes: bottom, axes: x}\n", "4:6", "fix: expected a list of supports"},
        {"fix: [{axes: x}]\n", "4:7", "a fix entry needs the key \"nodes\""},
        {"fix: [{nodes: bottom}]\n", "4:7", "for example axes: xyz"},
        {"fix: [{nodes: bottom, axes: xw}]\n", "4:29", "some of the letters x, y, z"},
        {"fix: [{nodes: bottom, axes: xx}]\n", "4:29", "each once"},
        {"fix: [{nodes: bottom, axes: [x]}]\n", "4:29", "found a list"},
        {"fix: [{nodes: bottom, axis: x}]\n", "4:23", "did you mean axes?"},
        {"fix: [{nodes: botom, axes: x}]\n", "4:15", "did you mean bottom?"},
        {"fix: [{nodes: 0, axes: x}]\n", "4:15", "there is no node 0"},
        {"fix: [{nodes: \"1\", axes: x}]\n", "4:15", "the set \"1\" is unknown"},
        {"move: [{nodes: lid, axes: x, by: 0.1}]\n", "4:8",
         "a sudden displacement is not physical"},
        {"move: [{nodes: lid, axes: x, by: 0.1, over: 0}]\n", "4:45",
         "a sudden displacement is not physical"},
        {"move: [{nodes: lid, axes: x, by: 0.1, over: -1}]\n", "4:45", "not be negative"},
        {"move: [{nodes: lid, axes: x, over: 1}]\n", "4:8", "needs the key \"by\""},
        {"move: [{nodes: lid, axes: x, by: 1 mm, over: 1}]\n", "4:34",
         "by: expected a number in metres (SI units)"},
        {"move: [{nodes: lid, axes: x, by: 1, over: 1, curve: {points: [[0, 0]]}}]\n", "4:46",
         "over and curve say the same thing"},
        {"move: [{nodes: lid, axes: x, by: 1, curve: {points: [[0, 1]]}}]\n", "4:44",
         "must be 0 at time 0"},
        {"move: [{nodes: lid, axes: x, by: 1, curve: {points: [[0, 0], [1, 1]], shape: step}}]\n",
         "4:44", "cannot have the shape step"},
        {"move: [{nodes: lid, axes: x, by: 1, curve: {points: [[0, 0], [1, 1], [1, 2]]}}]\n",
         "4:44", "two values at one time"},
        {"move: [{nodes: lid, axes: x, by: 1, curve: {points: [[0, 0], [1, 1]], repeat: true}}]\n",
         "4:44", "that repeats must end with 0"},
        {"load: [{nodes: lid, force: [1, 0, 0], curve: {points: [[0, 0]], repeat: true}}]\n",
         "4:73", "points at two times"},
        {"load: [{nodes: lid, force: [1, 0, 0], curve: {points: [[0, 0], [1, 0]], repeat: 3}}]\n",
         "4:81", "expected true or false"},
        {"move: [{nodes: lid, axes: x, by: 1, curve: {points: []}}]\n", "4:53", "list is empty"},
        {"move: [{nodes: lid, axes: x, by: 1, curve: {shape: linear}}]\n", "4:44",
         "needs the key \"points\""},
        {"move: [{nodes: lid, axes: x, by: 1, curve: {points: [[0, 0, 0]]}}]\n", "4:54",
         "points: expected two numbers"},
        {"move: [{nodes: lid, axes: x, by: 1, curve: {points: [[1, 0], [0, 1]]}}]\n", "4:62",
         "time 0 comes after time 1"},
        {"move: [{nodes: lid, axes: x, by: 1, curve: {points: [[0, 0]], shape: cubic}}]\n", "4:70",
         "the shapes are: linear, step, smooth, spline"},
        {"move: [{nodes: lid, rigid: {axis: [0, 0, 1], over: 1}}]\n", "4:28", "needs degrees"},
        {"move: [{nodes: lid, rigid: {axis: [0, 0, 1], degrees: 9, over: 1}}]\n", "4:28",
         "needs a point that its axis goes through"},
        {"move: [{nodes: lid, rigid: {by: 1, over: 1}}]\n", "4:28", "needs the key \"axis\""},
        {"move: [{nodes: lid, rigid: {axis: [0, 0, 0], by: 1, over: 1}}]\n", "4:35",
         "has no direction"},
        {"move: [{nodes: lid, rigid: {axis: [1, 0, 0], by: 1}}]\n", "4:28",
         "a sudden displacement is not physical"},
        {"move: [{nodes: lid, rigid: []}]\n", "4:28", "a list of 1 to 6 motions"},
        {"move: [{nodes: lid, rigid: 5}]\n", "4:28", "a rigid motion"},
        {"move: [{nodes: lid, axes: x, rigid: {axis: [1, 0, 0], by: 1, over: 1}}]\n", "4:21",
         "axes"},
        {"move: [{nodes: lid, rigid: {axis: [1, 0, 0], by: 1, over: 1}},\n"
         "       {nodes: lid, axes: x, by: 1, over: 1}]\n",
         "5:8", "already moved in line 4"},
        {"fix: [{nodes: bottom, axes: xyz}]\nmove:\n  - {nodes: 9, axes: yx, by: 1, over: 1}\n",
         "6:5", "node 9 is moved along x here (line 6) and already fixed in line 4"},
        {"move:\n  - {nodes: 9, axes: x, by: 1, over: 1}\n  - {nodes: 8, axes: x, by: 1, over: 1}\n"
         "  - {nodes: bottom, axes: zx, by: 1, over: 1}\n",
         "7:5", "node 8 is moved along x here (line 7) and already moved in line 6"},
    };
    REFUSES(table, BASE);
}

static void test_loads_and_output(void **state) {
    (void)state;
    static const wrong_scene table[] = {
        {"load: 5\n", "4:7", "load: expected a list of loads"},
        {"load: [{force: [0, 0, 1]}]\n", "4:8", "either nodes, with a force, or faces"},
        {"load: [{nodes: 1, faces: lid}]\n", "4:19", "either nodes, with a force, or faces"},
        {"load: [{nodes: 1}]\n", "4:8", "either force, the total"},
        {"load: [{nodes: 1, force: [0, 0, 1], force_per_node: [0, 0, 1]}]\n", "4:37",
         "either force, the total"},
        {"load: [{nodes: 1, pressure: 5}]\n", "4:19", "the key \"pressure\" is unknown"},
        {"load: [{nodes: 1, force: 5}]\n", "4:26", "force: expected three numbers in newton"},
        {"load: [{faces: lid, force: [0, 0, 1]}]\n", "4:21", "the key \"force\" is unknown"},
        {"load: [{faces: lid}]\n", "4:8", "needs the key \"pressure\""},
        {"load: [{faces: lid, pressure: 5 Pa}]\n", "4:31", "a number in pascal"},
        {"load: [{faces: ild, pressure: 5}]\n", "4:16", "did you mean lid?"},
        {"load: [{nodes: 1, force: [0, 0, 1], over: -1}]\n", "4:43", "not be negative"},
        {"initial: [{nodes: 1}]\n", "4:11", "needs the key \"velocity\""},
        {"initial: [{nodes: 1, velocity: 3}]\n", "4:32", "three numbers in m/s"},
        {"surface: []\n", "4:10", "expected the name of a surface file (.stl .obj .vtk .vtp)"},
        {"surface: {scale: 1}\n", "4:10", "a surface needs the key \"file\""},
        {"surface: {file: [a.stl]}\n", "4:17", "the name of a surface file"},
        {"surface: {file: a.stl, scale: 0}\n", "4:31", "metres per unit of the surface's file"},
        {"surface: {file: a.stl, scale: mm}\n", "4:31", "for example 0.001"},
        {"surface: {file: a.stl, unit: mm}\n", "4:24", "the key \"unit\" is unknown"},
        {"surface: nowhere/at/all.stl\n", "4:10", "nowhere/at/all.stl: cannot be opened"},
        {"surface: organ.xyz\n", "4:10", "organ.xyz"},
        {"output: []\n", "4:9", "expected output as a mapping"},
        {"output: {evry: 1}\n", "4:10", "did you mean every?"},
        {"output: {every: -1}\n", "4:17", "not be negative"},
        {"output: {fields: stress}\n", "4:18", "a list of fields"},
        {"output: {fields: [vonmises]}\n", "4:19",
         "did you mean von_mises? the fields are: displacement, velocity, von_mises, pressure, "
         "energy"},
        {"output: {probes: [{name: x}]}\n", "4:19", "\"cells\", \"tool\" or \"energy\""},
        {"output: {probes: [{cells: all}]}\n", "4:20", "cells and mean belong together"},
        {"output: {probes: [{node: 1, mean: stress}]}\n", "4:29", "a probe of nodes has neither"},
        {"output: {probes: [{cells: all, mean: stress, sum: reaction}]}\n", "4:32", "belong"},
        {"output: {probes: [{cells: all, mean: stretch}]}\n", "4:38",
         "there are means of: von_mises"},
        {"output: {probes: [{cells: [99], mean: stress}]}\n", "4:28", "99"},
        {"output: {probes: [{node: 1, set: bottom}]}\n", "4:29", "make two probes"},
        {"output: {probes: [{node: bottom}]}\n", "4:26", "the number of a node"},
        {"output: {probes: [{node: 99}]}\n", "4:26", "there is no node 99"},
        {"output: {probes: [{set: bottom, sum: force}]}\n", "4:38", "expected reaction"},
        {"output: {probes: [{energy: all, sum: contact}]}\n", "4:33", "neither sum nor mean"},
        {"output: {probes: [{node: 1, about: [0, 0, 0]}]}\n", "4:29", "add sum: reaction"},
        {"output: {probes: [{energy: 1}]}\n", "4:28", "expected all"},
        {"output: {probes: [{energy: all}, {energy: all}]}\n", "4:34",
         "two probes would be called"},
        {"output: {probes: [{tool: ball}]}\n", "4:26", "none of the scene's tools; the key tools"},
        {"output: {probes: [{tool: ball}]}\n"
         "tools: [{name: rod, shape: sphere, radius: 0.001, at: [0, 0, 9]}]\n",
         "4:26", "for example \"rod\""},
        {"output: {probes: [{node: 1}, {node: 1}]}\n", "4:30", "two probes would be called"},
    };
    REFUSES(table, BASE);
}

static void test_contact(void **state) {
    (void)state;
#define RUBS(mu)                                                                                   \
    "contact: [{faces: all, plane: {through: [0, 0, -1], normal: [0, 0, 1]}, friction: " mu "}]\n"
#define PLANE(values) "contact: [{faces: all, plane: {" values "}}]\n"
    static const wrong_scene extra[] = {
        {"contact: all\n", "4:10", "expected a list of contacts, {self: true}"},
        {"contact: [all]\n", "4:11", "a contact entry as a mapping"},
        {"contact: [{}]\n", "4:11", "a contact entry says one of three things: {self: true}"},
        {"contact: [{slef: true}]\n", "4:12",
         "the key \"slef\" is unknown; did you mean self? a contact entry may have the keys: self, "
         "between, faces, plane, friction"},
        {"contact: [{self: true, between: [lid, bottom]}]\n", "4:11", "one of three things"},
        {"contact: [{faces: lid}]\n", "4:11", "one of three things"},
        {"contact: [{self: lid, faces: lid}]\n", "4:11", "one of three things"},
        {"contact: [{plane: {through: [0, 0, 0], normal: [0, 0, 1]}}]\n", "4:11",
         "one of three things"},
        {"contact: [{self: false}]\n", "4:18", "self: expected true, or faces"},
        {"contact: [{self: \"true\"}]\n", "4:18", "the set \"true\" is unknown"},
        {"contact: [{self: 1}]\n", "4:18", "a number alone says too little"},
        {"contact: [{self: ld}]\n", "4:18", "the set \"ld\" is unknown; did you mean lid?"},
        {"contact: [{self: {box: [[1, 1, 1], [2, 2, 2]]}}]\n", "4:18",
         "this selects no boundary face at all"},
        {"contact: [{between: lid}]\n", "4:21", "between: expected two sets of faces"},
        {"contact: [{between: [lid, bottom, lid]}]\n", "4:21", "expected two sets of faces"},
        {"contact: [{between: [lid, {surface: true}]}]\n", "4:11",
         "the two sets of faces have 4 in common (one is face 5 of element 105); contact of a "
         "surface with itself is {self: FACES}"},
        {RUBS("-0.1"), "4:83", "friction is -0.1; it must be from 0 to 5, for example 0.3"},
        {RUBS("5.1"), "4:83", "friction is 5.1; it must be from 0 to 5"},
        {RUBS(".nan"), "4:83", "\".nan\" is not a finite number; expected a number from 0 to 5"},
        {RUBS("rough"), "4:83", "friction: expected a number from 0 to 5, for example 0.3"},
        {"contact: [{self: true, friction: 5.5}]\n", "4:34",
         "friction is 5.5; it must be from 0 to 5"},
        {"contact: [{between: [lid, bottom], friction: rough}]\n", "4:46",
         "friction: expected a number from 0 to 5, for example 0.3"},
        {"contact: [{self: true, distance: 0}]\n", "4:34",
         "distance is 0; it must be more than zero"},
        {"contact: [{self: true, distance: near}]\n", "4:34", "distance: expected"},
        {"contact: [{faces: all, distance: 1, plane: {through: [0, 0, 0], normal: [0, 0, 1]}}]\n",
         "4:34", "a plane pushes what touches it, at no distance; leave it out"},
        {"contact: [{self: true, restitution: 0.5}]\n", "4:37", "restitution is of planes"},
        {"contact: [{faces: all, restitution: 1.5, plane: {through: [0, 0, 0], normal: [0, 0, 1]}}]"
         "\n",
         "4:37", "restitution is 1.5; it must be from 0 to 1"},
        {"contact: [{faces: all, plane: [0, 0, 1]}]\n", "4:31", "the plane of a contact"},
        {PLANE("normal: [0, 0, 1]"), "4:31", "needs the key \"through\""},
        {PLANE("through: [0, 0, 0]"), "4:31", "needs the key \"normal\""},
        {PLANE("point: [0, 0, 0], normal: [0, 0, 1]"), "4:32", "the key \"point\" is unknown"},
        {PLANE("through: [0, 0, 0], normal: [0, 0, 0]"), "4:60",
         "normal: this vector has no direction; expected three numbers, a direction"},
        {PLANE("through: [0, 0, 0], normal: z"), "4:60", "normal: expected three numbers"},
        {PLANE("through: [0, 0], normal: [0, 0, 1]"), "4:41", "through: expected three numbers"},
        {PLANE("through: [0, 0, 0], normal: [0, 0, -1]"), "4:11",
         "node 19 lies 0.02 m behind this plane at the start; move the plane, turn its normal"},
        {PLANE("through: [0, 0, 1.0e-4], normal: [0, 0, 2]"), "4:11",
         "node 1 lies 0.0001 m behind this plane"},
    };
    /* A surface as a mesh file gives it may go through the inside. */
    static const wrong_scene within[] = {
        {"contact: [{self: wall}]\n", "4:18",
         "face 1 of element 101 is inside the body, where nothing can touch it; take faces of the "
         "outer surface only, for example {all: [NAME, {surface: true}]}"},
        {"contact: [{between: [lid, wall]}]\n", "4:27", "face 1 of element 101 is inside"},
        {"contact: [{faces: wall, plane: {through: [0, 0, 0], normal: [0, 0, 1]}}]\n", "4:19",
         "inside the body"},
    };
    REFUSES(extra, BASE);
    REFUSES(within, "lariat: 1\nmesh: wall.vtu\n"
                    "materials: [{cells: all, law: neo-hookean, density: 1050, "
                    "shear_modulus: 4.0e3, bulk_modulus: 4.0e5}]\n");
}

static void test_tools(void **state) {
    (void)state;
#define SPHERE(values) "tools: [{shape: sphere, " values "}]\n"
#define GRASPER(values)                                                                            \
    "tools: [{name: a, shape: grasper, radius: 0.001, length: 0.02, at: [0, 0, 0.1], " values "}]" \
    "\n"
    static const wrong_scene extra[] = {
        {"tools: probe\n", "4:8", "expected a list of tools, {name: probe, shape: sphere"},
        {"tools: [probe]\n", "4:9", "a tool as a mapping"},
        {"tools: [{}]\n", "4:9", "a tool needs the key \"name\"; add it"},
        {"tools: [{name: a}]\n", "4:9", "a tool needs the key \"shape\""},
        {"tools: [{name: a, colour: red}]\n", "4:19", "the key \"colour\" is unknown"},
        {"tools: [{name: a, shape: spere}]\n", "4:26",
         "the shape \"spere\" is unknown; did you mean sphere? the shapes are: sphere, capsule, "
         "grasper"},
        {"tools: [{name: a, shape: hand}]\n", "4:26",
         "the shapes are: sphere, capsule, grasper, rigid"},
        {"tools: [{name: a, shape: rigid}]\n", "4:9", "a rigid tool needs the key \"nodes\""},
        {"tools: [{name: a, shape: rigid, nodes: all, radius: 1}]\n", "4:45",
         "the key \"radius\" is unknown; a rigid tool may have the keys: name, shape, nodes, at"},
        {"tools:\n  - {name: a, shape: rigid, nodes: {box: [[-1, -1, -1], [1, 1, 0]]}}\n"
         "  - {name: b, shape: rigid, nodes: all}\n",
         "6:5", "node 1 is moved along x here (line 6) and already moved in line 5"},
        {SPHERE("name: a"), "4:9", "a sphere needs the key \"radius\""},
        {SPHERE("name: a, radius: 0.01"), "4:9", "a sphere needs the key \"at\""},
        {SPHERE("name: a, radius: 0, at: [0, 0, 1]"), "4:42", "radius is 0; it must be more than"},
        {SPHERE("name: a, radius: -0.1, at: [0, 0, 1]"), "4:42", "radius is -0.1; it must be more"},
        {SPHERE("name: a, radius: 5 mm, at: [0, 0, 1]"), "4:42", "a number in metres (SI units)"},
        {SPHERE("name: a, radius: 0.1, length: 1, at: [0, 0, 1]"), "4:47",
         "the key \"length\" is unknown; a sphere may have the keys: name, shape, radius, at"},
        {SPHERE("name: a, radius: 0.1, at: [0, 0, 1], towards: [0, 0, 1]"), "4:62",
         "the key \"towards\" is unknown"},
        {SPHERE("name: a, radius: 0.1, at: [0, 0, 1], friction: -1"), "4:72",
         "friction is -1; it must be from 0 to 5"},
        {SPHERE("name: a, radius: 0.1, at: [0, 0, 1], friction: .inf"), "4:72",
         "not a finite number"},
        {SPHERE("name: a, radius: 0.1, at: here"), "4:51", "at: expected three numbers in metres"},
        {SPHERE("name: [], radius: 0.1, at: [0, 0, 1]"), "4:31", "expected the name of the tool"},
        {SPHERE("name: a, radius: 0.1, path: []"), "4:53",
         "path: the list is empty; give at least"},
        {SPHERE("name: a, radius: 0.1, path: 3.csv"), "4:53", "3.csv"},
        {SPHERE("name: a, radius: 0.1, path: {}"), "4:53",
         "path: expected the name of a file of positions at times (docs/devices.md), or a list"},
        {SPHERE("name: a, radius: 0.1, path: [[0, 0, 1]]"), "4:54",
         "path: expected four numbers, [time in seconds, x, y, z in metres]"},
        {SPHERE("name: a, radius: 0.1, path: [[0, 0, 0, 1, 1]]"), "4:54", "path: expected four"},
        {SPHERE("name: a, radius: 0.1, path: [[0, 0, up, 1]]"), "4:61", "expected four numbers"},
        {SPHERE("name: a, radius: 0.1, path: [[0, 0, 0, 101]]"), "4:64",
         "path: 101 m; positions are in metres, within 100"},
        {SPHERE("name: a, radius: 0.1, path: [[1, 0, 0, 1]]"), "4:9",
         "a sphere needs the key \"at\"; add it"},
        {SPHERE("name: a, radius: 0.1, path: [[-1, 0, 0, 1]]"), "4:53",
         "path: it begins at -1 s; scenes begin at time 0"},
        {SPHERE("name: a, radius: 0.1, path: [[0, 0, 0, 1], [0, 0, 0, 2]]"), "4:68",
         "path: time 0 does not come after 0; times must grow from row to row"},
        {SPHERE("name: a, radius: 0.1, at: [0, 0, 1.1], path: [[0, 0, 0, 1]]"), "4:51",
         "at and the path's place at time 0, [0, 0, 1], are not the same; leave one of them out"},
        {SPHERE("name: a, radius: 0.01, path: [[0, 0.015, 0.015, 0.029]]"), "4:9",
         "the tool would begin 0.001 m inside the body, at element 108; begin outside and move it"},
        {SPHERE("name: hand, radius: 0.1, at: [0, 0, 1]"), "4:31",
         "\"hand\" is the name of the hand that pulls with the mouse; choose another name"},
        {SPHERE("name: hand 2, radius: 0.1, at: [0, 0, 1]"), "4:31", "the name of the hand"},
        {SPHERE("name: a234567890123456789012345678901234567890123456789012345678901234, "
                "radius: 0.1, at: [0, 0, 1]"),
         "4:31", "the name of a tool has 1 to 63 bytes, this one has 64"},
        {"tools:\n  - {name: a, shape: sphere, radius: 0.01, at: [0, 0, 1]}\n"
         "  - {name: a, shape: sphere, radius: 0.01, at: [0, 0, 2]}\n",
         "6:12", "there is already a tool named \"a\"; choose another name"},
        {"tools: [{name: a, shape: capsule, radius: 0.01, at: [0, 0, 1]}]\n", "4:9",
         "a capsule needs the key \"length\""},
        {"tools: [{name: a, shape: capsule, radius: 0.01, length: -1, at: [0, 0, 1]}]\n", "4:57",
         "length is -1"},
        {"tools: [{name: a, shape: capsule, radius: 0.01, length: 1, spread: 1, at: [0, 0, 1]}]\n",
         "4:60", "the key \"spread\" is unknown; a capsule may have the keys"},
        {GRASPER("spread: 0"), "4:89", "spread is 0; it must be more than zero"},
        {GRASPER("spread: 180"), "4:9", "less than 180 degrees"},
        {GRASPER("spread: 0.9"), "4:89",
         "do not part at that angle; if it is in radians, write 51.6"},
        {GRASPER("spread: 60 deg"), "4:89", "spread: expected a number in degrees"},
        {GRASPER("towards: [0, 0, 0]"), "4:90", "towards: this vector has no direction"},
        {GRASPER("towards: down"), "4:90", "towards: expected three numbers, a direction"},
        {GRASPER("path: [[1, 0, 0, 0, 2]]"), "4:101", "jaws are open by 0 (closed) to 1, not by 2"},
        {GRASPER("turn: left"), "4:87", "turn: expected a number in degrees"},
        {SPHERE("name: a, radius: 0.01, at: [0.015, 0.015, 0.029]"), "4:9",
         "the tool would begin 0.001 m inside the body, at element 108; begin outside and move it"},
        {SPHERE("name: a, radius: 0.001, at: [0.01, 0.01, 0.01]"), "4:9",
         "the tool would begin 0.011 m inside the body"},
        {"tools: [{name: a, shape: capsule, radius: 0.001, length: 1.005, at: [0.013, 0.012, "
         "-1]}]\n",
         "4:9", "the tool would begin 0.001 m inside the body, at element 104"},
        {"tools: [{name: a, shape: capsule, radius: 0.0151421356, length: 1, at: [0.265, 0.28, "
         "-0.22], towards: [1, 1, -1]}]\n",
         "4:9", "the tool would begin 0.001 m inside the body"}, /* across an edge */
        {"tools: [{name: a, shape: grasper, radius: 0.001, length: 0.02, at: [0.03, 0.01, 0.03], "
         "spread: 90}]\n",
         "4:9", "inside the body"}, /* one jaw, */
        {"tools: [{name: a, shape: grasper, radius: 0.001, length: 0.02, at: [-0.01, 0.01, 0.03], "
         "spread: 90}]\n",
         "4:9", "inside the body"}, /* and the other */
        {"tools: [{name: a, shape: grasper, radius: 0.001, length: 0.02, at: [0.01, 0.01, 0.037], "
         "spread: 30}]\n",
         "4:9", "inside the body"},
    };
    REFUSES(extra, BASE);
    char text[3000] = "tools:\n";
    for (int i = 0; i < 33; i++)
        snprintf(text + strlen(text), 80,
                 "  - {name: t%d, shape: sphere, radius: 0.01, at: [0, 0, 1]}\n", i);
    const wrong_scene many[] = {{text, "37:5", "there are more than 32 tools; remove some"}};
    REFUSES(many, BASE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_root),      cmocka_unit_test(test_yaml),
        cmocka_unit_test(test_materials), cmocka_unit_test(test_sets),
        cmocka_unit_test(test_supports),  cmocka_unit_test(test_loads_and_output),
        cmocka_unit_test(test_contact),   cmocka_unit_test(test_tools),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
