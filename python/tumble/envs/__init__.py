"""Environments for learning, many worlds in each: Gymnasium's `VectorEnv` over `tumble.Batch`.

`CartPole`, `Docking` and `Quadruped` are vector environments. `Single` makes a `gymnasium.Env` of
one with a single world, as `CartPole.single()` does. Importing this registers all of them:

>>> import gymnasium, tumble.envs
>>> envs = gymnasium.make_vec("tumble/CartPole-v0", num_envs=16)
>>> observations, infos = envs.reset(seed=1)
>>> observations.shape
(16, 4)

Gymnasium is needed: `pip install tumble[envs]`.
"""

try:
    import gymnasium  # noqa: F401
except ImportError as error:
    raise ImportError("tumble.envs needs gymnasium: pip install tumble[envs]") from error

from ._base import BatchEnv
from ._register import register_all, single_cart_pole, single_docking, single_quadruped
from ._single_env import Single
from .cart_pole import CartPole
from .docking import Docking
from .quadruped import Quadruped

__all__ = [
    "BatchEnv",
    "CartPole",
    "Docking",
    "Quadruped",
    "Single",
    "single_cart_pole",
    "single_docking",
    "single_quadruped",
]

register_all()
