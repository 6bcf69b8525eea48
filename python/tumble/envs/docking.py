"""A spacecraft that is to dock."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode
from numpy.typing import ArrayLike, NDArray

from ._base import BatchEnv, Observations
from ._picture import Part, View
from ._vectors import random_directions, random_orientations

MAX_FORCE = 20.0
MAX_TORQUE = 4.0
#: Within all of these the craft is docked [m, rad, m/s, rad/s].
DOCKED = {"distance": 0.1, "angle": 0.1, "speed": 0.05, "rate": 0.05}
#: Beyond this the episode ends [m].
TOO_FAR = 20.0
_NEAREST, _FURTHEST = 4.0, 8.0
_MAX_SPEED, _MAX_RATE = 0.2, 0.1
_PORT, _CRAFT = 0, 1

SCENE: dict[str, Any] = {
    "name": "docking",
    "source": "Ours: size and thrust as of a small servicing spacecraft.",
    "gravity": [0, 0, 0],
    "dt": 0.1,
    "bodies": [
        {
            "name": "port",
            "shape": {"cylinder": {"radius": 0.5, "half_height": 0.05}},
            "fixed": True,
        },
        {
            "name": "craft",
            "shape": {"cuboid": {"half_extents": [0.6, 0.4, 0.5]}},
            "mass": 100.0,
        },
    ],
}


class Docking(BatchEnv):
    """A spacecraft without gravity docks at a port at the origin, with the axes of the world.

    Actions (num_envs, 6) from -1 to 1 are a force, of 20 N at 1, and a torque, of 4 N m at 1,
    along the axes of the craft, for 0.1 s. Observations (num_envs, 13) are the position of its
    centre from the port [m], its orientation, a quaternion x, y, z, w with w >= 0 from its frame
    to the port's, its velocity [m/s] and angular velocity [rad/s], all in the frame of the port.

    It begins 4 m to 8 m away in any direction and orientation, with up to 0.2 m/s and 0.1 rad/s.
    It is docked within 0.1 m, 0.1 rad, 0.05 m/s and 0.05 rad/s; that terminates the episode, as
    do more than 20 m. It is truncated after 600 steps. `infos["docked"]` says which are docked.

    The reward of a step is how much `distance / 8 m + angle / pi` fell, less 0.001 for the mean
    of the squares of the actions, and 10 more where it docks, or 10 less where it is too far.
    The craft has 100 kg and 1.2 m x 0.8 m x 1 m; `vary` changes `bodies.craft.mass`.
    """

    metadata = {**BatchEnv.metadata, "render_fps": 10}
    _view = View(middle=(0.0, 0.0), width=22.0)
    _parts = [
        Part(_PORT, (0, 0, 0), (0, 0, 0), 0.9, (200, 70, 60)),
        Part(_CRAFT, (-0.6, 0, 0), (0.6, 0, 0), 0.4, (70, 100, 150)),
        Part(_CRAFT, (0, 0, -2), (0, 0, 2), 0.15, (180, 140, 60)),
    ]

    def __init__(
        self,
        num_envs: int = 1,
        *,
        vary: Mapping[str, ArrayLike] | None = None,
        max_episode_steps: int | None = 600,
        render_mode: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        copy: bool = True,
    ) -> None:
        high = np.array([50.0] * 3 + [1.0] * 4 + [50.0] * 6, np.float32)
        super().__init__(
            SCENE,
            num_envs,
            Box(-high, high, dtype=np.float32),
            Box(-1.0, 1.0, (6,), np.float32),
            vary=vary,
            max_episode_steps=max_episode_steps,
            render_mode=render_mode,
            autoreset_mode=autoreset_mode,
            copy=copy,
        )
        self._to_go = np.zeros(num_envs)

    def _place(self, worlds: NDArray[np.intp]) -> None:
        draws = self._draws(worlds, 12)
        distance = _NEAREST + (_FURTHEST - _NEAREST) * draws[:, :1]
        speed, rate = _MAX_SPEED * draws[:, 6:7], _MAX_RATE * draws[:, 9:10]
        self.batch.set_state(
            "craft",
            worlds=worlds,
            positions=(distance * random_directions(draws[:, 1:3]))[:, None],
            orientations=random_orientations(draws[:, 3:6])[:, None],
            linear_velocities=(speed * random_directions(draws[:, 7:9]))[:, None],
            angular_velocities=(rate * random_directions(draws[:, 10:]))[:, None],
        )

    def _act(self, actions: NDArray[Any]) -> None:
        self.batch.set_forces(
            "craft",
            forces=(MAX_FORCE * actions[:, :3])[:, None],
            torques=(MAX_TORQUE * actions[:, 3:])[:, None],
            frame="body",
        )

    def _observe(self, out: Observations) -> None:
        out[:] = self._states[:, _CRAFT]
        np.negative(out[:, 3:7], out=out[:, 3:7], where=out[:, 6:7] < 0)

    def _distance(self) -> NDArray[np.float64]:
        place = self._observations[:, :3].astype(np.float64)
        distance: NDArray[np.float64] = np.linalg.norm(place, axis=1)
        return distance

    def _angle(self) -> NDArray[np.float64]:
        """The angle of the whole rotation [rad], 0 to pi."""
        quaternions = self._observations[:, 3:7].astype(np.float64)
        sine = np.linalg.norm(quaternions[:, :3], axis=1)
        angle: NDArray[np.float64] = 2.0 * np.arctan2(sine, quaternions[:, 3])
        return angle

    def _left(self) -> NDArray[np.float64]:
        return self._distance() / _FURTHEST + self._angle() / np.pi

    def _begin(self, worlds: NDArray[np.bool_]) -> None:
        self._to_go[worlds] = self._left()[worlds]

    def _judge(
        self, actions: NDArray[Any]
    ) -> tuple[NDArray[np.float64], NDArray[np.bool_], dict[str, Any]]:
        distance, left = self._distance(), self._left()
        speed = np.linalg.norm(self._observations[:, 7:10], axis=1)
        rate = np.linalg.norm(self._observations[:, 10:], axis=1)
        docked = (distance < DOCKED["distance"]) & (self._angle() < DOCKED["angle"])
        docked &= (speed < DOCKED["speed"]) & (rate < DOCKED["rate"])
        lost = distance > TOO_FAR
        rewards = self._to_go - left - 0.001 * np.mean(actions.astype(np.float64) ** 2, axis=1)
        rewards += 10.0 * docked - 10.0 * lost
        self._to_go = left
        infos = {"docked": docked.copy(), "_docked": np.ones(self.num_envs, np.bool_)}
        return rewards, docked | lost, infos
