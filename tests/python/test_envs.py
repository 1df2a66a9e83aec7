"""Environments: a policy by hand solves each; the same bits with any number of workers and after
pickling; Gymnasium's own checks where it is installed; misuse."""

import copy
import os
import pickle
import sys
import unittest

import lariat
from common import WITHOUT_NUMPY, child, numpy

if numpy is None:
    print("skipped: " + WITHOUT_NUMPY)
    sys.exit(0)

from lariat import envs  # pylint: disable=wrong-import-position

try:
    import gymnasium
except ImportError:
    gymnasium = None
FULL = bool(os.environ.get("LARIAT_TEST_FULL"))
SANITIZED = os.environ.get("LARIAT_TEST_SANITIZED")


def resident():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


class Solved(unittest.TestCase):
    """Each task within its horizon, by what is observed alone; and not by doing nothing."""

    def solve(self, make):
        with make() as env:
            policy = envs.scripted.policy(env)
            for seed in range(10 if FULL else 1):
                observation, info = env.reset(seed=seed)
                policy.reset()
                self.assertFalse(info["success"])
                over = False
                while not over:
                    self.assertIn(observation, env.observation_space)
                    observation, reward, terminated, truncated, info = env.step(policy(observation))
                    self.assertLess(reward, 11.5)
                    over = terminated or truncated
                self.assertTrue(terminated and info["success"], (make, seed))
                self.assertGreater(reward, 10)
            observation, _ = env.reset(seed=0)
            still = numpy.zeros(env.action_space.shape, numpy.float32)
            for _ in range(20):
                _, reward, terminated, truncated, info = env.step(still)
                self.assertFalse(terminated or truncated or info["success"])
                self.assertLessEqual(reward, 0)

    def test_palpate(self):
        self.solve(envs.Palpate)

    def test_lift(self):
        self.solve(envs.Lift)

    def test_retract(self):
        self.solve(envs.Retract)

    def test_through_ring(self):
        self.solve(envs.ThroughRing)

    def test_thread_ring(self):
        self.solve(envs.ThreadRing)


def play(env, actions):
    """All that comes back, and the hashes after each step."""
    got = []
    for action in actions:
        observation, reward, terminated, truncated, info = env.step(action)
        hashes = env.hashes() if hasattr(env, "hashes") else (env.hash(),)
        got.append((observation.tobytes(), numpy.asarray(reward).tobytes(),
                    numpy.asarray(terminated).tolist(), numpy.asarray(truncated).tolist(), hashes,
                    numpy.asarray(info["success"]).tolist()))
    return got


class Bits(unittest.TestCase):
    RUNS, STEPS = 3, 25

    def actions(self, count):
        random = numpy.random.default_rng(5)
        shape = (self.STEPS, count, 4)
        return numpy.clip(random.normal(size=shape), -1, 1) * (1, 1, 1, 1) - (0.3, 0, 0.3, 0)

    def test_workers_single_runs_and_pickles(self):
        actions, seen = numpy.clip(self.actions(self.RUNS), -1, 1), []
        for workers in (1, 2, 8):
            env = envs.VectorEnv(envs.Lift, self.RUNS, workers=workers)
            first, _ = env.reset(seed=7)
            seen.append(play(env, actions))
        self.assertEqual(seen[0], seen[1])
        self.assertEqual(seen[0], seen[2])
        for i in range(self.RUNS):
            single = envs.Lift()
            self.assertEqual(single.reset(seed=7 + i)[0].tobytes(), first[i].tobytes())
            alone = play(single, actions[:, i])
            for one, many in zip(alone, seen[0]):
                self.assertEqual(one[4][0], many[4][i])
                self.assertEqual(one[0], numpy.frombuffer(many[0]).reshape(self.RUNS, -1)[i].tobytes())
        env = envs.VectorEnv(envs.Lift, self.RUNS, workers=2)
        env.reset(seed=7)
        half = self.STEPS // 2
        begun = play(env, actions[:half])
        self.assertEqual(begun + play(pickle.loads(pickle.dumps(env)), actions[half:]), seen[0])
        self.assertEqual(begun + play(env, actions[half:]), seen[0])

    def test_pickled_single_runs_draw_the_same_goals(self):
        env = envs.Palpate()
        env.reset(seed=3)
        twin, other = copy.deepcopy(env), pickle.loads(pickle.dumps(env))
        for one in (env, twin, other):
            one.step([0.5, 0, -1])
        self.assertEqual(env.hash(), twin.hash())
        self.assertEqual(env.hash(), other.hash())
        for _ in range(3):
            self.assertEqual(env.reset()[0].tobytes(), other.reset()[0].tobytes())

    def test_touching_bodies(self):
        one, two = envs.ThroughRing(), envs.VectorEnv(envs.ThroughRing, 2, workers=2)
        policy = envs.scripted.policy(one)
        observation, _ = one.reset(seed=1)
        two.reset(seed=1)
        for _ in range(40):
            action = policy(observation)
            observation, *_ = one.step(action)
            two.step(numpy.stack([action, action]))
        self.assertEqual(one.hash(), two.hashes()[0])


