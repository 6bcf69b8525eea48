"""What the environments have in common: worlds, seeds, episodes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
from gymnasium.error import ClosedEnvironmentError, ResetNeeded
from gymnasium.spaces import Box, Discrete
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import ArrayLike, NDArray

from .. import Batch
from .._errors import ArgumentError
from ._picture import Part, View, draw
from ._starts import uniform

if TYPE_CHECKING:
    from ._single_env import Single

Observations = NDArray[np.float32]
Step = tuple[
    Observations, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]
]


class BatchEnv(VectorEnv[Observations, NDArray[Any], NDArray[Any]]):
    """A vector environment of which each environment is a world of one `tumble.Batch`.

    A subclass says what a world is made of and gives `_act`, `_place`, `_observe` and `_judge`.

    `vary` has fields of the scene by their paths, each with a number for every world, as for
    `tumble.Batch`: `{"bodies.cart.mass": masses}`. `max_episode_steps` truncates episodes; `None`
    does not. `autoreset_mode` is one of Gymnasium's: with `NEXT_STEP` an environment that has
    ended begins again in the next step, which ignores its action and has reward 0; with
    `SAME_STEP` at once, with the last observation in `infos["final_obs"]`; with `DISABLED` only
    by `reset(options={"reset_mask": mask})`. Without `copy` a step returns the same array of
    observations each time.

    Observations are float32 (num_envs, n), clipped to `observation_space`. Rewards are float64
    (num_envs,). Continuous actions outside of -1 to 1 are clipped.

    A start depends on the seed, on the index of its world and on how many episodes the world has
    had since: not on `num_envs`, nor on other worlds, nor on `tumble.set_threads`.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 50}

    #: Steps of the engine for each step of the environment.
    _engine_steps = 1
    #: Keys of `options` beside `reset_mask` and `vary`.
    _option_names: frozenset[str] = frozenset()
    _parts: list[Part]
    _view: View

    def __init__(
        self,
        scene: dict[str, Any],
        num_envs: int,
        observation_space: Box,
        action_space: Box | Discrete,
        *,
        vary: Mapping[str, ArrayLike] | None = None,
        max_episode_steps: int | None = None,
        render_mode: str | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        copy: bool = True,
    ) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            problem = f"render_mode: rgb_array or None is needed, not {render_mode!r}"
            raise ArgumentError(problem, "render_mode")
        if max_episode_steps is not None and max_episode_steps < 1:
            problem = f"max_episode_steps: 1 at least is needed, not {max_episode_steps}"
            raise ArgumentError(problem, "max_episode_steps")
        modes = [mode.value for mode in AutoresetMode]
        if autoreset_mode not in (*AutoresetMode, *modes):
            problem = f"autoreset_mode: one of {modes} is needed, not {autoreset_mode!r}"
            raise ArgumentError(problem, "autoreset_mode")
        self._batch: Batch | None = Batch(scene, num_envs, vary=dict(vary) if vary else None)
        self.num_envs = num_envs
        self.max_episode_steps = max_episode_steps
        self.render_mode = render_mode
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.metadata = {**self.metadata, "autoreset_mode": self.autoreset_mode}
        self.single_observation_space = observation_space
        self.single_action_space = action_space
        self.observation_space = batch_space(observation_space, num_envs)
        self.action_space = batch_space(action_space, num_envs)
        self._copy = copy
        self._low, self._high = observation_space.low, observation_space.high
        self._states = np.zeros((num_envs, len(self.batch.body_names), 13), np.float32)
        self._observations = np.zeros((num_envs, *observation_space.shape), np.float32)
        self._elapsed = np.zeros(num_envs, np.int64)
        self._ended = np.zeros(num_envs, np.bool_)
        self._was_reset = False
        self._keys = np.zeros(num_envs, np.uint64)
        self._episodes = np.zeros(num_envs, np.uint64)

    @classmethod
    def single(cls, **settings: Any) -> Single:
        """One world as a `gymnasium.Env`, with the same arguments but `num_envs`."""
        from ._single_env import Single

        return Single(cls(1, autoreset_mode=AutoresetMode.DISABLED, **settings))  # type: ignore

    @property
    def batch(self) -> Batch:
        """The worlds. Raises `gymnasium.error.ClosedEnvironmentError` after `close`."""
        if self._batch is None:
            raise ClosedEnvironmentError(f"{self} is closed")
        return self._batch

    # What a subclass gives.

    def _act(self, actions: NDArray[Any]) -> None:
        """Lets the actions, which are checked and clipped, act on the worlds."""
        raise NotImplementedError

    def _place(self, worlds: NDArray[np.intp]) -> None:
        """Brings worlds, which are as the scene has them, to their starts."""
        raise NotImplementedError

    def _observe(self, out: Observations) -> None:
        """Writes the observations of all worlds, of which `_states` are read."""
        raise NotImplementedError

    def _judge(
        self, actions: NDArray[Any]
    ) -> tuple[NDArray[np.float64], NDArray[np.bool_], dict[str, Any]]:
        """Rewards, whether episodes terminate, and infos, each (num_envs,)."""
        raise NotImplementedError

    def _begin(self, worlds: NDArray[np.bool_]) -> None:
        """Is called where episodes begin, after `_observe`."""

    def _configure(self, options: dict[str, Any]) -> None:
        """Takes the options of `reset` that are the environment's own."""

    # What Gymnasium calls.

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, dict[str, Any]]:
        """Begins episodes: observations (num_envs, n) and infos.

        `options` may have `reset_mask`, booleans (num_envs,) of the worlds to begin again, all
        unless given, and `vary`, with numbers for each of these worlds in place of those that the
        environment was made with. Raises `tumble.ArgumentError` for others.
        """
        batch, options = self.batch, options or {}
        unknown = set(options) - self._option_names - {"reset_mask", "vary"}
        if unknown:
            raise ArgumentError(f"options: there is no {min(unknown)!r}", "options")
        mask = self._checked_mask(options.get("reset_mask"))
        self._configure(options)
        super().reset(seed=seed)
        kept = self._keys.copy(), self._episodes.copy()
        # Without a seed a world goes on with its own starts, whatever the others do.
        if seed is not None or not self._was_reset:
            self._keys[mask] = self.np_random.integers(0, 2**64, dtype=np.uint64)
            self._episodes[mask] = 0
        try:
            self._restart(mask, options.get("vary"))
        except ArgumentError:
            self._keys, self._episodes = kept
            raise
        batch.read_states(self._states)
        self._look()
        self._begin(mask)
        self._was_reset = True
        return self._seen(), {}

    def step(self, actions: NDArray[Any]) -> Step:
        """Takes a step in every world: observations, rewards, terminations, truncations, infos.

        Raises `tumble.ArgumentError` if `actions` have a wrong shape or type or are impossible,
        and `gymnasium.error.ResetNeeded` before the first `reset`.
        """
        batch, given = self.batch, self._checked(actions)
        if not self._was_reset:
            raise ResetNeeded("reset is needed before the first step")
        again = self._ended
        if self.autoreset_mode is AutoresetMode.DISABLED and again.any():
            raise ResetNeeded(f"reset is needed: {np.flatnonzero(again).tolist()} have ended")
        self._act(given)
        batch.step(self._engine_steps)
        self._elapsed += 1
        restarts = bool(again.any())
        if restarts:
            self._restart(again)
        batch.read_states(self._states)
        self._look()
        rewards, terminated, infos = self._judge(given)
        limit = self.max_episode_steps
        truncated = np.zeros_like(terminated) if limit is None else self._elapsed >= limit
        if restarts:
            rewards[again], terminated[again], truncated[again] = 0.0, False, False
            self._begin(again)
        self._ended = terminated | truncated
        if self.autoreset_mode is AutoresetMode.SAME_STEP and self._ended.any():
            infos = self._begin_at_once(infos)
        return self._seen(), rewards, terminated, truncated, infos

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """A picture (320, 480, 3) of each world, seen along -z; `None` without a render mode."""
        if self.render_mode is None:
            gymnasium.logger.warn('render needs render_mode="rgb_array"')
            return None
        states = self.batch.states
        return tuple(draw(world, self._parts, self._view) for world in states)

    def close_extras(self, **kwargs: Any) -> None:
        """Frees the worlds; every further step is an error."""
        self._batch = None

    def forget_starts(self) -> None:
        """Lets the next `reset` draw its starts from `np_random`, as one with a seed does."""
        self._was_reset = False

    # The course of episodes.

    def _restart(self, mask: NDArray[np.bool_], vary: Any = None) -> None:
        """Makes worlds again, so that nothing is left of what was before, and places them."""
        self.batch.reset(mask, vary=vary)
        worlds = np.flatnonzero(mask)
        self._place(worlds)
        self._elapsed[mask] = 0
        self._ended = self._ended & ~mask
        self._episodes[mask] += np.uint64(1)

    def _begin_at_once(self, infos: dict[str, Any]) -> dict[str, Any]:
        """Begins the episodes that have ended, and says in the infos how these ended."""
        ended = self._ended
        finals = np.full(self.num_envs, None, dtype=object)
        for world in np.flatnonzero(ended):
            finals[world] = self._observations[world].copy()
        said = {key: value & ended if key[0] == "_" else value for key, value in infos.items()}
        running = {key: value & ~ended if key[0] == "_" else value for key, value in infos.items()}
        self._restart(ended)
        self.batch.read_states(self._states)
        self._look()
        self._begin(ended)
        last = {"final_obs": finals, "final_info": said}
        return {**running, **last, "_final_obs": ended, "_final_info": ended.copy()}

    def _draws(self, worlds: NDArray[np.intp], count: int) -> NDArray[np.float64]:
        """Numbers in [0, 1) for the starts of worlds (n,): (n, count)."""
        indices = worlds.astype(np.uint64)
        return uniform(self._keys[worlds], indices, self._episodes[worlds], count)

    def _look(self) -> None:
        self._observe(self._observations)
        np.clip(self._observations, self._low, self._high, out=self._observations)

    def _seen(self) -> Observations:
        return self._observations.copy() if self._copy else self._observations

    # What is wrong with arguments.

    def _checked(self, actions: NDArray[Any]) -> NDArray[Any]:
        given, shape = np.asarray(actions), self.action_space.shape
        if given.shape != shape:
            raise ArgumentError(f"actions: shape {shape} is needed, not {given.shape}", "actions")
        space = self.single_action_space
        kinds, needed = ("iu", "integers") if isinstance(space, Discrete) else ("fiu", "numbers")
        if given.dtype.kind not in kinds:
            problem = f"actions: {needed} are needed, not dtype {given.dtype}"
            raise ArgumentError(problem, "actions")
        if isinstance(space, Discrete):
            wrong = (given < 0) | (given >= space.n)
            rule = f"0 to {space.n - 1}"
        else:
            wrong = ~np.isfinite(given)
            rule = "a finite number"
        if wrong.any():
            at = tuple(int(index) for index in np.argwhere(wrong)[0])
            problem = f"actions: {given[at]} at index {at} is not {rule}"
            raise ArgumentError(problem, "actions")
        if isinstance(space, Discrete):
            return given
        clipped: Observations = np.clip(given, -1.0, 1.0).astype(np.float32)
        return clipped

    def _checked_mask(self, mask: Any) -> NDArray[np.bool_]:
        if mask is None:
            return np.ones(self.num_envs, np.bool_)
        given = np.asarray(mask)
        if given.dtype != np.bool_ or given.shape != (self.num_envs,):
            found = f"dtype {given.dtype} and shape {given.shape}"
            problem = f"options: reset_mask needs ({self.num_envs},) booleans, not {found}"
            raise ArgumentError(problem, "options")
        if not self._was_reset and not given.all():
            raise ResetNeeded("the first reset needs all worlds")
        return given.copy()
