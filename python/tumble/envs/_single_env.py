"""One world of a vector environment as an environment of its own."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from .._errors import ArgumentError
from ._base import BatchEnv


class Single(gymnasium.Env[NDArray[np.float32], Any]):
    """A `gymnasium.Env` of a vector environment with one world and `AutoresetMode.DISABLED`.

    Observations are float32 arrays of its `single_observation_space`; with the same seed they have
    the bits of world 0 of a vector environment of any size. Raises `tumble.ArgumentError` for any
    other vector environment.
    """

    def __init__(self, vector: BatchEnv) -> None:
        if vector.num_envs != 1:
            raise ArgumentError(f"vector: one world is needed, not {vector.num_envs}", "vector")
        if vector.autoreset_mode is not AutoresetMode.DISABLED:
            raise ArgumentError("vector: AutoresetMode.DISABLED is needed", "vector")
        self.vector = vector
        self.metadata = {k: v for k, v in vector.metadata.items() if k != "autoreset_mode"}
        self.render_mode = vector.render_mode
        self.observation_space = vector.single_observation_space
        self.action_space = vector.single_action_space

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins an episode; see `BatchEnv.reset`, of whose options there is no `reset_mask`."""
        super().reset(seed=seed)
        self.vector.np_random = self.np_random
        if seed is not None:
            self.vector.forget_starts()
        observations, infos = self.vector.reset(options=options)
        return observations[0].copy(), _of_one(infos)

    def step(
        self, action: Any
    ) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Takes one step: observation, reward, terminated, truncated, info."""
        actions = np.asarray(action)[None]
        observations, rewards, terminated, truncated, infos = self.vector.step(actions)
        ends = bool(terminated[0]), bool(truncated[0])
        return observations[0].copy(), float(rewards[0]), *ends, _of_one(infos)

    def render(self) -> Any:
        """A picture of the world (height, width, 3) in uint8, with `render_mode="rgb_array"`."""
        frames = self.vector.render()
        return None if frames is None else frames[0]

    def close(self) -> None:
        """Frees the world; every further step is an error."""
        self.vector.close()


def _of_one(infos: dict[str, Any]) -> dict[str, Any]:
    """The infos of world 0, without the masks that say which worlds have one."""
    return {key: value[0].item() for key, value in infos.items() if not key.startswith("_")}
