"""Promise: any array of real numbers is taken, others are refused by name, and nothing is half-written."""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import partial
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import tumble

from models import box, floating, hinged, mixed

Call = Callable[[Any, Any], None]
DRIVEN = hinged(drives=[{"axes": ["angular_x"], "velocity": 1.0, "max_force": 2.0}])
BODIES, WORLDS = 3, 4
QUANTITIES = {"positions": 3, "orientations": 4, "linear_velocities": 3, "angular_velocities": 3, "states": 13}


def _setter(name: str) -> Call:
    return lambda made, value: setattr(made, name, value)


# Each call with an array: its arguments' names, and how it is made.
CALLS: dict[str, tuple[str, Call]] = {
    **{f"{name} =": (name, _setter(name)) for name in QUANTITIES},
    "set_state": ("linear_velocities", lambda made, value: made.set_state(linear_velocities=value)),
    "push forces": ("forces", lambda made, value: made.push(forces=value)),
    "push torques": ("torques", lambda made, value: made.push(torques=value)),
    "push points": ("points", lambda made, value: made.push(forces=[0, 0, 1], points=value)),
    "set_forces forces": ("forces", lambda made, value: made.set_forces(forces=value)),
    "set_forces torques": ("torques", lambda made, value: made.set_forces(torques=value)),
}
DATE = np.datetime64(1, "s")
# Beyond what the engine takes, in each precision.
TOO_LARGE = {"positions": 1e16, "orientations": 1.01, "linear_velocities": 1e10, "angular_velocities": 1e10}
TOO_LARGE |= {"states": 1e16, "forces": 1e19, "torques": 1e19, "points": 1e16}


@pytest.fixture(params=["Simulation", "Batch"])
def made(lib: ModuleType, request: pytest.FixtureRequest) -> Any:
    return lib.Simulation(floating(BODIES)) if request.param == "Simulation" else lib.Batch(floating(BODIES), WORLDS)


def hashes(made: Any) -> Any:
    """The state, and what it becomes in a step: forces that were set show there."""
    return made.state_hashes() if hasattr(made, "state_hashes") else made.state_hash


def hash_after_a_step(made: Any) -> Any:
    made.step()
    return hashes(made)


def outer(made: Any) -> tuple[int, ...]:
    return (WORLDS, BODIES) if hasattr(made, "state_hashes") else (BODIES,)


def good(made: Any, name: str) -> Any:
    """What the call may be given: of the shape of all bodies."""
    found = getattr(made, name) if name in QUANTITIES else np.ones((*outer(made), 3))
    return np.array(found, dtype=np.float64)


def refused(lib: ModuleType, made: Any, field: str, call: Callable[[], Any], kind: Any = None) -> None:
    """Asserts that a call is refused by the name of its argument and changes nothing."""
    before = hashes(made)
    with pytest.raises(kind or (lib.ArgumentError, lib.ArgumentTypeError)) as caught:
        call()
    assert caught.value.field == field
    assert field in str(caught.value)
    assert hashes(made) == before


def fresh_hash(lib: ModuleType, made: Any) -> Any:
    return hash_after_a_step(type(made)(floating(BODIES), *([WORLDS] if hasattr(made, "state_hashes") else [])))


@pytest.mark.parametrize("name", list(QUANTITIES))
def test_arrays_that_are_read_are_new_and_of_the_precision(made: Any, name: str, dtype: type) -> None:
    array = getattr(made, name)
    assert array.shape == (*outer(made), QUANTITIES[name])
    assert array.dtype == dtype and array.flags.c_contiguous and array.flags.writeable
    kept = array.copy()
    made.push(forces=[1.0, 2.0, 3.0])
    made.step(5)
    assert np.array_equal(array, kept)
    assert not np.array_equal(getattr(made, name), kept)
    before = hashes(made)
    getattr(made, name)[...] = 7
    assert hashes(made) == before


def test_states_are_the_quantities_side_by_side(made: Any) -> None:
    made.step(3)
    parts = [getattr(made, name) for name in list(QUANTITIES)[:4]]
    assert np.array_equal(made.states, np.concatenate(parts, axis=-1))


@pytest.mark.parametrize("name", list(QUANTITIES))
def test_what_was_read_can_be_set_again(lib: ModuleType, made: Any, name: str, eps: float) -> None:
    made.step(7)
    array = getattr(made, name)
    fresh = type(made)(floating(BODIES), *outer(made)[:-1])
    setattr(fresh, name, array)
    assert np.allclose(getattr(fresh, name), array, rtol=0, atol=16 * eps * np.abs(array).max())


def test_states_are_written_into_an_array_that_is_there(made: Any, dtype: type) -> None:
    out = np.full_like(made.states, np.nan)
    assert made.read_states(out) is out
    assert np.array_equal(out, made.states)
    part = np.full((2, *made.states.shape), np.nan, dtype)
    made.read_states(part[1])
    assert np.array_equal(part[1], made.states) and np.isnan(part[0]).all()


