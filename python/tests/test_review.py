"""Promise: what is left out stays to the bit, what is given twice is an error, nothing is stale."""

from __future__ import annotations

import json
import threading
import time
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import tumble
from models import box, hinged


def test_a_body_that_is_too_fast_changes_none(lib: ModuleType) -> None:
    made = lib.Simulation({"gravity": [0, 0, 0], "bodies": [box("a", mass=1e-3), box("b", mass=1e-3)]})
    for _ in range(4):
        made.push("b", forces=[[1e9, 0, 0]])
        made.step()
    assert np.abs(made.linear_velocities).max() > 1e9
    before = made.state_hash
    with pytest.raises(lib.ArgumentError) as caught:
        made.set_state(linear_velocities=[[1, 0, 0], [2e9, 0, 0]])
    assert caught.value.field == "linear_velocities" and made.state_hash == before
    # It can be put right.
    made.set_state(orientations=[[1, 0, 0, 0]] * 2, linear_velocities=np.zeros((2, 3)))
    assert np.all(made.linear_velocities == 0) and np.all(made.orientations[:, 0] == 1)


def test_a_velocity_that_is_set_leaves_the_other_to_the_bit(lib: ModuleType) -> None:
    spin = box("a", mass=1.3, angular_velocity=[0.3, 2.1, -0.7], linear_velocity=[0.1, 0.2, 0.7])
    made = lib.Simulation({"bodies": [spin]})
    made.step(7)
    angular = made.totals()["angular_momentum"] - np.cross(made.positions[0], made.totals()["linear_momentum"])
    made.linear_velocities = [[0, 0, 0]]
    assert np.allclose(made.totals()["angular_momentum"], angular, rtol=1e-6, atol=1e-7)
    linear = lib.Simulation({"bodies": [spin]})
    other = lib.Simulation({"bodies": [spin]})
    other.angular_velocities = other.angular_velocities
    assert np.array_equal(linear.totals()["linear_momentum"], other.totals()["linear_momentum"])


def test_what_is_given_for_all_worlds_does_not_vary(lib: ModuleType) -> None:
    model = {"bodies": [box("a", mass=1.0)]}
    for option in ({"gravity": [0, 0, 0]}, {"dt": 0.01}, {"substeps": 2}):
        field = next(iter(option)).replace("gravity", "gravity.1")
        with pytest.raises(lib.ArgumentError, match="for all worlds") as caught:
            lib.Batch(model, 2, vary={field: [1, 2]}, **option)
        assert field in caught.value.field


def test_a_file_that_has_changed_is_refused(lib: ModuleType, tmp_path: Path) -> None:
    path = tmp_path / "scene.json"
    path.write_text(json.dumps({"bodies": [box("a", mass=1.0), box("b", mass=2.0)]}))
    scene = lib.Scene(path)
    path.write_text(json.dumps({"bodies": [box("new", mass=1.0), box("a", mass=1.0), box("b", mass=2.0)]}))
    with pytest.raises(lib.ArgumentError, match="has changed"):
        lib.Batch(scene, 2, vary={"bodies.a.mass": [1, 2]})


def test_joint_readings_are_not_those_of_before_a_restore(lib: ModuleType) -> None:
    made = lib.Simulation(hinged())
    start = made.snapshot()
    made.set_state(angular_velocities=np.zeros((len(made), 3)))
    made.step(20)
    assert np.abs(made.joint_forces).max() > 0
    made.restore(start)
    assert np.all(made.joint_values == 0) and np.all(made.joint_forces == 0)


def test_a_recording_cannot_be_written_over(lib: ModuleType) -> None:
    recording = lib.Simulation("t-handle").record(3)
    with pytest.raises(ValueError, match="read-only"):
        recording.states[:] = 0


def test_one_origin_goes_with_many_directions(lib: ModuleType) -> None:
    made = lib.Simulation({"bodies": [{"shape": {"half_space": {}}, "fixed": True, "collider": {}}]})
    hits = made.cast_rays([0, 3, 0], [[0, -1, 0], [0, 1, 0], [4, -3, 0]])
    assert hits["bodies"].tolist() == [0, -1, 0]
    assert np.allclose(hits["distances"], [3, np.inf, 5])


def test_a_set_is_no_choice(lib: ModuleType) -> None:
    made = lib.Simulation({"bodies": [box("a", mass=1.0), box("b", mass=1.0)]})
    for choice in ({"a", "b"}, frozenset({"a"}), {"a": 1}):
        with pytest.raises(lib.ArgumentTypeError):
            made.push(choice, forces=[0, 1, 0])


def test_others_run_while_a_batch_is_read_beside_another(lib: ModuleType) -> None:
    busy, read = lib.Batch("pyramid", 4), lib.Batch("t-handle", 100)
    stepping = threading.Thread(target=busy.step, args=(40,))
    longest, is_over = [0.0], threading.Event()

    def sleeper() -> None:
        while not is_over.is_set():
            begun = time.perf_counter()
            time.sleep(0.001)
            longest[0] = max(longest[0], time.perf_counter() - begun)

    sleeping = threading.Thread(target=sleeper)
    sleeping.start()
    begun = time.perf_counter()
    stepping.start()
    while stepping.is_alive():
        read.positions
    took = time.perf_counter() - begun
    is_over.set()
    sleeping.join()
    stepping.join()
    assert longest[0] < 0.5 * took, f"stopped for {longest[0]} s of {took} s"


def test_an_input_that_another_call_writes_is_an_error() -> None:
    lib = tumble.double
    batch, made = lib.Batch("t-handle", 200), lib.Simulation("t-handle")
    out = batch.states
    stepping = threading.Thread(target=batch.step, args=(20_000,), kwargs={"out": out})
    stepping.start()
    seen = False
    while stepping.is_alive() and not seen:
        try:
            made.states = out[0]
        except tumble.ArgumentError as error:
            seen = error.field == "states"
    stepping.join()
    assert seen
