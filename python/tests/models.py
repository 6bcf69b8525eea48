"""Scenes of the tests, as dicts with the keys of a scene file."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

GRAVITY = 9.81
GROUND = {"name": "ground", "shape": {"half_space": {}}, "fixed": True, "collider": {}}


def box(name: str, half_extents: Any = (0.5, 0.5, 0.5), mass: float = 2.0, **more: Any) -> dict[str, Any]:
    return {"name": name, "shape": {"cuboid": {"half_extents": list(half_extents)}}, "mass": mass, **more}


def moments(half_extents: Any, mass: float) -> list[float]:
    """Moments of inertia of a cuboid about its axes [kg m^2]."""
    a, b, c = half_extents
    return [mass / 3 * (b * b + c * c), mass / 3 * (a * a + c * c), mass / 3 * (a * a + b * b)]


def floating(count: int = 4, **more: Any) -> dict[str, Any]:
    """Boxes without gravity that tumble and touch nothing: `b0`, `b1`..."""
    places = [(0.3 * i, [3.0 * i, 0.5 * i, -1.0 * i]) for i in range(count)]
    bodies = [
        box(f"b{i}", (0.1, 0.2, 0.3), 1 + i, position=place, angular_velocity=[1 + turn, 2 - turn, turn])
        for i, (turn, place) in enumerate(places)
    ]
    return {"gravity": [0, 0, 0], "dt": 0.01, "bodies": bodies, **more}


def still(**more: Any) -> dict[str, Any]:
    """One box of 2 kg at rest without gravity: `box`."""
    return {"gravity": [0, 0, 0], "dt": 0.01, "bodies": [box("box", (0.1, 0.2, 0.3))], **more}


def mixed() -> dict[str, Any]:
    """A body of each kind: `b0`, `b1` move, `point` does not turn, `wall` is fixed."""
    point = {"name": "point", "mass": 1.0, "position": [0, 5, 0]}
    wall = box("wall", position=[0, 50, 0], fixed=True)
    del wall["mass"]
    model = floating(2)
    model["bodies"] += [point, wall]
    return model


def boxes_on_ground(count: int = 8) -> dict[str, Any]:
    """`ground`, and boxes that fall on it and on each other: `b0`, `b1`..."""
    places = [[0.45 * (i % 3), 0.6 + 1.1 * i, 0.3 * (i % 2)] for i in range(count)]
    return {"bodies": [GROUND] + [box(f"b{i}", position=place, collider={}) for i, place in enumerate(places)]}


def box_at_rest(mass: float = 2.0) -> dict[str, Any]:
    """`ground`, and `b0` that lies on it."""
    return {"bodies": [GROUND, box("b0", mass=mass, position=[0, 0.5, 0], collider={})]}


def hinged(length: float = 1.0, mass: float = 2.0, drives: Any = (), **more: Any) -> dict[str, Any]:
    """`bob`, a cube of edge 0.2 m that hangs `length` below the hinge `hinge` of `frame`, about z."""
    frame = {"name": "frame", "shape": {"sphere": {"radius": 0.05}}, "fixed": True}
    bob = box("bob", (0.1, 0.1, 0.1), mass, position=[0, -length, 0])
    hinge: dict[str, Any] = {"name": "hinge", "between": ["frame", "bob"]}
    hinge["hinge"] = {"at": [0, 0, 0], "axis": [0, 0, 1]}
    if drives:
        hinge["drives"] = list(drives)
    return {"dt": 1 / 240, "bodies": [frame, bob], "joints": [hinge], **more}


def in_process(directory: Path, script: str, *arguments: str, seconds: float = 60) -> str:
    """Runs a script in a Python of its own, which fails if it takes longer; what it prints."""
    path = directory / "script.py"
    path.write_text(script)
    done = subprocess.run([sys.executable, str(path), *arguments], capture_output=True, text=True, timeout=seconds)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout
