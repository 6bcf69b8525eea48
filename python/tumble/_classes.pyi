# What the two extension modules have in common. There is no such module when Python runs.

import os
from collections.abc import Iterable
from typing import Any, Final, Generic, Literal, NoReturn, TypeAlias, TypedDict, TypeVar, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Self

R = TypeVar("R", np.float32, np.float64)
SceneT = TypeVar("SceneT")
SnapshotT = TypeVar("SnapshotT")
RecordingT = TypeVar("RecordingT")

ScenePlace: TypeAlias = str | os.PathLike[str] | dict[str, Any]
IntegratorName: TypeAlias = Literal["semi-implicit-euler", "runge-kutta4", "moser-veselov"]
# Names, indices or a mask; of worlds there are no names.
Mask: TypeAlias = Iterable[bool] | NDArray[np.bool_]
Worlds: TypeAlias = int | Iterable[int] | NDArray[np.integer[Any]] | Mask | None
Chosen: TypeAlias = str | Iterable[str | int] | Worlds

class Contacts(TypedDict, Generic[R]):
    bodies: NDArray[np.int64]
    points: NDArray[R]
    normals: NDArray[R]
    separations: NDArray[R]
    impulses: NDArray[R]
    substep: float

class RayHits(TypedDict, Generic[R]):
    bodies: NDArray[np.int64]
    distances: NDArray[R]
    points: NDArray[R]
    normals: NDArray[R]

class EnergyAndMomentum(TypedDict):
    linear_kinetic: float
    rotational_kinetic: float
    potential: float
    energy: float
    linear_momentum: NDArray[np.float64]
    angular_momentum: NDArray[np.float64]

class AnyScene:
    def __new__(
        cls, scene: ScenePlace, *, bodies: int | None = None, seed: int | None = None, repair: bool = False
    ) -> Self: ...
    @property
    def origin(self) -> str: ...
    @property
    def name(self) -> str | None: ...
    @property
    def description(self) -> str | None: ...
    @property
    def steps(self) -> int: ...
    @property
    def dt(self) -> float: ...
    @property
    def notices(self) -> list[str]: ...
    @property
    def body_names(self) -> list[str]: ...
    @property
    def joint_names(self) -> list[str]: ...
    def __len__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

class AnySnapshot:
    def __new__(cls, data: bytes | bytearray) -> Self: ...
    @property
    def state_hash(self) -> str: ...
    @property
    def steps(self) -> int | None: ...
    def __bytes__(self) -> bytes: ...
    def __len__(self) -> int: ...
    def __eq__(self, value: object, /) -> bool: ...
    def __hash__(self) -> NoReturn: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

class AnyRecording(Generic[R]):
    @property
    def times(self) -> NDArray[np.float64]: ...
    @property
    def energies(self) -> NDArray[np.float64]: ...
    @property
    def states(self) -> NDArray[R]: ...
    @property
    def body_names(self) -> list[str]: ...
    def html(self) -> str: ...
    def _repr_html_(self) -> str: ...
    def __len__(self) -> int: ...

# One world or many: their arrays differ in an axis only.
class Bodies(Generic[R, SceneT]):
    @property
    def scene(self) -> SceneT: ...
    @property
    def body_names(self) -> list[str]: ...
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def drive_names(self) -> list[str]: ...
    @property
    def positions(self) -> NDArray[R]: ...
    @positions.setter
    def positions(self, value: ArrayLike) -> None: ...
    @property
    def orientations(self) -> NDArray[R]: ...
    @orientations.setter
    def orientations(self, value: ArrayLike) -> None: ...
    @property
    def linear_velocities(self) -> NDArray[R]: ...
    @linear_velocities.setter
    def linear_velocities(self, value: ArrayLike) -> None: ...
    @property
    def angular_velocities(self) -> NDArray[R]: ...
    @angular_velocities.setter
    def angular_velocities(self, value: ArrayLike) -> None: ...
    @property
    def states(self) -> NDArray[R]: ...
    @states.setter
    def states(self, value: ArrayLike) -> None: ...
    @property
    def joint_values(self) -> NDArray[R]: ...
    @property
    def joint_speeds(self) -> NDArray[R]: ...
    @property
    def joint_forces(self) -> NDArray[R]: ...
    @property
    def joint_torques(self) -> NDArray[R]: ...
    @property
    def drive_positions(self) -> NDArray[R]: ...
    @property
    def drive_velocities(self) -> NDArray[R]: ...
    def read_states(self, out: NDArray[R]) -> NDArray[R]: ...
    def __len__(self) -> int: ...

