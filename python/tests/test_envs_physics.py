"""The physics of the environments: equations of motion, momentum, weights."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tumble.envs import CartPole, Docking, Quadruped
from tumble.envs import docking as docking_module
from tumble.envs import quadruped as quadruped_module
from tumble.envs._vectors import rotated

Floats = NDArray[np.floating[Any]]


# The cart and its pole.


def slope(state: Floats, force: Floats, pole: float) -> Floats:
    """Barto, Sutton and Anderson (1983), without friction: x, speed, angle, angular speed."""
    cart, half, gravity = 1.0, 0.5, 9.8
    _, speed, angle, rate = state.T
    sine, cosine, total = np.sin(angle), np.cos(angle), cart + pole
    common = (force + pole * half * rate**2 * sine) / total
    turn = (gravity * sine - cosine * common) / (half * (4 / 3 - pole * cosine**2 / total))
    return np.stack([speed, common - pole * half * turn * cosine / total, rate, turn], axis=1)


def runge_kutta(state: Floats, force: Floats, pole: float, step: float) -> Floats:
    one = slope(state, force, pole)
    two = slope(state + step / 2 * one, force, pole)
    three = slope(state + step / 2 * two, force, pole)
    four = slope(state + step * three, force, pole)
    return state + step / 6 * (one + 2 * two + 2 * three + four)


@pytest.mark.parametrize("pole", [0.1, 1.5])
def test_the_cart_pole_follows_its_equations_of_motion(pole: float) -> None:
    env = CartPole(64, vary={"bodies.pole.mass": np.full(64, pole)})
    env.reset(seed=0)
    random = np.random.default_rng(4)
    expected: Floats = random.uniform([-1, -1, -0.1, -0.3], [1, 1, 0.1, 0.3], (64, 4))
    env.set_motion(expected)
    within = np.ones(64, np.bool_)
    for _ in range(25):
        # Mostly towards the side to which the pole falls, so that few end.
        towards = expected[:, 2] + 0.3 * expected[:, 3] > 0
        actions = (towards ^ (random.random(64) < 0.2)).astype(np.int64)
        observed, _, terminated, _, _ = env.step(actions)
        for _ in range(20):
            expected = runge_kutta(expected, np.where(actions == 1, 10.0, -10.0), pole, 0.001)
        assert np.abs(observed - expected)[within].max() < 1e-3
        within &= ~terminated
    assert within.sum() > 20


def test_signs_of_the_cart_pole_are_those_of_the_world() -> None:
    # The equations are the same in a mirror, so they do not notice x, angle and force reversed.
    env = CartPole(2)
    env.reset(seed=0)
    env.set_motion([[0.5, 0, 0.2, 0], [0.5, 0, 0, 0]])
    cart, pole = env.batch.body_names.index("cart"), env.batch.body_names.index("pole")
    positions = env.batch.positions
    assert np.allclose(positions[:, cart, 0], 0.5)
    assert np.allclose(positions[0, pole] - positions[0, cart], [0.0993, 0.4900, 0], atol=1e-4)
    observed, *_ = env.step(np.array([1, 1]))
    assert observed[1, 1] > 0.19 and observed[1, 3] < -0.28
    assert env.batch.positions[1, cart, 0] > 0.5
    assert env.batch.linear_velocities[1, cart, 0] == observed[1, 1]


def test_the_cart_pole_ends_past_its_bounds_and_not_before() -> None:
    env = CartPole(4, autoreset_mode="Disabled")
    env.reset(seed=0)
    env.set_motion([[2.37, 1, 0, 0], [2.39, 1, 0, 0], [0, 0, 0.20, 0.1], [0, 0, -0.205, -0.5]])
    observed, rewards, terminated, _, _ = env.step(np.array([1, 1, 1, 1]))
    assert terminated.tolist() == [False, True, False, True] and (rewards == 1).all()
    assert observed[1, 0] > 2.4 and observed[3, 2] < -np.radians(12)


def test_masses_of_each_world_are_its_own_and_last_over_episodes() -> None:
    env = CartPole(2, vary={"bodies.cart.mass": [1.0, 9.0]}, max_episode_steps=2)
    for seed in (1, None):
        start, _ = env.reset(seed=seed)
        gain = env.step(np.ones(2, np.int64))[0][:, 1] - start[:, 1]
        assert np.allclose(gain, [0.195, 0.022], atol=0.003)
    env.reset(options={"vary": {"bodies.cart.mass": [9.0, 1.0]}})
    start, _ = env.reset()
    gain = env.step(np.ones(2, np.int64))[0][:, 1] - start[:, 1]
    assert gain[0] < 0.03 and gain[1] > 0.18


# The spacecraft.


def controller(observed: Floats, masses: Floats) -> NDArray[np.float32]:
    """Springs and dampers to the port, within what the nozzles can do."""
    observed = observed.astype(np.float64)
    position, turn, velocity = observed[:, :3], observed[:, 3:7], observed[:, 7:10]
    back = turn * [-1, -1, -1, 1]
    force = rotated(back, masses[:, None] * (-0.05 * position - 0.4 * velocity))
    torque = -2.0 * 2.0 * turn[:, :3] - 15.0 * rotated(back, observed[:, 10:])
    force /= docking_module.MAX_FORCE
    force /= np.maximum(1.0, np.abs(force).max(axis=1, keepdims=True))
    return np.hstack([force, torque / docking_module.MAX_TORQUE]).astype(np.float32)


def test_a_controller_docks_in_all_worlds_and_is_rewarded_for_it() -> None:
    masses = np.random.default_rng(2).uniform(70, 140, 64)
    env = Docking(64, vary={"bodies.craft.mass": masses}, autoreset_mode="SameStep")
    observed, _ = env.reset(seed=7)
    distance = np.linalg.norm(observed[:, :3], axis=1)
    assert distance.min() >= 4 and distance.max() <= 8 and (observed[:, 6] >= 0).all()
    docked, running = np.zeros(64, np.bool_), np.ones(64, np.bool_)
    returns = np.zeros(64)
    while running.any():
        observed, rewards, terminated, truncated, infos = env.step(controller(observed, masses))
        returns += rewards * running
        ended = running & (terminated | truncated)
        if ended.any():
            docked |= ended & infos["final_info"]["docked"]
            assert not (ended & infos["_docked"]).any()
        running &= ~ended
    assert docked.all()
    # What the way and the turn were worth, the prize, and little for fuel.
    assert returns.min() > 10 + 4 / 8 - 0.1 and returns.max() < 10 + 1 + 1


def test_the_reward_of_docking_is_the_way_that_was_made_less_the_fuel() -> None:
    def left(observed: Floats) -> Floats:
        angle = 2 * np.arccos(np.clip(observed[:, 6], -1, 1))
        distance: Floats = np.linalg.norm(observed[:, :3], axis=1)
        return distance / 8 + angle / np.pi

    env = Docking(16, max_episode_steps=5)
    env.action_space.seed(1)
    before, _ = env.reset(seed=2)
    for step in range(20):
        actions = env.action_space.sample()
        after, rewards, *_ = env.step(actions)
        expected = left(before) - left(after) - 0.001 * (actions**2).mean(axis=1)
        begins = step % 6 == 5
        assert np.abs(rewards - (0 if begins else expected)).max() < 2e-5
        before = after


def test_a_craft_adrift_is_too_far_and_loses() -> None:
    env = Docking(8)
    env.reset(seed=3)
    away = np.zeros((8, 6), np.float32)
    away[:, 0] = 1
    lost, returns = np.zeros(8, np.bool_), np.zeros(8)
    for _ in range(300):
        _, rewards, terminated, _, infos = env.step(away)
        returns += rewards * ~lost
        lost |= terminated & ~infos["docked"]
    assert lost.all() and returns.max() < -10.5


def test_a_force_changes_momentum_by_itself_times_time() -> None:
    masses = np.linspace(50, 200, 16)
    env = Docking(16, vary={"bodies.craft.mass": masses})
    start, _ = env.reset(seed=9)
    turn = np.tile([0, 0, np.sin(0.4), np.cos(0.4)], (16, 1))[:, None]
    env.batch.set_state("craft", orientations=turn, angular_velocities=[0, 0, 0])
    push = np.zeros((16, 6), np.float32)
    push[:, :3] = [0.5, -3.0, 0.25]
    for _ in range(10):
        observed, *_ = env.step(push)
    # 10 N, -20 N, the most, and 5 N along axes that are turned by 0.8 rad about z, for 1 s.
    force = [10 * np.cos(0.8) + 20 * np.sin(0.8), 10 * np.sin(0.8) - 20 * np.cos(0.8), 5]
    gained = (observed - start)[:, 7:10] * masses[:, None]
    assert np.abs(gained - force).max() < 2e-3


def test_a_torque_about_an_axis_of_the_craft_turns_it_by_its_moment() -> None:
    env = Docking(3)
    env.reset(seed=9)
    env.batch.set_state("craft", orientations=[0, 0, 0, 1], angular_velocities=[0, 0, 0])
    actions = np.zeros((3, 6), np.float32)
    actions[[0, 1, 2], [3, 4, 5]] = 1
    observed, *_ = env.step(actions)
    squares = np.array([0.6, 0.4, 0.5]) ** 2
    moments = 100 / 3 * (squares.sum() - squares)
    assert np.allclose(observed[:, 10:], np.diag(4.0 / moments * 0.1), atol=1e-5)


# The robot on legs.


def test_a_robot_stands_for_ten_seconds_whatever_pushed_it() -> None:
    env = Quadruped(32, max_episode_steps=500)
    observed, _ = env.reset(seed=3)
    assert np.abs(observed[:, 7:10]).max() > 0.2 and np.abs(observed[:, 10:13]).max() > 0.2
    still, total = np.zeros((32, 8), np.float32), np.zeros(32)
    for step in range(500):
        observed, rewards, terminated, truncated, _ = env.step(still)
        assert not terminated.any() and truncated.all() == (step == 499)
        total += rewards
    assert np.abs(observed[:, 7:13]).max() < 0.01 and total.min() > 490
    assert np.abs(observed[:, 1] - quadruped_module.HEIGHT).max() < 0.01


def test_hips_and_knees_carry_the_weight_that_is_above_them() -> None:
    torsos = np.array([4.0, 8.0, 12.0])
    env = Quadruped(3, vary={"bodies.torso.mass": torsos})
    env.reset(seed=3)
    for _ in range(250):
        env.step(np.zeros((3, 8), np.float32))
    names = env.batch.joint_names
    hips = [i for i, name in enumerate(names) if name.endswith("hip")]
    knees = [i for i, name in enumerate(names) if name.endswith("knee")]
    forces = env.batch.joint_forces.astype(np.float64)
    assert np.allclose(forces[:, hips].sum(axis=1)[:, 1], -torsos * 9.81, rtol=0.01)
    above = torsos + 4 * quadruped_module.THIGH_MASS
    assert np.allclose(forces[:, knees].sum(axis=1)[:, 1], -above * 9.81, rtol=0.01)


def test_without_force_in_its_servos_a_robot_falls() -> None:
    joints = [f"{leg}-{part}" for leg in quadruped_module.LEGS for part in ("hip", "knee")]
    servos = [f"joints.{joint}.drives.0.max_force" for joint in joints]
    limp = np.array([0.0, 20.0, 0.0, 20.0])
    env = Quadruped(4, vary={servo: limp for servo in servos}, autoreset_mode="Disabled")
    env.reset(seed=1)
    for _ in range(60):
        _, rewards, terminated, _, _ = env.step(np.zeros((4, 8), np.float32))
        if terminated.any():
            break
    assert terminated.tolist() == [True, False, True, False]
    assert (rewards[limp == 0] == 0).all() and (rewards[limp > 0] > 0.9).all()


def test_a_robot_that_is_tilted_has_fallen_however_high_it_is() -> None:
    env = Quadruped(3)
    env.reset(seed=1)
    half = np.array([0.3, 0.65, 0.65])
    zero = np.zeros(3)
    turns = np.stack([np.sin(half) * [1, 1, 0], zero, np.sin(half) * [0, 0, 1], np.cos(half)], 1)
    env.batch.set_state("torso", positions=[0, 1, 0], orientations=turns[:, None])
    _, rewards, terminated, *_ = env.step(np.zeros((3, 8), np.float32))
    assert terminated.tolist() == [False, True, True] and (rewards[1:] == 0).all()


def test_an_action_moves_the_servo_it_is_for() -> None:
    env = Quadruped(8)
    env.reset(seed=1)
    assert [name.split(".")[0] for name in env.batch.drive_names] == env.batch.joint_names
    assert env.batch.joint_names[1:3] == ["front-left-knee", "front-right-hip"]
    actions = (0.4 * np.eye(8)).astype(np.float32)
    env.step(actions)
    assert np.allclose(env.batch.drive_positions, quadruped_module.REACH * actions)
    # A hip waits until its foot, which friction holds, lets go.
    for _ in range(39):
        observed, *_ = env.step(actions)
    assert (observed[:, 13:21].argmax(axis=1) == np.arange(8)).all()
