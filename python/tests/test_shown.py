"""Promise: objects print what they are, and a recording shows itself without loading anything from elsewhere."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from models import boxes_on_ground, floating, hinged

LOADS = (
    r"url\(\s*['\"]?\s*(?!['\"]?(?:data:|#))|@import|\bimport\s*\(|\bfetch\s*\("
    r"|XMLHttpRequest|WebSocket|importScripts|EventSource|sendBeacon"
)


class Page(HTMLParser):
    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str, str]] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes += [(tag, name, value or "") for name, value in attrs]


class Text(HTMLParser):
    """What is read on a page."""

    def __init__(self, page: str) -> None:
        super().__init__(convert_charrefs=True)
        self.shown, self.hidden = "", False
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.hidden = tag in ("script", "style")

    def handle_endtag(self, tag: str) -> None:
        self.hidden = False

    def handle_data(self, data: str) -> None:
        self.shown += "" if self.hidden else data


def assert_loads_nothing(text: str) -> None:
    page = Page(text)
    for tag, name, value in page.attributes:
        if name in ("src", "href", "xlink:href", "action", "data", "poster", "srcset"):
            assert value.startswith(("#", "data:")), (tag, name, value)
    assert not {"iframe", "object", "embed", "base"} & set(page.tags)
    found = re.search(LOADS, text)
    assert found is None, text[found.start() - 40 : found.end() + 40] if found else ""


@pytest.fixture
def prefix(lib: ModuleType) -> str:
    return "<tumble.double." if lib.PRECISION == "f64" else "<tumble."


def test_objects_print_their_class_name_and_counts(lib: ModuleType, prefix: str) -> None:
    model = {**hinged(), "name": "the \"clock\""}
    scene, batch = lib.Scene(model), lib.Batch(model, 3)
    simulation, other = lib.Simulation(model), lib.Simulation(model)
    simulation.step(12)
    time = 12 / 240
    parts: list[tuple[Any, str, list[str]]] = [
        (scene, "Scene", ["clock", "2 bodies", "1 joint", "600 steps", f"{1 / 240:.6f} s"]),
        (simulation, "Simulation", ["clock", "2 bodies", "step 12", f"{time:.6f} s"]),
        (batch, "Batch", ["clock", "3 worlds", "2 bodies"]),
        (simulation.snapshot(), "Snapshot", ["2 bodies", "12 steps", simulation.state_hash]),
        (other.record(18, every=6), "Recording", ["clock", "4 frames", f"{18 / 240:.6f} s"]),
    ]
    for made, kind, texts in parts:
        shown = repr(made)
        assert shown.startswith(prefix + kind) and shown.endswith(">") and "\n" not in shown
        assert [text for text in texts if text not in shown] == [], shown
    assert prefix.strip("<") == f"{type(scene).__module__}."
    assert [len(made) for made, _, _ in parts] == [2, 2, 3, 2, 4]


@pytest.mark.parametrize("every", [1, 3, 7, 100])
def test_a_recording_has_the_states_of_stepping_by_hand(lib: ModuleType, every: int) -> None:
    steps, model = 20, boxes_on_ground(3)
    simulation, by_hand = lib.Simulation(model), lib.Simulation(model)
    for made in (simulation, by_hand):
        made.step(5)
    recording = simulation.record(steps, every=every)
    ends = [*range(0, steps, every), steps]
    states, times, energies, done = [], [], [], 0
    for end in ends:
        by_hand.step(end - done)
        done = end
        states.append(by_hand.states)
        times.append(by_hand.time)
        energies.append(by_hand.totals()["energy"])
    assert len(recording) == len(ends)
    assert np.array_equal(recording.states, states) and recording.states.dtype == states[0].dtype
    assert recording.times.tolist() == times
    assert np.allclose(recording.energies, energies, rtol=1e-9, atol=0)
    assert simulation.state_hash == by_hand.state_hash
    assert recording.body_names == simulation.body_names == ["ground", "b0", "b1", "b2"]


@pytest.mark.parametrize("every", [1, 4])
def test_a_recording_is_controlled_before_each_step(lib: ModuleType, every: int) -> None:
    simulation, by_hand = lib.Simulation(floating(2)), lib.Simulation(floating(2))
    seen: list[int] = []

    def push(given: Any) -> None:
        assert given is simulation
        seen.append(given.steps)
        given.push("b1", forces=[given.steps + 1.0, 0, 0])

    recording = simulation.record(10, every=every, control=push)
    for step in range(10):
        by_hand.push("b1", forces=[step + 1.0, 0, 0])
        by_hand.step()
    assert seen == list(range(10)) and len(recording) == len({*range(0, 10, every), 10})
    assert np.array_equal(recording.states[-1], by_hand.states)
    assert simulation.state_hash == by_hand.state_hash

    def fails(given: Any) -> None:
        if given.steps == 12:
            raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        simulation.record(10, control=fails)
    assert simulation.steps == 12
    with pytest.raises(TypeError):
        simulation.record(1, control=3)


def test_a_recording_whose_control_goes_back_counts_no_steps_below_0(lib: ModuleType) -> None:
    simulation = lib.Simulation(floating(2))
    start = simulation.snapshot()
    simulation.step(10)
    recording = simulation.record(3, control=lambda made: made.restore(start))
    assert len(recording) == 4 and simulation.steps == 1
    assert re.search(r"\d{12,}|(\d{3}[^\d<>]?){5}", Text(recording.html()).shown) is None


def test_a_recording_keeps_its_states(lib: ModuleType) -> None:
    simulation = lib.Simulation(floating(2))
    recording = simulation.record(3)
    kept = recording.states.copy()
    assert recording.states is recording.states
    simulation.step(5)
    assert np.array_equal(recording.states, kept)
    assert len(simulation.record(0)) == 1
    assert len(lib.Simulation(floating(2, steps=4)).record()) == 5


@pytest.mark.parametrize("scene", ["t-handle", "cradle", "arm", "windy-day", "hills", "skater"])
def test_a_page_is_html_that_loads_nothing_from_elsewhere(lib: ModuleType, scene: str) -> None:
    recording = lib.Simulation(scene).record(10, every=2)
    page = recording.html()
    assert page.startswith("<!DOCTYPE html>") and page.rstrip().endswith("</html>")
    assert_loads_nothing(page)
    assert "canvas" in Page(page).tags and "svg" in Page(page).tags
    policy = [value for tag, name, value in Page(page).attributes if (tag, name) == ("meta", "content")]
    assert any("default-src 'none'" in value for value in policy)


def test_a_notebook_gets_the_page_in_a_frame(lib: ModuleType) -> None:
    name = "<b> & \"co\" </script> it's"
    recording = lib.Simulation(floating(2, name=name)).record(4)
    frame = Page(recording._repr_html_())
    assert frame.tags == ["iframe"]
    attributes = {name: value for _, name, value in frame.attributes}
    assert attributes["srcdoc"] == recording.html()
    assert "src" not in attributes
    page = Page(recording.html())
    assert "b" not in page.tags
    assert_loads_nothing(recording.html())


def test_a_page_has_the_numbers_of_the_run(lib: ModuleType) -> None:
    simulation = lib.Simulation("t-handle")
    page = simulation.record(600).html()
    assert simulation.state_hash in page and lib.PRECISION in page


def test_built_in_scenes_are_listed_with_what_they_show(lib: ModuleType) -> None:
    listed = lib.scenes()
    assert {"t-handle", "pile", "cradle"} <= set(listed)
    assert all(isinstance(text, str) and text for text in listed.values())
    for name in ("t-handle", "arm"):
        scene = lib.Scene(name)
        assert scene.origin == name and scene.steps > 0 and scene.dt > 0 and scene.notices == []
        assert len(scene) == len(scene.body_names)
    assert len(lib.Scene("arm").joint_names) == 6


def test_a_scene_says_what_its_file_says(lib: ModuleType) -> None:
    scene = lib.Scene({"name": "a", "description": "b", "steps": 7, "dt": 0.25, "bodies": [{"mass": 1}]})
    assert (scene.name, scene.description, scene.steps, scene.dt) == ("a", "b", 7, 0.25)
    assert (scene.origin, scene.body_names, scene.joint_names) == ("scene", ["body-0"], [])
    bare = lib.Scene({})
    assert (bare.name, bare.description, len(bare)) == (None, None, 0)
    empty = lib.Simulation(bare)
    empty.step(3)
    assert empty.states.shape == (0, 13) and empty.steps == 3
    assert lib.Simulation(scene, dt=0.5).dt == 0.5 and lib.Simulation(scene).scene.dt == 0.25


@pytest.mark.parametrize("kind", ["json", "ron", "urdf"])
def test_texts_of_scenes_are_read(lib: ModuleType, kind: str) -> None:
    text = {
        "json": '{"bodies": [{"name": "ball", "mass": 3}]} // a comment',
        "ron": '(bodies: [(name: "ball", mass: 3)])',
        "urdf": '<robot name="r"><link name="ball"><inertial><mass value="3"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>',
    }[kind]
    scene = lib.Scene.from_text(text, kind)
    assert scene.body_names == ["ball"]
    assert lib.Simulation(scene).masses.tolist() == [3]
    with pytest.raises(lib.SceneError, match="here"):
        lib.Scene.from_text("}", kind, "here")
    with pytest.raises(lib.ArgumentError) as caught:
        lib.Scene.from_text(text, "yaml")
    assert caught.value.field == "kind"
