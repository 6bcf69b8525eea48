"""Scenes as Python has them, as the text of a scene file."""

from __future__ import annotations

import json
import os
from typing import Any

import numpy as np

from ._errors import ArgumentTypeError


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise ArgumentTypeError(f"scene: {value!r} of type {type(value).__name__} has no place in a scene", "scene")


def to_json(model: dict[str, Any]) -> str:
    """The text of a scene file with these keys; NumPy's numbers and arrays are taken as lists."""
    try:
        return json.dumps(model, default=_plain)
    except ArgumentTypeError:
        raise
    except (TypeError, ValueError, RecursionError) as error:
        raise ArgumentTypeError(f"scene: {error}", "scene") from None


def doubles(array: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """The array in double precision, contiguous; what is too large becomes infinite."""
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(array, dtype=np.float64)
