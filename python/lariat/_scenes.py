"""Models, scenes and tables that are in memory, as files for the command.

    with Folder() as folder:
        name = folder.model(model)       a Model, a Meshing, a dict or a path: what the command reads

A folder is made when there is something to write into it, and is gone in the end. The command then
runs in it; in its messages `told` puts the caller's own words in place of the names of these files.
Paths of the caller's are made absolute.
"""

import base64
import math
import os
import re
import struct
import sys
import tempfile
from urllib.parse import quote

from ._lariat import ArgumentError, Meshing, Model
from ._scene_text import DictText, check_text, text_of, with_keys

_HEXAHEDRON = 12  # of VTK
_VECTORS = 'NumberOfComponents="3"'


def path_of(source, name="path"):
    """A path as the operating system takes it, absolute."""
    try:
        path = os.fsdecode(source)
    except TypeError:
        raise TypeError(f"{name}: expected a path, got {type(source)!r}") from None
    check_text(path, name)
    if not path or "\0" in path:
        raise ArgumentError(f"{name}: expected a path, got {path!r}")
    return os.path.abspath(path)


# ---- a mesh in memory ----------------------------------------------------------------------------


def _array(name, kind, raw, size=""):
    """An array of a VTK file: its bytes in base64, behind their number."""
    inside = base64.b64encode(struct.pack("=Q", len(raw)) + raw).decode()
    return f'<DataArray type="{kind}" Name="{name}" {size} format="binary">{inside}</DataArray>\n'


def _vtu(nodes, hexahedra, tags, sets, *fibres):
    """A VTK file of packed arrays: (bytes, format, columns) each, as pickles have them."""
    points, cells = len(nodes[0]) // 24, len(hexahedra[0]) // 32
    order = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
    yield (f'<VTKFile type="UnstructuredGrid" version="1.0" byte_order="{order}" '
           'header_type="UInt64"><UnstructuredGrid>\n<FieldData>\n')
    for name, (kind, index) in sets.items():
        yield _array(f"set:{kind}:{quote(name, safe='')}", "Int32", index[0],
                     f'NumberOfTuples="{len(index[0]) // 4}"')
    yield f'</FieldData>\n<Piece NumberOfPoints="{points}" NumberOfCells="{cells}">\n<Points>\n'
    yield _array("Points", "Float64", nodes[0], _VECTORS)
    yield "</Points>\n<Cells>\n" + _array("connectivity", "Int32", hexahedra[0])
    yield _array("offsets", "Int64", struct.pack(f"={cells}q", *range(8, 8 * cells + 1, 8)))
    yield _array("types", "UInt8", bytes([_HEXAHEDRON]) * cells) + "</Cells>\n<CellData>\n"
    if tags:
        yield _array("tag", "Int32", tags[0])
    for name, family in zip(("fibre", "fibre2"), fibres):
        if family:
            yield _array(name, "Float64", family[0], _VECTORS)
    yield "</CellData>\n</Piece></UnstructuredGrid></VTKFile>\n"


def _with_mesh(scene, mesh):
    """The text of a scene, which has no mesh or `mesh: given`, with one."""
    key = f'"mesh": "{mesh}"'
    given = re.compile(r"""^\s?(["']?)mesh\1\s*:\s*(["']?)given\2(?=\s*(,|#|$))""", re.M)
    if given.search(scene):
        return given.sub(lambda found: key, scene, count=1)
    flow = re.match(r"\s*\{", scene)
    if flow:
        return scene[:flow.end()] + key + "," + scene[flow.end():]
    head = re.match(r"(%.*\n)*(---[ \t]*\n)?", scene).end()
    return f"{scene[:head]}{key}\n{scene[head:]}"


# ---- dicts with paths in them --------------------------------------------------------------------


def _file_entry(value, name):
    """`mesh` and `surface` of a scene: a path, {"file": path, ...}, or a list of them."""
    if isinstance(value, (list, tuple)):
        return [_file_entry(entry, name) for entry in value]
    if isinstance(value, dict):
        return {**value, "file": path_of(value["file"], name)} if "file" in value else value
    return value if value == "given" else path_of(value, name)


def _scene_with_paths(scene):
    scene = dict(scene)
    for key in ("mesh", "surface"):
        if key in scene:
            scene[key] = _file_entry(scene[key], key)
    if isinstance(scene.get("materials"), (list, tuple)):
        scene["materials"] = [
            {**m, "tissue": path_of(m["tissue"], "tissue")} if isinstance(m, dict) and "tissue" in m
            else m for m in scene["materials"]]
    return scene


# ---- tables --------------------------------------------------------------------------------------


def _column(values, name):
    try:
        numbers = [float(v) for v in values]
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected a sequence of numbers, [rows]") from None
    for row, number in enumerate(numbers):
        if not math.isfinite(number):
            raise ArgumentError(f"{name}: row {row} is {number}, which is no finite number")
    return numbers


