"""The tasks: a small model each, its goal and its reward."""

import numpy as np

import lariat

from ._core import Env, Task
from ._meshes import Mesh


def distance(a, b):
    """Between points, along the last axis."""
    way = a - b
    return np.sqrt(np.add.reduce(way * way, axis=-1))


def middle_of(points):
    """Means [n, 3] of points [n, k, 3]."""
    return np.add.reduce(points, axis=1) / points.shape[1]


def between(values):
    """Not less than 0 and not more than 1."""
    return np.minimum(np.maximum(values, 0), 1)


def tissue(shear, name="tissue", cells="all"):
    """A soft material, nearly incompressible, as scenes have it."""
    return {"name": name, "cells": cells, "law": "neo-hookean", "density": 1050.0,
            "shear_modulus": shear, "bulk_modulus": 10 * shear}


FLOOR = {"faces": "all", "plane": {"through": [0, 0, -0.0005], "normal": [0, 0, 1]}}


def grasper(at, **more):
    """A small grasper that comes from +x."""
    return {"name": "grasper", "shape": "grasper", "radius": 0.0015, "length": 0.012, "spread": 60,
            "at": list(at), "towards": [-1, 0, 0], **more}


class PalpateTask(Task):
    """A pad and a ball."""

    jaws, speed, horizon = False, 0.1, 200
    low, high = (0.0, 0.0, 0.015), (0.048, 0.048, 0.05)
    band = (0.15, 0.35)

    def __init__(self):
        self.mesh = Mesh()
        self.mesh.box("pad", (0, 0, 0), (8, 8, 3), (0.006, 0.006, 0.006))
        self.mesh.choose("floor", lambda x, y, z: z < 1e-6)
        top = self.mesh.choose("top", lambda x, y, z: z > 0.0179)
        self.watched = top[::10]

    def model(self):
        mesh = self.mesh
        scene = {"lariat": 1, "title": "Reach and palpate", "gravity": [0, 0, -9.81], "damping": 20.0,
                 "materials": [tissue(3000.0)], "fix": [{"nodes": "floor", "axes": "xyz"}],
                 "tools": [{"name": "probe", "shape": "sphere", "radius": 0.006,
                            "at": [0.024, 0.024, 0.04]}]}
        return lariat.Model.from_arrays(mesh.nodes, mesh.hexahedra, scene, sets=mesh.sets)

    def goal(self, random):
        return np.array([*random.uniform(0.012, 0.036, 2), 0.018])

    def judge(self, seen):
        low, high = self.band
        force = distance(seen.wrench[:, :3], 0)
        aside = distance(seen.tip[:, :2], seen.goal[:, :2])
        reached = (aside < 0.004) & (force >= low) & (force <= high)
        reward = (-distance(seen.tip, seen.goal) / 0.05 + reached
                  - np.maximum(force - high, 0) / high)
        return reward, reached


class FlapTask(Task):
    """What tasks with a flap share: it is fixed at x = 0 and lies on a plane; its free edge is at
    x = 0.05."""

    length, width = 0.05, 0.02
    shear, tool = 8000.0, (0.075, 0.01, 0.002)
    low, high = (-0.005, -0.01, 0.0015), (0.085, 0.03, 0.06)

    def __init__(self):
        self.mesh = Mesh()
        self.mesh.box("flap", (0, 0, 0), (10, 4, 1), (0.005, 0.005, 0.004))
        self.mesh.choose("root", lambda x, y, z: x < 1e-6)
        self.edge = self.mesh.choose("edge", lambda x, y, z: x > 0.0499)
        self.watched = self.edge

    def scene(self):
        """The scene without what tasks add."""
        return {"lariat": 1, "gravity": [0, 0, -9.81], "damping": 10.0,
                "materials": [tissue(self.shear)], "fix": [{"nodes": "root", "axes": "xyz"}],
                "contact": [FLOOR], "tools": [grasper(self.tool)]}

    def model(self):
        mesh = self.mesh
        return lariat.Model.from_arrays(mesh.nodes, mesh.hexahedra, self.scene(), sets=mesh.sets,
                                        tags=mesh.tags)

    def towards_edge(self, seen):
        """-1 to 0: how far the tip is from the middle of the free edge."""
        middle = middle_of(seen.points[:, : len(self.edge)])
        return -np.minimum(distance(seen.tip, middle) / 0.05, 1)


