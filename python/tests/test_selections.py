"""Promise: bodies, worlds and drives are chosen by name, index or mask, and a wrong choice is refused by name."""

from __future__ import annotations

from collections.abc import Iterator
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from models import floating, hinged

BODIES, WORLDS = 4, 5
PUSH = {"forces": [0.0, 0.0, 100.0]}
RIGHT: list[tuple[Any, list[int]]] = [
    (None, [0, 1, 2, 3]),
    ("b2", [2]),
    (2, [2]),
    (-1, [3]),
    (np.int64(1), [1]),
    (np.uint8(1), [1]),
    (np.array(1), [1]),
    ([], []),
    ((), []),
    (np.zeros(0, int), []),
    (["b3", "b0"], [0, 3]),
    (["b3", 0, -2], [0, 2, 3]),
    (np.array(["b3", "b0"]), [0, 3]),
    (range(1, 3), [1, 2]),
    (np.array([3, 1], np.uint16), [1, 3]),
    (np.array([3, 9, 1, 9])[::2], [1, 3]),
    ([True, False, False, True], [0, 3]),
    (np.array([True, False, True, False]), [0, 2]),
    (np.array([True, False, True, False] * 2)[::2], [0, 1, 2, 3]),
    ([np.True_, np.False_, np.False_, np.False_], [0]),
    (np.zeros(BODIES, bool), []),
]
IMPOSSIBLE: list[Any] = [4, -5, [0, 9], ["b0", "nobody"], "nobody", "", [0, 0], ["b0", 0], [1, -3]]
IMPOSSIBLE += [np.ones(3, bool), [True, False], np.ones((2, 2), bool), np.array(True), 2**70, [2**70], 2**63]
WRONG_TYPE: list[Any] = [1.0, [1.0], np.array([1.0]), slice(0, 2), object(), [None], [[0, 1]], np.array([[0, 1]])]
WRONG_TYPE += [True, [True, 1], [1, False], b"\x00", 1j]


def pushed(made: Any) -> list[int]:
    made.step()
    return sorted(np.flatnonzero(made.linear_velocities[..., 2].reshape(-1, BODIES)[-1] > 0).tolist())


@pytest.mark.parametrize(("choice", "wanted"), RIGHT, ids=str)
def test_bodies_are_chosen(lib: ModuleType, choice: Any, wanted: list[int]) -> None:
    simulation, batch = lib.Simulation(floating(BODIES)), lib.Batch(floating(BODIES), 2)
    simulation.push(choice, **PUSH)
    batch.push(choice, **PUSH)
    assert pushed(simulation) == pushed(batch) == wanted


def test_bodies_are_chosen_by_what_gives_them_one_by_one(lib: ModuleType) -> None:
    simulation = lib.Simulation(floating(BODIES))
    simulation.push((name for name in ("b0", "b2")), **PUSH)
    assert pushed(simulation) == [0, 2]

    def fails() -> Iterator[str]:
        yield "b1"
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        simulation.push(fails(), **PUSH)


def test_rows_are_in_the_order_of_the_choice(lib: ModuleType) -> None:
    simulation = lib.Simulation(floating(BODIES))
    simulation.set_state(["b3", 0, -2], positions=[[3, 3, 3], [0, 0, 9], [2, 2, 2]])
    assert simulation.positions[[0, 2, 3]].tolist() == [[0, 0, 9], [2, 2, 2], [3, 3, 3]]
    simulation.set_state(np.array([False, True, False, True]), positions=[[1, 1, 1], [4, 4, 4]])
    assert simulation.positions[[1, 3]].tolist() == [[1, 1, 1], [4, 4, 4]]


@pytest.mark.parametrize("choice", IMPOSSIBLE + WRONG_TYPE, ids=repr)
@pytest.mark.parametrize("call", ["push", "set_forces", "set_state"])
def test_a_wrong_choice_of_bodies_is_refused(lib: ModuleType, choice: Any, call: str) -> None:
    given = {"positions": [0, 0, 0]} if call == "set_state" else PUSH
    for made in (lib.Simulation(floating(BODIES)), lib.Batch(floating(BODIES), 2)):
        before = made.states
        with pytest.raises((lib.ArgumentError, lib.ArgumentTypeError)) as caught:
            getattr(made, call)(choice, **given)
        assert caught.value.field == "bodies"
        assert np.array_equal(made.states, before)
        assert pushed(made) == []


