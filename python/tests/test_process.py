"""Promise: nothing is leaked, and importing is light."""

from __future__ import annotations

import gc
import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from models import boxes_on_ground, floating, hinged

ROUNDS = 10_000
# 200 bytes in each round would be 2 MB.
MOST = 2_000_000


def resident() -> int:
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


def _cases(lib: ModuleType) -> dict[str, Callable[[], Any]]:
    scene, drives = lib.Scene(floating(2)), [{"axes": ["angular_x"], "velocity": 1.0}]
    simulation, batch = lib.Simulation(boxes_on_ground(2)), lib.Batch(scene, 2)
    simulation.step(60)
    swing, ones, out = lib.Simulation(hinged(drives=drives)), np.ones(3), simulation.states
    data = bytes(simulation.snapshot())

    def reads() -> None:
        for name in ("positions", "orientations", "states", "masses", "body_names", "joint_values", "scene"):
            getattr(simulation, name)
        simulation.contacts(), simulation.contact_events(), simulation.totals(), simulation.state_hash
        simulation.cast_rays([[0, 5, 0]] * 2, [0, -1, 0])
        batch.states, batch.times, batch.steps, batch.energies(), batch.state_hashes()

    def writes() -> None:
        simulation.positions = simulation.positions
        simulation.push([1, "b1"], forces=ones, points=ones)
        simulation.set_forces("b0", torques=ones * 0, frame="body")
        simulation.read_states(out)
        swing.set_drives("hinge.drives.0", positions=np.nan, velocities=1)
        batch.push(worlds=[1], forces=ones)
        simulation.step()
        batch.step(2)
        swing.step()

    def errors() -> None:
        calls: list[Callable[[], Any]] = [
            lambda: lib.Scene({"bodies": [{"mass": -1}]}),
            lambda: lib.Scene("nowhere"),
            lambda: simulation.push("nobody", forces=ones),
            lambda: simulation.push([0, 0], forces=ones),
            lambda: simulation.push(forces="a"),
            lambda: simulation.push(forces=[np.nan, 0, 0]),
            lambda: simulation.read_states(ones),
            lambda: simulation.step(-1),
            lambda: lib.Snapshot(data[:-1]),
            lambda: batch.reset(5),
            lambda: lib.Simulation(scene, dt=0),
        ]
        for call in calls:
            with suppress(lib.TumbleError):
                call()

    return {
        "simulations": lambda: lib.Simulation(scene).step(),
        "scenes": lambda: lib.Scene(floating(1)),
        "batches": lambda: lib.Batch(scene, 2, vary={"bodies.b0.mass": [1, 2]}).reset([1]),
        "snapshots": lambda: simulation.restore(pickle.loads(pickle.dumps(lib.Snapshot(data)))),
        "recordings": lambda: lib.Simulation("t-handle").record(2)._repr_html_(),
        "reads": reads,
        "writes": writes,
        "errors": errors,
    }


NAMES = ["simulations", "scenes", "batches", "snapshots", "recordings", "reads", "writes", "errors"]


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="the memory of a process is read from /proc")
@pytest.mark.parametrize("case", NAMES)
def test_memory_does_not_grow(lib: ModuleType, case: str) -> None:
    cases = _cases(lib)
    assert list(cases) == NAMES
    act, rounds = cases[case], ROUNDS // 20 if case == "recordings" else ROUNDS
    for _ in range(rounds // 5):
        act()
    before = resident()
    for _ in range(rounds):
        act()
    assert resident() - before < MOST


def test_arrays_and_names_are_released(lib: ModuleType) -> None:
    simulation = lib.Simulation(floating(2))
    forces, names, out = np.ones((2, 3)), ["b0", "b1"], simulation.states
    before = [sys.getrefcount(it) for it in (forces, names, out, simulation, *names)]
    for _ in range(100):
        simulation.push(names, forces=forces)
        simulation.read_states(out)
        simulation.record(1)
        with pytest.raises(lib.TumbleError):
            simulation.push(names, forces=out)
        with pytest.raises(lib.TumbleError):
            simulation.read_states(forces)
    assert [sys.getrefcount(it) for it in (forces, names, out, simulation, *names)] == before


@pytest.mark.parametrize("module", ["tumble", "tumble.double"])
def test_importing_loads_no_other_library(module: str) -> None:
    script = f"import sys, {module}; print(sorted({{name.split('.')[0] for name in sys.modules}}))"
    loaded = eval(subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True).stdout)
    assert "tumble" in loaded
    assert not {"numpy", "gymnasium", "ray", "matplotlib", "multiprocessing"} & set(loaded)
