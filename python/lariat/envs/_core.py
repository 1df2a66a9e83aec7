"""What all environments share: one Batch, its tools moved by actions, its states as observations."""

import numpy as np

import lariat

from ._spaces import NEXT_STEP, Base, Box, VectorBase, batched


class Task:
    """What is to be done: a model with one tool, goals, rewards. Everything that belongs to a run
    (goals, actions, observations) is an array with a row for each run, so that one environment and
    many are the same code.

    Attributes that a task sets:
        control  seconds of a control step
        horizon  control steps until a run is truncated
        speed    of the tool's tip when an action is 1 [m/s]
        jaws     True: the action has a fourth number, which opens and closes the tool
        low, high  corners of the box that the tip is kept in [m]
        watched  nodes whose places are observed
        settle   seconds before the start of a run, in which bodies come to rest
        patience control steps for which the goal has to be kept
    """

    control, horizon, speed, jaws, settle, patience = 0.02, 300, 0.1, True, 0.4, 10
    low, high, watched = (0.0, 0.0, 0.0), (0.1, 0.1, 0.1), ()

    def model(self):
        """The Model; its first tool is the one that actions move."""
        raise NotImplementedError

    def goal(self, random):
        """A goal for one run, three numbers [m], from a numpy Generator."""
        raise NotImplementedError

    def judge(self, seen):
        """Rewards and whether the goal is reached now, arrays [n], of what is seen (see Seen)."""
        raise NotImplementedError


class Seen:
    """What environments see, views into the observations, a row for each run: tip [n, 3] (m),
    opening [n], wrench [n, 6] (N, N m), held [n] (surface points), goal [n, 3] (m), points
    [n, watched, 3] (m)."""

    SIZE = 14

    def __init__(self, observations):
        self.observations = observations
        self.tip = observations[:, 0:3]
        self.opening = observations[:, 3]
        self.wrench = observations[:, 4:10]
        self.held = observations[:, 10]
        self.goal = observations[:, 11:14]
        self.points = observations[:, 14:].reshape(len(observations), -1, 3)


