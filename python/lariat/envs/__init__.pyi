"""Types of lariat.envs. Observations and actions are numpy arrays; help() says more."""

from collections.abc import Mapping, Sequence
from typing import Any, Union

import numpy as np

from .. import Batch, Model, Simulation
from . import scripted as scripted

_Array = np.ndarray[Any, Any]
_Seed = Union[int, None]
_Options = Union[Mapping[str, Any], None]

TASKS: tuple[type[Env], ...]

class Box:
    low: _Array
    high: _Array
    shape: tuple[int, ...]
    dtype: Any
    def __init__(
        self,
        low: Any,
        high: Any,
        shape: Union[Sequence[int], None] = None,
        dtype: Any = ...,
        seed: Any = None,
    ) -> None: ...
    def sample(self) -> _Array: ...
    def seed(self, seed: _Seed = None) -> Any: ...
    def contains(self, x: Any) -> bool: ...
    def __contains__(self, x: Any) -> bool: ...

class Seen:
    SIZE: int
    observations: _Array
    tip: _Array
    opening: _Array
    wrench: _Array
    held: _Array
    goal: _Array
    points: _Array
    def __init__(self, observations: _Array) -> None: ...

class Task:
    control: float
    horizon: int
    speed: float
    jaws: bool
    settle: float
    patience: int
    low: Sequence[float]
    high: Sequence[float]
    watched: Sequence[int]
    def model(self) -> Model: ...
    def goal(self, random: np.random.Generator) -> _Array: ...
    def judge(self, seen: Seen) -> tuple[_Array, _Array]: ...

class Env:
    task_class: Any
    task: Task
    observation_space: Box
    action_space: Box
    metadata: dict[str, Any]
    render_mode: Union[str, None]
    def __init__(self, model: Union[Model, None] = None) -> None: ...
    def reset(
        self, *, seed: _Seed = None, options: _Options = None
    ) -> tuple[_Array, dict[str, Any]]: ...
    def step(self, action: Any) -> tuple[_Array, float, bool, bool, dict[str, Any]]: ...
    def hash(self) -> int: ...
    def render(self) -> None: ...
    def close(self) -> None: ...
    def __enter__(self) -> Env: ...
    def __exit__(self, *exception: Any) -> Any: ...
    @property
    def simulation(self) -> Simulation: ...
    @property
    def steps(self) -> int: ...

class Palpate(Env): ...
class Lift(Env): ...
class Retract(Env): ...
class ThroughRing(Env): ...
class ThreadRing(Env): ...

class VectorEnv:
    task: Task
    num_envs: int
    closed: bool
    observation_space: Box
    action_space: Box
    single_observation_space: Box
    single_action_space: Box
    metadata: dict[str, Any]
    render_mode: Union[str, None]
    def __init__(
        self,
        env: type[Env],
        num_envs: int,
        *,
        workers: int = 0,
        model: Union[Model, None] = None,
    ) -> None: ...
    def reset(
        self, *, seed: Union[int, Sequence[_Seed], None] = None, options: _Options = None
    ) -> tuple[_Array, dict[str, Any]]: ...
    def step(self, actions: Any) -> tuple[_Array, _Array, _Array, _Array, dict[str, Any]]: ...
    def hashes(self) -> tuple[int, ...]: ...
    def close(self, **unused: Any) -> None: ...
    @property
    def batch(self) -> Batch: ...
