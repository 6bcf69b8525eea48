"""A robot with four legs that is to stand."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode
from numpy.typing import ArrayLike, NDArray

from ._base import BatchEnv, Observations
from ._picture import Part, View

LEGS = ("front-left", "front-right", "rear-left", "rear-right")
#: How far from the stance a target goes at an action of 1 [rad].
REACH = 0.8
TORSO_MASS, THIGH_MASS, SHANK_MASS = 8.0, 0.6, 0.3
_HALF_TORSO = (0.25, 0.06, 0.1)
_HIP = (0.2, -0.03, 0.13)
_LINK, _RADIUS = 0.2, 0.02
_BEND = 0.6
#: Height of the torso's centre in the stance [m].
HEIGHT = 2 * _LINK * math.cos(_BEND) + _RADIUS - _HIP[1]
_LOWEST, _MOST_TILT = 0.6 * HEIGHT, 0.8
_MAX_SPEED, _MAX_RATE = 0.3, 0.3
_TORSO = 1


def _turned(angle: float) -> list[float]:
    return [0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2)]


def _link(name: str, top: tuple[float, float, float], angle: float, mass: float) -> dict[str, Any]:
    """A link that hangs down from `top`, turned about z."""
    middle = [top[0] + _LINK / 2 * math.sin(angle), top[1] - _LINK / 2 * math.cos(angle), top[2]]
    return {
        "name": name,
        "shape": {"capsule": {"radius": _RADIUS, "half_height": _LINK / 2}},
        "mass": mass,
        "position": middle,
        "orientation": _turned(angle),
    }


def _servo(name: str, between: list[str], at: tuple[float, float, float]) -> dict[str, Any]:
    drive = {"axes": ["angular_x"], "position": 0, "stiffness": 80, "damping": 2, "max_force": 20}
    return {
        "name": name,
        "between": between,
        "hinge": {"at": list(at), "axis": [0, 0, 1]},
        "limits": {"angular_x": [-1.2, 1.2]},
        "drives": [drive],
    }


def scene() -> dict[str, Any]:
    """The robot on its ground, as the dict of a scene file. It looks along +x; y is up."""
    touching = {"friction": 0.8, "groups": [1], "touches": [0]}
    torso = {
        "name": "torso",
        "shape": {"cuboid": {"half_extents": list(_HALF_TORSO)}},
        "mass": TORSO_MASS,
        "position": [0, HEIGHT, 0],
        "collider": touching,
    }
    ground = {
        "name": "ground",
        "shape": {"half_space": {}},
        "fixed": True,
        "collider": {"friction": 0.8, "groups": [0]},
    }
    bodies: list[dict[str, Any]] = [ground, torso]
    joints = []
    for leg in LEGS:
        along = _HIP[0] if leg.startswith("front") else -_HIP[0]
        aside = -_HIP[2] if leg.endswith("left") else _HIP[2]
        hip = (along, HEIGHT + _HIP[1], aside)
        knee = (hip[0] - _LINK * math.sin(_BEND), hip[1] - _LINK * math.cos(_BEND), aside)
        thigh, shank = f"{leg}-thigh", f"{leg}-shank"
        bodies.append(_link(thigh, hip, -_BEND, THIGH_MASS))
        bodies.append({**_link(shank, knee, _BEND, SHANK_MASS), "collider": touching})
        joints.append(_servo(f"{leg}-hip", ["torso", thigh], hip))
        joints.append(_servo(f"{leg}-knee", [thigh, shank], knee))
    return {
        "name": "quadruped",
        "source": "Ours: sizes and weights as of a small walking robot.",
        "gravity": [0, -9.81, 0],
        "dt": 0.02,
        "contact_substeps": 8,
        "bodies": bodies,
        "joints": joints,
    }


class Quadruped(BatchEnv):
    """A robot of 11.6 kg on four legs with two servos each, on the ground, is to stay standing.

    Actions (num_envs, 8) from -1 to 1 are the targets of the servos, 0.8 rad from the stance at
    1, for 0.02 s: hip and knee of the front left leg, front right, rear left, rear right. All
    turn about z of the torso, which looks along x. A servo has 80 N m/rad and 2 N m s/rad, and
    20 N m at most.

    Observations (num_envs, 29) are position [m] and orientation (x, y, z, w) of the torso, its
    velocity [m/s] and angular velocity [rad/s] in the frame of the world, and the 8 angles [rad]
    and speeds [rad/s] of the joints, from the stance.

    It begins in the stance, pushed: all of it moves with up to 0.3 m/s along the ground and turns
    with up to 0.3 rad/s. The episode terminates where the torso is lower than 0.6 of its height
    in the stance, or tilted by more than 0.8 rad, and is truncated after 500 steps.

    The reward of a step is `1 - tilt^2 - 4 (1 - height / stance)^2 - 0.05 speed^2`, less 0.02 for
    the mean of the squares of the actions, and at least 0; where it falls, 0. `vary` changes
    masses such as `bodies.torso.mass`, and servos: `joints.rear-left-knee.drives.0.max_force`.
    """

    _view = View(middle=(0.0, 0.25), width=1.5, beside=_TORSO)

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
        high = np.array([1e3] * 3 + [1.0] * 4 + [100.0] * 6 + [np.pi] * 8 + [200.0] * 8, np.float32)
        super().__init__(
            scene(),
            num_envs,
            Box(-high, high, dtype=np.float32),
            Box(-1.0, 1.0, (8,), np.float32),
            vary=vary,
            max_episode_steps=max_episode_steps,
            render_mode=render_mode,
            autoreset_mode=autoreset_mode,
            copy=copy,
        )
        half = (0.0, _LINK / 2, 0.0), (0.0, -_LINK / 2, 0.0)
        links = range(_TORSO + 1, _TORSO + 9)
        self._parts = [Part(link, *half, _RADIUS, (90, 90, 100)) for link in links]
        self._parts.append(Part(_TORSO, (-0.2, 0, 0), (0.2, 0, 0), 0.06, (60, 90, 140)))
        self._parts.append(Part(0, (-50, -0.01, 0), (50, -0.01, 0), 0.01, (120, 120, 120)))

    def _place(self, worlds: NDArray[np.intp]) -> None:
        draws = 2.0 * self._draws(worlds, 5) - 1.0
        velocity = np.zeros((len(worlds), 1, 3))
        velocity[:, 0, 0], velocity[:, 0, 2] = _MAX_SPEED * draws[:, 0], _MAX_SPEED * draws[:, 1]
        rate = (_MAX_RATE * draws[:, 2:])[:, None]
        bodies = self.batch.positions[worlds, _TORSO:]
        arms = bodies - bodies[:, :1]
        self.batch.set_state(
            self.batch.body_names[_TORSO:],
            worlds=worlds,
            linear_velocities=velocity + np.cross(rate, arms),
            angular_velocities=np.broadcast_to(rate, arms.shape),
        )

    def _act(self, actions: NDArray[Any]) -> None:
        self.batch.set_drives(positions=REACH * actions)

    def _observe(self, out: Observations) -> None:
        out[:, :13] = self._states[:, _TORSO]
        out[:, 13:21] = self.batch.joint_values[:, :, 3]
        out[:, 21:] = self.batch.joint_speeds[:, :, 3]

    def _judge(
        self, actions: NDArray[Any]
    ) -> tuple[NDArray[np.float64], NDArray[np.bool_], dict[str, Any]]:
        seen = self._observations[:, :13].astype(np.float64)
        height, speed = seen[:, 1], np.linalg.norm(seen[:, 7:10], axis=1)
        tilt = np.arccos(np.clip(1.0 - 2.0 * (seen[:, 3] ** 2 + seen[:, 5] ** 2), -1.0, 1.0))
        fallen = (height < _LOWEST) | (tilt > _MOST_TILT)
        effort = np.mean(actions.astype(np.float64) ** 2, axis=1)
        lost = tilt**2 + 4.0 * (1.0 - height / HEIGHT) ** 2 + 0.05 * speed**2 + 0.02 * effort
        rewards = np.where(fallen, 0.0, np.maximum(1.0 - lost, 0.0))
        return rewards, fallen, {}
