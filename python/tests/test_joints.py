"""Promise: joints and drives do what mechanics says, by their names, and report what they carry."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np
import pytest

from models import GRAVITY, box, hinged, moments


@pytest.mark.parametrize("length", [0.5, 1.0, 4.0])
@pytest.mark.parametrize("mass", [1e-3, 1.0, 1e3])
def test_a_pendulum_swings_with_its_small_period(lib: ModuleType, length: float, mass: float) -> None:
    about_hinge = moments((0.1, 0.1, 0.1), mass)[2] + mass * length**2
    period = 2 * np.pi * np.sqrt(about_hinge / (mass * GRAVITY * length))
    simulation = lib.Simulation(hinged(length, mass), dt=period / 800)
    speed = 0.02 * 2 * np.pi / period
    simulation.set_state("bob", angular_velocities=[0, 0, speed], linear_velocities=[speed * length, 0, 0])
    angles, speeds = [], []
    for _ in range(2000):
        simulation.step()
        angles.append(simulation.joint_values[0, 3])
        speeds.append(simulation.joint_speeds[0, 3])
    crossings = np.flatnonzero(np.diff(np.array(angles) > 0))
    assert np.diff(crossings).tolist() == pytest.approx([400] * (len(crossings) - 1), abs=4)
    assert len(crossings) >= 4
    assert np.max(angles) == pytest.approx(0.02, rel=0.02) and angles[0] > 0
    assert np.max(np.abs(speeds)) == pytest.approx(speed, rel=0.02) and speeds[0] > 0


def test_a_joint_carries_the_weight(lib: ModuleType) -> None:
    for mass in (1e-3, 2.0, 1e5):
        for made in (lib.Simulation(hinged(mass=mass)), lib.Batch(hinged(mass=mass), 2)):
            assert not made.joint_forces.any()
            made.step(100)
            forces, torques = made.joint_forces, made.joint_torques
            assert forces.shape[-2:] == torques.shape[-2:] == (1, 3)
            assert np.allclose(forces, [0, mass * GRAVITY, 0], rtol=1e-3, atol=mass * 1e-3)
            assert np.allclose(torques, 0, atol=mass * 1e-3)


def test_a_fixed_joint_carries_the_moment_of_a_beam(lib: ModuleType) -> None:
    model = hinged()
    model["bodies"][1]["position"] = [2, 0, 0]
    model["joints"] = [{"between": ["frame", "bob"], "fixed": {"at": [2, 0, 0]}}]
    simulation = lib.Simulation(model)
    simulation.step(200)
    assert simulation.joint_names == ["joint-0"]
    assert np.allclose(simulation.joint_forces, [[0, 2 * GRAVITY, 0]], rtol=1e-2, atol=1e-2)
    assert np.allclose(simulation.joint_values, 0, atol=1e-3)


@pytest.mark.parametrize("target", [-1.2, 0.5, 2.0])
@pytest.mark.parametrize("kind", [{"frequency": 2}, {"stiffness": 400, "damping": 60}, {}])
def test_a_drive_reaches_its_position(lib: ModuleType, target: float, kind: dict[str, Any]) -> None:
    model = hinged(drives=[{"axes": ["angular_x"], "position": 0, **kind}], gravity=[0, 0, 0])
    simulation, batch = lib.Simulation(model), lib.Batch(model, 3)
    simulation.set_drives("hinge.drives.0", positions=target)
    batch.set_drives(positions=[[target], [0], [-target]])
    for made in (simulation, batch):
        made.step(1500)
    assert simulation.drive_positions.tolist() == pytest.approx([target])
    assert simulation.joint_values[0, 3] == pytest.approx(target, abs=0.01)
    assert batch.joint_values[:, 0, 3].tolist() == pytest.approx([target, 0, -target], abs=0.01)
    place = simulation.positions[1]
    assert np.allclose(place, [np.sin(target), -np.cos(target), 0], atol=0.02)


@pytest.mark.parametrize("speed", [-3.0, 0.5])
def test_a_position_of_nan_keeps_the_velocity(lib: ModuleType, speed: float) -> None:
    drive = {"axes": ["angular_x"], "position": 0.7, "stiffness": 10, "damping": 500}
    model = hinged(drives=[drive], gravity=[0, 0, 0])
    simulation = lib.Simulation(model)
    assert simulation.drive_positions.tolist() == pytest.approx([0.7])
    simulation.set_drives(positions=np.nan, velocities=speed)
    assert np.isnan(simulation.drive_positions).all() and simulation.drive_velocities.tolist() == [speed]
    simulation.step(500)
    assert simulation.joint_speeds[0, 3] == pytest.approx(speed, rel=0.01)
    assert simulation.angular_velocities[1, 2] == pytest.approx(speed, rel=0.01)


def test_a_drive_gives_no_more_than_its_greatest_force(lib: ModuleType) -> None:
    model = hinged(drives=[{"axes": ["angular_x"], "velocity": 100.0}], gravity=[0, 0, 0])
    for torque in (0.0, 0.5, 3.0):
        simulation = lib.Simulation(model)
        simulation.set_drives(max_forces=torque)
        simulation.step(24)
        about_hinge = moments((0.1, 0.1, 0.1), 2.0)[2] + 2.0
        assert simulation.angular_velocities[1, 2] == pytest.approx(torque / about_hinge * 0.1, rel=0.02, abs=1e-9)
    simulation.set_drives(max_forces=np.inf)
    simulation.step(5)
    assert simulation.angular_velocities[1, 2] == pytest.approx(100, rel=0.01)


def test_drives_of_the_worlds_of_a_batch_are_their_own(lib: ModuleType) -> None:
    model = hinged(drives=[{"axes": ["angular_x"], "velocity": 0.0, "damping": 100}], gravity=[0, 0, 0])
    batch = lib.Batch(model, 4)
    batch.set_drives(worlds=[1, 3], velocities=[[1.0], [2.0]])
    assert batch.drive_velocities.tolist() == [[0], [1], [0], [2]]
    batch.step(400)
    assert np.allclose(batch.joint_speeds[:, 0, 3], [0, 1, 0, 2], atol=0.02)
    batch.reset([3])
    assert batch.drive_velocities.tolist() == [[0], [1], [0], [0]]


def test_a_scene_without_joints_has_empty_arrays(lib: ModuleType) -> None:
    model = {"bodies": [box("box")]}
    simulation, batch = lib.Simulation(model), lib.Batch(model, 3)
    assert simulation.joint_values.shape == simulation.joint_speeds.shape == (0, 6)
    assert batch.joint_forces.shape == batch.joint_torques.shape == (3, 0, 3)
    assert batch.drive_positions.shape == (3, 0) and simulation.drive_names == []
    simulation.set_drives(positions=1.0)
    batch.set_drives([], velocities=np.zeros((3, 0)))
