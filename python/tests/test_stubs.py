"""Promise: type checkers see what is there, in both precisions."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import tumble
import tumble.double
from models import floating

PACKAGE = Path(__file__).parents[1]


def checked(*command: str, where: Path = PACKAGE) -> str:
    done = subprocess.run([sys.executable, "-m", *command], cwd=where, capture_output=True, text=True, timeout=300)
    return "" if done.returncode == 0 else done.stdout + done.stderr


def test_the_package_has_no_type_error_in_strict_mode() -> None:
    assert checked("mypy", "--strict") == ""


def test_the_stubs_say_what_the_extension_modules_have(tmp_path: Path) -> None:
    # Away from the sources, of which there are stubs only unless they are installed in place.
    modules, config = ["tumble._single", "tumble._double"], str(PACKAGE / "pyproject.toml")
    assert checked("mypy.stubtest", *modules, "--mypy-config-file", config, where=tmp_path) == ""


def test_the_stubs_of_both_precisions_differ_in_the_precision_only() -> None:
    single = (PACKAGE / "tumble" / "_single.pyi").read_text()
    double = (PACKAGE / "tumble" / "_double.pyi").read_text()
    assert single.replace("float32", "float64").replace('"f32"', '"f64"') == double
    assert single != double


def test_both_precisions_have_the_same_names() -> None:
    assert sorted(tumble.double.__all__) == sorted(tumble.__all__)


# Lines with whether they are right; LIB is one precision, OTHER the other.
LINES = {
    "a: NDArray[np.RIGHT] = simulation.positions": True,
    "a: NDArray[np.WRONG] = simulation.positions": False,
    "simulation.positions = [[0, 0, 0]]": True,
    "simulation.time = 3.0": False,
    "simulation.push('b0', forces=[1, 0, 0], points=[0, 1, 0])": True,
    "simulation.push('b0', [1, 0, 0])": False,
    "simulation.set_forces(frame='local')": False,
    "LIB.Simulation(simulation.scene, integrator='runge-kutta4')": True,
    "OTHER.Simulation(simulation.scene)": False,
    "a: LIB.Scene = simulation.scene": True,
    "batch.restore(0, simulation.snapshot())": True,
    "batch.restore(0, batch.scene)": False,
    "simulation.record(3, control=lambda made: made.push(forces=1))": True,
    "simulation.record(3, control=lambda made: made.nothing())": False,
    "a: NDArray[np.bool_] = batch.asleep": True,
    "batch.step(3, out=batch.states)": True,
    "out: NDArray[np.WRONG] = np.zeros(3, np.WRONG); batch.step(3, out=out)": False,
    "batch.push(worlds=np.array([True, False]), forces=1)": True,
    "batch.push(worlds='b0', forces=1)": False,
    "a: NDArray[np.RIGHT] = simulation.contacts()['points']": True,
    "simulation.contacts()['nothing']": False,
    "class Mine(LIB.Simulation): pass": False,
    "isinstance(simulation, LIB.Simulation)": True,
}


@pytest.mark.parametrize("right", ["float32", "float64"])
def test_a_type_checker_tells_right_calls_from_wrong_ones(right: str, tmp_path: Path) -> None:
    wrong, lib, other = ("float64", "tumble", "double") if right == "float32" else ("float32", "double", "tumble")
    head = ["import tumble, numpy as np", "from numpy.typing import NDArray", "from tumble import double"]
    names = {"RIGHT": right, "WRONG": wrong, "LIB": lib, "OTHER": other}
    for at, line in enumerate(LINES):
        head += [f"def case{at}(simulation: LIB.Simulation, batch: LIB.Batch) -> None:", f"    {line}"]
    text = "\n".join(head)
    for name, meaning in names.items():
        text = text.replace(name, meaning)
    (tmp_path / "lines.py").write_text(text + "\n")
    found = checked("mypy", "--strict", "--no-error-summary", str(tmp_path / "lines.py"), "--config-file", "")
    refused = {int(message.split(":")[1]) for message in found.splitlines() if ": error:" in message}
    says = {line: 5 + 2 * at not in refused for at, line in enumerate(LINES)}
    assert says == LINES, found


def test_arrays_have_the_types_that_the_stubs_say(lib: ModuleType, dtype: type[np.floating]) -> None:
    simulation, batch = lib.Simulation(floating(2)), lib.Batch(floating(2), 2)
    for made in (simulation, batch):
        for name in ("positions", "orientations", "linear_velocities", "angular_velocities", "states", "joint_forces"):
            assert getattr(made, name).dtype == dtype
        for name in ("masses", "inertias", "principal_axes", "joint_values", "joint_speeds", "drive_positions"):
            assert getattr(made, name).dtype == dtype
        assert made.asleep.dtype == np.bool_
    assert batch.steps.dtype == np.uint64
    assert batch.times.dtype == batch.energies().dtype == np.float64
