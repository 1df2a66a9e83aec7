"""Files for the sweep: small meshes in every format, scenes and decks from their grammars, label
images; right ones, ones with something in them that cannot be, and ones changed by chance.
"""
import gzip
import re
import struct

# Numbers that lie at a border.
BORDERS = ["0", "-1", "1", "2", "127", "2147483647", "2147483648", "-2147483648", "4294967295",
           "9223372036854775807", "18446744073709551615", "99999999999999999999999", "1e308",
           "1e309", "-1e308", "-1e-320", "1e-30", "nan", "inf", "-inf", "1e", ".", "0x10", "''"]


def mutate(chance, data, changes=None):
    """Bytes changed one to four times: as tests/fuzz/driver.c does."""
    data = bytearray(data)
    for _ in range(changes or 1 + chance.randrange(4)):
        if not data:
            return b"\n"
        at, what = chance.randrange(len(data)), chance.randrange(10)
        if what == 0:
            data[at] ^= 1 << chance.randrange(8)
        elif what == 1:
            data[at] = chance.randrange(256)
        elif what == 2:
            del data[at:]
        elif what == 3:
            del data[at:at + chance.randrange(1, 100)]
        elif what == 4:
            data[at:at] = data[at:at + chance.randrange(1, 200)]
        elif what == 5:
            words = list(re.finditer(rb"[A-Za-z_]{2,}", bytes(data)))
            if words:
                one, other = chance.choice(words), chance.choice(words)
                data[one.start():one.end()] = other.group()
        else:
            numbers = list(re.finditer(rb"[-+]?[0-9][-+.0-9e]*", bytes(data)))
            if numbers:
                one = chance.choice(numbers)
                data[one.start():one.end()] = chance.choice(BORDERS).encode()
    return bytes(data)


# ---- meshes ---------------------------------------------------------------------------------------

# Corners of a cube, and what it can be cut into.
CUBE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
CUTS = {"hex": [range(8)],
        "tet": [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)],
        "prism": [(0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)],
        "pyramid": [(0, 1, 2, 3, 6), (0, 4, 5, 1, 6), (0, 3, 7, 4, 6)]}
TYPES = {"hex": ("C3D8", 5, 12), "tet": ("C3D4", 4, 10), "prism": ("C3D6", 6, 13),
         "pyramid": ("C3D5", 7, 14)}


