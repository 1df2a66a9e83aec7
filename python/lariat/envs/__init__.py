"""Environments for learning, in Gymnasium's interface: tissue, one tool, positions and wrenches.

    from lariat import envs
    env = envs.Lift()
    observation, info = env.reset(seed=1)
    observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
    many = envs.VectorEnv(envs.Lift, 64)             # on all cores

Palpate, Lift, Retract, ThroughRing, ThreadRing: the tasks; their docstrings say what the reward is.
Env and VectorEnv: what they have in common. Task and Seen: for tasks of one's own. scripted: a policy
for each. numpy is needed; gymnasium is used where it is installed, and the ids "lariat/Lift-v0" and
so on are registered there. docs/environments.md is the tutorial.
"""

try:
    import numpy as _numpy
except ImportError as error:
    raise ImportError("lariat.envs needs numpy (apt-get install python3-numpy)") from error

from . import scripted
from ._core import Env, Seen, Task, VectorEnv
from ._spaces import Box
from ._spaces import gymnasium as _gymnasium
from ._tasks import Lift, Palpate, Retract, ThreadRing, ThroughRing

__all__ = ["Box", "Env", "Lift", "Palpate", "Retract", "Seen", "Task", "ThreadRing", "ThroughRing",
           "VectorEnv", "scripted"]

TASKS = (Palpate, Lift, Retract, ThroughRing, ThreadRing)


def _register():
    for env in TASKS:
        _gymnasium.register(
            id=f"lariat/{env.__name__}-v0", entry_point=env,
            vector_entry_point=lambda num_envs, env=env, **options: VectorEnv(env, num_envs, **options))


if _gymnasium is not None:
    _register()