@pytest.mark.parametrize("call", ["read_states", "step"])
def test_an_array_that_cannot_be_written_is_refused(lib: ModuleType, made: Any, call: str, dtype: type) -> None:
    if call == "step" and isinstance(made, lib.Simulation):
        call = "read_states"
    write = made.read_states if call == "read_states" else lambda out: made.step(3, out=out)
    shape = made.states.shape
    read_only = np.zeros(shape, dtype)
    read_only.flags.writeable = False
    bytes_of = np.zeros(np.prod(shape) * np.dtype(dtype).itemsize + 1, np.uint8)
    values = [read_only, np.zeros((*shape, 2), dtype)[..., 0], np.zeros(shape, dtype)[..., ::-1]]
    values += [np.zeros(shape, dtype, order="F"), np.zeros((shape[0] + 1, *shape[1:]), dtype)]
    values += [np.zeros(np.prod(shape), dtype), bytes_of[1:].view(dtype).reshape(shape)]
    for out in values:
        refused(lib, made, "out", partial(write, out), lib.ArgumentError)
        assert not out.any()
    other = np.float64 if dtype == np.float32 else np.float32
    kinds: list[Any] = [other, np.dtype(dtype).newbyteorder(), np.int32, bool, complex, object, "U4"]
    for wrong in [*(np.zeros(shape, kind) for kind in kinds), np.zeros(shape).tolist(), 3]:
        refused(lib, made, "out", partial(write, wrong), lib.ArgumentTypeError)


@pytest.mark.parametrize("key", list(CALLS))
def test_numbers_in_any_form_give_the_same_bits(lib: ModuleType, made: Any, key: str, dtype: type) -> None:
    field, call = CALLS[key]
    value = good(made, field)
    call(made, value)
    wanted = hash_after_a_step(made)
    forms: dict[str, Any] = {
        "list": value.tolist(),
        "precision": value.astype(dtype),
        "big-endian": value.astype(">f8"),
        "Fortran": np.asfortranarray(value),
        "strided": np.repeat(value, 2, axis=-1)[..., ::2],
        "negative strides": value[..., ::-1].copy()[..., ::-1],
        "transposed": np.moveaxis(np.moveaxis(value, -1, 0).copy(), 0, -1),
        "long": value.astype(np.longdouble),
    }
    for form, given in forms.items():
        again = type(made)(floating(BODIES), *outer(made)[:-1])
        call(again, given)
        assert hash_after_a_step(again) == wanted, form


@pytest.mark.parametrize("key", [key for key in CALLS if "orientations" not in key])
def test_integers_and_single_numbers_are_repeated_over_bodies_and_worlds(lib: ModuleType, made: Any, key: str) -> None:
    field, call = CALLS[key]
    if field == "states":
        one: list[Any] = [[1, 2, 3, 0, 0, 0, 1, 4, 5, 6, 7, 8, 9]]
    else:
        one = [2, 2, 2]
    whole = np.broadcast_to(np.array(one, float), (*outer(made), np.size(one)))
    call(made, whole)
    wanted = hash_after_a_step(made)
    forms: list[Any] = [np.array(one, kind) for kind in (np.int8, np.uint64, np.int32, np.float16)] + [one]
    forms += [] if field == "states" else [2, np.array(2), np.float32(2), whole[0], np.full(1, 2.0)]
    for given in forms:
        again = type(made)(floating(BODIES), *outer(made)[:-1])
        call(again, given)
        assert hash_after_a_step(again) == wanted, given


@pytest.mark.parametrize("key", list(CALLS))
@pytest.mark.parametrize("value", [True, 1j, "1", b"1", None, [1, [2]], [2**70] * 3, object(), [[]], DATE], ids=repr)
def test_what_is_no_real_number_is_refused(lib: ModuleType, made: Any, key: str, value: Any) -> None:
    field, call = CALLS[key]
    if value is None and not key.endswith("="):
        return
    kind = lib.ArgumentError if isinstance(value, list) and value == [[]] else lib.ArgumentTypeError
    refused(lib, made, field, lambda: call(made, value), kind)


@pytest.mark.parametrize("key", list(CALLS))
def test_a_wrong_shape_is_refused(lib: ModuleType, made: Any, key: str) -> None:
    field, call = CALLS[key]
    value = good(made, field)
    wrong = [value[..., :2], value[..., :1, :-1], value[None, None], np.zeros(0), np.concatenate([value, value])]
    for given in wrong:
        refused(lib, made, field, partial(call, made, given), lib.ArgumentError)


@pytest.mark.parametrize("key", list(CALLS))
@pytest.mark.parametrize("number", [np.nan, np.inf, -np.inf, 1e39, "too large"])
def test_an_impossible_number_in_the_last_world_changes_none(
    lib: ModuleType, made: Any, key: str, number: float | str
) -> None:
    field, call = CALLS[key]
    number = TOO_LARGE[field] if number == "too large" else float(number)
    value = good(made, field)
    value[..., -1, -1] += 1e-4
    value.reshape(-1)[0] += 2e-4
    value[(-1,) * value.ndim] = number
    if field == "states" and number == TOO_LARGE["states"]:
        value[(-1,) * (value.ndim - 1)][0] = number
    refused(lib, made, field, lambda: call(made, value), lib.ArgumentError)
    assert hash_after_a_step(made) == fresh_hash(lib, made)


@pytest.mark.parametrize(
    ("field", "body", "value"),
    [
        ("linear_velocities", "wall", [1, 0, 0]),
        ("angular_velocities", "wall", [0, 1, 0]),
        ("angular_velocities", "point", [0, 1, 0]),
    ],
)
def test_a_velocity_that_a_body_cannot_have_changes_no_body(lib: ModuleType, field: str, body: str, value: Any) -> None:
    simulation, batch = lib.Simulation(mixed()), lib.Batch(mixed(), 2)
    for made in (simulation, batch):
        given = np.zeros((2, 3))
        given[1] = value
        refused(lib, made, field, lambda: made.set_state(["b0", body], positions=[5, 5, 5], **{field: given}))
        given[1] = 0
        made.set_state(["b0", body], **{field: given})


def test_a_velocity_whose_momentum_overflows_changes_no_body() -> None:
    # In double precision no mass that a scene may have is so large.
    model = {"bodies": [box("light", mass=1.0), {"name": "heavy", "mass": 1e37}]}
    speed = np.array([[1.0, 0, 0], [1e9, 0, 0]])
    for made in (tumble.Simulation(model), tumble.Batch(model, 2)):
        refused(tumble, made, "linear_velocities", partial(made.set_state, linear_velocities=speed))


def test_a_setter_with_one_bad_argument_applies_none(lib: ModuleType, made: Any) -> None:
    bad = [np.nan, 0, 0]
    refused(lib, made, "angular_velocities", lambda: made.set_state(positions=[1, 1, 1], angular_velocities=bad))
    refused(lib, made, "torques", lambda: made.push(forces=[1, 1, 1], torques=bad))
    refused(lib, made, "torques", lambda: made.set_forces(forces=[1, 1, 1], torques=bad))
    refused(lib, made, "points", lambda: made.push(torques=[1, 1, 1], points=[0, 0, 0]))
    refused(lib, made, "frame", lambda: made.set_forces(forces=[1, 1, 1], frame="local"))
    assert hash_after_a_step(made) == fresh_hash(lib, made)


def test_drives_with_one_bad_argument_stay(lib: ModuleType) -> None:
    for made in (lib.Simulation(DRIVEN), lib.Batch(DRIVEN, 3)):
        before = made.drive_velocities
        for field, value in [("max_forces", -1), ("max_forces", np.nan), ("positions", np.inf), ("positions", "a")]:
            given: dict[str, Any] = {"velocities": 5.0, field: value}
            refused(lib, made, field, partial(made.set_drives, **given))
        too_large = 1e39 if lib.PRECISION == "f32" else np.inf
        wrong: list[Any] = [np.nan, np.inf, too_large, True, [1, 2], [[[1]]] * 5]
        for value in wrong:
            refused(lib, made, "velocities", partial(made.set_drives, positions=1, velocities=value))
        assert np.array_equal(made.drive_velocities, before) and np.isnan(made.drive_positions).all()


def test_an_empty_choice_takes_empty_arrays_and_does_nothing(lib: ModuleType, made: Any) -> None:
    empty = np.zeros((*outer(made)[:-1], 0, 3))
    for value in (empty, [0.0, 0.0, 0.0]):
        made.push([], forces=value)
        made.set_forces([], torques=value)
        made.set_state([], positions=value)
        made.set_state(np.zeros(BODIES, bool), linear_velocities=value)
    if isinstance(made, lib.Batch):
        made.push(worlds=[], forces=np.zeros((0, BODIES, 3)))
        made.reset([])
    assert hash_after_a_step(made) == fresh_hash(lib, made)


def test_inputs_are_neither_kept_nor_changed(lib: ModuleType, made: Any) -> None:
    value = np.ones((*outer(made), 3))
    kept, references = value.copy(), sys.getrefcount(value)
    for _ in range(10):
        made.push(forces=value, torques=value, points=value)
        made.set_state(positions=value)
        made.positions = value
        with pytest.raises(lib.ArgumentError):
            made.push(forces=value[..., :2])
    made.step()
    assert np.array_equal(value, kept)
    assert sys.getrefcount(value) == references


def test_too_large_for_single_precision_is_refused_without_a_warning(recwarn: Any, lib: ModuleType, made: Any) -> None:
    for number in (np.float64(1e300), np.longdouble("1e4000")):
        refused(lib, made, "forces", partial(made.push, forces=np.array([number, 0, 0])))
    assert [str(warning.message) for warning in recwarn] == []
