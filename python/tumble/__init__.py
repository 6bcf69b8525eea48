"""Rigid bodies in batches: many worlds in one call, the same bits every time.

Everything here simulates in single precision; `tumble.double` has the same names in double
precision. Metres, kilograms, seconds, radians; vectors in the world frame; quaternions x, y, z, w.

>>> import tumble
>>> simulation = tumble.Simulation("t-handle")
>>> simulation.step(60)
>>> simulation.positions.shape
(1, 3)
"""

from ._errors import ArgumentError, ArgumentTypeError, SceneError, SnapshotError, SweepFileError, TumbleError
from ._single import (
    PRECISION,
    SIMD,
    Batch,
    Recording,
    Scene,
    Simulation,
    Snapshot,
    __version__,
    scenes,
    set_threads,
    threads,
)
from ._sweep import Sweep, sweep

__all__ = [
    "PRECISION",
    "SIMD",
    "ArgumentError",
    "ArgumentTypeError",
    "Batch",
    "Recording",
    "Scene",
    "SceneError",
    "Simulation",
    "Snapshot",
    "SnapshotError",
    "Sweep",
    "SweepFileError",
    "TumbleError",
    "__version__",
    "scenes",
    "set_threads",
    "sweep",
    "threads",
]