class Core:
    """`n` runs of a task."""

    def __init__(self, task, n, workers, model=None):
        self.task = task
        self.model = model if model is not None else task.model()
        self.batch = lariat.Batch(self.model, n, workers=workers)
        self._prepare()
        self.random = [np.random.default_rng() for _ in range(n)]
        self.steps = np.zeros(n, np.int64)
        self.kept = np.zeros(n, np.int64)
        self.done = np.ones(n, bool)  # needs a reset
        self.goals = np.zeros((n, 3))
        self.asked = np.zeros((n, 1, 7))
        self.opening = np.zeros((n, 1))
        self.observations = np.zeros((n, Seen.SIZE + 3 * len(task.watched)))

    def _prepare(self):
        """The state that runs begin with, and what is constant."""
        task = self.task
        first = lariat.Simulation(self.model)
        first.advance(seconds=task.settle)
        self.start = first.save()
        pose = first.tool_pose(0)
        self.home = np.array([*pose["position"], *pose["orientation"]])
        self.home_opening = pose["opening"]
        self.control_steps = max(1, round(task.control / first.time_step))
        n, watched = len(self.batch), np.asarray(task.watched, np.int32)
        if len(watched) and not 0 <= watched.min() <= watched.max() < self.model.node_count:
            raise lariat.ArgumentError(f"model: it has {self.model.node_count} nodes, and the task "
                                       f"watches node {watched.max()}")
        self.watched = watched
        self.low, self.high = np.asarray(task.low, float), np.asarray(task.high, float)
        self._seen = np.empty((n, 11 + 3 * len(watched)))

    def __getstate__(self):
        state = {key: value for key, value in self.__dict__.items() if not key.startswith("_")}
        del state["start"]
        return state

    def __setstate__(self, state):
        self.__dict__.update(state)
        self.model = self.batch[0].model
        self._prepare()

    def observe(self, unsound=()):
        """Fills the observations; what has become unstable keeps its last one."""
        seen = self.observations
        kept = {i: seen[i].copy() for i in unsound}
        self.batch.observe(self.watched, self._seen)
        seen[:, :11] = self._seen[:, :11]
        seen[:, 11:14] = self.goals
        seen[:, 14:] = self._seen[:, 11:]
        for i, row in kept.items():
            seen[i] = row

    def reset(self, which, seeds=None, options=None):
        """Begins runs anew: array of their numbers, and a seed or None for each."""
        if options is not None and not isinstance(options, dict):
            raise TypeError(f"options: expected a dict, as {{\"stiffness\": 2}}, got {type(options)!r}")
        options = dict(options or {})
        stiffness = options.pop("stiffness", None)
        goal = options.pop("goal", None)
        if options:
            raise lariat.ArgumentError(f"options: {sorted(options)} are unknown; there are "
                                       "stiffness and goal")
        if goal is not None:
            try:
                goal = np.asarray(goal, float)
            except (TypeError, ValueError) as error:
                raise lariat.ArgumentError(f"goal: expected 3 finite numbers: {error}") from None
            if goal.shape != (3,) or not np.isfinite(goal).all():
                raise lariat.ArgumentError(f"goal: expected 3 finite numbers, got {goal}")
            size = self.high - self.low
            if (goal < self.low - size).any() or (goal > self.high + size).any():
                raise lariat.ArgumentError(f"goal: {goal} m is far from where the tip can go, "
                                           f"{self.low} to {self.high} m")
        if stiffness is not None:  # refused before any run has begun anew
            check_stiffness(stiffness)
        self.batch.reset(which, self.start)
        for k, i in enumerate(which):
            if seeds is not None and seeds[k] is not None:
                self.random[i] = np.random.default_rng(seeds[k])
            self.goals[i] = self.task.goal(self.random[i]) if goal is None else goal
            if stiffness is not None:
                self.batch[int(i)].set_stiffness(stiffness)
        self.steps[which] = self.kept[which] = 0
        self.done[which] = False
        self.asked[which, 0] = self.home
        self.opening[which] = self.home_opening

    def act(self, actions, which):
        """One control step of some runs. Returns {run: why} of those that became unstable."""
        task, some = self.task, self.rows(which)
        place = self.asked[some, 0, :3] + actions[:, :3] * (task.speed * task.control)
        self.asked[some, 0, :3] = np.minimum(np.maximum(place, self.low), self.high)
        if task.jaws:
            change = 0.5 * (actions[:, 3:4] + 1) - self.opening[some]
            self.opening[some] += np.minimum(np.maximum(change, -0.2), 0.2)
        members = None if isinstance(some, slice) else which
        unstable = {}
        try:
            self.batch.set_tool_poses(self.asked[some], self.control_steps,
                                      openings=self.opening[some], tools=(0,), members=members)
            self.batch.advance(self.control_steps, members=members)
        except lariat.UnstableError as error:
            unstable = error.members
        self.steps[some] += 1
        return unstable

    def rows(self, which):
        """What selects the rows of these runs: all of them without a copy."""
        return slice(None) if len(which) == len(self.steps) else which

    def check_actions(self, actions, shape):
        """Actions as float64, within -1 and 1."""
        try:
            actions = np.asarray(actions, np.float64)
        except (TypeError, ValueError) as error:
            raise lariat.ArgumentError(f"action: expected numbers of shape {shape}: {error}") from None
        if actions.shape != shape:
            raise lariat.ArgumentError(f"action: expected shape {shape}, got {actions.shape}")
        for at in np.argwhere(~np.isfinite(actions))[:1].tolist():
            raise lariat.ArgumentError(f"action{at}: expected a finite number, got {actions[tuple(at)]}")
        return np.minimum(np.maximum(actions, -1), 1)

    def step(self, actions, which):
        """Rewards, terminations, truncations and unstable runs, of `which`."""
        task, some = self.task, self.rows(which)
        unstable = self.act(actions, which)
        self.observe(unstable)
        rewards, reached = task.judge(Seen(self.observations[some]))
        self.kept[some] = (self.kept[some] + 1) * reached
        success = terminated = self.kept[some] >= task.patience
        rewards = rewards + 10.0 * success
        if unstable:
            broken = np.array([int(i) in unstable for i in which], bool)
            success = success & ~broken
            terminated = success | broken
            rewards = np.where(broken, -10.0, rewards)
        truncated = ~terminated & (self.steps[some] >= task.horizon)
        self.done[some] = terminated | truncated
        return rewards, terminated, truncated, success, unstable