class AnySimulation(Bodies[R, SceneT], Generic[R, SceneT, SnapshotT, RecordingT]):
    def __new__(
        cls,
        scene: ScenePlace | SceneT,
        *,
        dt: float | None = None,
        substeps: int | None = None,
        contact_substeps: int | None = None,
        gravity: ArrayLike | None = None,
        integrator: IntegratorName | None = None,
        sleep: bool | None = None,
    ) -> Self: ...
    @property
    def steps(self) -> int: ...
    @property
    def time(self) -> float: ...
    @property
    def dt(self) -> float: ...
    @property
    def masses(self) -> NDArray[R]: ...
    @property
    def state_hash(self) -> str: ...
    def step(self, count: int = 1) -> None: ...
    def record(self, steps: int | None = None, *, every: int = 1) -> RecordingT: ...
    def set_state(
        self,
        bodies: Chosen = None,
        *,
        positions: ArrayLike | None = None,
        orientations: ArrayLike | None = None,
        linear_velocities: ArrayLike | None = None,
        angular_velocities: ArrayLike | None = None,
    ) -> None: ...
    def push(
        self,
        bodies: Chosen = None,
        *,
        forces: ArrayLike | None = None,
        torques: ArrayLike | None = None,
        points: ArrayLike | None = None,
    ) -> None: ...
    def set_forces(
        self,
        bodies: Chosen = None,
        *,
        forces: ArrayLike | None = None,
        torques: ArrayLike | None = None,
        frame: Literal["world", "body"] = "world",
    ) -> None: ...
    def set_drives(
        self,
        drives: Chosen = None,
        *,
        positions: ArrayLike | None = None,
        velocities: ArrayLike | None = None,
        max_forces: ArrayLike | None = None,
    ) -> None: ...
    def contacts(self) -> Contacts[R]: ...
    def contact_events(self) -> list[tuple[Literal["begin", "end"], str, str]]: ...
    def cast_rays(self, origins: ArrayLike, directions: ArrayLike, max_distance: float = ...) -> RayHits[R]: ...
    def totals(self) -> EnergyAndMomentum: ...
    def snapshot(self) -> SnapshotT: ...
    def restore(self, snapshot: SnapshotT) -> None: ...

class AnyBatch(Bodies[R, SceneT], Generic[R, SceneT, SnapshotT]):
    def __new__(
        cls,
        scene: ScenePlace | SceneT,
        worlds: int,
        *,
        vary: dict[str, ArrayLike] | None = None,
        dt: float | None = None,
        substeps: int | None = None,
        contact_substeps: int | None = None,
        gravity: ArrayLike | None = None,
        integrator: IntegratorName | None = None,
        sleep: bool | None = None,
    ) -> Self: ...
    @property
    def steps(self) -> NDArray[np.uint64]: ...
    @property
    def times(self) -> NDArray[np.float64]: ...
    def step(self, count: int = 1, *, out: NDArray[R] | None = None) -> None: ...
    def reset(self, worlds: Worlds = None, *, vary: dict[str, ArrayLike] | None = None) -> None: ...
    def set_state(
        self,
        bodies: Chosen = None,
        *,
        worlds: Worlds = None,
        positions: ArrayLike | None = None,
        orientations: ArrayLike | None = None,
        linear_velocities: ArrayLike | None = None,
        angular_velocities: ArrayLike | None = None,
    ) -> None: ...
    def push(
        self,
        bodies: Chosen = None,
        *,
        worlds: Worlds = None,
        forces: ArrayLike | None = None,
        torques: ArrayLike | None = None,
        points: ArrayLike | None = None,
    ) -> None: ...
    def set_forces(
        self,
        bodies: Chosen = None,
        *,
        worlds: Worlds = None,
        forces: ArrayLike | None = None,
        torques: ArrayLike | None = None,
        frame: Literal["world", "body"] = "world",
    ) -> None: ...
    def set_drives(
        self,
        drives: Chosen = None,
        *,
        worlds: Worlds = None,
        positions: ArrayLike | None = None,
        velocities: ArrayLike | None = None,
        max_forces: ArrayLike | None = None,
    ) -> None: ...
    def energies(self) -> NDArray[np.float64]: ...
    def state_hashes(self) -> list[str]: ...
    def snapshot(self, world: int) -> SnapshotT: ...
    def restore(self, world: int, snapshot: SnapshotT) -> None: ...

@final
class SweepCore:
    def __new__(
        cls,
        *,
        scene: str,
        vary: list[str],
        worlds: int | None,
        seed: int,
        bodies: list[str],
        steps: int | None,
        duration: float | None,
        dt: float | None,
        substeps: int | None,
        integrator: str | None,
        observe: list[str],
        until: str | None,
        repair: bool,
    ) -> Self: ...
    @property
    def worlds(self) -> int: ...
    @property
    def columns(self) -> list[str]: ...
    @property
    def identity(self) -> str: ...
    def rows(self, start: int, stop: int) -> bytes: ...

@final
class SweepWriter:
    def __new__(cls, path: str | os.PathLike[str], sweep: SweepCore) -> Self: ...
    @property
    def next_world(self) -> int: ...
    def append(self, lines: bytes, worlds: int) -> None: ...
    def close(self) -> None: ...

SIMD: Final[str]
__version__: Final[str]

def scenes() -> dict[str, str]: ...
def threads() -> int: ...
def set_threads(count: int) -> None: ...
