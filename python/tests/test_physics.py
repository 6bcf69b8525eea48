"""Promise: forces do what mechanics says, with the right sign, for all masses, sizes and time steps."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from models import box, box_at_rest, floating, mixed, moments, still

STEPS = 40
DTS = [1 / 10, 1 / 60, 1 / 240]
Draw = tuple[float, NDArray[np.float64], float]


@pytest.fixture(params=range(12))
def draw(request: pytest.FixtureRequest) -> Draw:
    """A mass of 1 mg to 1000 t, half extents around 1 cm to 100 m, and a time step."""
    random = np.random.default_rng(request.param)
    mass = 10.0 ** random.uniform(-6, 6)
    half_extents = 10.0 ** random.uniform(-2, 2) * random.uniform(0.5, 1.5, 3)
    return mass, half_extents, DTS[request.param % 3]


def made(lib: ModuleType, draw: Draw, **more: object) -> Any:
    mass, half_extents, dt = draw
    model = still()
    model["bodies"] = [box("box", half_extents.tolist(), mass, **more)]
    return lib.Simulation(model, dt=dt)


def turned(axis: NDArray[np.float64], angle: float) -> tuple[list[float], NDArray[np.float64]]:
    """A quaternion x, y, z, w about an axis, and its matrix."""
    x, y, z = axis = axis / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    matrix = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return [*(np.sin(angle / 2) * axis), np.cos(angle / 2)], matrix


def rotated(quaternion: ArrayLike, vector: NDArray[np.float64]) -> NDArray[np.float64]:
    """A vector, turned by a quaternion x, y, z, w."""
    x, y, z, w = np.asarray(quaternion, np.float64)
    first = 2 * np.cross([x, y, z], vector)
    return np.asarray(vector + w * first + np.cross([x, y, z], first))


def close(found: ArrayLike, wanted: ArrayLike, eps: float, steps: int = STEPS) -> bool:
    """Whether vectors agree within the rounding of a number of steps, by the size of what is wanted."""
    difference = np.abs(np.asarray(found, np.float64) - np.asarray(wanted))
    return bool(np.max(difference) <= 8 * steps * eps * np.max(np.abs(wanted)))


def test_a_constant_force_gives_its_time_over_the_mass(lib: ModuleType, eps: float, draw: Draw) -> None:
    mass, half_extents, dt = draw
    force = np.array([1.0, -2.0, 3.0]) * mass
    simulation = made(lib, draw)
    simulation.set_forces("box", forces=force)
    simulation.step(STEPS)
    time = STEPS * dt
    assert simulation.time == pytest.approx(time, rel=1e-6)
    assert close(simulation.linear_velocities[0], force / mass * time, eps)
    assert np.allclose(simulation.positions[0], force / mass * time**2 / 2, rtol=1.5 / STEPS)
    assert not simulation.angular_velocities.any()
    simulation.set_forces("box", forces=[0, 0, 0])
    before = simulation.linear_velocities
    simulation.step(STEPS)
    assert np.array_equal(simulation.linear_velocities, before)


def test_a_push_acts_in_one_step_and_pushes_add_up(lib: ModuleType, eps: float, draw: Draw) -> None:
    mass, _, dt = draw
    force = np.array([3.0, 1.0, -2.0]) * mass
    simulation = made(lib, draw)
    simulation.push("box", forces=force)
    simulation.push([0], forces=2 * force)
    assert not simulation.linear_velocities.any()
    simulation.step()
    after = simulation.linear_velocities
    assert close(after[0], 3 * force / mass * dt, eps)
    simulation.step(STEPS)
    assert np.array_equal(simulation.linear_velocities, after)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("way", ["push", "set_forces"])
def test_a_torque_on_a_principal_axis_turns_about_it(
    lib: ModuleType, eps: float, draw: Draw, axis: int, way: str
) -> None:
    mass, half_extents, dt = draw
    inertia = moments(half_extents, mass)[axis]
    torque = np.zeros(3)
    torque[axis] = -0.01 * inertia
    simulation = made(lib, draw)
    getattr(simulation, way)("box", torques=torque)
    simulation.step(STEPS)
    time = dt if way == "push" else STEPS * dt
    assert close(simulation.angular_velocities[0], torque / inertia * time, eps)
    assert not simulation.linear_velocities.any()
    x, y, z, w = simulation.orientations[0]
    assert [x, y, z][axis] < 0 < w


def test_a_force_at_a_point_turns_by_its_lever(lib: ModuleType, eps: float, draw: Draw) -> None:
    mass, half_extents, dt = draw
    random = np.random.default_rng(int(mass * 1e9) % 997)
    force = random.normal(size=3) * mass
    lever = random.normal(size=3) * half_extents.max()
    place = half_extents * [2, -3, 1]
    simulation = made(lib, draw, position=place.tolist())
    simulation.push("box", forces=force, points=place + lever)
    simulation.step()
    assert close(simulation.linear_velocities[0], force / mass * dt, eps)
    spin = np.cross(lever, force) / moments(half_extents, mass) * dt
    # A step turns the body a little, and its angular momentum stays.
    assert np.allclose(simulation.angular_velocities[0], spin, rtol=0.1, atol=0.1 * np.abs(spin).max())
    momentum = simulation.totals()["angular_momentum"]
    assert close(momentum, np.cross(place + lever, force) * dt, eps, 200)


def test_forces_in_the_frame_of_a_body_turn_with_it(lib: ModuleType, eps: float, draw: Draw) -> None:
    mass, half_extents, dt = draw
    random = np.random.default_rng(int(mass * 1e9) % 991)
    quaternion, matrix = turned(random.normal(size=3), random.uniform(0.5, 3))
    force = random.normal(size=3) * mass
    simulation = made(lib, draw, orientation=quaternion)
    simulation.set_forces("box", forces=force, frame="body")
    simulation.step(STEPS)
    assert close(simulation.linear_velocities[0], matrix @ force / mass * STEPS * dt, eps, 2 * STEPS)
    for axis, inertia in enumerate(moments(half_extents, mass)):
        simulation = made(lib, draw, orientation=quaternion)
        simulation.set_forces("box", torques=0.01 * inertia * np.eye(3)[axis], frame="body")
        simulation.step(STEPS)
        assert close(simulation.angular_velocities[0], matrix[:, axis] * 0.01 * STEPS * dt, eps, 4 * STEPS)


def test_a_force_that_is_set_keeps_its_frame_when_only_a_torque_is_set(lib: ModuleType) -> None:
    quaternion, _ = turned(np.array([0.0, 0.0, 1.0]), np.pi / 2)
    simulation = lib.Simulation(still())
    simulation.orientations = quaternion
    simulation.set_forces(forces=[2, 0, 0])
    try:
        simulation.set_forces(torques=[0, 0, 0], frame="body")
    except lib.ArgumentError as error:
        assert error.field == "frame"
    simulation.step(100)
    assert np.allclose(simulation.linear_velocities, [[1, 0, 0]], atol=1e-4)


@pytest.mark.parametrize("integrator", ["semi-implicit-euler", "runge-kutta4", "moser-veselov"])
@pytest.mark.parametrize("dt", DTS)
def test_all_masses_fall_alike(lib: ModuleType, eps: float, integrator: str, dt: float) -> None:
    gravity = np.array([1.5, -9.81, 0.25])
    model = still()
    model["bodies"] = [box(f"b{i}", mass=mass, position=[i, 0, 0]) for i, mass in enumerate([1e-6, 1.0, 1e6])]
    simulation = lib.Simulation(model, gravity=gravity, dt=dt, integrator=integrator)
    start = simulation.positions
    simulation.step(STEPS)
    time = STEPS * dt
    assert close(simulation.linear_velocities, np.tile(gravity * time, (3, 1)), eps)
    fallen = gravity * time**2 / 2
    error = simulation.positions - start - fallen
    assert np.abs(error).max() <= np.abs(gravity).max() * time * dt / 2 * 1.01 + 200 * eps * np.abs(fallen).max()


@pytest.mark.parametrize("dt", DTS)
def test_momentum_and_energy_are_kept_in_free_flight(lib: ModuleType, eps: float, dt: float) -> None:
    simulation = lib.Simulation(floating(5), dt=dt)
    simulation.linear_velocities = np.random.default_rng(3).normal(size=(5, 3))
    before = simulation.totals()
    simulation.step(300)
    after = simulation.totals()
    assert close(after["linear_momentum"], before["linear_momentum"], eps, 10)
    assert close(after["angular_momentum"], before["angular_momentum"], eps, 300)
    assert after["linear_kinetic"] == pytest.approx(before["linear_kinetic"], rel=100 * eps)
    assert after["energy"] == pytest.approx(before["energy"], rel=0.02)
    assert after["potential"] == before["potential"] == 0


def test_totals_are_the_sums_over_the_bodies(lib: ModuleType, eps: float) -> None:
    random = np.random.default_rng(8)
    simulation = lib.Simulation(floating(4), gravity=[0, -9.81, 0])
    simulation.linear_velocities = random.normal(size=(4, 3))
    masses = np.asarray(simulation.masses, float)
    assert masses.tolist() == [1, 2, 3, 4]
    places, speeds = (np.asarray(it, float) for it in (simulation.positions, simulation.linear_velocities))
    totals = simulation.totals()
    assert totals["linear_kinetic"] == pytest.approx((masses @ speeds**2).sum() / 2, rel=50 * eps)
    assert totals["potential"] == pytest.approx(9.81 * masses @ places[:, 1], rel=50 * eps)
    assert close(totals["linear_momentum"], masses @ speeds, eps)
    spins = np.asarray(simulation.angular_velocities, float)
    inertias = np.array([moments((0.1, 0.2, 0.3), mass) for mass in masses])
    assert totals["rotational_kinetic"] == pytest.approx((inertias * spins**2).sum() / 2, rel=50 * eps)
    orbital = np.cross(places, masses[:, None] * speeds).sum(axis=0)
    assert close(totals["angular_momentum"], orbital + (inertias * spins).sum(axis=0), eps)
    parts = totals["linear_kinetic"] + totals["rotational_kinetic"] + totals["potential"]
    assert totals["energy"] == pytest.approx(parts, rel=1e-12)


def test_masses_and_inertias_are_those_of_the_scene(lib: ModuleType, eps: float) -> None:
    axes, _ = turned(np.array([1.0, 2.0, -1.0]), 0.7)
    model = mixed()
    model["bodies"][1]["inertia"] = {"principal": [1, 2, 2.5], "axes": axes}
    batch = lib.Batch(model, 3, vary={"bodies.b0.mass": [1, 10, 1e6]})
    for world, mass in enumerate([1, 10, 1e6]):
        model["bodies"][0]["mass"] = mass
        simulation = lib.Simulation(model)
        masses, inertias = simulation.masses, simulation.inertias
        assert masses.tolist() == [np.float32(mass), 2, 1, np.inf]
        assert close(np.sort(inertias[0]), sorted(moments((0.1, 0.2, 0.3), mass)), eps)
        assert close(np.sort(inertias[1]), [1, 2, 2.5], eps)
        assert not inertias[2].any() and np.isinf(inertias[3]).all()
        for name in ("masses", "inertias", "principal_axes"):
            assert np.array_equal(getattr(batch, name)[world], getattr(simulation, name))
    # The principal frame spins about its own axes at the rate of a torque over a moment.
    for axis, inertia in enumerate(np.asarray(inertias[1], float)):
        simulation = lib.Simulation(model)
        simulation.set_state("b1", angular_velocities=[0, 0, 0])
        direction = rotated(simulation.principal_axes[1], np.eye(3)[axis])
        simulation.push("b1", torques=direction)
        simulation.step()
        assert close(simulation.angular_velocities[1], direction / inertia * simulation.dt, eps, 200)


def test_bodies_at_rest_are_asleep_where_the_settings_say_so(lib: ModuleType) -> None:
    for made in (lib.Simulation(box_at_rest(), sleep=True), lib.Batch(box_at_rest(), 2, sleep=True)):
        assert made.asleep.dtype == bool and made.asleep.shape == made.positions.shape[:-1]
        assert not made.asleep.any()
        made.step(200)
        assert made.asleep[..., 1].all()
        made.push("b0", forces=[0, 4000, 0])
        made.step()
        assert not made.asleep[..., 1].any()
    waking = lib.Simulation(box_at_rest(), sleep=False)
    waking.step(200)
    assert not waking.asleep.any()


@pytest.mark.parametrize("ratio", [1.0, 1e3, 1e6])
def test_a_spring_between_two_masses_has_the_period_of_their_reduced_mass(
    lib: ModuleType, eps: float, ratio: float
) -> None:
    stiffness, reduced = 50.0, ratio / (1 + ratio)
    period = 2 * np.pi * np.sqrt(reduced / stiffness)
    spring = {"spring": {"to": "heavy", "rest_length": 1.0, "stiffness": stiffness}}
    bodies = [
        {"name": "heavy", "mass": ratio},
        {"name": "light", "mass": 1.0, "position": [1.2, 0, 0], "forces": [spring]},
    ]
    simulation = lib.Simulation({"gravity": [0, 0, 0], "dt": period / 400, "bodies": bodies})
    gaps = []
    for _ in range(800):
        gaps.append(float(np.diff(simulation.positions[:, 0])[0]) - 1)
        simulation.step()
    is_long = np.array(gaps) > 0
    crossings = np.flatnonzero(np.diff(is_long))
    assert len(crossings) == 4 and is_long[0]
    assert np.allclose(np.diff(crossings), 200, atol=2)
    assert np.min(gaps) == pytest.approx(-0.2, rel=0.02)
    assert np.abs(simulation.totals()["linear_momentum"]).max() < 5000 * eps * np.sqrt(stiffness * reduced)


def test_a_body_that_is_turned_keeps_its_velocities(lib: ModuleType, eps: float) -> None:
    simulation = lib.Simulation(floating(3))
    before = simulation.states
    quaternion, _ = turned(np.array([1.0, 2.0, 3.0]), 1.0)
    simulation.set_state(["b2", 0], orientations=quaternion)
    after = simulation.states
    assert close(after[[0, 2], 3:7], [quaternion] * 2, eps)
    assert close(after[:, 7:], before[:, 7:], eps)
    assert np.array_equal(after[1], before[1])


@pytest.mark.parametrize("asleep", [False, True])
def test_whatever_is_done_to_a_sleeping_body_wakes_it(lib: ModuleType, asleep: bool) -> None:
    acts: dict[str, Any] = {
        "push": lambda made: made.push("b0", forces=[0, 4000, 0]),
        "set_forces": lambda made: made.set_forces("b0", forces=[0, 400, 0]),
        "position": lambda made: made.set_state("b0", positions=[0, 50, 0]),
        "velocity": lambda made: made.set_state("b0", linear_velocities=[0, 5, 0]),
    }
    for name, act in acts.items():
        simulation = lib.Simulation(box_at_rest(), sleep=asleep)
        simulation.step(200)
        resting = simulation.state_hash
        simulation.step(10)
        assert not asleep or simulation.state_hash == resting
        act(simulation)
        simulation.step(10)
        before, now = 0.5 + 49.5 * (name == "position"), float(simulation.positions[1, 1])
        assert abs(now - before) > 0.1, name
