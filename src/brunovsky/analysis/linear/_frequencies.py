"""Frequencies at which to look at a loop, so that no narrow resonance slips through."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

_EVERYWHERE = 4000
_WIDTH = np.concatenate((-np.logspace(3, -3, 151), np.logspace(-3, 3, 151)))


def frequencies(roots: Iterable[complex], low: float, high: float) -> NDArray[np.float64]:
    """Ascending frequencies from `low` to `high`, rad/s: all decades alike, denser about each pole or zero (1/s)."""
    about = [abs(root.imag) + abs(root.real) * _WIDTH for root in roots]
    found = np.concatenate((np.geomspace(low, high, _EVERYWHERE), *about))
    return np.unique(found[(found >= low) & (found <= high)])