class Runs(unittest.TestCase):
    def test_vector_environments_begin_anew_by_themselves(self):
        env = envs.VectorEnv(envs.Palpate, 3, workers=2)
        policy, begun = envs.scripted.policy(env), 0
        observations, _ = env.reset(seed=0)
        over = numpy.zeros(3, bool)
        for _ in range(70):
            hashes = env.hashes()
            observations, rewards, terminated, truncated, infos = env.step(policy(observations))
            for i in numpy.flatnonzero(over):
                self.assertEqual((rewards[i], terminated[i]), (0, False))
                self.assertNotEqual(env.hashes()[i], hashes[i])
                policy.reset(i)
                begun += 1
            self.assertTrue((infos["success"] <= terminated).all())
            over = terminated | truncated
        self.assertGreaterEqual(begun, 3)

    def test_horizon_and_steps_behind_the_end(self):
        env = envs.Palpate()
        with self.assertRaisesRegex(lariat.StateError, "call reset"):
            env.step(numpy.zeros(3))
        env.reset(seed=0)
        env.task.horizon = 5
        for k in range(5):
            _, _, terminated, truncated, _ = env.step(numpy.zeros(3))
            self.assertEqual((terminated, truncated), (False, k == 4))
        with self.assertRaisesRegex(lariat.StateError, "call reset"):
            env.step(numpy.zeros(3))

    def test_unstable_runs_end_and_the_others_go_on(self):
        env = envs.VectorEnv(envs.Lift, 3, workers=2)
        with self.assertRaisesRegex(lariat.StateError, "call reset"):
            env.step(numpy.zeros((3, 4)))
        env.reset(seed=0)
        for node in range(20, 90):
            env.batch[1].set_force(node, (0, 0, 100))
        _, rewards, terminated, _, infos = env.step(numpy.zeros((3, 4)))
        self.assertEqual(terminated.tolist(), [False, True, False])
        self.assertEqual((rewards[1], infos["_unstable"].tolist()), (-10, [False, True, False]))
        self.assertRegex(infos["unstable"][1], "step|node|element")
        observations, rewards, terminated, _, infos = env.step(numpy.zeros((3, 4)))
        self.assertFalse(terminated.any() or "unstable" in infos)
        self.assertTrue(numpy.isfinite(observations).all())

    def test_options_and_models_of_ones_own(self):
        env = envs.Palpate()
        observation, _ = env.reset(options={"goal": (0.02, 0.02, 0.018), "stiffness": 2})
        self.assertEqual(envs.Seen(observation[None]).goal[0].tolist(), [0.02, 0.02, 0.018])
        self.assertEqual(env.simulation.stiffness(0), 2)
        env.reset()
        self.assertEqual(env.simulation.stiffness(0), 1)
        self.assertRaises(ValueError, envs.Palpate, model=envs.Lift().simulation.model)
        self.assertRaises(TypeError, envs.Palpate, model="pad.yaml")
        again = envs.Palpate(model=env.simulation.model)
        self.assertEqual(again.reset(seed=4)[0].tobytes(), env.reset(seed=4)[0].tobytes())

    def test_a_task_of_ones_own(self):
        class Deeper(envs.Palpate):
            class task_class(envs.Palpate.task_class):
                control = 0.01

                def judge(self, seen):
                    return -seen.tip[:, 2], seen.tip[:, 2] < 0.0
        env = Deeper()
        env.reset(seed=0)
        self.assertAlmostEqual(env.step(numpy.zeros(3))[1], -0.04)

    @unittest.skipIf(SANITIZED, "sanitizers keep what was freed")
    def test_nothing_grows(self):
        env = envs.Palpate()
        for i in range(100000 if FULL else 2000):
            if i == 500:
                before = resident()
            env.reset()
        for _ in range(300 if FULL else 20):
            with envs.VectorEnv(envs.Palpate, 4, workers=2) as more:
                more.reset()
                more.step(numpy.zeros((4, 3)))
        self.assertLess(resident() - before, 8 << 20)


class Misuse(unittest.TestCase):
    def test_closed_ones_say_what_to_do(self):
        for env in (envs.Lift(), envs.VectorEnv(envs.Lift, 2)):
            env.reset(seed=0)
            env.close()
            for call, ask in (("reset", env.reset), ("step", lambda e=env: e.step([0] * 4))):
                with self.assertRaisesRegex(lariat.StateError, f"^{call}: .*closed; make a new one"):
                    ask()

    def test_actions_seeds_options(self):
        env = envs.Lift()
        env.reset(seed=0)
        before = env.hash()
        for wrong in (None, "up", 5, [0] * 3, [[0] * 4], [0, 0, 0, float("nan")], [0, 0, float("inf"), 0],
                      {}, [[], [], [], []], object()):
            with self.assertRaises(ValueError, msg=wrong):
                env.step(wrong)
        with self.assertRaisesRegex(lariat.ArgumentError, r"^action\[3\]: .*finite number, got nan"):
            env.step([0, 0, 0, float("nan")])
        with self.assertRaisesRegex(lariat.ArgumentError, r"shape \(4,\), got \(3,\)"):
            env.step([0] * 3)
        self.assertEqual(env.hash(), before)
        env.step([5, -5, 0, 0])  # beyond the bounds: as at them
        for seed in (-1, 1.5, "1", True, numpy.zeros(2)):
            with self.assertRaises(ValueError, msg=seed):
                env.reset(seed=seed)
        for options in ({"colour": 1}, {"goal": (1, 2)}, {"goal": (1000, 0, 0)},
                        {"goal": (0, 0, float("nan"))},
                        {"stiffness": 100}):
            with self.assertRaises(ValueError, msg=options):
                env.reset(options=options)
        with self.assertRaisesRegex(TypeError, "^options: expected a dict.*list"):
            env.reset(options=[1])
        env.reset(seed=numpy.int64(4))
        for one in (env, envs.VectorEnv(type(env), 2)):  # the run goes on where it was
            one.reset(seed=1)
            for _ in range(3):
                one.step(numpy.ones(one.action_space.shape))
            before = one.hash() if one is env else one.hashes()
            for stiffness in (0, 100, float("nan"), "soft", None.__class__):
                with self.assertRaisesRegex(ValueError, "stiffness: expected"):
                    one.reset(seed=5, options={"stiffness": stiffness})
            self.assertEqual(one.hash() if one is env else one.hashes(), before)
            one.step(numpy.zeros(one.action_space.shape))

    def test_after_close(self):
        env, many = envs.Palpate(), envs.VectorEnv(envs.Palpate, 2)
        for one in (env, many):
            one.close()
            one.close()
            for call in (one.reset, lambda e=one: e.step(numpy.zeros(3))):
                self.assertRaises(lariat.StateError, call)
        self.assertRaises(lariat.StateError, env.hash)
        self.assertRaises(lariat.StateError, many.hashes)

    def test_of_vector_environments(self):
        self.assertRaisesRegex(TypeError, "no task", envs.Env)
        for wrong in (envs.Palpate(), "Palpate", int, envs.Env):
            self.assertRaises(TypeError, envs.VectorEnv, wrong, 2)
        for count in (0, -1):
            self.assertRaises(ValueError, envs.VectorEnv, envs.Palpate, count)
        env = envs.VectorEnv(envs.Palpate, 2)
        self.assertRaises(ValueError, lambda: env.reset(seed=[1]))
        env.reset(seed=[1, None])
        self.assertRaises(ValueError, lambda: env.step(numpy.zeros((2, 4))))

    def test_own_spaces(self):
        space = envs.Palpate().action_space
        space.seed(1)
        first = space.sample()
        space.seed(1)
        self.assertTrue(numpy.array_equal(space.sample(), first))
        self.assertIn(first, space)
        self.assertNotIn(first + 2, space)
        self.assertNotIn(first[:2], space)
        self.assertEqual((first.dtype, first.shape), (numpy.float32, (3,)))


