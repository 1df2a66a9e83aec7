"""A policy by hand for each task: stages one after the other, each a place to go to.

    policy = lariat.envs.scripted.policy(env)        # Env or VectorEnv of a task of lariat.envs
    observation, info = env.reset(seed=1)
    policy.reset()
    action = policy(observation)

They see nothing but observations."""

import numpy as np

from . import _tasks
from ._core import Seen


class Stage:
    """Goes to `where(seen)` with the jaws at `opening`, until `until(seen, waited)`, at a share of
    the full speed."""

    def __init__(self, where, opening=1.0, until=None, speed=1.0):
        self.where, self.opening, self.speed = where, opening, speed
        self.until = until or (lambda seen, waited: near(seen, where(seen)))


def near(seen, place, within=0.0015):
    """Whether the tip is there."""
    return float(np.abs(seen.tip[0] - place).max()) < within


class Policy:
    """Actions for one run, or for the runs of a VectorEnv, from observations."""

    def __init__(self, task, count=None):
        self.task, self.count = task, count
        known = [kind for kind in type(task).__mro__ if kind in STAGES]
        if not known:
            raise ValueError(f"there is no scripted policy for {type(task).__name__}")
        self.stages = STAGES[known[0]](task)
        self.reset()

    def reset(self, which=None):
        """Begins with the first stage again, for all runs or the `which`-th."""
        if which is None:
            self._at = [0] * (self.count or 1)
            self._waited = [0] * (self.count or 1)
        else:
            self._at[which] = self._waited[which] = 0

    def _act(self, i, observation):
        seen = Seen(np.asarray(observation, float)[None])
        if self._at[i] + 1 < len(self.stages) and self.stages[self._at[i]].until(
                seen, self._waited[i]):
            self._at[i] += 1
            self._waited[i] = 0
        self._waited[i] += 1
        stage = self.stages[self._at[i]]
        way = (np.asarray(stage.where(seen)) - seen.tip[0]) / (self.task.speed * self.task.control)
        longest = max(float(np.abs(way).max()), 1e-9)
        action = way * min(1.0, stage.speed / longest)
        if self.task.jaws:
            action = np.append(action, 2 * stage.opening - 1)
        return action.astype(np.float32)

    def __call__(self, observations):
        """float32 [4] or [3], or [n, ...] for a VectorEnv. A run that has begun anew by itself: call
        reset(i)."""
        if self.count is None:
            return self._act(0, observations)
        return np.stack([self._act(i, row) for i, row in enumerate(observations)])


def waited(steps):
    """Until so many steps have passed."""
    return lambda seen, count: count >= steps


def palpate(task):
    """Above the goal, down until the force is in the band, then hold it there."""
    middle = sum(task.band) / 2

    def above(seen):
        return seen.goal[0] + (0, 0, 0.012)

    def press(seen):
        """A place below the tip, the farther the less it feels."""
        force = float(np.sqrt((seen.wrench[0, :3] ** 2).sum()))
        step = np.clip(0.002 * (middle - force), -0.0005, 0.0005)
        return np.array([*seen.goal[0, :2], seen.tip[0, 2] + (-0.0008 if force == 0 else -step)])

    return [Stage(above), Stage(press)]


def grasp_edge(task, beyond=0.008):
    """Around the free edge and closed: the stages before something is done with it. The jaws end
    `beyond` behind their tip."""

    def middle(seen):
        return seen.points[0, : len(task.edge)].mean(axis=0)

    def before(seen):
        return middle(seen) + (0.02, 0, 0.0005)

    def around(seen):
        return middle(seen) + (beyond, 0, 0.0005)

    return [Stage(before), Stage(around, until=lambda seen, count: count > 25 or near(
        seen, around(seen), 0.0008)), Stage(lambda seen: seen.tip[0], 0.0, waited(10))]


def lift(task):
    """Takes hold and goes up."""
    return grasp_edge(task) + [
        Stage(lambda seen: np.array([0.05, seen.tip[0, 1], seen.goal[0, 2] + 0.008]), 0.0, speed=0.6,
              until=lambda seen, count: False)]


def retract(task):
    """Takes hold, goes up and then back over the fixed end."""
    return grasp_edge(task) + [
        Stage(lambda seen: np.array([0.045, 0.01, 0.03]), 0.0, speed=0.6),
        Stage(lambda seen: np.array([0.015, 0.01, 0.035]), 0.0, speed=0.6,
              until=lambda seen, count: False)]


def through_ring(task):
    """Through the ring, takes hold, and back the same way."""
    axis = task.ring_at

    def before(seen):
        return np.array([axis[0] + 0.02, axis[1], axis[2] - 0.003])

    return [Stage(before)] + grasp_edge(task)[1:] + [
        Stage(lambda seen: np.array([seen.goal[0, 0] + 0.02, axis[1], axis[2] - 0.002]), 0.0,
              speed=0.5, until=lambda seen, count: False)]


def thread_ring(task):
    """Down on the thread, takes hold, up before the ring, and the end through it."""
    tips = len(task.tip)

    def grip(seen):
        return seen.points[0, tips:].mean(axis=0)

    def shift(seen, place):
        """The place of the grasper for which the end is at `place`."""
        return seen.tip[0] + place - seen.points[0, :tips].mean(axis=0)

    def raised(seen):
        return shift(seen, np.array([task.ring_at[0] - 0.01, *task.ring_at[1:]]))

    return [Stage(lambda seen: grip(seen) + (0, 0, 0.02)),
            Stage(lambda seen: grip(seen) + (0, 0, 0.006),
                  until=lambda seen, count: count > 25 or near(seen, grip(seen) + (0, 0, 0.006), 0.0008)),
            Stage(lambda seen: seen.tip[0], 0.0, waited(10)),
            Stage(lambda seen: seen.tip[0] + (0, 0, 0.004), 0.0, waited(8), 0.6),
            Stage(raised, 0.0, speed=0.5),
            Stage(lambda seen: shift(seen, seen.goal[0] + (0.002, 0, 0)), 0.0, speed=0.5,
                  until=lambda seen, count: False)]


STAGES = {_tasks.PalpateTask: palpate, _tasks.LiftTask: lift, _tasks.RetractTask: retract,
          _tasks.ThroughRingTask: through_ring, _tasks.ThreadRingTask: thread_ring}


def policy(env):
    """The Policy of an Env or VectorEnv of lariat.envs."""
    return Policy(env.task, getattr(env, "num_envs", None))
