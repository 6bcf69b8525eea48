"""Promise: the same bits from the program, from one world and from many, however they are stepped."""

from __future__ import annotations

import json
import pickle
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import tumble
import tumble.double
from models import boxes_on_ground, floating, hinged

FEW = [name for name in tumble.scenes() if len(tumble.Scene(name)) <= 60]
MODELS: dict[str, Callable[[], dict[str, Any]]] = {
    "floating": floating,
    "contacts": boxes_on_ground,
    "drive": lambda: hinged(drives=[{"axes": ["angular_x"], "position": 1.0, "frequency": 2}]),
}
STEPS = 90


def in_parts(steps: int, part: int) -> Iterator[int]:
    for begin in range(0, steps, part):
        yield min(part, steps - begin)


@pytest.fixture(params=list(MODELS))
def model(request: pytest.FixtureRequest) -> dict[str, Any]:
    return MODELS[request.param]()


def alone(lib: ModuleType, model: Any, steps: int = STEPS) -> str:
    simulation = lib.Simulation(model)
    simulation.step(steps)
    return str(simulation.state_hash)


@pytest.mark.parametrize("name", FEW)
def test_a_built_in_scene_ends_with_the_hash_of_the_program(name: str, program: Path) -> None:
    command = [str(program), "run", name, "--steps", "60", "--json"]
    summary = json.loads(subprocess.run(command, check=True, capture_output=True, text=True, timeout=60).stdout)
    lib = {"f32": tumble, "f64": tumble.double}[summary["precision"]]
    assert alone(lib, name, 60) == summary["state_hash"]
    assert alone(lib, name, 61) != summary["state_hash"]


def test_the_t_handle_ends_with_known_bits(lib: ModuleType) -> None:
    known = {"f32": "26e13f40d0b487d6", "f64": "e910dc45fefbb59d"}
    assert alone(lib, "t-handle", 600) == known[lib.PRECISION]


@pytest.mark.parametrize("threads", [1, 2, 5])
@pytest.mark.parametrize("part", [1, 16, STEPS])
def test_worlds_of_a_batch_have_the_bits_of_one_alone(
    lib: ModuleType, model: dict[str, Any], threads: int, part: int
) -> None:
    lib.set_threads(threads)
    assert lib.threads() == threads
    batch = lib.Batch(model, 7)
    for count in in_parts(STEPS, part):
        batch.step(count)
    assert set(batch.state_hashes()) == {alone(lib, model)}
    assert batch.steps.tolist() == [STEPS] * 7


@pytest.mark.parametrize("part", [1, 7, 16])
def test_a_simulation_has_the_same_bits_however_its_steps_are_divided(
    lib: ModuleType, model: dict[str, Any], part: int
) -> None:
    simulation = lib.Simulation(model)
    for count in in_parts(STEPS, part):
        simulation.step(count)
    assert simulation.state_hash == alone(lib, model)
    assert simulation.state_hash != alone(lib, model, STEPS + 1)


@pytest.mark.parametrize("part", [1, 16, STEPS])
def test_states_written_while_stepping_are_those_read_afterwards(
    lib: ModuleType, model: dict[str, Any], part: int
) -> None:
    batch, other = lib.Batch(model, 5), lib.Batch(model, 5)
    out = np.full_like(batch.states, np.nan)
    for count in in_parts(STEPS, part):
        batch.step(count, out=out)
        other.step(count)
        assert np.array_equal(out, other.states)
    assert batch.state_hashes() == other.state_hashes()


def test_neighbours_with_other_numbers_change_nothing(lib: ModuleType) -> None:
    masses = np.random.default_rng(1).uniform(1, 9, 6)
    batch = lib.Batch(boxes_on_ground(4), 6, vary={"bodies.b2.mass": masses})
    batch.step(STEPS)
    hashes = batch.state_hashes()
    assert len(set(hashes)) == 6
    for world, mass in enumerate(masses):
        model = boxes_on_ground(4)
        model["bodies"][3]["mass"] = mass
        assert alone(lib, model) == hashes[world]