def spaces_of(task):
    """Observation and action space of one run."""
    size = Seen.SIZE + 3 * len(task.watched)
    return (Box(-np.inf, np.inf, (size,), np.float64),
            Box(-1.0, 1.0, (4 if task.jaws else 3,), np.float32))


class Env(Base):
    """One run of a task at a time, in Gymnasium's interface.

    Env(model=None): a class of its own for each task; `model` may be another Model with the same
    nodes watched and tool, such as one with other materials.

    Observations, float64 [14 + 3 w]: the tip's place (3, m), how far the jaws are open (1, 0 to 1),
    the wrench on the tool (6, N and N m about the tip), how many surface points it has hold of (1),
    the goal (3, m), and the places of the w nodes that the task watches (m).

    Actions, float32 [4], or [3] for tools without jaws, from -1 to 1: the tip's velocity along x, y
    and z times `task.speed`, and the jaws: -1 closes, 1 opens, a fifth of the way in a step. The tip
    is kept within the box from `task.low` to `task.high`; its orientation stays.

    A step is `task.control` seconds. `terminated`: the goal was kept for `task.patience` steps (then
    10 are added to the reward, and info["success"] is True), or the simulation became unstable
    (reward -10, info["unstable"] says why). `truncated`: after `task.horizon` steps.

    The same seed and actions give the same bits (`hash()`), with any number of workers, and after
    pickling."""

    metadata = {"render_modes": []}
    render_mode = None
    task_class = None
    _core = None

    def __init__(self, model=None):
        if self.task_class is None:
            raise TypeError("Env: there is no task; take a class such as lariat.envs.Lift")
        self.task = self.task_class()
        self._core = Core(self.task, 1, 1, model)
        self._all = np.arange(1)
        self.observation_space, self.action_space = spaces_of(self.task)

    def reset(self, *, seed=None, options=None):
        """Begins a run; returns observation and info. seed: an int; None goes on with the random
        numbers. options: dict, `stiffness` (how many times as stiff all materials are, 0.1 to 4)
        and `goal` (three numbers, m)."""
        self._open("reset")
        core = self._core
        if self._np_random is not None:
            core.random[0] = self._np_random
        core.reset(self._all, None if seed is None else [check_seed(seed)], options)
        self._np_random = core.random[0]
        if seed is not None:
            self._np_random_seed = int(seed)
        core.observe()
        return core.observations[0].copy(), {"success": False}

    def step(self, action):
        """One control step; returns observation, reward, terminated, truncated, info."""
        self._open("step")
        core = self._core
        if core.done[0]:
            raise lariat.StateError("step: the run is over, or has not begun; call reset")
        action = core.check_actions(action, self.action_space.shape)
        rewards, terminated, truncated, success, unstable = core.step(action[None], self._all)
        info = {"success": bool(success[0])}
        if unstable:
            info["unstable"] = unstable[0]
        return (core.observations[0].copy(), float(rewards[0]), bool(terminated[0]),
                bool(truncated[0]), info)

    def _open(self, call):
        if self._core is None:
            raise lariat.StateError(f"{call}: the environment is closed; make a new one")

    @property
    def simulation(self):
        """The Simulation, to look at."""
        self._open("simulation")
        return self._core.batch[0]

    @property
    def steps(self):
        """Control steps of the run, an int."""
        self._open("steps")
        return int(self._core.steps[0])

    def hash(self):
        """Simulation.hash() of the run."""
        return self.simulation.hash()

    def render(self):
        """Nothing: environments have no picture; lariat.Session shows one."""

    def close(self):
        """Frees it; closing twice is fine."""
        if self._core is not None:
            self._core.batch.close()
        self._core = None


def check_stiffness(stiffness):
    """As Simulation.set_stiffness has it."""
    try:
        good = 0.1 <= float(stiffness) <= 4
    except (TypeError, ValueError, OverflowError):
        good = False
    if not good:
        raise lariat.ArgumentError(f"stiffness: expected a number from 0.1 to 4, got {stiffness!r}")