class LiftTask(FlapTask):
    """A flap and a grasper."""

    def goal(self, random):
        return np.array([0.05, 0.01, random.uniform(0.015, 0.025)])

    def judge(self, seen):
        height = middle_of(seen.points)[:, 2]
        holds = seen.held > 0
        lifted = between(height / seen.goal[:, 2])
        return np.where(holds, lifted, self.towards_edge(seen)), holds & (height >= seen.goal[:, 2])


class RetractTask(FlapTask):
    """A flap over a target."""

    shear, horizon, clear = 4000.0, 400, 0.006

    def __init__(self):
        super().__init__()
        top = self.mesh.choose("top", lambda x, y, z: z > 0.0039)
        self.watched = self.edge + top

    def goal(self, random):
        return np.array([random.uniform(0.028, 0.04), random.uniform(0.006, 0.014), 0.0])

    def judge(self, seen):
        flap = seen.points[:, len(self.edge):, :2]
        free = distance(flap, seen.goal[:, None, :2]).min(axis=1)
        exposed = between(free / self.clear)
        return np.where(seen.held > 0, exposed, self.towards_edge(seen)), free >= self.clear


class ThroughRingTask(FlapTask):
    """A strip and a ring before its free end; the grasper reaches through the ring."""

    shear, tool, horizon = 5000.0, (0.09, 0.005, 0.012), 400
    ring_at, inner = (0.057, 0.005, 0.009), 0.011
    low, high = (0.035, -0.005, 0.0015), (0.1, 0.015, 0.03)

    def __init__(self):
        self.mesh = Mesh()
        self.mesh.box("strip", (0, 0, 0), (10, 2, 1), (0.005, 0.005, 0.004))
        self.mesh.choose("root", lambda x, y, z: x < 1e-6)
        self.edge = self.mesh.choose("edge", lambda x, y, z: 0.0499 < x < 0.0501)
        self.mesh.ring("ring", self.ring_at, self.inner, self.inner + 0.003, 0.004)
        self.watched = self.edge

    def scene(self):
        strip, ring = tissue(self.shear, "strip", {"tag": 1}), tissue(self.shear, "ring", {"tag": 4})
        return {**super().scene(), "materials": [strip, ring],
                "fix": [{"nodes": "root", "axes": "yz"}, {"nodes": "ring", "axes": "xyz"}],
                "contact": [{**FLOOR, "faces": "strip", "friction": 0.3},
                            {"between": ["strip", "ring"]}]}

    def goal(self, random):
        return np.array([self.ring_at[0] + random.uniform(0.003, 0.006), *self.ring_at[1:]])

    def judge(self, seen):
        end = middle_of(seen.points)
        beyond = end[:, 0] - seen.goal[:, 0]
        inside = distance(end[:, 1:], seen.goal[:, 1:]) < self.inner
        holds = seen.held > 0
        drawn = between(1 + beyond / 0.015)
        return (np.where(holds, drawn, self.towards_edge(seen)), holds & inside & (beyond >= 0))