class Mesh:
    def __init__(self, chance, counts, edge, kind="hex", jitter=0.0):
        self.kind = kind
        nx, ny, nz = counts
        number = {}
        self.nodes, self.cells, self.tags = [], [], []
        for k in range(nz + 1):
            for j in range(ny + 1):
                for i in range(nx + 1):
                    number[i, j, k] = len(self.nodes)
                    self.nodes.append([edge * (x + chance.uniform(-jitter, jitter))
                                       for x in (i, j, k)])
        for k in range(nz):
            for j in range(ny):
                for i in range(nx):
                    corners = [number[i + a, j + b, k + c] for a, b, c in CUBE]
                    for cut in CUTS[kind]:
                        self.cells.append([corners[c] for c in cut])
                        self.tags.append(1 if 2 * k < nz else 2)

    def spoil(self, chance):
        """Something that no mesh has."""
        what = chance.randrange(6)
        cell = chance.choice(self.cells)
        node = chance.choice(self.nodes)
        if what == 0:
            cell[0], cell[1] = cell[1], cell[0]
        elif what == 1:
            cell[0] = cell[1]
        elif what == 2:
            self.cells.append(list(cell))
            self.tags.append(1)
        elif what == 3:
            node[chance.randrange(3)] = chance.choice([1e300, -1e30, 1e-300, float("nan"), 0])
        elif what == 4:
            cell[0] = len(self.nodes) + chance.choice([0, 1, 1 << 31])
        else:
            node[:] = chance.choice(self.nodes)

    def inp(self):
        lines = ["*HEADING", "A block", "*NODE, NSET=ALL"]
        lines += [f"{n + 1}, {x!r}, {y!r}, {z!r}" for n, (x, y, z) in enumerate(self.nodes)]
        for tag in sorted(set(self.tags)):
            lines.append(f"*ELEMENT, TYPE={TYPES[self.kind][0]}, ELSET=PART{tag}")
            lines += [", ".join(map(str, [e + 1] + [n + 1 for n in cell]))
                      for e, cell in enumerate(self.cells) if self.tags[e] == tag]
        lines += ["*ELSET, ELSET=ALL_OF_IT, GENERATE", f"1, {len(self.cells)}, 1"]
        low = min(node[2] for node in self.nodes)
        lines.append("*NSET, NSET=BASE")
        lines += [f"{n + 1}," for n, node in enumerate(self.nodes) if node[2] == low]
        lines += ["*SURFACE, NAME=SKIN", f"PART{max(self.tags)}, S2"]
        return "\n".join(lines) + "\n"

    def msh(self):
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(self.nodes))]
        lines += [f"{n + 1} {x!r} {y!r} {z!r}" for n, (x, y, z) in enumerate(self.nodes)]
        lines += ["$EndNodes", "$Elements", str(len(self.cells))]
        lines += [" ".join(map(str, [e + 1, TYPES[self.kind][1], 2, self.tags[e], self.tags[e]] +
                               [n + 1 for n in cell])) for e, cell in enumerate(self.cells)]
        return "\n".join(lines + ["$EndElements"]) + "\n"

    def vtk(self):
        lines = ["# vtk DataFile Version 3.0", "a block", "ASCII", "DATASET UNSTRUCTURED_GRID",
                 f"POINTS {len(self.nodes)} double"]
        lines += [f"{x!r} {y!r} {z!r}" for x, y, z in self.nodes]
        lines.append(f"CELLS {len(self.cells)} {sum(1 + len(c) for c in self.cells)}")
        lines += [" ".join(map(str, [len(cell)] + cell)) for cell in self.cells]
        lines.append(f"CELL_TYPES {len(self.cells)}")
        lines += [str(TYPES[self.kind][2])] * len(self.cells)
        lines += [f"CELL_DATA {len(self.cells)}", "SCALARS tag int", "LOOKUP_TABLE default"]
        return "\n".join(lines + [str(tag) for tag in self.tags]) + "\n"

    def vtu(self):
        offsets, end = [], 0
        for cell in self.cells:
            end += len(cell)
            offsets.append(end)

        def array(name, kind, values, more=""):
            return (f'<DataArray type="{kind}" Name="{name}" {more}format="ascii">'
                    + " ".join(map(repr, values)) + "</DataArray>")
        return ('<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" '
                'byte_order="LittleEndian">\n<UnstructuredGrid>\n'
                f'<Piece NumberOfPoints="{len(self.nodes)}" NumberOfCells="{len(self.cells)}">\n'
                "<Points>" + array("Points", "Float64", [x for n in self.nodes for x in n],
                                   'NumberOfComponents="3" ') + "</Points>\n<Cells>"
                + array("connectivity", "Int64", [n for c in self.cells for n in c]) + "\n"
                + array("offsets", "Int64", offsets) + "\n"
                + array("types", "UInt8", [TYPES[self.kind][2]] * len(self.cells))
                + "</Cells>\n<CellData>" + array("tag", "Int32", self.tags)
                + "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n")

    def feb(self):
        kinds = {"hex": "hex8", "tet": "tet4", "prism": "penta6", "pyramid": "pyra5"}
        nodes = "".join(f'<node id="{n + 1}">{x!r},{y!r},{z!r}</node>\n'
                        for n, (x, y, z) in enumerate(self.nodes))
        cells = "".join(f'<elem id="{e + 1}">{",".join(str(n + 1) for n in cell)}</elem>\n'
                        for e, cell in enumerate(self.cells))
        return ('<?xml version="1.0"?>\n<febio_spec version="4.0">\n<Module type="solid"/>\n<Mesh>'
                f'<Nodes name="all">\n{nodes}</Nodes>\n<Elements type="{kinds[self.kind]}" '
                f'name="PART1">\n{cells}</Elements>\n</Mesh>\n</febio_spec>\n')


def some_mesh(chance, kind="hex", most=3, spoilt=0.15):
    counts = [chance.randrange(1, most + 1) for _ in range(3)]
    mesh = Mesh(chance, counts, chance.choice([0.01, 0.01, 0.01, 1, 1e-6, 1e6]), kind,
                chance.choice([0, 0, 0.1, 0.3]))
    if chance.random() < spoilt:
        mesh.spoil(chance)
    return mesh


