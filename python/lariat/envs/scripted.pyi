"""Types of lariat.envs.scripted."""

from collections.abc import Callable
from typing import Any, Union

import numpy as np

from . import Env, Seen, Task, VectorEnv

_Array = np.ndarray[Any, Any]

class Stage:
    def __init__(
        self,
        where: Callable[[Seen], Any],
        opening: float = 1.0,
        until: Union[Callable[[Seen, int], bool], None] = None,
        speed: float = 1.0,
    ) -> None: ...

class Policy:
    def __init__(self, task: Task, count: Union[int, None] = None) -> None: ...
    def reset(self, which: Union[int, None] = None) -> None: ...
    def __call__(self, observations: _Array) -> _Array: ...

def policy(env: Union[Env, VectorEnv]) -> Policy: ...
