"""The environments: Gymnasium's rules, the same bits from a seed, and the example."""

from __future__ import annotations

import subprocess
import sys
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

import tumble
from tumble.envs import BatchEnv, CartPole, Docking, Quadruped, Single
from tumble.envs._starts import uniform

Make = Callable[..., BatchEnv]
ALL: list[Make] = [CartPole, Docking, Quadruped]
NAMES = ["CartPole", "Docking", "Quadruped"]


@pytest.fixture
def any_threads() -> Iterator[None]:
    before = tumble.threads()
    yield
    tumble.set_threads(before)


def played(env: BatchEnv, seed: int, steps: int) -> list[Any]:
    """All that an environment returns in some steps, with actions that follow from the seed."""
    env.action_space.seed(seed)
    found: list[Any] = [env.reset(seed=seed)[0]]
    for _ in range(steps):
        found.extend(env.step(env.action_space.sample())[:4])
    return found


def same_bits(one: list[Any], other: list[Any]) -> bool:
    return all(a.tobytes() == b.tobytes() for a, b in zip(one, other, strict=True))


# Gymnasium's rules.


@pytest.mark.parametrize("name", NAMES)
def test_the_checker_of_gymnasium_passes_without_warnings(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(f"tumble/{name}-v0").unwrapped)
        check_env(gymnasium.make(f"tumble/{name}-v0", render_mode="rgb_array").unwrapped)


