from typing import Final, Literal, final

import numpy as np

from ._classes import (
    SIMD,
    AnyBatch,
    AnyRecording,
    AnyScene,
    AnySimulation,
    AnySnapshot,
    SweepCore,
    SweepWriter,
    __version__,
    scenes,
    set_threads,
    threads,
)

__all__ = [
    "PRECISION",
    "SIMD",
    "Batch",
    "Recording",
    "Scene",
    "Simulation",
    "Snapshot",
    "SweepCore",
    "SweepWriter",
    "__version__",
    "scenes",
    "set_threads",
    "threads",
]

PRECISION: Final = "f32"

@final
class Scene(AnyScene):
    @staticmethod
    def from_text(text: str, kind: Literal["json", "ron", "urdf"] = "json", file: str = "scene") -> Scene: ...

@final
class Snapshot(AnySnapshot): ...

@final
class Recording(AnyRecording[np.float32]): ...

@final
class Simulation(AnySimulation[np.float32, Scene, Snapshot, Recording]): ...

@final
class Batch(AnyBatch[np.float32, Scene, Snapshot]): ...
