"""Random numbers of starts, which depend on the seed, the world and its episode alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_GAMMA = np.uint64(0x9E3779B97F4A7C15)


def _mix(bits: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """The output function of SplitMix64."""
    bits = (bits ^ (bits >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    bits = (bits ^ (bits >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return bits ^ (bits >> np.uint64(31))


def uniform(
    keys: NDArray[np.uint64],
    worlds: NDArray[np.uint64],
    episodes: NDArray[np.uint64],
    count: int,
) -> NDArray[np.float64]:
    """Numbers in [0, 1) of shape (n, count), a row for each of n worlds.

    A row is a stream of SplitMix64 whose start is a hash of `keys`, `worlds` and `episodes` (n,).
    So it does not matter which other worlds there are, nor when their episodes end.
    """
    streams = _mix(_mix(keys + _GAMMA * (worlds + np.uint64(1))) + episodes)
    steps = _GAMMA * np.arange(1, count + 1, dtype=np.uint64)
    bits = _mix(streams[:, None] + steps[None, :])
    return (bits >> np.uint64(11)).astype(np.float64) * 2.0**-53
