"""What environments inherit: Gymnasium's classes where it is installed, otherwise as much of them as
learners ask for."""

import numpy as np

try:
    import gymnasium
except ImportError:
    gymnasium = None

NEXT_STEP = "NextStep"
if gymnasium is not None:
    from gymnasium import Env as Base
    from gymnasium.spaces import Box
    from gymnasium.vector import VectorEnv as VectorBase

    try:
        from gymnasium.vector import AutoresetMode

        NEXT_STEP = AutoresetMode.NEXT_STEP
    except ImportError:  # before 1.1
        pass
else:

    class Box:
        """Numbers between `low` and `high`, of Gymnasium's interface: sample, seed, contains."""

        def __init__(self, low, high, shape=None, dtype=np.float32, seed=None):
            self.dtype = np.dtype(dtype)
            self.shape = tuple(shape) if shape is not None else np.shape(low)
            self.low = np.broadcast_to(np.asarray(low, self.dtype), self.shape).copy()
            self.high = np.broadcast_to(np.asarray(high, self.dtype), self.shape).copy()
            self._random = np.random.default_rng(seed)

        def seed(self, seed=None):
            """Begins the numbers of sample() anew; returns the seed."""
            self._random = np.random.default_rng(seed)
            return seed

        def sample(self):
            """Random numbers: even where both bounds are finite, else of a normal distribution."""
            bounded = np.isfinite(self.low) & np.isfinite(self.high)
            low, high = np.where(bounded, self.low, 0), np.where(bounded, self.high, 1)
            even = self._random.uniform(low, high)
            normal = np.clip(self._random.normal(size=self.shape), self.low, self.high)
            return np.where(bounded, even, normal).astype(self.dtype)

        def contains(self, x):
            """Whether x is an array of this shape between the bounds, of a type that fits."""
            return bool(isinstance(x, np.ndarray) and np.can_cast(x.dtype, self.dtype)
                        and x.shape == self.shape and np.all((x >= self.low) & (x <= self.high)))

        def __contains__(self, x):
            return self.contains(x)

        def __eq__(self, other):
            return (isinstance(other, Box) and self.shape == other.shape
                    and self.dtype == other.dtype and np.array_equal(self.low, other.low)
                    and np.array_equal(self.high, other.high))

        def __repr__(self):
            return f"Box({self.low.min()}, {self.high.max()}, {self.shape}, {self.dtype})"

    class Base:
        """Gymnasium's Env, as far as it goes without it."""

        metadata = {"render_modes": []}
        render_mode = None
        spec = None
        _np_random = None
        _np_random_seed = None

        @property
        def unwrapped(self):
            """The environment itself."""
            return self

        @property
        def np_random(self):
            """The numpy Generator that goals come from."""
            if self._np_random is None:
                self._np_random = np.random.default_rng()
            return self._np_random

        def render(self):
            """Nothing: there is no picture."""

        def __enter__(self):
            return self

        def __exit__(self, *exception):
            self.close()
            return False

        def close(self):
            """Frees it."""

    class VectorBase(Base):
        """Gymnasium's VectorEnv, likewise."""


def batched(space, count):
    """The space of `count` things of a Box."""
    low = np.broadcast_to(space.low, (count, *space.shape))
    high = np.broadcast_to(space.high, (count, *space.shape))
    return Box(low, high, dtype=space.dtype.type)