def table_of(columns, name):
    """A dict of columns as CSV."""
    if not columns:
        raise ArgumentError(f"{name}: there is no column")
    names = list(columns)
    for column in names:
        if not isinstance(column, str) or not re.fullmatch(r"[^\s,#\"]+", column):
            raise ArgumentError(f"{name}: {column!r} cannot be the name of a column")
    parts = [_column(columns[column], f'{name}["{column}"]') for column in names]
    for column, part in zip(names, parts):
        if len(part) != len(parts[0]):
            raise ArgumentError(f'{name}["{column}"]: expected {len(parts[0])} rows as "{names[0]}" '
                                f"has, got {len(part)}")
    rows = [",".join(map(repr, row)) for row in zip(*parts)]
    return "\n".join([",".join(names), *rows]) + "\n"


class Folder:
    """A folder for what has no file; `path` is None as long as there is nothing in it."""

    def __init__(self):
        self._made = None
        self._names = set()
        self._dicts = {}  # name of a file: what the caller calls it, and its text
        self._tables = {}  # name of a file: what the caller calls it

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self._made:
            self._made.cleanup()

    @property
    def path(self):
        return self._made.name if self._made else None

    def write(self, name, parts):
        """A file of a name like this one; returns its name."""
        self._made = self._made or tempfile.TemporaryDirectory(prefix="lariat-")
        stem, ending = os.path.splitext(name)
        number = 2
        while name in self._names:
            name, number = f"{stem}_{number}{ending}", number + 1
        self._names.add(name)
        with open(os.path.join(self._made.name, name), "w", encoding="utf-8",
                  errors="surrogateescape") as file:
            file.writelines(parts)
        return name

    def dict_file(self, file, value, name):
        """A file of what is in a dict, which the caller calls `name`; returns the file's name."""
        text = text_of(value, name)
        file = self.write(file, [text])
        self._dicts[file] = name, text
        return file

    def told(self, message):
        """A message of the command's, in which dicts and texts are no files."""
        for file, (name, text) in self._dicts.items():
            message = with_keys(message, name, text, file)
            message = message.replace(f"the {name} {file}", f"the {name}")
            message = re.sub(rf"(?<![\w/.]){re.escape(file)}(?=: )", name, message)
            message = re.sub(rf"(?<=\w ){re.escape(file)}(?![\w:/]|\.\w)", f"the {name}", message)
        for file, name in self._tables.items():
            file = rf"(?<![\w/.]){re.escape(file)}"
            message = re.sub(rf"{file}:1\b", name, message)  # the line of the columns' names
            message = re.sub(rf"{file}:(\d+)\b",
                             lambda found, name=name: f"{name}, row {int(found[1]) - 2}", message)
            message = re.sub(rf"{file}(?![\w/]|\.\w)", name, message)
        return message

    def model(self, model, name="model"):
        """What the command reads: a path."""
        if isinstance(model, Meshing):
            model = model.model()
        if isinstance(model, dict):
            return self.dict_file("scene.yaml", _scene_with_paths(model), name)
        if not isinstance(model, Model):
            try:
                return path_of(model, name)
            except TypeError:
                raise TypeError(f"{name}: expected a Model, a path or a scene as a dict, got "
                                f"{type(model)!r}") from None
        recipe = model.__reduce__()[1]
        if len(recipe) == 1:
            return path_of(recipe[0], name)
        nodes, hexahedra, scene, tags, sets, *fibres = recipe
        mesh = self.write("mesh.vtu", _vtu(nodes, hexahedra, tags, sets, *fibres))
        if scene is None:
            return mesh
        file = self.write("scene.yaml", [_with_mesh(scene, mesh)])
        self._dicts[file] = "scene", scene if isinstance(scene, DictText) else ""
        return file

    def table(self, source, key, entry):
        """A table, in the experiments' entry of this number: a path, or columns by their names."""
        if not isinstance(source, dict):
            return path_of(source, key)
        name = f"experiment.experiments[{entry}].{key}"
        file = self.write(f"{key}.csv", [table_of(source, name)])
        self._tables[file] = name
        return file

    def experiment(self, experiment):
        """The file of a fit: a path, or a dict whose scenes and tables may be in memory."""
        if not isinstance(experiment, dict):
            try:
                return path_of(experiment, "experiment")
            except TypeError:
                raise TypeError("experiment: expected a path or a dict, got "
                                f"{type(experiment)!r}") from None
        experiment = {"lariat-fit": 1, **experiment}
        listed = experiment.get("experiments")
        if not isinstance(listed, (list, tuple)) or not all(isinstance(e, dict) for e in listed):
            raise ArgumentError('experiment: expected "experiments", a list of dicts')
        written = {}  # one file for a scene that several experiments have
        experiment["experiments"] = [self._entry(dict(entry), written, i)
                                     for i, entry in enumerate(listed)]
        return self.dict_file("experiment.yaml", experiment, "experiment")

    def _entry(self, entry, written, number):
        if "scene" in entry:
            scene = entry["scene"]
            if id(scene) not in written:
                written[id(scene)] = self.model(scene, "scene")
            entry["scene"] = written[id(scene)]
        for key in ("data", "pressure"):
            if key in entry:
                entry[key] = self.table(entry[key], key, number)
        return entry
