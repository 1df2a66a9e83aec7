#!/usr/bin/env python3
"""Writes the meshes of the scenes in this folder (millimetres)."""
from math import cos, pi, radians, sin


class Mesh:
    def __init__(self):
        self.nodes, self.elements, self.sets = [], [], {}

    def grid(self, counts, place, name, closed=False):
        """A block of counts[0] x [1] x [2] hexahedra; place(u, v, w), each 0..1, is a point.
        closed: u = 1 is where u = 0 is."""
        nx, ny, nz = counts
        first, row = len(self.nodes), nx if closed else nx + 1
        for k in range(nz + 1):
            for j in range(ny + 1):
                for i in range(row):
                    self.nodes.append(place(i / nx, j / ny, k / nz))

        def node(i, j, k):
            return first + 1 + i % row + row * (j + (ny + 1) * k)

        corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
        for k in range(nz):
            for j in range(ny):
                for i in range(nx):
                    self.elements.append((name, [node(i + a, j + b, k + c)
                                                 for c in (0, 1) for a, b in corners]))

    def write(self, path, title):
        with open(path, "w") as out:
            out.write(f"** {title}, in millimetres; written by meshes.py\n*NODE\n")
            for number, (x, y, z) in enumerate(self.nodes, 1):
                out.write(f"{number}, {x:.5g}, {y:.5g}, {z:.5g}\n")
            last = None
            for number, (name, nodes) in enumerate(self.elements, 1):
                if name != last:
                    out.write(f"*ELEMENT, TYPE=C3D8, ELSET={name}\n")
                last = name
                out.write(", ".join(map(str, [number] + nodes)) + "\n")
            for name, nodes in self.sets.items():
                out.write(f"*NSET, NSET={name}\n")
                for first in range(0, len(nodes), 16):
                    out.write(", ".join(map(str, nodes[first:first + 16])) + "\n")


def turned(point, axis, angle):
    """A point turned about a coordinate axis through the origin."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    c, s = cos(radians(angle)), sin(radians(angle))
    result = list(point)
    result[i], result[j] = c * point[i] - s * point[j], s * point[i] + c * point[j]
    return result


def blocks():
    """A slab on the table, and a cube that hangs above it, tilted so that an edge lands first."""
    mesh = Mesh()
    mesh.grid((8, 8, 4), lambda u, v, w: (40 * u - 20, 40 * v - 20, 16 * w), "lower")

    def cube(u, v, w):
        point = turned((20 * u - 10, 20 * v - 10, 20 * w - 10), 1, 12)
        x, y, z = turned(point, 2, 25)
        return x, y, z + 33
    mesh.grid((5, 5, 5), cube, "upper")
    mesh.write("blocks.inp", "Two blocks")


def strip():
    """A C: a strip bent to 300 degrees of a ring, its gap to the right."""
    def place(u, v, w):
        angle = pi / 6 + u * 5 * pi / 3
        radius = 18 + 4 * v
        return radius * cos(angle), 12 * w - 6, radius * sin(angle)
    mesh = Mesh()
    mesh.grid((45, 2, 4), place, "strip")
    mesh.write("strip.inp", "A strip bent to a C")


def bar():
    """A muscle of 30 x 8 x 8 mm along x."""
    mesh = Mesh()
    mesh.grid((9, 3, 3), lambda u, v, w: (30 * u, 8 * v, 8 * w), "muscle")
    mesh.write("bar.inp", "A bar")


def cup():
    """A thick half of an egg, open at z = 0, with a small hole at its lower end."""
    def place(u, v, w):
        side, down = 2 * pi * u, radians(82 * w)
        radius, depth = 10 + 5 * v, 20 + 5 * v
        return (radius * cos(down) * cos(side), radius * cos(down) * sin(side),
                -depth * sin(down))
    mesh = Mesh()
    mesh.grid((12, 2, 6), place, "wall", closed=True)
    for name, layer in (("inside", 0), ("outside", 2)):
        mesh.sets[name] = [1 + i + 12 * (layer + 3 * k) for k in range(7) for i in range(12)]
    mesh.write("cup.inp", "A cup with a thick wall")


def gel():
    """A block of gel."""
    mesh = Mesh()
    mesh.grid((12, 12, 6), lambda u, v, w: (40 * u - 20, 40 * v - 20, 20 * w), "gel")
    mesh.sets["bottom"] = list(range(1, 13 * 13 + 1))
    mesh.write("gel.inp", "A block of gel")


def tube():
    """A tube of 60 mm along z."""
    def place(u, v, w):
        radius = 4 + 2 * v
        return radius * cos(2 * pi * u), -radius * sin(2 * pi * u), 60 * w
    mesh = Mesh()
    mesh.grid((12, 1, 30), place, "wall", closed=True)
    mesh.write("tube.inp", "A tube")


def ring():
    """A quarter of a ring of an artery."""
    def place(u, v, w):
        radius = 3.1 + 0.8 * v
        return radius * sin(pi / 2 * u), radius * cos(pi / 2 * u), 1.5 * w
    mesh = Mesh()
    mesh.grid((16, 4, 2), place, "media")
    for name, layer in (("inside", 0), ("outside", 4)):
        mesh.sets[name] = [1 + i + 17 * (layer + 5 * k) for k in range(3) for i in range(17)]
    mesh.write("ring.inp", "A quarter of a ring of an artery")


blocks()
strip()
bar()
cup()
gel()
tube()
ring()