@pytest.mark.parametrize("name", NAMES)
def test_make_vec_makes_each_environment_in_each_way(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for mode in ("vector_entry_point", "sync"):
            envs = gymnasium.make_vec(f"tumble/{name}-v0", num_envs=3, vectorization_mode=mode)
            observations, infos = envs.reset(seed=1)
            assert envs.observation_space.contains(observations) and infos == {}
            observations, rewards, *ends, _ = envs.step(envs.action_space.sample())
            assert envs.observation_space.contains(observations)
            assert rewards.dtype == np.float64 and rewards.shape == (3,)
            assert all(end.dtype == np.bool_ and end.shape == (3,) for end in ends)
            envs.close()


def test_the_limit_of_steps_is_that_of_make_vec_and_make() -> None:
    envs = gymnasium.make_vec("tumble/Quadruped-v0", num_envs=2, max_episode_steps=3)
    env = gymnasium.make("tumble/Quadruped-v0", max_episode_steps=3)
    envs.reset(seed=1), env.reset(seed=1)
    still = np.zeros((2, 8), np.float32)
    assert [bool(envs.step(still)[3].all()) for _ in range(3)] == [False, False, True]
    assert [env.step(still[0])[3] for _ in range(3)] == [False, False, True]
    full = gymnasium.make_vec("tumble/CartPole-v0").unwrapped
    assert isinstance(full, CartPole) and full.max_episode_steps == 500


def test_an_environment_that_ended_begins_in_the_next_step_and_ignores_its_action() -> None:
    env = CartPole(3, max_episode_steps=4)
    assert env.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    first, _ = env.reset(seed=5)
    ones = np.ones(3, np.int64)
    for _ in range(3):
        assert not env.step(ones)[3].any()
    last, rewards, terminated, truncated, _ = env.step(ones)
    assert truncated.all() and not terminated.any() and (rewards == 1).all()
    assert (np.abs(last) > 0.05).any(axis=1).all()
    begun, rewards, terminated, truncated, _ = env.step(ones)
    assert (np.abs(begun) <= 0.05).all() and (begun != first).all()
    assert not (rewards.any() or terminated.any() or truncated.any())
    assert not any(env.step(ones)[3].any() for _ in range(3)) and env.step(ones)[3].all()


def test_same_step_gives_the_last_observation_and_begins_at_once() -> None:
    env = CartPole(2, max_episode_steps=2, autoreset_mode=AutoresetMode.SAME_STEP)
    next_step = CartPole(2, max_episode_steps=2)
    env.reset(seed=3), next_step.reset(seed=3)
    ones = np.ones(2, np.int64)
    env.step(ones), next_step.step(ones)
    begun, _, _, truncated, infos = env.step(ones)
    last = next_step.step(ones)[0]
    assert truncated.all() and infos["_final_obs"].all() and infos["_final_info"].all()
    assert np.stack(infos["final_obs"]).tobytes() == last.tobytes()
    assert begun.tobytes() == next_step.step(ones)[0].tobytes()


def test_without_autoreset_worlds_begin_where_the_mask_says() -> None:
    env = CartPole(3, max_episode_steps=2, autoreset_mode="Disabled")
    ones = np.ones(3, np.int64)
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(ones)
    env.reset(seed=3)
    env.step(ones)
    last = env.step(ones)[0]
    with pytest.raises(gymnasium.error.ResetNeeded, match="0, 1, 2"):
        env.step(ones)
    mask = np.array([True, False, True])
    mixed, _ = env.reset(options={"reset_mask": mask})
    assert (mixed[1] == last[1]).all() and (mixed[mask] != last[mask]).all()
    none, _ = env.reset(options={"reset_mask": np.zeros(3, np.bool_)})
    assert none.tobytes() == mixed.tobytes()
    with pytest.raises(gymnasium.error.ResetNeeded, match=r"\[1\]"):
        env.step(ones)


def test_a_step_returns_arrays_of_its_own_unless_asked_not_to_copy() -> None:
    env, sharing = CartPole(2), CartPole(2, copy=False)
    assert env.reset(seed=1)[0] is not env.step(np.ones(2, np.int64))[0]
    kept, _ = env.reset(seed=1)
    before = kept.copy()
    env.step(np.ones(2, np.int64))
    assert (kept == before).all()
    assert sharing.reset(seed=1)[0] is sharing.step(np.ones(2, np.int64))[0]


@pytest.mark.parametrize(
    "make, actions, text",
    [
        (CartPole, np.zeros(3, np.int64), r"actions: shape \(2,\) is needed, not \(3,\)"),
        (CartPole, np.zeros(2, np.float32), "actions: integers are needed, not dtype float32"),
        (CartPole, np.array([0, 2]), "actions: 2 at index .1,. is not 0 to 1"),
        (Docking, np.zeros(6, np.float32), r"actions: shape \(2, 6\) is needed, not \(6,\)"),
        (Docking, np.zeros((2, 6), np.complex64), "actions: numbers are needed, not dtype complex"),
        (Quadruped, np.full((2, 8), np.nan), r"actions: nan at index \(0, 0\) is not a finite"),
        (Quadruped, np.full((2, 8), "x"), "actions: numbers are needed, not dtype <U1"),
    ],
)
def test_wrong_actions_are_refused_by_name(make: Make, actions: NDArray[Any], text: str) -> None:
    env = make(num_envs=2)
    observations, _ = env.reset(seed=1)
    with pytest.raises(tumble.ArgumentError, match=text) as raised:
        env.step(actions)
    assert raised.value.field == "actions"
    assert (env.batch.steps == 0).all()


def test_wrong_settings_and_options_are_refused_by_name() -> None:
    for settings, field in [
        ({"render_mode": "human"}, "render_mode"),
        ({"max_episode_steps": 0}, "max_episode_steps"),
        ({"autoreset_mode": "Never"}, "autoreset_mode"),
        ({"num_envs": 0}, "worlds"),
        ({"vary": {"bodies.cart.mess": [1.0]}}, 'vary["bodies.cart.mess"]'),
    ]:
        with pytest.raises(tumble.ArgumentError) as raised:
            CartPole(**settings)  # type: ignore[arg-type]
        assert raised.value.field == field
    env = CartPole(2)
    env.reset(seed=1)
    wrong: list[dict[str, Any]] = [{"lower": 1}, {"low": 1, "high": 0}, {"low": "a"}]
    for options in [*wrong, {"reset_mask": [True]}, {"reset_mask": 1}]:
        with pytest.raises(tumble.ArgumentError, match="options"):
            env.reset(options=options)
    with pytest.raises(tumble.ArgumentError, match="one world is needed, not 2"):
        Single(env)


def test_a_closed_environment_says_so() -> None:
    env = CartPole(2)
    env.reset(seed=1)
    assert repr(env) == "CartPole(num_envs=2)"
    env.close()
    env.close()
    with pytest.raises(gymnasium.error.ClosedEnvironmentError, match=r"CartPole\(num_envs=2\)"):
        env.step(np.ones(2, np.int64))


def test_without_gymnasium_the_import_says_what_to_install() -> None:
    text = (
        "import sys; sys.modules['gymnasium'] = None; import tumble\n"
        "assert 'tumble.envs' not in sys.modules\n"
        "try: import tumble.envs\n"
        "except ImportError as error: print(error)"
    )
    run = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True)
    assert "pip install tumble[envs]" in run.stdout


def test_observations_stay_in_their_space() -> None:
    env = Docking(2)
    env.reset(seed=1)
    env.batch.set_state("craft", positions=[0, 900, 0], linear_velocities=[-300, 0, 0])
    observed, _, terminated, *_ = env.step(np.full((2, 6), 7.0))
    assert env.observation_space.contains(observed) and terminated.all()
    assert observed[0, 1] == 50 and observed[0, 7] == -50


@pytest.mark.parametrize("make", ALL)
def test_pictures_show_the_bodies_and_change_as_they_move(make: Make) -> None:
    env = make(num_envs=2, render_mode="rgb_array")
    env.action_space.seed(1)
    env.reset(seed=1)
    first = env.render()
    for _ in range(10):
        env.step(env.action_space.sample())
    then = env.render()
    assert first is not None and then is not None and len(first) == 2
    assert first[0].shape == (320, 480, 3) and first[0].dtype == np.uint8
    background = (first[0] == first[0][0, 0]).all(axis=2).mean()
    assert 0.5 < background < 0.995 and (first[0] != then[0]).any()