# ---- scenes ---------------------------------------------------------------------------------------

def usually(chance, good, *others):
    """The good value, but now and then one of the others, or a border."""
    if chance.random() < 0.985:
        return good
    return chance.choice(list(others) + BORDERS)


def vector(chance, reach, sign=0):
    """Three numbers; below or above zero where a sign is given."""
    low, high = -reach if sign <= 0 else reach / 2, reach if sign >= 0 else 0
    return "[" + ", ".join(str(usually(chance, repr(chance.uniform(low, high))))
                           for _ in range(3)) + "]"


def selector(chance, edge, depth=0):
    """Anything that stands where nodes are asked for."""
    if depth < 2 and chance.random() < 0.25:
        a, b = selector(chance, edge, depth + 1), selector(chance, edge, depth + 1)
        return chance.choice([f"{{ all: [ {a}, {b} ] }}", f"{{ any: [ {a}, {b} ] }}",
                              f"{{ not: {a} }}", f"[ {a}, {b} ]"])
    return chance.choice([
        "all", "base", "top", "skin" if depth < 2 else "all", f"{{ box: [{vector(chance, edge, -1)}, {vector(chance, 3 * edge, 1)}] }}",
        f"{{ sphere: {{ center: {vector(chance, edge)}, radius: {usually(chance, 2 * edge)} }} }}",
        f"{{ plane: {{ point: [0, 0, 0], normal: {vector(chance, 1)} }} }}",
        f"{{ nearest: {vector(chance, edge)} }}", "{ surface: true }", "{ tag: 2 }", "{ list: [1] }",
        "{ set: base }", str(usually(chance, 1))])


def curve(chance):
    if chance.random() < 0.4:
        return f"over: {usually(chance, 0.01)}"
    points = ", ".join(f"[{usually(chance, round(0.004 * i, 4))}, "
                       f"{usually(chance, round(chance.uniform(0, 1), 3) if i else 0)}]"
                       for i in range(chance.randrange(1, 4)))
    shape = usually(chance, chance.choice(["linear", "smooth"]), "step", "round")
    return f"curve: {{ points: [{points}], shape: {shape} }}"


def material(chance):
    law = chance.choice(["neo-hookean", "coupled-neo-hookean", "mooney-rivlin"])
    g = usually(chance, chance.choice([500, 4e3, 1e5]))
    stiffness = chance.choice([
        f"shear_modulus: {g}, bulk_modulus: {usually(chance, 4e5)}",
        f"youngs_modulus: {g}, poisson_ratio: {usually(chance, 0.45, 0.5, -1, 0.4999999)}",
        {"neo-hookean": f"shear_modulus: {g}, bulk_modulus: 1e5",
         "coupled-neo-hookean": f"mu: {g}, lambda: {usually(chance, 4e4, -100)}",
         "mooney-rivlin": f"c1: {g}, c2: {usually(chance, 100, -100)}, bulk_modulus: 1e5"}[law]])
    return f"law: {law}, density: {usually(chance, 1000, 1e-6)}, {stiffness}"


def tool(chance, edge, name):
    shape = chance.choice(["sphere", "capsule", "grasper"])
    size = edge * chance.choice([0.3, 0.5, 1])
    more = "" if shape == "sphere" else f", length: {usually(chance, 3 * size)}"
    if shape != "sphere" and chance.random() < 0.5:
        more += f", towards: {vector(chance, 1)}"
    if shape == "grasper" and chance.random() < 0.5:
        more += f", spread: {usually(chance, 50, 0, 180)}, turn: {usually(chance, 90)}"
    return (f"{{ name: {name}, shape: {usually(chance, shape, 'none')}, radius: "
            f"{usually(chance, size)}{more}, at: [{edge}, {edge}, {usually(chance, 9 * edge)}] }}")


