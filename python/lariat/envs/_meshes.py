"""Small bodies of hexahedra for environments: boxes and rings, put together into one mesh."""

import math


class Mesh:
    """Nodes, hexahedra, sets; each part adds to them and names its nodes and elements."""

    def __init__(self):
        self.nodes, self.hexahedra, self.tags, self.sets = [], [], [], {}

    def _add(self, name, nodes, hexahedra):
        first = len(self.nodes)
        self.nodes += nodes
        self.hexahedra += [[first + n for n in element] for element in hexahedra]
        self.tags += [len(self.sets) + 1] * len(hexahedra)
        self.sets[name] = list(range(first, len(self.nodes)))
        return first

    def box(self, name, origin, cells, edges):
        """`cells` cells of `edges` metres along x, y and z from `origin`."""
        nx, ny, nz = cells
        nodes = [[o + e * c for o, e, c in zip(origin, edges, (i, j, k))]
                 for k in range(nz + 1) for j in range(ny + 1) for i in range(nx + 1)]

        def at(i, j, k):
            return (k * (ny + 1) + j) * (nx + 1) + i

        around = ((0, 0), (1, 0), (1, 1), (0, 1))
        self._add(name, nodes, [[at(i + a, j + b, k + c) for c in (0, 1) for a, b in around]
                                for k in range(nz) for j in range(ny) for i in range(nx)])

    def ring(self, name, centre, inner, outer, width, segments=12):
        """A ring around the x axis through `centre`, `width` metres long."""
        nodes = []
        for s in range(segments):
            angle = 2 * math.pi * s / segments
            for radius in (inner, outer):
                for x in (-0.5 * width, 0.5 * width):
                    nodes.append([centre[0] + x, centre[1] + radius * math.cos(angle),
                                  centre[2] + radius * math.sin(angle)])

        def at(s, r, x):
            return 4 * (s % segments) + 2 * r + x

        self._add(name, nodes, [[at(s, 0, 0), at(s, 0, 1), at(s, 1, 1), at(s, 1, 0),
                                 at(s + 1, 0, 0), at(s + 1, 0, 1), at(s + 1, 1, 1), at(s + 1, 1, 0)]
                                for s in range(segments)])

    def choose(self, name, where):
        """A set of the nodes whose place fulfils `where(x, y, z)`."""
        self.sets[name] = [n for n, place in enumerate(self.nodes) if where(*place)]
        return self.sets[name]
