"""Names of the environments in Gymnasium's registry."""

from __future__ import annotations

from typing import Any

import gymnasium

from ._single_env import Single
from .cart_pole import CartPole
from .docking import Docking
from .quadruped import Quadruped


def single_cart_pole(**settings: Any) -> Single:
    """`CartPole` with one world and no time limit: `gymnasium.make` adds its own."""
    return CartPole.single(**{"max_episode_steps": None, **settings})


def single_docking(**settings: Any) -> Single:
    """`Docking` with one world and no time limit: `gymnasium.make` adds its own."""
    return Docking.single(**{"max_episode_steps": None, **settings})


def single_quadruped(**settings: Any) -> Single:
    """`Quadruped` with one world and no time limit: `gymnasium.make` adds its own."""
    return Quadruped.single(**{"max_episode_steps": None, **settings})


_ENVS = {
    "CartPole": ("single_cart_pole", 500),
    "Docking": ("single_docking", 600),
    "Quadruped": ("single_quadruped", 500),
}


def register_all() -> None:
    """Registers `tumble/CartPole-v0`, `tumble/Docking-v0` and `tumble/Quadruped-v0`, once."""
    for name, (single, steps) in _ENVS.items():
        full_name = f"tumble/{name}-v0"
        if full_name not in gymnasium.registry:
            gymnasium.register(
                full_name,
                entry_point=f"tumble.envs:{single}",
                vector_entry_point=f"tumble.envs:{name}",
                max_episode_steps=steps,
            )
