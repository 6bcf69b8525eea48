"""Promise: contacts and rays tell which bodies touch, where, how hard and from which side."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np
import pytest

from models import GRAVITY, GROUND, box, box_at_rest, floating


@pytest.mark.parametrize("mass", [1e-3, 2.0, 1e5])
def test_the_impulses_of_a_substep_carry_the_weight(lib: ModuleType, mass: float, dtype: type) -> None:
    simulation = lib.Simulation(box_at_rest(mass))
    assert simulation.contacts()["bodies"].shape == (0, 2)
    simulation.step(120)
    contacts = simulation.contacts()
    count = len(contacts["bodies"])
    assert count == 4
    assert contacts["bodies"].tolist() == [[0, 1]] * 4 and contacts["bodies"].dtype == np.int64
    assert contacts["points"].shape == contacts["normals"].shape == (4, 3)
    assert contacts["separations"].shape == contacts["impulses"].shape == (4,)
    assert contacts["points"].dtype == contacts["impulses"].dtype == dtype
    assert contacts["substep"] == pytest.approx(simulation.dt / 4, rel=1e-6)
    assert np.allclose(contacts["normals"], [0, 1, 0], atol=1e-4)
    assert contacts["impulses"].sum() / contacts["substep"] == pytest.approx(mass * GRAVITY, rel=0.01)
    corners = np.abs(contacts["points"])
    assert np.allclose(corners, [0.5, 0, 0.5], atol=0.01) and np.abs(contacts["separations"]).max() < 0.01


def test_normals_lead_from_the_first_body_to_the_second(lib: ModuleType) -> None:
    places = {"left": [-0.99, 0, 0], "middle": [0, 0, 0], "right": [0.99, 0, 0]}
    bodies = [box(name, position=place, collider={}) for name, place in places.items()]
    simulation = lib.Simulation({"gravity": [0, 0, 0], "bodies": bodies})
    simulation.step()
    contacts = simulation.contacts()
    assert len(contacts["bodies"]) > 0
    for (first, second), normal in zip(contacts["bodies"], contacts["normals"], strict=True):
        assert normal[0] * (simulation.positions[second, 0] - simulation.positions[first, 0]) > 0.9


@pytest.mark.parametrize("steps", [60, 400, 5000])
def test_events_are_those_of_the_whole_call(lib: ModuleType, steps: int) -> None:
    simulation = lib.Simulation({"bodies": [GROUND, box("b0", position=[0, 1, 0], collider={})]})
    simulation.step(2)
    assert simulation.contact_events() == []
    simulation.step(steps)
    events = simulation.contact_events()
    assert events and events[0] == ("begin", "ground", "b0")
    simulation.step(3)
    assert simulation.contact_events() == []
    simulation.set_state("b0", positions=[0, 9, 0])
    simulation.step(5)
    assert simulation.contact_events() == [("end", "ground", "b0")]


def ray(lib: ModuleType, *arguments: Any, **named: Any) -> Any:
    simulation = lib.Simulation(box_at_rest())
    return simulation.cast_rays(*arguments, **named)


def test_a_ray_meets_the_ground_at_its_distance(lib: ModuleType, dtype: type) -> None:
    heights = np.array([1.0, 2.5, 100.0])
    origins = np.stack([np.full(3, 7.0), heights, np.zeros(3)], axis=1)
    hits = ray(lib, origins, [0, -1, 0])
    assert hits["bodies"].tolist() == [0, 0, 0] and hits["bodies"].dtype == np.int64
    assert np.allclose(hits["distances"], heights) and hits["distances"].dtype == dtype
    assert np.allclose(hits["points"], [[7, 0, 0]] * 3, atol=1e-5)
    assert np.allclose(hits["normals"], [[0, 1, 0]] * 3)


def test_a_ray_meets_what_is_first(lib: ModuleType) -> None:
    origins = np.array([[0, 5, 0], [-5, 0.5, 0], [5, 0.25, 0]])
    hits = ray(lib, origins, [[0, -1, 0], [1, 0, 0], [-1, 0, 0]])
    assert hits["bodies"].tolist() == [1, 1, 1]
    assert np.allclose(hits["distances"], [4, 4.5, 4.5])
    assert np.allclose(hits["normals"], [[0, 1, 0], [-1, 0, 0], [1, 0, 0]], atol=1e-6)
    assert np.allclose(hits["points"], np.array([[0, 1, 0], [-0.5, 0.5, 0], [0.5, 0.25, 0]]), atol=1e-5)


def test_a_ray_that_misses_has_no_body_and_no_place(lib: ModuleType) -> None:
    hits = ray(lib, [[0, 5, 0], [0, 5, 0]], [[0, 1, 0], [1, 0, 0]])
    assert hits["bodies"].tolist() == [-1, -1] and np.isposinf(hits["distances"]).all()
    assert np.isnan(hits["points"]).all() and np.isnan(hits["normals"]).all()
    for far, body in [(3.9, -1), (4.1, 1), (np.inf, 1)]:
        assert ray(lib, [0, 5, 0], [0, -1, 0], far)["bodies"].tolist() == [body]
        assert ray(lib, [0, 5, 0], [0, -1, 0], max_distance=far)["bodies"].tolist() == [body]


@pytest.mark.parametrize("length", [1e-44, 1e-20, 0.3, 1e20, 3e38])
def test_the_length_of_a_direction_does_not_matter(lib: ModuleType, length: float) -> None:
    hits = ray(lib, [0, 5, 0], [0, -length, 0])
    assert hits["bodies"].tolist() == [1] and hits["distances"][0] == pytest.approx(4, rel=1e-5)


def test_rays_follow_the_bodies(lib: ModuleType) -> None:
    simulation = lib.Simulation(box_at_rest())
    simulation.set_state("b0", positions=[0, 3, 0])
    assert simulation.cast_rays([0, 9, 0], [0, -1, 0])["distances"].tolist() == pytest.approx([5.5])
    assert lib.Simulation(floating(2)).cast_rays([0, 9, 0], [0, -1, 0])["bodies"].tolist() == [-1]


def test_wrong_rays_are_refused_by_name(lib: ModuleType) -> None:
    simulation = lib.Simulation(box_at_rest())
    origins, down = np.ones((3, 3)), [0, -1, 0]
    wrong: list[tuple[str, tuple[Any, ...]]] = [
        ("origins", ([[0, 0], [1, 1]], down)),
        ("origins", ([[0, 0, 0], [1]], down)),
        ("origins", ("a", down)),
        ("origins", (np.ones((2, 2, 3)), down)),
        ("origins", ([0, np.nan, 0], down)),
        ("directions", (origins, [0, 0, 0])),
        ("directions", (origins, np.ones((2, 3)))),
        ("directions", (origins, [0, np.inf, 0])),
        ("directions", (origins, [True, False, False])),
        ("max_distance", (origins, down, -1.0)),
        ("max_distance", (origins, down, np.nan)),
    ]
    for field, arguments in wrong:
        with pytest.raises((lib.ArgumentError, lib.ArgumentTypeError)) as caught:
            simulation.cast_rays(*arguments)
        assert caught.value.field == field
    none = simulation.cast_rays(np.zeros((0, 3)), down)
    assert [none[name].shape for name in ("bodies", "distances", "points", "normals")] == [(0,), (0,), (0, 3), (0, 3)]
