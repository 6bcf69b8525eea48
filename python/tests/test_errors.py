"""Promise: what is wrong is named by file, body, field, world or argument, and nothing crashes."""

from __future__ import annotations

import json
import pickle
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import tumble
import tumble.double
from models import box, boxes_on_ground, floating, hinged, mixed

OUT_OF_RANGE: list[tuple[str, Any]] = [
    ("dt", 0),
    ("dt", -0.1),
    ("dt", float("nan")),
    ("dt", float("inf")),
    ("dt", 1e-300),
    ("substeps", 0),
    ("substeps", -1),
    ("substeps", 2**32),
    ("substeps", 2**62),
    ("contact_substeps", 0),
    ("contact_substeps", 1001),
    ("contact_substeps", -(2**40)),
    ("gravity", [0, 1e10, 0]),
    ("gravity", [0, np.nan, 0]),
    ("gravity", [0, 1]),
    ("gravity", np.zeros((2, 3))),
    ("integrator", "euler"),
    ("integrator", ""),
]
WRONG_TYPE: list[tuple[str, Any]] = [
    ("dt", "a"),
    ("substeps", 1.5),
    ("contact_substeps", "2"),
    ("gravity", "down"),
    ("gravity", [True, False, True]),
    ("integrator", 3),
    ("sleep", "yes"),
]


@pytest.mark.parametrize(("field", "value"), OUT_OF_RANGE, ids=repr)
def test_a_setting_out_of_range_is_named(lib: ModuleType, field: str, value: Any) -> None:
    for make in (lib.Simulation, lambda scene, **given: lib.Batch(scene, 2, **given)):
        with pytest.raises(lib.ArgumentError) as caught:
            make(floating(), **{field: value})
        assert caught.value.field == field and str(caught.value).startswith(f"{field}: ")
        assert isinstance(caught.value, ValueError) and isinstance(caught.value, lib.TumbleError)


@pytest.mark.parametrize(("field", "value"), WRONG_TYPE, ids=repr)
def test_a_setting_of_a_wrong_type_is_a_type_error(lib: ModuleType, field: str, value: Any) -> None:
    for make in (lib.Simulation, lambda scene, **given: lib.Batch(scene, 2, **given)):
        with pytest.raises(TypeError, match=field):
            make(floating(), **{field: value})


def test_negative_and_huge_counts_are_refused_by_name(lib: ModuleType) -> None:
    simulation, batch = lib.Simulation(floating()), lib.Batch(floating(), 2)
    calls: dict[str, list[Callable[[int], Any]]] = {
        "count": [simulation.step, batch.step, lambda count: batch.step(count, out=batch.states), lib.set_threads],
        "steps": [simulation.record],
        "every": [lambda count: simulation.record(3, every=count)],
        "worlds": [lambda count: lib.Batch(floating(), count)],
        "bodies": [lambda count: lib.Scene("pile", bodies=count)],
        "seed": [lambda count: lib.Scene("pile", seed=count)],
    }
    before = simulation.state_hash, batch.state_hashes()
    for field, functions in calls.items():
        for call in functions:
            for count in [-1, -(2**63), *([] if field in ("bodies", "seed") else [2**40])]:
                with pytest.raises(lib.ArgumentError) as caught:
                    call(count)
                assert caught.value.field == field
            for number in (1.5, "2", None if field in ("count", "every", "worlds") else [1], 2**70):
                with pytest.raises((TypeError, OverflowError)):
                    call(number)  # type: ignore[arg-type]
    with pytest.raises(lib.ArgumentError):
        simulation.record(3, every=0)
    with pytest.raises(lib.ArgumentError):
        lib.Batch(floating(), 0)
    assert before == (simulation.state_hash, batch.state_hashes())
    simulation.step(0)
    batch.step(0)
    assert before == (simulation.state_hash, batch.state_hashes())


@pytest.mark.parametrize("way", ["dict", "text", "file"])
def test_an_error_of_a_scene_has_file_body_and_field(lib: ModuleType, way: str, tmp_path: Path) -> None:
    model = floating(2)
    model["bodies"][1]["mass"] = -2.5
    path = tmp_path / "bad.json"
    path.write_text(json.dumps(model))
    makes = {
        "dict": lambda: lib.Scene(model),
        "text": lambda: lib.Scene.from_text(json.dumps(model), file="bad.json"),
        "file": lambda: lib.Scene(path),
    }
    with pytest.raises(lib.SceneError, match="-2.5") as caught:
        makes[way]()
    assert isinstance(caught.value, ValueError)
    error: Any = caught.value
    assert (error.body, error.field) == ("b1", "mass")
    assert error.file == {"dict": "scene", "text": "bad.json", "file": str(path)}[way]
    copy = pickle.loads(pickle.dumps(error))
    assert (str(copy), copy.file, copy.body, copy.field) == (str(error), error.file, error.body, error.field)


