"""The whole of tumble in double precision: arrays are of `float64`."""

from functools import partial as _partial

from ._double import (
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
from ._errors import ArgumentError, ArgumentTypeError, SceneError, SnapshotError, SweepFileError, TumbleError
from ._sweep import Sweep
from ._sweep import sweep as _sweep

#: As `tumble.sweep`, in double precision.
sweep = _partial(_sweep, precision="f64")

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
