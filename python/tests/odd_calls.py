"""Calls everything with odd arguments: `python odd_calls.py MODULE SEED SECONDS`. Prints how many calls."""

from __future__ import annotations

import importlib
import random
import sys
import time
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from models import boxes_on_ground, floating, hinged, mixed

HUGE = [0, 1, -1, 2, 7, 2**31, 2**32 - 1, 2**63 - 1, -(2**63), 2**64, 10**30, True, False, None]
FLOATS = [0.0, -0.0, 1.0, -1.0, 1e-300, 1e-45, 1e15, 1e18, 1e38, 1e39, 1e308, float("nan"), float("inf"), -float("inf")]
TEXTS = ["", "b0", "b1", "ground", "hinge", "hinge.drives.0", "\0", "\ud800", "x" * 1000, "bodies.b0.mass", "dt"]
TEXTS += ["world", "body"]
# Steps of these counts end within the time of the test.
COUNTS = [0, 1, 2, 3, 17, -1, -(2**63), 2**32, 2**64, 1.5, None, "1", True]


class Odd:
    """Answers all questions with errors."""

    def __array__(self, *arguments: Any, **options: Any) -> Any:
        raise ZeroDivisionError

    def __iter__(self) -> Any:
        raise MemoryError

    def __index__(self) -> int:
        raise RecursionError

    def __repr__(self) -> str:
        raise LookupError


def array(random: random.Random) -> Any:
    shape = [random.choice([0, 1, 2, 3, 4, 13]) for _ in range(random.randrange(4))]
    kind = random.choice(["f4", "f8", "f8", "f8", "f2", "g", "i1", "u8", ">f8", "?", "c8", "O", "U3", "m8[s]"])
    numbers = np.random.default_rng(random.randrange(2**32)).normal(size=shape) * random.choice([1, 1, 1e3, 1e16, 0])
    with np.errstate(all="ignore"):
        made = np.asarray(numbers).astype(kind)
    if made.size and made.dtype.kind == "f" and random.random() < 0.3:
        made.reshape(-1)[-1] = random.choice([np.nan, np.inf])
    return made[..., ::-1] if made.ndim and random.random() < 0.3 else made


def odd(random: random.Random) -> Any:
    makes: list[Callable[[], Any]] = [
        lambda: random.choice(HUGE),
        lambda: random.choice(FLOATS),
        lambda: random.choice(TEXTS),
        lambda: array(random),
        lambda: array(random),
        lambda: array(random),
        lambda: [odd(random) for _ in range(random.randrange(4))],
        lambda: (random.choice(FLOATS),) * 3,
        lambda: [random.randrange(-2, 4) for _ in range(random.randrange(3))],
        lambda: {random.choice(TEXTS): odd(random)},
        lambda: random.choice([Odd(), object(), b"", b"TUMBLE", 1j, int, slice(0, 2), range(3), {1}, Odd, ...]),
    ]
    return random.choice(makes)()


def calls(lib: Any, random: random.Random) -> list[Any]:
    models = [floating(2), hinged(drives=[{"axes": ["angular_x"], "velocity": 1.0}]), mixed(), boxes_on_ground(3)]
    model = random.choice(models)
    made = [lib.Simulation(model), lib.Batch(model, 3, vary={"gravity.1": [0, -1, -9]})]
    made.append(lib.Batch(random.choice(models), 1))
    names = ["positions", "orientations", "linear_velocities", "angular_velocities", "states"]
    keywords = [*names[:4], "forces", "torques", "points", "worlds", "frame", "velocities", "max_forces", "vary", "out"]
    keywords += ["every", "dt", "substeps", "contact_substeps", "gravity", "integrator", "sleep", "max_distance"]
    keywords += ["bodies", "seed"]
    methods = ["push", "set_forces", "set_state", "set_drives", "read_states", "cast_rays", "restore", "snapshot"]
    methods.append("reset")

    def options() -> dict[str, Any]:
        return {random.choice(keywords): odd(random) for _ in range(random.randrange(3))}

    def arguments() -> list[Any]:
        return [odd(random) for _ in range(random.randrange(3))]

    def method() -> Any:
        return getattr(random.choice(made), random.choice(methods))(*arguments(), **options())

    def likely() -> Any:
        one, name = random.choice(made), random.choice(["push", "set_forces", "set_state", "set_drives"])
        fields = {"push": ["forces", "torques", "points"], "set_forces": ["forces", "torques"], "set_state": names[:4]}
        given = {field: odd(random) for field in fields.get(name, ["positions", "velocities", "max_forces"])}
        return getattr(one, name)(random.choice([None, 0, "b0", odd(random)]), **given)

    def step() -> Any:
        return random.choice(made).step(random.choice(COUNTS))

    def record() -> Any:
        return made[0].record(random.choice(COUNTS[:7] + [1.5]), every=odd(random))

    def read() -> Any:
        one = random.choice(made)
        found = getattr(one, random.choice([name for name in dir(one) if not name.startswith("__")]))
        is_read = getattr(found, "__name__", "") in ("contacts", "contact_events", "totals", "energies")
        return found() if is_read else found

    def whole() -> Any:
        kind = random.choice(["Scene", "Simulation", "Snapshot", "Batch"])
        changed = {**model, random.choice(["bodies", "dt", "joints", "gravity"]): odd(random)}
        scene = random.choice([model, odd(random), changed])
        counts = [random.choice([-1, 0, 1, 3, "a", 2**64])] if kind == "Batch" else []
        return getattr(lib, kind)(scene, *counts, **options())

    def text() -> Any:
        texts = [*TEXTS, "{}", "[]", "(", "<robot/>", 3]
        return lib.Scene.from_text(*[random.choice(texts) for _ in range(random.randrange(1, 4))])

    def setter() -> Any:
        return setattr(random.choice(made), random.choice([*names, "time", "nothing"]), odd(random))

    return [method, likely, likely, step, record, read, whole, text, setter]


def main(module: str, seed: int, seconds: float) -> None:
    warnings.simplefilter("ignore")
    # Errors of `__repr__` while a message is written are ignored by Rust too.
    sys.unraisablehook = lambda _: None
    lib, chance, done, refused = importlib.import_module(module), random.Random(seed), 0, 0
    begun = time.monotonic()
    while time.monotonic() - begun < seconds:
        made = calls(lib, chance)
        for _ in range(60):
            done += 1
            try:
                chance.choice(made)()
            except Exception as error:
                # A panic of Rust is a BaseException, which ends the script.
                assert not isinstance(error, SystemError), error
                refused += isinstance(error, lib.TumbleError)
    print(done, refused)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), float(sys.argv[3]))