@pytest.mark.parametrize("threads", [1, 5])
def test_a_world_that_is_reset_has_the_bits_of_a_new_one(lib: ModuleType, model: dict[str, Any], threads: int) -> None:
    lib.set_threads(threads)
    batch = lib.Batch(model, 5)
    batch.push(forces=[3.0, 1.0, 0.0])
    batch.step(20)
    before = batch.state_hashes()
    batch.reset([1, 3])
    fresh = lib.Batch(model, 1).state_hashes()[0]
    assert [found == fresh for found in batch.state_hashes()] == [False, True, False, True, False]
    assert [batch.state_hashes()[i] for i in (0, 2, 4)] == [before[i] for i in (0, 2, 4)]
    assert batch.steps.tolist() == [20, 0, 20, 0, 20]
    batch.step(STEPS)
    assert [batch.state_hashes()[i] for i in (1, 3)] == [alone(lib, model)] * 2


def test_a_reset_takes_other_numbers_for_the_chosen_worlds_only(lib: ModuleType) -> None:
    path = "bodies.b1.mass"
    batch = lib.Batch(floating(2), 4, vary={path: [1, 2, 3, 4]})
    batch.reset(np.array([False, True, False, True]), vary={path: [9, 8]})
    batch.reset()
    batch.push("b1", forces=[1.0, 0.0, 0.0])
    batch.step()
    gained = batch.linear_velocities[:, 1, 0]
    assert np.allclose(gained, 0.01 / np.array([1, 9, 3, 8]), rtol=1e-5)


def test_forces_that_were_set_do_not_outlive_a_reset(lib: ModuleType) -> None:
    batch = lib.Batch(floating(), 3)
    batch.set_forces(forces=[1.0, 2.0, 3.0])
    batch.step(5)
    batch.reset()
    batch.step(STEPS)
    assert set(batch.state_hashes()) == {alone(lib, floating())}


@pytest.mark.parametrize("way", ["kept", "bytes", "pickle"])
def test_a_snapshot_goes_on_with_the_same_bits(lib: ModuleType, model: dict[str, Any], way: str) -> None:
    carried: dict[str, Callable[[Any], Any]] = {
        "kept": lambda snapshot: snapshot,
        "bytes": lambda snapshot: lib.Snapshot(bytes(snapshot)),
        "pickle": lambda snapshot: pickle.loads(pickle.dumps(snapshot)),
    }
    simulation = lib.Simulation(model)
    simulation.step(30)
    snapshot = carried[way](simulation.snapshot())
    assert snapshot == simulation.snapshot()
    assert snapshot.state_hash == simulation.state_hash and snapshot.steps == 30
    simulation.step(STEPS - 30)
    assert snapshot != simulation.snapshot()
    fresh, batch = lib.Simulation(model), lib.Batch(model, 3)
    simulation.restore(snapshot)
    fresh.restore(snapshot)
    batch.restore(-2, snapshot)
    assert fresh.steps == simulation.steps == 30 and fresh.time == simulation.time
    for made in (simulation, fresh, batch):
        made.step(STEPS - 30)
    assert simulation.state_hash == fresh.state_hash == batch.state_hashes()[1] == alone(lib, model)
    assert batch.snapshot(1) == simulation.snapshot()
    assert batch.state_hashes()[0] == batch.state_hashes()[2] == alone(lib, model, STEPS - 30)


@pytest.mark.parametrize("source", ["t-handle", "dict", "json"])
def test_a_scene_that_was_pickled_has_the_same_bits(lib: ModuleType, source: str) -> None:
    model = boxes_on_ground(3)
    scene = {
        "t-handle": lambda: lib.Scene("t-handle"),
        "dict": lambda: lib.Scene(model),
        "json": lambda: lib.Scene.from_text(json.dumps(model), "json", "mine.json"),
    }[source]()
    copy = pickle.loads(pickle.dumps(scene))
    assert type(copy) is lib.Scene and copy.origin == scene.origin and copy.body_names == scene.body_names
    assert alone(lib, copy) == alone(lib, scene)


def test_a_generated_scene_that_was_pickled_has_its_size_and_seed(lib: ModuleType) -> None:
    scene = lib.Scene("pile", bodies=30, seed=5)
    copy = pickle.loads(pickle.dumps(scene))
    assert copy.body_names == scene.body_names
    assert alone(lib, copy, 20) == alone(lib, scene, 20) != alone(lib, lib.Scene("pile", bodies=30, seed=6), 20)