def check_seed(seed):
    """An int from 0 on."""
    if isinstance(seed, (int, np.integer)) and not isinstance(seed, bool) and seed >= 0:
        return int(seed)
    raise lariat.ArgumentError(f"seed: expected a whole number from 0 on, got {seed!r}")


class VectorEnv(VectorBase):
    """Many runs of a task, advanced by one call on all cores, in Gymnasium's vector interface.

    VectorEnv(env, num_envs, *, workers=0, model=None): `env` is a class such as lariat.envs.Lift;
    workers as those of lariat.Batch: 0 is one for each core.

    Run i has the bits of a single environment that is reset with seed + i. A run that is over is
    begun anew by the next step, which ignores its action and gives the reward 0 for it (Gymnasium's
    AutoresetMode.NEXT_STEP); all others go on. Arrays have a row for each run."""

    metadata = {"render_modes": [], "autoreset_mode": NEXT_STEP}
    render_mode = None
    spec = None
    _core = None
    _begun = False

    def __init__(self, env, num_envs, *, workers=0, model=None):
        if not (isinstance(env, type) and issubclass(env, Env) and env.task_class):
            raise TypeError(f"env: expected a class such as lariat.envs.Lift, got {env!r}")
        self.task = env.task_class()
        self._core = Core(self.task, num_envs, workers, model)
        self.num_envs = len(self._core.batch)
        self._all = np.arange(self.num_envs)
        self.single_observation_space, self.single_action_space = spaces_of(self.task)
        self.observation_space = batched(self.single_observation_space, self.num_envs)
        self.action_space = batched(self.single_action_space, self.num_envs)
        self.closed = False

    def _seeds(self, seed):
        if seed is None:
            return None
        if isinstance(seed, (list, tuple)):
            if len(seed) != self.num_envs:
                raise lariat.ArgumentError(f"seed: {len(seed)} are given for {self.num_envs} runs")
            return [None if one is None else check_seed(one) for one in seed]
        return [check_seed(seed) + i for i in range(self.num_envs)]

    def _open(self, call):
        if self._core is None:
            raise lariat.StateError(f"{call}: the environment is closed; make a new one")

    def reset(self, *, seed=None, options=None):
        """Begins all runs; returns observations [n, ...] and infos. seed: an int, run i gets
        seed + i; or one for each. options as those of Env."""
        self._open("reset")
        self._core.reset(self._all, self._seeds(seed), options)
        self._begun = True
        self._core.observe()
        return self._core.observations.copy(), {"success": np.zeros(self.num_envs, bool),
                                                "_success": np.ones(self.num_envs, bool)}

    def step(self, actions):
        """One control step of all runs; returns observations, rewards, terminations, truncations,
        infos, arrays [n, ...]. infos["success"]: [n]; infos["unstable"], where there are any: why,
        [n], None for those that are sound (infos["_unstable"] says which)."""
        self._open("step")
        if not self._begun:
            raise lariat.StateError("step: no run has begun; call reset")
        core, n = self._core, self.num_envs
        actions = core.check_actions(actions, self.action_space.shape)
        rewards, terminated = np.zeros(n), np.zeros(n, bool)
        truncated, success = np.zeros(n, bool), np.zeros(n, bool)
        over, going = np.flatnonzero(core.done), np.flatnonzero(~core.done)
        unstable = {}
        if len(over):
            core.reset(over)
        if len(going):
            (rewards[going], terminated[going], truncated[going], success[going],
             unstable) = core.step(actions[going], going)
        else:
            core.observe()
        infos = {"success": success, "_success": np.ones(n, bool)}
        if unstable:
            infos["unstable"], infos["_unstable"] = np.full(n, None, object), np.zeros(n, bool)
            for i, why in unstable.items():
                infos["unstable"][i], infos["_unstable"][i] = why, True
        return core.observations.copy(), rewards, terminated, truncated, infos

    @property
    def batch(self):
        """The Batch, to look at."""
        self._open("batch")
        return self._core.batch

    def hashes(self):
        """Simulation.hash() of every run, a tuple of ints."""
        return self.batch.hashes()

    def close(self, **unused):
        """Frees it; closing twice is fine."""
        if self._core is not None:
            self._core.batch.close()
        self._core = None
        self.closed = True
