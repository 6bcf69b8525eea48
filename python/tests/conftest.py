"""What several tests need."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import tumble
import tumble.double


@pytest.fixture(scope="session")
def program() -> Path:
    """The program `tumble` in single precision: that of $TUMBLE, or of a debug build of this clone."""
    built = Path(__file__).parents[2] / "target" / "debug" / "tumble"
    path = Path(os.environ.get("TUMBLE", built))
    if not path.exists():
        if os.environ.get("TUMBLE_REQUIRED"):
            pytest.fail(f"TUMBLE_REQUIRED is set, and there is no program {path}")
        pytest.skip(f"there is no program {path}: cargo build, or set TUMBLE")
    return path


@pytest.fixture(params=[tumble, tumble.double], ids=["f32", "f64"])
def lib(request: pytest.FixtureRequest) -> ModuleType:
    """tumble, in each precision."""
    module: ModuleType = request.param
    return module


@pytest.fixture
def dtype(lib: ModuleType) -> type[np.floating[Any]]:
    """What the arrays of `lib` are of."""
    return np.float32 if lib is tumble else np.float64


@pytest.fixture
def eps(dtype: type[np.floating[Any]]) -> float:
    """Relative distance of the next number after 1."""
    return float(np.finfo(dtype).eps)


@pytest.fixture(autouse=True)
def threads_as_before() -> Iterator[None]:
    """Tests may set the threads: the next test has those of before."""
    before = [(module, module.threads()) for module in (tumble, tumble.double)]
    yield
    for module, count in before:
        if module.threads() != count:
            module.set_threads(count)