class ThreadRingTask(Task):
    """A free thread on a plane and a narrow ring; the grasper takes the thread behind its end."""

    horizon, inner = 400, 0.006
    ring_at = (0.065, 0.012, 0.012)
    low, high = (0.005, -0.02, 0.0015), (0.07, 0.035, 0.04)

    def __init__(self):
        self.mesh = Mesh()
        self.mesh.box("thread", (0, 0, 0), (16, 1, 1), (0.003, 0.003, 0.003))
        self.tip = self.mesh.choose("tip", lambda x, y, z: 0.0479 < x < 0.0481)
        self.grip = self.mesh.choose("grip", lambda x, y, z: 0.0359 < x < 0.0361)
        self.mesh.ring("ring", self.ring_at, self.inner, self.inner + 0.003, 0.003)
        self.watched = self.tip + self.grip

    def model(self):
        mesh = self.mesh
        scene = {"lariat": 1, "title": "Thread a ring", "gravity": [0, 0, -9.81], "damping": 10.0,
                 "materials": [tissue(20000.0, "thread", {"tag": 1}),
                               tissue(20000.0, "ring", {"tag": 4})],
                 "fix": [{"nodes": "ring", "axes": "xyz"}],
                 "contact": [{**FLOOR, "faces": "thread", "friction": 0.4},
                             {"between": ["thread", "ring"]}],
                 "tools": [{"name": "grasper", "shape": "grasper", "radius": 0.0015, "length": 0.01,
                            "spread": 60, "at": [0.036, 0.0015, 0.03], "towards": [0, 0, -1],
                            "turn": 90}]}
        return lariat.Model.from_arrays(mesh.nodes, mesh.hexahedra, scene, sets=mesh.sets,
                                        tags=mesh.tags)

    def goal(self, random):
        return np.array([self.ring_at[0] + random.uniform(0.003, 0.006), *self.ring_at[1:]])

    def judge(self, seen):
        count = len(self.tip)
        end, grip = middle_of(seen.points[:, :count]), middle_of(seen.points[:, count:])
        beyond = end[:, 0] - seen.goal[:, 0]
        aside = distance(end[:, 1:], seen.goal[:, 1:])
        reached = (beyond >= 0) & (aside < self.inner)
        near = -np.minimum(distance(seen.tip, grip) / 0.05, 1)
        threaded = between(1 - distance(end, seen.goal) / 0.03)
        return np.where(seen.held > 0, threaded, near), reached


class Palpate(Env):
    """Reach and palpate: a ball of 6 mm radius presses on a pad of 48 x 48 x 18 mm, at the goal on its
    surface, with a force from 0.15 to 0.35 N, for 10 steps.

    Reward of a step: -(distance of the tip from the goal) / 0.05 m, +1 within 4 mm of the goal (seen
    from above) with a force in the band, -(force - 0.35 N) / 0.35 N above it. Actions have three
    numbers. Watched: nine nodes of the surface."""

    task_class = PalpateTask


class Lift(Env):
    """Lift: a grasper takes the free edge of a flap of 50 x 20 x 4 mm and lifts it to the goal's
    height, 15 to 25 mm, for 10 steps.

    Reward of a step: while nothing is held, -(distance of the tip from the middle of the free edge) /
    0.05 m, at least -1; while it is, height of the edge / height of the goal, 0 to 1. Watched: the
    ten nodes of the free edge."""

    task_class = LiftTask


class Retract(Env):
    """Retract to expose a target: a flap of 50 x 20 x 4 mm lies over the goal on the ground; no node
    of its upper side is to be within 6 mm of it, seen from above, for 10 steps.

    Reward of a step: while nothing is held, as Lift; while it is, (distance from the goal of the
    closest node, from above) / 6 mm, 0 to 1. Watched: the free edge (10 nodes), then the upper side
    (55)."""

    task_class = RetractTask


class ThroughRing(Env):
    """Grasp and move tissue through a ring: a grasper reaches through a ring of 11 mm inner radius,
    takes the end of a strip of 50 x 10 x 4 mm, which slides along x on the ground, and draws it through, until the end is 3 to 6 mm
    beyond the ring's plane and within the ring, for 10 steps. Strip and ring are in contact.

    Reward of a step: while nothing is held, as Lift; while it is, 1 - (way of the end to the goal's x)
    / 15 mm, 0 to 1. Watched: the six nodes of the free end."""

    task_class = ThroughRingTask


class ThreadRing(Env):
    """Thread a ring: a grasper takes a free thread of 48 x 3 x 3 mm behind its end and brings the end
    through a ring of 6 mm inner radius, until it is 3 to 6 mm beyond the ring's plane, for 10 steps.
    Thread and ring are in contact.

    Reward of a step: while nothing is held, -(distance of the tip from where the thread is to be
    taken) / 0.05 m, at least -1; while it is, 1 - (distance of the end from the goal) / 30 mm, 0 to
    1. Watched: four nodes of the end, then four 12 mm behind it."""

    task_class = ThreadRingTask
