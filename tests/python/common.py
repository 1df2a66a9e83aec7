"""What the tests of the Python module share: a block with a probe, made of lists."""

import os
import sys
import tempfile

import lariat

try:
    import numpy
except ImportError:
    numpy = None
WITHOUT_NUMPY = "numpy is not installed"

EDGE, CELLS = 0.01, (6, 5, 3)
SCENE = {
    "lariat": 1, "title": "Block", "gravity": [0, 0, -9.81], "damping": 20,
    "materials": [{"name": "soft", "cells": "all", "law": "neo-hookean", "density": 1050,
                   "shear_modulus": 3000.0, "bulk_modulus": 30000.0}],
    "fix": [{"nodes": "floor", "axes": "xyz"}],
    "tools": [{"name": "probe", "shape": "sphere", "radius": 0.008, "at": [0.03, 0.025, 0.04]}],
}


def block_arrays(cells=CELLS):
    """Nodes, hexahedra and sets of a block, as nested lists."""
    nx, ny, nz = cells
    nodes = [[EDGE * i, EDGE * j, EDGE * k]
             for k in range(nz + 1) for j in range(ny + 1) for i in range(nx + 1)]

    def node(i, j, k):
        return (k * (ny + 1) + j) * (nx + 1) + i

    around = ((0, 0), (1, 0), (1, 1), (0, 1))
    hexahedra = [[node(i + a, j + b, k + c) for c in (0, 1) for a, b in around]
                 for k in range(nz) for j in range(ny) for i in range(nx)]
    floor = [n for n, place in enumerate(nodes) if place[2] == 0]
    top = [n for n, place in enumerate(nodes) if place[2] == EDGE * nz]
    return nodes, hexahedra, {"floor": floor, "top": top}


def block(**changes):
    nodes, hexahedra, sets = block_arrays()
    return lariat.Model.from_arrays(nodes, hexahedra, {**SCENE, **changes}, sets=sets)


_demo = []


def demo():
    """The folder of the demonstration organ, written once."""
    if not _demo:
        _demo.append(tempfile.TemporaryDirectory(prefix="lariat-test-"))
        lariat.write_demo(_demo[0].name)
    return _demo[0].name


def child(code):
    """Runs Python code in another process; what it prints and its exit status."""
    import subprocess
    done = subprocess.run([sys.executable, "-B", "-X", "faulthandler", "-c", code],
                          capture_output=True, text=True, timeout=300, check=False,
                          env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})
    return done.returncode, done.stdout, done.stderr