STAND_IN = """
import sys, types
class Env: _np_random = None; _np_random_seed = None
class Box:
    def __init__(self, low, high, shape=None, dtype=None):
        self.low, self.high, self.shape, self.dtype = low, high, shape or low.shape, dtype
    def contains(self, x): return x.shape == self.shape
    __contains__ = contains
import numpy
class FilledBox(Box):
    def __init__(self, low, high, shape=None, dtype=None):
        shape = shape if shape is not None else low.shape
        super().__init__(numpy.full(shape, low) if numpy.isscalar(low) else low,
                         numpy.full(shape, high) if numpy.isscalar(high) else high, shape,
                         numpy.dtype(dtype))
class VectorEnv:
    closed = False
    def __del__(self):
        if not self.closed: self.close()
ids = {}
gymnasium = types.ModuleType("gymnasium")
gymnasium.Env, gymnasium.register = Env, lambda id, **entry: ids.update({id: entry})
for name, things in (("spaces", {"Box": FilledBox}), ("vector", {"VectorEnv": VectorEnv})):
    module = types.ModuleType("gymnasium." + name)
    vars(module).update(things)
    sys.modules["gymnasium." + name] = module
    setattr(gymnasium, name, module)
sys.modules["gymnasium"] = gymnasium
from lariat import envs
env = ids["lariat/Palpate-v0"]["entry_point"]()
assert isinstance(env, Env) and isinstance(env.action_space, FilledBox)
observation, _ = env.reset(seed=1)
assert observation in env.observation_space and env._np_random is not None
many = ids["lariat/Palpate-v0"]["vector_entry_point"](num_envs=2, workers=1)
assert isinstance(many, VectorEnv) and many.observation_space.shape == (2, observation.size)
assert many.reset(seed=1)[0][0].tobytes() == observation.tobytes()
try: envs.VectorEnv(int, 2)
except TypeError: pass
print(sorted(ids))
"""


class Words(unittest.TestCase):
    """Everything has a docstring, and a line in the stub."""

    def test_docstrings_and_stub(self):
        with open(envs.__file__ + "i", encoding="utf-8") as file:
            stub = file.read()
        for name in envs.__all__:
            thing = getattr(envs, name)
            self.assertTrue(thing.__doc__, name)
            self.assertRegex(stub, rf"\b(class|as) {name}\b")
            for part, value in vars(thing).items():
                if part.startswith("_") or name in ("Box", "scripted"):
                    continue
                if callable(value) and not isinstance(value, type):
                    self.assertTrue(value.__doc__, part)
                    self.assertRegex(stub, rf"def {part}\(")
        for env in envs.TASKS:
            self.assertIn("Reward", env.__doc__)


class WithGymnasium(unittest.TestCase):
    """The classes are Gymnasium's where it is installed: here something stands in for it."""

    def test_its_classes_are_taken(self):
        status, said, error = child(STAND_IN)
        self.assertEqual((status, error), (0, ""), said)
        self.assertEqual(said.count("lariat/"), 5)


@unittest.skipUnless(gymnasium, "gymnasium is not installed")
class Gymnasium(unittest.TestCase):
    def test_its_own_checks(self):
        from gymnasium.utils.env_checker import check_env
        for env in envs.TASKS:
            check_env(env(), skip_render_check=True)

    def test_ids(self):
        env = gymnasium.make("lariat/Lift-v0")
        env.reset(seed=0)
        env.step(env.action_space.sample())
        many = gymnasium.make_vec("lariat/Lift-v0", num_envs=2, workers=2,
                                  vectorization_mode="vector_entry_point")
        observations, _ = many.reset(seed=0)
        self.assertIn(observations, many.observation_space)
        self.assertIn("NEXT_STEP", repr(many.metadata["autoreset_mode"]))
        one = gymnasium.vector.SyncVectorEnv([envs.Lift] * 2)
        self.assertEqual(one.reset(seed=0)[0].tobytes(), observations.tobytes())


if __name__ == "__main__":
    unittest.main()