@pytest.mark.parametrize("choice", WRONG_TYPE, ids=repr)
def test_a_choice_of_a_wrong_type_is_a_type_error(lib: ModuleType, choice: Any) -> None:
    with pytest.raises(TypeError):
        lib.Simulation(floating(BODIES)).push(choice, **PUSH)


def test_a_name_that_is_not_there_is_in_the_message(lib: ModuleType) -> None:
    with pytest.raises(lib.ArgumentError, match="nobody"):
        lib.Simulation(floating(BODIES)).push(["b0", "nobody"], **PUSH)


WORLD_CHOICES: list[tuple[Any, list[int]]] = [
    (None, [0, 1, 2, 3, 4]),
    (3, [3]),
    (-1, [4]),
    ([], []),
    ([0, 2], [0, 2]),
    ([0, -1], [0, 4]),
    (range(1, 4), [1, 2, 3]),
    (np.array([1, 4]), [1, 4]),
    ([True, False, False, True, False], [0, 3]),
    (np.arange(WORLDS) % 2 == 1, [1, 3]),
]


@pytest.mark.parametrize(("choice", "wanted"), WORLD_CHOICES, ids=str)
def test_worlds_are_chosen_and_the_others_stay(lib: ModuleType, choice: Any, wanted: list[int]) -> None:
    batch = lib.Batch(floating(2), WORLDS)
    before = batch.states
    rows = np.arange(3.0 * len(wanted)).reshape(len(wanted), 1, 3) + 1
    batch.set_state("b1", worlds=choice, linear_velocities=rows)
    found = batch.linear_velocities
    assert np.allclose(found[wanted, 1], rows[:, 0])
    others = [world for world in range(WORLDS) if world not in wanted]
    assert np.array_equal(batch.states[others], before[others])
    batch.push(worlds=choice, forces=[0, 0, 1e3])
    batch.set_forces("b0", worlds=choice, torques=[0, 0, 1])
    batch.step()
    moved = batch.linear_velocities[:, 0, 2] > 0
    assert np.flatnonzero(moved).tolist() == wanted
    batch.reset(choice)
    assert np.flatnonzero(batch.steps == 0).tolist() == wanted


@pytest.mark.parametrize("choice", [5, -6, [0, 0], [1, 0], "b0", ["0"], 1.0, np.ones(4, bool), [True], True], ids=repr)
@pytest.mark.parametrize("call", ["push", "set_forces", "set_state", "set_drives", "reset"])
def test_a_wrong_choice_of_worlds_is_refused(lib: ModuleType, choice: Any, call: str) -> None:
    batch = lib.Batch(floating(2), WORLDS)
    batch.step()
    before = batch.state_hashes()
    with pytest.raises((lib.ArgumentError, lib.ArgumentTypeError)) as caught:
        getattr(batch, call)(worlds=choice)
    assert caught.value.field == "worlds"
    assert batch.state_hashes() == before


def test_one_world_is_chosen_by_its_index(lib: ModuleType) -> None:
    batch = lib.Batch(floating(2), 3)
    batch.push(worlds=2, forces=[0, 0, 1])
    batch.step()
    assert batch.snapshot(-1) == batch.snapshot(2) != batch.snapshot(0)
    snapshot = batch.snapshot(0)
    for world in (3, -4):
        for call, more in ((batch.snapshot, ()), (batch.restore, (snapshot,))):
            with pytest.raises(lib.ArgumentError) as caught:
                call(world, *more)
            assert caught.value.field == "world"


def test_drives_are_chosen_by_name_or_index(lib: ModuleType) -> None:
    motors = [{"axes": ["angular_x"], "velocity": 1.0, "damping": 1.0}] * 2
    for made in (lib.Simulation(hinged(drives=motors)), lib.Batch(hinged(drives=motors), 2)):
        assert made.joint_names == ["hinge"]
        assert made.drive_names == ["hinge.drives.0", "hinge.drives.1"]
        made.set_drives("hinge.drives.1", velocities=5)
        assert np.unique(made.drive_velocities.reshape(-1, 2), axis=0).tolist() == [[1, 5]]
        made.set_drives([-2], velocities=7)
        assert np.unique(made.drive_velocities.reshape(-1, 2), axis=0).tolist() == [[7, 5]]
        for choice in ("hinge", "hinge.drives.2", 2, [0, 0], [True]):
            with pytest.raises(lib.ArgumentError) as caught:
                made.set_drives(choice, velocities=9)
            assert caught.value.field == "drives"
        assert np.unique(made.drive_velocities.reshape(-1, 2), axis=0).tolist() == [[7, 5]]
