#!/usr/bin/env python3
"""Ways to stabilise the one-point hexahedron, side by side on coarse meshes: linear, small strain.

Prints the table of docs/validation.md, "The hourglass constant". Needs numpy and some minutes.

All ways share the mean strain part. In hourglass mode m the displacement is q h_m / 8, h_m being xi eta,
eta zeta, zeta xi or xi eta zeta, and M_m the integral of grad h_m (x) grad h_m:

    isotropic   k G 2 I2(M_m)/I1(M_m) |q|^2 / 64: what Lariat has (src/mechanics/hex8.h), with other k
    direction   a mode of two axes bends in these (E M_xx q_x^2) and twists along the third
                (G (M_xx + M_yy) q_z^2), each with a factor; parasitic shear is left out
    assumed     normal strains linear in one axis, with plane stress in the third, and the shears of
                twists, all coupled as in a box (after Belytschko and Bindeman 1993, and Puso 2000)
"""
import numpy as np

SIGN = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1],
                 [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], float)
MODE = [SIGN[:, 0] * SIGN[:, 1], SIGN[:, 1] * SIGN[:, 2], SIGN[:, 2] * SIGN[:, 0],
        SIGN[:, 0] * SIGN[:, 1] * SIGN[:, 2]]
AXES = [(0, 1, 2), (1, 2, 0), (2, 0, 1)]  # of a mode: two that it bends in, one that it twists along
POINT = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / np.sqrt(3)


def shape_gradients(p):
    """[8][3] by the reference coordinates."""
    one = 1 + SIGN * p
    return SIGN * np.stack([one[:, 1] * one[:, 2], one[:, 0] * one[:, 2], one[:, 0] * one[:, 1]], 1) / 8


def mode_gradients(p):
    """[4][3] of xi eta, eta zeta, zeta xi, xi eta zeta."""
    x, y, z = p
    return np.array([[y, x, 0], [0, z, y], [z, 0, x], [y * z, x * z, x * y]])


def strain_matrix(gradient):
    matrix = np.zeros((6, 24))
    for a, (x, y, z) in enumerate(gradient):
        matrix[:, 3 * a:3 * a + 3] = [[x, 0, 0], [0, y, 0], [0, 0, z], [y, x, 0], [0, z, y], [z, 0, x]]
    return matrix


class Element:
    """Stiffness of one element, with the ways to stabilise it as methods."""

    def __init__(self, corner, young, poisson):
        self.young, self.poisson = young, poisson
        self.shear = young / (2 * (1 + poisson))
        bulk = young * poisson / ((1 + poisson) * (1 - 2 * poisson))
        law = np.diag([2 * self.shear] * 3 + [self.shear] * 3)
        law[:3, :3] += bulk
        mean = np.zeros((8, 3))
        self.point = []  # weight, gradients of the modes
        for p in POINT:
            jacobian = corner.T @ shape_gradients(p)
            weight, inverse = np.linalg.det(jacobian), np.linalg.inv(jacobian)
            mean += weight * shape_gradients(p) @ inverse
            self.point.append((weight, mode_gradients(p) @ inverse))
        self.volume = sum(weight for weight, _ in self.point)
        mean /= self.volume
        strain = strain_matrix(mean)
        self.stiffness = self.volume * strain.T @ law @ strain
        self.gamma = [h - mean @ (corner.T @ h) for h in MODE]
        left, _, right = np.linalg.svd(corner.T @ shape_gradients(np.zeros(3)))
        self.frame = left @ right

    def add(self, m, n, block):
        self.stiffness += np.kron(np.outer(self.gamma[m], self.gamma[n]), block) / 64

    def integral(self, m, i, n, j):
        """Of d h_m/d i times d h_n/d j, along axes of the element's frame."""
        e, f = self.frame[:, i], self.frame[:, j]
        return sum(weight * (e @ g[m]) * (f @ g[n]) for weight, g in self.point)

    def isotropic(self, k, modes=range(4)):
        for m in modes:
            square = sum(weight * np.outer(g[m], g[m]) for weight, g in self.point)
            first = np.trace(square)
            second = 0.5 * (first ** 2 - np.trace(square @ square))
            self.add(m, m, k * self.shear * 2 * second / first * np.eye(3))

    def direction(self, bending, twist):
        for m, (a, b, n) in enumerate(AXES):
            x, y = self.integral(m, a, m, a), self.integral(m, b, m, b)
            block = np.zeros((3, 3))
            block[a, a], block[b, b] = bending * self.young * x, bending * self.young * y
            block[n, n] = twist * self.shear * (x + y)
            self.add(m, m, self.frame @ block @ self.frame.T)
        self.isotropic(0.2, [3])

    def assumed(self, bending, twist):
        plane = bending * self.young / (1 - self.poisson ** 2)
        # Linear in eta: xi eta along x and eta zeta along z; in xi and zeta likewise.
        for pair in (((0, 0), (1, 2)), ((0, 1), (2, 2)), ((2, 0), (1, 1))):
            for m, i in pair:
                for n, j in pair:
                    factor = plane if (m, i) == (n, j) else self.poisson * plane
                    block = np.outer(self.frame[:, i], self.frame[:, j])
                    self.add(m, n, factor * self.integral(m, i, n, j) * block)
        for pair in (((0, 2, 0), (1, 0, 2)), ((0, 2, 1), (2, 1, 2)), ((2, 1, 0), (1, 0, 1))):
            for m, i, d in pair:
                for n, j, e in pair:
                    block = np.outer(self.frame[:, i], self.frame[:, j])
                    self.add(m, n, twist * self.shear * self.integral(m, d, n, e) * block)
        self.isotropic(0.2, [3])


