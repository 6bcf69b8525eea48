"""Rotations of rows of vectors; quaternions are x, y, z, w."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating[Any]]


def rotated(orientations: Floats, vectors: Floats) -> Floats:
    """Vectors (..., 3) turned by quaternions (..., 4): from the body's frame to the world's."""
    axis, scalar = orientations[..., :3], orientations[..., 3:]
    twice: Floats = 2.0 * np.cross(axis, vectors)
    turned: Floats = vectors + scalar * twice + np.cross(axis, twice)
    return turned


def random_directions(uniform: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unit vectors (n, 3), even over the sphere, of numbers in [0, 1) (n, 2)."""
    height = 2.0 * uniform[:, 0] - 1.0
    angle = 2.0 * np.pi * uniform[:, 1]
    radius = np.sqrt(np.maximum(1.0 - height**2, 0.0))
    return np.stack([radius * np.cos(angle), height, radius * np.sin(angle)], axis=1)


def random_orientations(uniform: NDArray[np.float64]) -> NDArray[np.float64]:
    """Quaternions (n, 4), even over all rotations, of numbers in [0, 1) (n, 3)."""
    first, second = 2.0 * np.pi * uniform[:, 1], 2.0 * np.pi * uniform[:, 2]
    low, high = np.sqrt(1.0 - uniform[:, 0]), np.sqrt(uniform[:, 0])
    parts = [low * np.sin(first), low * np.cos(first), high * np.sin(second), high * np.cos(second)]
    return np.stack(parts, axis=1)