def test_errors_of_scenes_name_what_they_know(lib: Any, tmp_path: Path) -> None:
    with pytest.raises(lib.SceneError, match='did you mean "t-handle"') as unknown:
        lib.Scene("t-handel")
    assert (unknown.value.file, unknown.value.body, unknown.value.field) == ("t-handel", None, None)
    with pytest.raises(lib.SceneError, match="nowhere.json") as caught:
        lib.Scene(tmp_path / "nowhere.json")
    assert caught.value.file == str(tmp_path / "nowhere.json")
    with pytest.raises(lib.SceneError, match="json, .ron"):
        lib.Scene(Path("t-handle"))
    with pytest.raises(lib.SceneError) as caught:
        lib.Scene({"gravty": [0, 0, 0]})
    assert "gravty" in str(caught.value)
    with pytest.raises(lib.SceneError) as caught:
        lib.Scene({"bodies": [box("twin"), box("twin")]})
    assert "twin" in str(caught.value)


NO_SCENES: list[Any] = [None, 3, 1.5, [], b"t-handle", object()]
NO_SCENES += [{(1, 2): 3}, {"gravity": [0, 1j, 0]}, {"a": object()}, {"a": {1}}]


@pytest.mark.parametrize("scene", NO_SCENES)
def test_what_is_no_scene_is_a_type_error_of_the_argument(lib: ModuleType, scene: Any) -> None:
    for make in (lib.Scene, lib.Simulation, lambda scene: lib.Batch(scene, 2)):
        with pytest.raises(lib.ArgumentTypeError) as caught:
            make(scene)
        assert caught.value.field == "scene"


def test_a_dict_that_contains_itself_is_refused(lib: ModuleType) -> None:
    model: dict[str, Any] = {}
    model["bodies"] = [model]
    deep: Any = {}
    for _ in range(100_000):
        deep = {"bodies": [deep]}
    for scene in (model, deep):
        with pytest.raises(lib.ArgumentTypeError):
            lib.Scene(scene)


def test_numbers_and_arrays_of_numpy_have_a_place_in_a_dict(lib: ModuleType) -> None:
    plain = floating(2)
    numpy = {**plain, "gravity": np.zeros(3), "dt": np.float64(plain["dt"]), "steps": np.int32(7)}
    numpy["bodies"] = [{**body, "mass": np.int8(body["mass"])} for body in plain["bodies"]]
    plain["steps"] = 7
    made = [lib.Simulation(model) for model in (plain, numpy)]
    assert made[0].state_hash == made[1].state_hash
    assert made[1].masses.tolist() == [1, 2] and made[1].scene.steps == 7


@pytest.mark.parametrize("path", ["bodies.nobody.mass", "bodies.9.mass", "mass", "", "bodies.b0.name", "bodies..mass"])
def test_a_path_that_cannot_vary_is_named(lib: ModuleType, path: str) -> None:
    with pytest.raises(lib.ArgumentError) as caught:
        lib.Batch(floating(2), 2, vary={path: [1, 2]})
    assert caught.value.field is not None and caught.value.field.startswith("vary") and path in str(caught.value)


@pytest.mark.parametrize("value", [-1.0, 0.0, np.nan, np.inf])
def test_the_world_whose_number_is_impossible_is_named(lib: ModuleType, value: float) -> None:
    masses = [1.0, 2.0, value, 4.0, value]
    with pytest.raises(lib.SceneError, match="^world 2: ") as caught:
        lib.Batch(floating(2), 5, vary={"bodies.b1.mass": masses})
    assert (caught.value.body, caught.value.field) == ("b1", "mass")


def test_vary_is_refused_by_name_where_it_cannot_be_used(lib: ModuleType) -> None:
    path = "bodies.b1.mass"
    field = f'vary["{path}"]'
    for value in ([1, 2], "a", [True, True, False], np.ones((3, 3))):
        with pytest.raises((lib.ArgumentError, lib.ArgumentTypeError)) as caught:
            lib.Batch(floating(2), 3, vary={path: value})
        assert caught.value.field == field
    with pytest.raises(lib.ArgumentError, match="twice"):
        lib.Batch(floating(2), 3, vary={path: 1, "bodies.1.mass": 1})
    with pytest.raises(lib.ArgumentTypeError):
        lib.Batch(floating(2), 3, vary={1: 1})
    for scene in (lib.Scene("pile", bodies=30), lib.Scene("pile", seed=3)):
        with pytest.raises(lib.ArgumentError) as caught:
            lib.Batch(scene, 2, vary={"gravity.1": 1})
        assert caught.value.field == "vary"