def scene(chance, mesh_name, edge):
    """A scene of every key, each of them there now and then."""
    lines = ["lariat: 1", f"mesh: {mesh_name}", "materials:",
             f"  - {{ cells: all, {material(chance)} }}"]

    def maybe(likely, *more):
        if chance.random() < likely:
            lines.extend(more)
    maybe(0.3, f"  - {{ cells: 2, {material(chance)} }}")
    lines += ["sets:", f"  - {{ name: base, nodes: {{ box: [[-9e9, -9e9, -9e9], [9e9, 9e9, "
              f"{edge / 2}]] }} }}",
              "  - { name: top, faces: { surface: true } }",
              f"  - {{ name: skin, nodes: {selector(chance, edge, 2)} }}"]
    maybe(0.3, f"title: {usually(chance, 'a block')}")
    maybe(0.6, f"gravity: {vector(chance, 10)}")
    maybe(0.6, f"damping: {usually(chance, 5)}")
    maybe(0.2, f"time_step: {usually(chance, 'auto', 1e-5, 1e-9)}")
    maybe(0.3, f"duration: {usually(chance, 'rest', 0.01)}")
    maybe(0.8, "fix: [ { nodes: base, axes: xyz } ]")
    maybe(0.2, f"move: [ {{ nodes: {{ nearest: {vector(chance, 3 * edge)} }}, axes: x, by: "
          f"{usually(chance, edge / 5)}, {curve(chance)} }} ]")
    loads = [f"  - {{ nodes: {selector(chance, edge)}, force: {vector(chance, 0.1)}, "
             f"{curve(chance)} }}",
             f"  - {{ faces: {usually(chance, 'all', selector(chance, edge))}, pressure: "
             f"{usually(chance, 50)}, {curve(chance)} }}"]
    maybe(0.5, "load:", *chance.sample(loads, chance.randrange(1, 3)))
    maybe(0.2, f"initial: [ {{ nodes: {selector(chance, edge)}, velocity: {vector(chance, 1)} }} ]")
    maybe(0.4, "contact:", "  - { self: true }", f"  - {{ faces: all, plane: {{ through: [0, 0, "
          f"{usually(chance, -edge)}], normal: [0, 0, {usually(chance, 1)}] }} }}")
    maybe(0.5, "tools:", *[f"  - {tool(chance, edge, name)}"
                           for name in ["probe", "second"][:chance.randrange(1, 3)]])
    maybe(0.3, f"view: {vector(chance, 1)}")
    maybe(0.6, f"output: {{ every: {usually(chance, 0.001)}, fields: [displacement, velocity, "
          f"von_mises, pressure, energy], probes: [ {{ node: {usually(chance, 1)} }}, {{ nodes: "
          f"{selector(chance, edge)}, name: p, sum: reaction }} ] }}")
    return "\n".join(lines) + "\n"


# ---- decks ----------------------------------------------------------------------------------------

def deck(chance, mesh):
    """An Abaqus deck: what docs/formats.md says is read, with something else in between."""
    law = usually(chance, chance.choice(["*ELASTIC\n1e4, 0.4", "*HYPERELASTIC, NEO HOOKE\n500, 1e-4",
                                         "*HYPERELASTIC, MOONEY-RIVLIN\n300, 100, 2e-5"]),
                  "*PLASTIC\n1, 2")
    static = chance.random() < 0.5
    loads = [
        f"*BOUNDARY{usually(chance, '', ', AMPLITUDE=UP', ', OP=NEW')}\n2, 1, 1, "
        f"{usually(chance, 0.0001)}",
        f"*CLOAD{usually(chance, '', ', AMPLITUDE=UP')}\nALL, {usually(chance, 3)}, "
        f"{usually(chance, -0.001)}",
        f"*DLOAD\nALL_OF_IT, {usually(chance, 'P2', 'P7')}, {usually(chance, 10)}",
        f"*DLOAD\n, GRAV, {usually(chance, 9.81)}, 0, 0, {usually(chance, -1)}",
        f"*DSLOAD\nSKIN, P, {usually(chance, 5)}"]
    between = ["*FRICTION\n0.", "*NODE FILE\nU", "*EQUATION\n2\n1,1,1.", "*TEMPERATURE\nALL, 300",
               "*INCLUDE, INPUT=/etc/passwd", "*SURFACE INTERACTION, NAME=T", "*UNHEARD OF, X=1",
               "*INITIAL CONDITIONS, TYPE=VELOCITY\nALL, 1, 0.01"]
    lines = [mesh.inp() + "*MATERIAL, NAME=A", law, f"*DENSITY\n{usually(chance, 1000)}",
             *[f"*SOLID SECTION, ELSET=PART{tag}, MATERIAL={usually(chance, 'A', 'B')}"
               for tag in sorted(set(mesh.tags))],
             f"*AMPLITUDE, NAME=UP\n0, 0, {usually(chance, 0.01)}, {usually(chance, 1)}",
             f"*BOUNDARY\nBASE, {usually(chance, 1)}, {usually(chance, 3)}"]
    if chance.random() < 0.2:
        lines.append(chance.choice(between))
    lines += [f"*STEP{usually(chance, ', NLGEOM')}",
              f"{'*STATIC' if static else '*DYNAMIC, EXPLICIT'}\n0.001, {usually(chance, 0.01)}"]
    lines += chance.sample(loads, chance.randrange(0, 4))
    if chance.random() < 0.1:
        lines.append(chance.choice(between))
    return "\n".join(lines + [usually(chance, "*END STEP")]) + "\n"


