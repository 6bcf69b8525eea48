"""Sweeps: one scene in many worlds whose numbers differ, a line of a file for each."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any, Union

from ._errors import ArgumentError, ArgumentTypeError, SceneError, TumbleError

#: What the values of a field are drawn from: a text as of `tumble sweep`, the two ends of a uniform
#: distribution, or a list of values.
Values = Union[str, tuple[float, float], Sequence[float], Any]
Progress = Union[bool, Callable[[int, int], None], None]


def _number(value: Any, field: str) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise ArgumentTypeError(f"{field}: a number is needed, not {value!r}", field) from None


def _distribution(values: Values, field: str) -> str:
    if isinstance(values, str):
        return values
    try:
        numbers = [_number(value, field) for value in values]
    except TypeError:
        raise ArgumentTypeError(f"{field}: a text, two ends or a list is needed", field) from None
    if isinstance(values, tuple):
        if len(numbers) != 2:
            raise ArgumentError(f"{field}: a tuple has two ends, not {len(numbers)} numbers", field)
        return f"{numbers[0]!r}..{numbers[1]!r}"
    return "list(" + ",".join(repr(number) for number in numbers) + ")"


def _count(value: Any, field: str) -> int:
    number = _number(value, field)
    if not (0 <= number < 2**63 and number == int(number)):
        raise ArgumentError(f"{field}: a whole number, 0 or more, is needed, not {value!r}", field)
    # An integer is taken as it is: not all of them are numbers of double precision.
    return int(value)


def _texts(value: str | Sequence[str]) -> list[str]:
    return [value] if isinstance(value, str) else [str(item) for item in value]


def _optional(value: Any, convert: Callable[..., Any], *more: Any) -> Any:
    return None if value is None else convert(value, *more)


class Sweep:
    """One scene in many worlds whose numbers differ; `tumble.sweep` makes it.

    A world depends on nothing but the arguments and its index. `run` and `on_ray` write the same
    file, byte for byte, as `tumble sweep` does on one machine or many.
    """

    def __init__(self, module: str, arguments: dict[str, Any]):
        self._module = module
        self._arguments = arguments
        self._core = import_module(module).SweepCore(**arguments)

    def __reduce__(self) -> tuple[Any, ...]:
        return (Sweep, (self._module, self._elsewhere()))

    def __len__(self) -> int:
        return self.worlds

    def __repr__(self) -> str:
        vary = ", ".join(self._arguments["vary"])
        return f"<tumble.Sweep of {self._arguments['scene']!r}: {self.worlds} worlds, {vary}>"

    @property
    def worlds(self) -> int:
        """How many worlds there are."""
        return int(self._core.worlds)

    @property
    def columns(self) -> list[str]:
        """Names of the columns of the file; docs/batch.md says what they are."""
        return list(self._core.columns)

    def rows(self, start: int, stop: int) -> bytes:
        """Runs the worlds from `start` to `stop` and returns their lines of the file."""
        return bytes(self._core.rows(start, stop))

    def run(self, out: str | os.PathLike[str], *, progress: Progress = None) -> Path:
        """Runs all worlds on the threads of this machine and writes the file `out`, a `.csv`.

        Where the file of the same sweep is there already, it goes on after its last whole line:
        after Ctrl-C or a crash call it again. `progress` is whether to show it on standard error (if
        that is a terminal, unless given), or is called with the worlds done and all of them.
        """
        path = Path(out)
        block, shown = 16, _Shown(self.worlds, progress, path)
        with self._writer(path) as writer:
            while (begin := writer.next_world) < self.worlds:
                end = min(begin + block, self.worlds)
                begun = time.perf_counter()
                writer.append(self.rows(begin, end), end - begin)
                # About a quarter of a second, so that little is lost.
                block = max(1, min(int(block * 0.25 / max(time.perf_counter() - begun, 1e-4)), block * 4))
                shown.at(end)
        shown.end()
        return path

    def on_ray(
        self,
        out: str | os.PathLike[str],
        *,
        block: int | None = None,
        progress: Progress = None,
        retries: int = 10,
    ) -> Path:
        """Runs the worlds on a Ray cluster and writes the file `out` here, in order.

        The bytes are those of `run`. Ray starts on this machine unless it is running. A task is
        `block` worlds on one core; one whose worker dies is run again, `retries` times at most. The
        scene's files have to be at the same paths on all machines, and are compared by their
        contents. Goes on with a file as `run` does.
        """
        ray = _ray()
        path = Path(out)
        size = None if block is None else _count(block, "block")
        if size == 0:
            raise ArgumentError("block: 1 world at least is needed", "block")
        if not ray.is_initialized():
            ray.init(log_to_driver=False)
        cores = int(ray.cluster_resources().get("CPU", 0))
        if cores == 0:
            raise TumbleError("the Ray cluster has no CPU: ray.init(num_cpus=..) gives it some")
        size = size or max(1, min(2000, -(-self.worlds // (cores * 8))))
        task = ray.remote(num_cpus=1, max_retries=_count(retries, "retries"))(_rows)
        shown = _Shown(self.worlds, progress, path)
        # Made here once for all tasks.
        sweep = ray.put((self._module, self._elsewhere(), self._core.identity))
        running: dict[Any, int] = {}
        try:
            with self._writer(path) as writer:
                blocks = _blocks(writer.next_world, self.worlds, size)
                finished: dict[int, tuple[bytes, int]] = {}
                while writer.next_world < self.worlds:
                    # What waits for a slow block before it is in memory, so it is limited.
                    while len(running) + len(finished) < 4 * cores and (part := next(blocks, None)):
                        running[task.remote(sweep, *part)] = part[0]
                    done, _ = ray.wait(list(running), num_returns=1)
                    for reference in done:
                        finished[running.pop(reference)] = ray.get(reference)
                    while (lines := finished.pop(writer.next_world, None)) is not None:
                        writer.append(*lines)
                        shown.at(writer.next_world)
        finally:
            # After an error or Ctrl-C nobody wants the rest.
            for reference in running:
                ray.cancel(reference, force=True)
            shown.end()
        return path

    def _elsewhere(self) -> dict[str, Any]:
        """The arguments with a path that does not depend on the directory of a process."""
        scene = self._arguments["scene"]
        is_path = os.path.dirname(scene) or os.path.splitext(scene)[1]
        return {**self._arguments, "scene": os.path.abspath(scene) if is_path else scene}

    @contextmanager
    def _writer(self, path: Path) -> Iterator[Any]:
        if path.suffix != ".csv":
            raise ArgumentError(f"out: a sweep's file ends in .csv, not {path.name!r}", "out")
        writer = import_module(self._module).SweepWriter(path, self._core)
        try:
            yield writer
        finally:
            writer.close()


def sweep(
    scene: str | os.PathLike[str],
    vary: Mapping[str, Values],
    *,
    worlds: float | None = None,
    seed: int = 0,
    bodies: str | Sequence[str] = (),
    steps: float | None = None,
    duration: float | None = None,
    dt: float | None = None,
    substeps: int | None = None,
    integrator: str | None = None,
    observe: str | Sequence[str] = (),
    until: str | None = None,
    repair: bool = False,
    precision: str = "f32",
) -> Sweep:
    """One scene in many worlds whose numbers differ.

    `scene` is the name of a built-in scene or the path of a file. `vary` has fields by their paths,
    each with what its values are drawn from: a text as of `tumble sweep` (`"0..5"`,
    `"normal(0,0.1)"`, `"choice(1,2)"`, `"grid(0,1,11)"`), a tuple of the two ends of a uniform
    distribution, or a list of values. `.run("out.csv")` or `.on_ray("out.csv")` then write a line for
    each world: see docs/batch.md for its columns, and for `observe` and `until`.

    `worlds` may be left out where there are only grids and lists. A world runs as many `steps` as
    the scene says unless given, or a `duration` [s]. `bodies` are those whose ends are written, by
    name; the first that moves unless given.
    """
    modules = {"f32": "tumble._single", "f64": "tumble._double"}
    if precision not in modules:
        raise ArgumentError(f"precision: f32 or f64 is needed, not {precision!r}", "precision")
    if isinstance(scene, os.PathLike):
        scene = os.fspath(scene)
        scene = scene if os.path.dirname(scene) else os.path.join(".", scene)
    if not isinstance(scene, str):
        raise ArgumentTypeError("scene: the name of a built-in scene or a path is needed", "scene")
    if not isinstance(vary, Mapping):
        raise ArgumentTypeError("vary: fields by their paths are needed, each with its values", "vary")
    fields = [f"{field}={_distribution(values, f'vary[{field!r}]')}" for field, values in vary.items()]
    return Sweep(
        modules[precision],
        {
            "scene": scene,
            "vary": fields,
            "worlds": _optional(worlds, _count, "worlds"),
            "seed": _count(seed, "seed"),
            "bodies": _texts(bodies),
            "steps": _optional(steps, _count, "steps"),
            "duration": _optional(duration, _number, "duration"),
            "dt": _optional(dt, _number, "dt"),
            "substeps": substeps,
            "integrator": integrator,
            "observe": _texts(observe),
            "until": until,
            "repair": repair,
        },
    )


def _blocks(begin: int, end: int, size: int) -> Iterator[tuple[int, int]]:
    for start in range(begin, end, size):
        yield start, min(start + size, end)


_made: dict[str, Sweep] = {}


def _rows(sweep: tuple[str, dict[str, Any], str], start: int, stop: int) -> tuple[bytes, int]:
    """A task of Ray: the lines of a block, on one thread."""
    module, arguments, identity = sweep
    made = _made.get(identity)
    if made is None:
        import_module(module).set_threads(1)
        made = Sweep(module, arguments)
        if made._core.identity != identity:
            scene = arguments["scene"]
            raise SceneError(f"{scene}: another file or version of tumble than where the sweep began", scene)
        _made.clear()
        _made[identity] = made
    return made.rows(start, stop), stop - start


def _ray() -> Any:
    try:
        return import_module("ray")
    except ImportError:
        raise ImportError("Ray is not installed: pip install 'tumble[ray]'") from None


class _Shown:
    """Progress on standard error, or to a function."""

    def __init__(self, worlds: int, progress: Progress, path: Path):
        self._worlds = worlds
        self._call = progress if callable(progress) else None
        is_shown = sys.stderr.isatty() if progress is None else bool(progress)
        self._is_shown = is_shown and self._call is None
        self._path = path
        self._last = 0.0

    def at(self, done: int) -> None:
        if self._call:
            self._call(done, self._worlds)
        elif self._is_shown and (done == self._worlds or time.monotonic() - self._last > 0.2):
            self._last = time.monotonic()
            share = 100 * done // self._worlds
            print(f"\r{self._path}: {done} of {self._worlds} worlds, {share} %", end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        if self._is_shown:
            print(file=sys.stderr)
