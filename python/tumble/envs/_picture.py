"""Pictures of worlds, drawn by NumPy alone: capsules seen along -z."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ._vectors import rotated

WIDTH, HEIGHT = 480, 320
_BACKGROUND = (245, 245, 240)


@dataclass(frozen=True)
class Part:
    """A capsule of a body to draw: `begin` and `end` in the body's frame, from its centre [m]."""

    body: int
    begin: tuple[float, float, float]
    end: tuple[float, float, float]
    radius: float
    color: tuple[int, int, int]


@dataclass(frozen=True)
class View:
    """Its middle in x and y and its width [m]; x is from the body `beside`, or the origin."""

    middle: tuple[float, float]
    width: float
    beside: int | None = None


def draw(states: NDArray[np.float32], parts: list[Part], view: View) -> NDArray[np.uint8]:
    """The bodies of one world, `states` (bodies, 13), as a picture (HEIGHT, WIDTH, 3)."""
    picture = np.full((HEIGHT, WIDTH, 3), _BACKGROUND, dtype=np.float64)
    scale = view.width / WIDTH
    x = (np.arange(WIDTH) + 0.5 - WIDTH / 2) * scale + view.middle[0]
    y = (HEIGHT / 2 - np.arange(HEIGHT) - 0.5) * scale + view.middle[1]
    if view.beside is not None:
        x = x + states[view.beside, 0]
    for part in sorted(parts, key=lambda part: float(states[part.body, 2])):
        state = states[part.body].astype(np.float64)
        ends = state[:3] + rotated(state[None, 3:7], np.array([part.begin, part.end]))
        begin, way = ends[0, :2], ends[1, :2] - ends[0, :2]
        across, up = x[None, :] - begin[0], y[:, None] - begin[1]
        along = (across * way[0] + up * way[1]) / max(float(way @ way), 1e-12)
        along = np.clip(along, 0.0, 1.0)
        distance = np.hypot(across - along * way[0], up - along * way[1])
        cover = np.clip((part.radius - distance) / scale + 0.5, 0.0, 1.0)[..., None]
        picture += cover * (np.array(part.color) - picture)
    return np.rint(picture).astype(np.uint8)