# Seeds.


@pytest.mark.parametrize("make", ALL)
def test_a_seed_gives_the_same_bits_with_any_number_of_threads(
    make: Make, any_threads: None
) -> None:
    found = []
    for threads in (1, 2, 5):
        tumble.set_threads(threads)
        found.append(played(make(num_envs=24), seed=11, steps=40))
    again = make(num_envs=24)
    played(again, seed=4, steps=25)
    found.append(played(again, seed=11, steps=40))
    assert all(same_bits(found[0], other) for other in found[1:])
    assert not same_bits(found[0], played(again, seed=12, steps=40))


@pytest.mark.parametrize("make", ALL)
def test_a_world_has_the_same_bits_whatever_others_there_are(make: Make) -> None:
    few, many = make(num_envs=2), make(num_envs=9)
    alone = Single(make(num_envs=1, autoreset_mode="Disabled"))
    several = [few.reset(seed=2)[0], many.reset(seed=2)[0]]
    single = alone.reset(seed=2)[0]
    many.action_space.seed(3)
    ends = 0
    for _ in range(60):
        assert several[0].tobytes() == several[1][:2].tobytes()
        assert single.tobytes() == several[0][0].tobytes() or ends
        actions = many.action_space.sample()
        several = [few.step(actions[:2])[0], many.step(actions)[0]]
        if not ends:
            single, _, terminated, truncated, _ = alone.step(actions[0])
            ends += terminated or truncated


def test_without_a_seed_each_reset_goes_on_from_the_last() -> None:
    one, other = CartPole(3), CartPole(3)
    starts = [[env.reset(seed=1)[0], env.reset()[0], env.reset()[0]] for env in (one, other)]
    assert same_bits(*starts)
    assert not (starts[0][0] == starts[0][1]).any() and not (starts[0][1] == starts[0][2]).any()


def test_a_seed_for_some_worlds_leaves_the_episodes_of_others_as_they_are() -> None:
    env, other = CartPole(3, max_episode_steps=1), CartPole(3, max_episode_steps=1)
    ones, first = np.ones(3, np.int64), np.array([True, False, False])
    env.reset(seed=1), other.reset(seed=1)
    begun, _ = env.reset(seed=9, options={"reset_mask": first})
    assert (begun[0] == CartPole(1).reset(seed=9)[0][0]).all()
    for _ in range(2):
        here, there = env.step(ones)[0], other.step(ones)[0]
        assert (here[1:] == there[1:]).all() and (here[0] != there[0]).all()


def test_starts_are_even_and_independent() -> None:
    worlds = np.arange(20_000, dtype=np.uint64)
    draws = uniform(np.full_like(worlds, 7), worlds, np.zeros_like(worlds), 4)
    later = uniform(np.full_like(worlds, 7), worlds, np.ones_like(worlds), 4)
    both = np.hstack([draws, later])
    assert both.min() >= 0 and both.max() < 1
    assert np.abs(both.mean(axis=0) - 0.5).max() < 0.01
    assert np.abs(both.var(axis=0) - 1 / 12).max() < 0.002
    assert np.abs(np.corrcoef(both.T) - np.eye(8)).max() < 0.03


def test_options_of_the_cart_pole_say_how_wide_it_begins() -> None:
    observations, _ = CartPole(200).reset(seed=1, options={"low": 0.1, "high": 0.2})
    assert observations.min() > 0.0999 and observations.max() < 0.2001
    assert observations.min() < 0.101 and observations.max() > 0.199


# The example.


def test_the_example_learns_to_balance(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(Path(__file__).parents[1] / "examples"))
    import cartpole

    assert cartpole.main(seed=1, worlds=256) >= 475


def test_a_start_does_not_depend_on_which_worlds_were_reset_before() -> None:
    def start_of_the_second(before: list[bool] | None) -> np.ndarray[Any, Any]:
        env = CartPole(2, autoreset_mode="Disabled")
        env.reset(seed=1)
        if before:
            env.reset(options={"reset_mask": np.array(before)})
        return env.reset(options={"reset_mask": np.array([False, True])})[0][1]

    assert np.array_equal(start_of_the_second(None), start_of_the_second([True, False]))
    assert not np.array_equal(start_of_the_second(None), start_of_the_second([False, True]))


def test_a_reset_that_is_refused_changes_nothing() -> None:
    env, other = CartPole(3), CartPole(3)
    for one in (env, other):
        one.reset(seed=4)
    for options in ({"low": -1e20, "high": -1e20}, {"vary": {"nothing": [1, 2, 3]}}):
        with pytest.raises(tumble.ArgumentError):
            env.reset(options=options)
    assert np.array_equal(env.reset()[0], other.reset()[0])
