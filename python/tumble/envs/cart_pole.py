"""A pole on a cart, to be balanced."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium.spaces import Box, Discrete
from gymnasium.vector import AutoresetMode
from numpy.typing import ArrayLike, NDArray

from .._errors import ArgumentError
from ._base import BatchEnv, Observations
from ._picture import Part, View

_FORCE = 10.0
_HALF_LENGTH = 0.5
#: Largest size of a number of a start [m, m/s, rad, rad/s].
_MAX_START = 100.0
_MAX_X = 2.4
_MAX_THETA = np.radians(12.0)
_CART, _POLE = 1, 2

SCENE: dict[str, Any] = {
    "name": "cart-pole",
    "source": "Barto, Sutton and Anderson, IEEE Trans. SMC 13 (1983) 834.",
    "gravity": [0, -9.8, 0],
    "dt": 0.02,
    "bodies": [
        {
            "name": "track",
            "shape": {"cuboid": {"half_extents": [_MAX_X, 0.01, 0.01]}},
            "fixed": True,
        },
        {
            "name": "cart",
            "shape": {"cuboid": {"half_extents": [0.2, 0.1, 0.1]}},
            "mass": 1.0,
        },
        {
            "name": "pole",
            "shape": {"cuboid": {"half_extents": [0.005, _HALF_LENGTH, 0.005]}},
            "mass": 0.1,
            "position": [0, _HALF_LENGTH, 0],
        },
    ],
    "joints": [
        {
            "name": "slider",
            "between": ["track", "cart"],
            "slider": {"at": [0, 0, 0], "axis": [1, 0, 0]},
        },
        {
            "name": "hinge",
            "between": ["cart", "pole"],
            "hinge": {"at": [0, 0, 0], "axis": [0, 0, 1]},
        },
    ],
}


class CartPole(BatchEnv):
    """The task of Gymnasium's CartPole-v1: a cart on a track balances a pole.

    Actions (num_envs,) are 0 and 1: a force of -10 N or +10 N along x on the cart, for 0.02 s.
    Observations (num_envs, 4) are x of the cart [m], its velocity [m/s], the angle of the pole
    from upright [rad], positive towards +x, and its angular velocity [rad/s]. Each begins evenly
    within ±0.05, or from `low` to `high` of the options of `reset`.

    Each step has reward 1. An episode terminates where |x| > 2.4 m or the angle is beyond 12
    degrees, and is truncated after 500 steps. Gymnasium's takes Euler steps; this follows the
    equations of motion, within 1e-3 over half a second. The cart has 1 kg, the pole 0.1 kg and
    1 m; `vary` changes `bodies.cart.mass` and `bodies.pole.mass`.
    """

    _option_names = frozenset({"low", "high"})
    _view = View(middle=(0.0, 0.4), width=5.2)
    _parts = [
        Part(0, (-_MAX_X, 0, 0), (_MAX_X, 0, 0), 0.01, (120, 120, 120)),
        Part(_CART, (-0.15, 0, 0), (0.15, 0, 0), 0.1, (40, 40, 40)),
        Part(_POLE, (0, -_HALF_LENGTH, 0), (0, _HALF_LENGTH, 0), 0.04, (202, 152, 101)),
    ]

    def __init__(
        self,
        num_envs: int = 1,
        *,
        vary: Mapping[str, ArrayLike] | None = None,
        max_episode_steps: int | None = 500,
        render_mode: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        copy: bool = True,
    ) -> None:
        high = np.array([2 * _MAX_X, 100.0, 2 * _MAX_THETA, 100.0], np.float32)
        super().__init__(
            SCENE,
            num_envs,
            Box(-high, high, dtype=np.float32),
            Discrete(2),
            vary=vary,
            max_episode_steps=max_episode_steps,
            render_mode=render_mode,
            autoreset_mode=autoreset_mode,
            copy=copy,
        )
        self._range = (-0.05, 0.05)
        self._forces = np.zeros((num_envs, 1, 3), np.float32)

    def _configure(self, options: dict[str, Any]) -> None:
        given = options.get("low", -0.05), options.get("high", 0.05)
        try:
            low, high = (float(bound) for bound in given)
        except (TypeError, ValueError):
            raise ArgumentError(f"options: {given} are not numbers", "options") from None
        if not -_MAX_START <= low <= high <= _MAX_START:
            problem = f"options: low {low} and high {high} are not ordered within {_MAX_START}"
            raise ArgumentError(problem, "options")
        self._range = (low, high)

    def _place(self, worlds: NDArray[np.intp]) -> None:
        low, high = self._range
        start = low + (high - low) * self._draws(worlds, 4)
        self.set_motion(start, worlds)

    def set_motion(self, motion: ArrayLike, worlds: NDArray[np.intp] | None = None) -> None:
        """Gives worlds, by increasing indices (n,) or all, the x, speed, angle and angular speed
        of `motion` (n, 4) [m, m/s, rad, rad/s]."""
        start = np.asarray(motion, np.float64)
        x, speed, angle, rate = (start[:, i] for i in range(4))
        sine, cosine, zero = np.sin(angle), np.cos(angle), np.zeros_like(x)
        bodies = np.zeros((len(start), 2, 13))
        bodies[:, :, 0], bodies[:, :, 7] = x[:, None], speed[:, None]
        bodies[:, 0, 6] = 1.0
        bodies[:, 1, 0] += _HALF_LENGTH * sine
        bodies[:, 1, 1] = _HALF_LENGTH * cosine
        bodies[:, 1, 3:7] = np.stack([zero, zero, -np.sin(angle / 2), np.cos(angle / 2)], axis=1)
        bodies[:, 1, 7] += _HALF_LENGTH * cosine * rate
        bodies[:, 1, 8] = -_HALF_LENGTH * sine * rate
        bodies[:, 1, 12] = -rate
        self.batch.set_state(
            ["cart", "pole"],
            worlds=worlds,
            positions=bodies[..., :3],
            orientations=bodies[..., 3:7],
            linear_velocities=bodies[..., 7:10],
            angular_velocities=bodies[..., 10:],
        )

    def _act(self, actions: NDArray[Any]) -> None:
        self._forces[:, 0, 0] = np.where(actions == 1, _FORCE, -_FORCE)
        self.batch.set_forces(_CART, forces=self._forces)

    def _observe(self, out: Observations) -> None:
        cart, pole = self._states[:, _CART], self._states[:, _POLE]
        z, w = pole[:, 5], pole[:, 6]
        out[:, 0] = cart[:, 0]
        out[:, 1] = cart[:, 7]
        np.arctan2(-2.0 * w * z, w * w - z * z, out=out[:, 2])
        np.negative(pole[:, 12], out=out[:, 3])

    def _judge(
        self, actions: NDArray[Any]
    ) -> tuple[NDArray[np.float64], NDArray[np.bool_], dict[str, Any]]:
        beyond = np.abs(self._observations[:, 0]) > _MAX_X
        tilted = np.abs(self._observations[:, 2]) > _MAX_THETA
        return np.ones(self.num_envs), beyond | tilted, {}