# ---- images ---------------------------------------------------------------------------------------

def labels(chance, size):
    """A ball of 1 with a ball of 2 in it, some noise."""
    noise = chance.choice([0, 0, 0.02])
    middle = [(n - 1) / 2 for n in size]
    reach = max(1, min(size) / 2 - 0.6)
    out = bytearray()
    for k in range(size[2]):
        for j in range(size[1]):
            for i in range(size[0]):
                away = sum(((x - m) / reach) ** 2 for x, m in zip((i, j, k), middle)) ** 0.5
                value = 0 if away > 1 else 2 if away < 0.5 else 1
                out.append(chance.randrange(4) if chance.random() < noise else value)
    return bytes(out)


def nrrd(chance):
    size = [chance.randrange(4, 13) for _ in range(3)]
    voxels = labels(chance, size)
    encoding = chance.choice(["raw", "gzip", "text"])
    data = {"raw": voxels, "gzip": gzip.compress(voxels, mtime=0),
            "text": " ".join(map(str, voxels)).encode()}[encoding]
    step = usually(chance, chance.choice([2, 0.5, 1]))
    head = (f"NRRD0004\ntype: {usually(chance, 'uchar', 'float', 'int64', 'double')}\n"
            f"dimension: {usually(chance, 3, 4)}\nspace: {usually(chance, 'left-posterior-superior')}"
            f"\nsizes: {usually(chance, size[0])} {size[1]} {size[2]}\n"
            f"space directions: ({step},0,0) (0,{step},0) (0,{usually(chance, 0)},{step})\n"
            f"encoding: {encoding}\nendian: little\nspace origin: ({usually(chance, 5)},2,3)\n\n")
    return head.encode() + data


def nifti(chance):
    """NIfTI-1, one file: https://nifti.nimh.nih.gov, nifti1.h."""
    size = [chance.randrange(4, 13) for _ in range(3)]
    step = chance.choice([2.0, 0.5, 1.0, 1.0, 0.0, float("nan"), -1.0, 1e30])
    head = bytearray(348)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 3, *[chance.choice([n, n, n, n, n, n, -1, 32767]) for n in size],
                     1, 1, 1, 1)
    struct.pack_into("<2h", head, 70, *chance.choice([(2, 8), (2, 8), (2, 8), (4, 16), (16, 32)]))
    struct.pack_into("<8f", head, 76, 1, step, step, step, 0, 0, 0, 0)
    struct.pack_into("<f", head, 108, chance.choice([352.0, 352.0, 352.0, 0.0, 1e9]))
    struct.pack_into("<2f", head, 112, *chance.choice([(1, 0), (0, 0), (0, 0), (1e30, 0), (1, -1)]))
    head[123] = chance.choice([2, 2, 2, 1, 0])
    struct.pack_into("<2h", head, 252, 0, chance.choice([0, 1]))
    struct.pack_into("<12f", head, 280, step, 0, 0, 0, 0, step, 0, 0, 0, 0, step, 0)
    head[344:348] = b"n+1\0"
    data = bytes(head) + bytes(4) + labels(chance, size)
    return gzip.compress(data, mtime=0) if chance.random() < 0.5 else data