def test_a_reset_with_impossible_numbers_resets_nothing(lib: ModuleType) -> None:
    path = "bodies.b1.mass"
    batch = lib.Batch(floating(2), 3, vary={path: [1, 2, 3]})
    batch.step(3)
    before = batch.state_hashes()
    for vary, kind in [
        ({path: [5, 5, -1]}, lib.SceneError),
        ({path: [5, 5]}, lib.ArgumentError),
        ({"gravity.1": 1}, lib.ArgumentError),
        ({path: 5, "gravity.1": 1}, lib.ArgumentError),
    ]:
        with pytest.raises(kind):
            batch.reset(vary=vary)
    with pytest.raises(lib.SceneError, match="^world 2: "):
        batch.reset([0, 2], vary={path: [5, -1]})
    assert batch.state_hashes() == before and batch.steps.tolist() == [3, 3, 3]
    batch.reset()
    assert batch.state_hashes() == lib.Batch(floating(2), 3, vary={path: [1, 2, 3]}).state_hashes()
    with pytest.raises(lib.ArgumentError) as caught:
        lib.Batch(floating(2), 3).reset(vary={path: 1})
    assert caught.value.field == "vary"


def test_a_constant_force_of_the_scene_is_not_overwritten(lib: ModuleType) -> None:
    model = floating(2)
    model["bodies"][1]["forces"] = [{"constant_wrench": {"force": [1, 0, 0]}}]
    for made in (lib.Simulation(model), lib.Batch(model, 2)):
        with pytest.raises(lib.ArgumentError, match="b1"):
            made.set_forces(forces=[0, 0, 1])
        made.set_forces("b0", forces=[0, 0, 1])
        made.step()
        assert np.all(made.linear_velocities[..., 1, 0] > 0) and np.all(made.linear_velocities[..., 0, 2] > 0)


@pytest.mark.parametrize("model", [floating(1), hinged(), boxes_on_ground(2)], ids=["free", "hinge", "contacts"])
def test_a_snapshot_damaged_at_any_byte_is_refused_or_restored(lib: ModuleType, model: dict[str, Any]) -> None:
    simulation = lib.Simulation(model, sleep=True)
    simulation.step(20)
    data = bytes(simulation.snapshot())
    refused = 0
    for at in range(len(data)):
        for mask in (0x01, 0x80, 0xFF):
            damaged = bytearray(data)
            damaged[at] ^= mask
            try:
                simulation.restore(lib.Snapshot(bytes(damaged)))
                simulation.step(2)
            except lib.SnapshotError:
                refused += 1
        with pytest.raises(lib.SnapshotError):
            lib.Snapshot(data[:at])
    assert refused > 0
    with pytest.raises(lib.SnapshotError):
        lib.Snapshot(data + b"\0")
    simulation.restore(lib.Snapshot(data))
    assert bytes(simulation.snapshot()) == data


def test_a_snapshot_of_another_scene_changes_nothing(lib: ModuleType) -> None:
    others = [floating(2), floating(5), mixed(), boxes_on_ground(3)]
    simulation, batch = lib.Simulation(floating(4)), lib.Batch(floating(4), 2)
    before = simulation.state_hash
    for other in others:
        snapshot = lib.Simulation(other).snapshot()
        for restore in (simulation.restore, lambda it: batch.restore(1, it)):
            with pytest.raises(lib.SnapshotError):
                restore(snapshot)
    assert {simulation.state_hash, *batch.state_hashes()} == {before}


def test_objects_of_the_other_precision_are_refused(lib: ModuleType) -> None:
    other = tumble.double if lib is tumble else tumble
    simulation = lib.Simulation(floating())
    snapshot = other.Simulation(floating()).snapshot()
    with pytest.raises(lib.ArgumentTypeError):
        lib.Simulation(other.Scene("t-handle"))
    with pytest.raises(TypeError):
        simulation.restore(snapshot)
    with pytest.raises(lib.SnapshotError, match=lib.PRECISION):
        lib.Snapshot(bytes(snapshot))
    assert (snapshot == simulation.snapshot()) is False
    for data in (b"", b"x", bytes(1000), b"\xff" * 1000):
        with pytest.raises(lib.SnapshotError):
            lib.Snapshot(data)


def test_arguments_that_are_not_there_and_values_that_are_read_only_are_refused(lib: ModuleType) -> None:
    simulation = lib.Simulation(floating())
    wrong: list[Callable[[], Any]] = [lambda: simulation.step(counts=1), lambda: simulation.push(force=[1, 0, 0])]
    wrong += [lambda: lib.Batch("t-handle"), lambda: lib.Simulation("t-handle", 0.01)]
    for call in wrong:
        with pytest.raises(TypeError):
            call()
    for name in ("time", "steps", "scene", "state_hash", "masses", "nothing"):
        with pytest.raises(AttributeError):
            setattr(simulation, name, 1)
    with pytest.raises(AttributeError):
        del simulation.positions
    for kind in (lib.Simulation, lib.Batch, lib.Scene, lib.Snapshot, lib.Recording):
        with pytest.raises(TypeError):
            type("Mine", (kind,), {})
    with pytest.raises(TypeError):
        lib.Recording()
    with pytest.raises(TypeError):
        hash(simulation.snapshot())
