"""Change of argument of a complex function along a path, for counts of zeros."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

_LARGEST_TURN = 0.5  # rad from one point to the next
_REFINEMENTS = 30


def argument_change(
    function: Callable[[NDArray[np.float64]], NDArray[np.complex128]], path: NDArray[np.float64]
) -> float:
    """Change of the argument of `function` (rad) from the first point of `path` to the last.

    Points are added in the middle of each step in which the argument turns too far to be followed.
    """
    values = function(path)
    for _ in range(_REFINEMENTS):
        coarse = np.abs(np.angle(values[1:] / values[:-1])) > _LARGEST_TURN
        if not coarse.any():
            break
        added = 0.5 * (path[1:] + path[:-1])[coarse]
        order = np.argsort(np.concatenate((path, added)), kind="stable")
        values = np.concatenate((values, function(added)))[order]
        path = np.concatenate((path, added))[order]
    return float(np.sum(np.angle(values[1:] / values[:-1])))
