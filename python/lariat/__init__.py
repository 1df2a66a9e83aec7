"""Lariat: real-time finite elements for soft tissue.

    import lariat
    lariat.write_demo("demo")
    model = lariat.Model("demo/uterus_live.yaml")
    with lariat.Simulation(model) as sim:
        sim.advance(seconds=0.1)
        print(sim.time, sim.energies(), f"{sim.hash():016x}")

mesh: from scans and surfaces to a Meshing. Model: what is simulated, constant. Simulation: the state that moves. Saved: a state in memory.
Batch: many simulations, advanced on all cores; lariat.envs: environments of Gymnasium's interface.
Session: a simulation in real time, with tools, devices and the viewer. info, requirements, predict
and fit measure, plan and find parameters of tissue, by the command `lariat`. SI units; vectors are x, y,
z; nodes and elements count from 0. Arrays are memoryviews, which numpy.asarray takes without a copy;
numpy is not needed. What is refused raises a subclass of Error with the library's sentence.
docs/python.md is the tutorial.
"""

import os as _os
from weakref import WeakValueDictionary as _WeakValueDictionary

if not _os.path.exists(_os.path.join(_os.path.dirname(__file__), "_lariat.abi3.so")):
    raise ImportError(
        "lariat's compiled module is not here; `make` builds it in a clone (`make demo` builds the "
        "command and the page only), `pip install .` installs it")
from ._lariat import (
    ArgumentError,
    Batch,
    Error,
    FileError,
    FormatError,
    Meshing,
    Model,
    ModelError,
    OutOfMemoryError,
    PeerError,
    Results,
    Saved,
    Session,
    Simulation,
    StateError,
    UnstableError,
    UnsupportedError,
    View,
    __version__,
    checkpoint_info,
    mesh,
    write_demo,
)
from ._study import Answer, Experiment, Fit, Parameter, fit, info, predict, profiles, requirements

__all__ = [
    "Answer", "ArgumentError", "Batch", "Error", "Experiment", "FileError", "Fit", "FormatError",
    "Meshing", "Model", "ModelError", "OutOfMemoryError", "Parameter", "PeerError",
    "Results", "Saved", "Session", "Simulation", "StateError", "UnstableError", "UnsupportedError", "View",
    "__version__", "checkpoint_info", "fit", "info", "mesh", "predict", "profiles", "requirements",
    "write_demo",
]
# What help() and pickles call them.
for _public in (Answer, Experiment, Fit, Parameter, fit, info, predict, profiles, requirements):
    _public.__module__ = __name__

# Wheels bring the viewer's page along; elsewhere the library knows where it was installed.
_viewer_folder = _os.path.join(_os.path.dirname(_os.path.abspath(__file__)), "viewer")
if not _os.path.exists(_os.path.join(_viewer_folder, "index.html")):
    _viewer_folder = None


# ---- pickles -------------------------------------------------------------------------------------


def _unpack(packed):
    if packed is None:
        return None
    data, kind, columns = packed
    view = memoryview(data).cast(kind)
    rows = len(view) // columns if columns else 0
    return memoryview(data).cast(kind, (rows, columns)) if columns and rows else view


def _from_packed(nodes, hexahedra, scene, tags, sets, fibres, fibres2=None):
    return Model.from_arrays(
        _unpack(nodes), _unpack(hexahedra), scene, tags=_unpack(tags), fibres=_unpack(fibres),
        fibres2=_unpack(fibres2),
        sets={name: (kind, _unpack(index)) for name, (kind, index) in sets.items()})


def _through_file(call):
    """Calls with a path in a folder of its own, which is gone afterwards; in memory where it has
    room, for nothing of it must outlive a power cut."""
    import tempfile

    for place in ("/dev/shm", None):
        try:
            with tempfile.TemporaryDirectory(prefix="lariat-", dir=place) as folder:
                return call(_os.path.join(folder, "state"))
        except OSError:
            if place is None:
                raise


class _Maker:
    """Makes the simulations of a pickle that are of one model, with the same options: all but the
    first are clones, which takes a fraction of the time. Pickles have it once."""

    def __init__(self, model, options):
        self.model, self.options, self.first = model, options, None

    def __reduce__(self):
        return _Maker, (self.model, self.options)

    def make(self):
        if self.first is not None:
            try:
                return self.first.clone()
            except Error:  # it has a grid, or is closed
                pass
        self.first = Simulation(self.model, **self.options)
        return self.first


_makers = _WeakValueDictionary()  # of the pickles that are being made, which keep them


def _reduce_simulation(simulation):
    def save(path):
        simulation.save()  # an unstable run says so, and not the path of a file that nobody knows
        simulation.save(path)
        with open(path, "rb") as file:
            return file.read()

    model, options = simulation.model, simulation.options
    key = id(model), repr(options)
    maker = _makers.get(key) or _makers.setdefault(key, _Maker(model, options))
    return _restore_simulation, (maker, _through_file(save), simulation._asked())


def _restore_simulation(maker, state, asked):
    def load(path):
        with open(path, "wb") as file:
            file.write(state)
        simulation.load(path)

    simulation = maker.make()
    _through_file(load)
    simulation._asked(asked)
    return simulation


def _restore_batch(simulations, workers):
    return Batch(simulations, workers=workers)