def grid(cells, place):
    x, y, z = cells
    node = lambda i, j, k: (k * (y + 1) + j) * (x + 1) + i
    nodes = np.array([place(i / x, j / y, k / z)
                      for k in range(z + 1) for j in range(y + 1) for i in range(x + 1)])
    corner = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    return nodes, [[node(i + a, j + b, k + c) for a, b, c in corner]
                   for k in range(z) for j in range(y) for i in range(x)]


def assemble(nodes, elements, young, poisson, way):
    stiffness = np.zeros((3 * len(nodes),) * 2)
    volume, known = np.zeros(len(nodes)), {}
    for e in elements:
        corner = nodes[e] - nodes[e[0]]
        key = np.round(corner, 12).tobytes()
        if key not in known:
            known[key] = Element(corner, young, poisson)
            way(known[key])
        unknown = (3 * np.array(e)[:, None] + range(3)).ravel()
        stiffness[np.ix_(unknown, unknown)] += known[key].stiffness
        volume[e] += known[key].volume / 8
    return stiffness, volume


def solve(stiffness, force, fixed):
    """`fixed`: value by unknown."""
    held, u = np.array(sorted(fixed)), np.zeros(len(force))
    u[held] = [fixed[i] for i in held]
    free = np.setdiff1d(np.arange(len(force)), held)
    load = force[free] - stiffness[np.ix_(free, held)] @ u[held]
    u[free] = np.linalg.solve(stiffness[np.ix_(free, free)], load)
    return u


def at(nodes, place):
    return int(np.argmin(np.abs(nodes - place).sum(1)))


def beam(across, poisson, way):
    """Deflection of the cantilever of docs/validation.md under a thousandth of its weight [m]."""
    nodes, elements = grid((10 * across, across, across), lambda x, y, z: (0.1 * x, 0.01 * y, 0.01 * z))
    stiffness, volume = assemble(nodes, elements, 3000, poisson, way)
    force = np.zeros(3 * len(nodes))
    force[2::3] = -volume * 9.81
    fixed = {3 * i + j: 0 for i in range(len(nodes)) if nodes[i, 0] < 1e-9 for j in range(3)}
    return solve(stiffness, force, fixed)[3 * at(nodes, (0.1, 0.005, 0.005)) + 2]


def cook(cells, way):
    """The corner of Cook's membrane under plane strain, nu = 0.4999, E = 1, force 1."""
    nodes, elements = grid((cells, cells, 1), lambda x, y, z: (48 * x, 44 * x + y * (44 - 28 * x), z))
    stiffness, _ = assemble(nodes, elements, 1.0, 0.4999, way)
    force = np.zeros(3 * len(nodes))
    for i in np.flatnonzero(nodes[:, 0] > 48 - 1e-9):
        force[3 * i + 1] = 0.5 if min(abs(nodes[i, 1] - 44), abs(nodes[i, 1] - 60)) < 1e-9 else 1
    fixed = {3 * i + 2: 0 for i in range(len(nodes))}
    fixed.update({3 * i + j: 0 for i in range(len(nodes)) if nodes[i, 0] < 1e-9 for j in range(2)})
    return solve(stiffness, force / force.sum(), fixed)[3 * at(nodes, (48, 60, 0)) + 1]


def torsion(across, way):
    """Stiffness of a square bar whose ends are turned and may warp, beside the exact one."""
    nodes, elements = grid((across, across, 2 * across), lambda x, y, z: (x - 0.5, y - 0.5, 2 * z))
    stiffness, _ = assemble(nodes, elements, 1.0, 0.45, way)
    fixed = {3 * at(nodes, (0, 0, 0)) + 2: 0}
    for i, (x, y, z) in enumerate(nodes):
        if min(z, 2 - z) < 1e-9:
            fixed.update({3 * i: -z * y, 3 * i + 1: z * x})
    u = solve(stiffness, np.zeros(3 * len(nodes)), fixed)
    return 0.5 * u @ stiffness @ u * 2 / 2 / (0.1405770 / 2.9)


def main():
    ways = [("isotropic, k = %g" % k, lambda e, k=k: e.isotropic(k)) for k in (1, 1.58, 2, 2.25)]
    ways += [("direction, bending %g, twist %g" % (b, t), lambda e, b=b, t=t: e.direction(b, t))
             for b, t in ((1, 1), (0.8, 0.2), (0.5, 0.2), (0.25, 0.2))]
    ways += [("assumed strain, bending %g, twist %g" % (b, t), lambda e, b=b, t=t: e.assumed(b, t))
             for b, t in ((1, 1), (1, 0.3))]
    today = ways[1][1]
    # The converged answers: those of the mesh that is measured against them in docs/validation.md,
    # and of Cook's membrane, linear here, by the series through 16 and 32 elements.
    straight = {0.45: beam(2, 0.45, today) / 1.0823, 0.49: beam(2, 0.49, today) / 1.0767}
    coarse, fine = cook(16, today), cook(32, today)
    corner = fine + (fine - coarse) / 3
    print("| way | beam 20x2x2, nu 0.45 | nu 0.49 | 40x4x4, nu 0.45 | torsion 4x4 | 8x8 | Cook 8x8 |")
    print("|---|---|---|---|---|---|---|")
    for name, way in ways:
        errors = [beam(2, 0.45, way) / straight[0.45], beam(2, 0.49, way) / straight[0.49],
                  beam(4, 0.45, way) / straight[0.45], torsion(4, way), torsion(8, way),
                  cook(8, way) / corner]
        print("| %s | %s |" % (name, " | ".join("%+.1f%%" % (100 * (e - 1)) for e in errors)), flush=True)


if __name__ == "__main__":
    main()
