"""Whether what a run shows still grows when it ends, judged by its envelope."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

Array = np.ndarray[Any, np.dtype[np.float64]]

GROWS = 0.05  # relative growth over the last half from which a run is growing
ROUNDING = 1e-9  # m; a smaller error may grow by rounding alone
PARTS = 4  # of the last half, whose root mean squares are the envelope


def envelope(time: Array, signal: Array, parts: int = PARTS) -> Array:
    """Root mean square of a signal in equal parts of the last half of the duration; NaN for one without instants."""
    ends = time[0] + (time[-1] - time[0]) * np.linspace(0.5, 1.0, parts + 1)
    places = np.searchsorted(time, ends)
    places[-1] = time.size
    found = [signal[first:last] for first, last in pairwise(places)]
    return np.array([np.sqrt(np.mean(part**2)) if part.size else np.nan for part in found])


def grows(time: Array, signal: Array, above: float = ROUNDING, by: float = GROWS) -> bool:
    """Whether the envelope rises from each part of the last half to the next, by a share in all, to above a floor.

    A slow divergence shows so long before it is large: a mode that grows by a tenth each second is told from one that
    stays, whatever its size.

    Parameters
    ----------
    time, signal : ndarray, shape (n,)
        Instants (s), and what is judged.
    above : float
        Floor, in units of the signal, below which it may grow: that of rounding.
    by : float
        Relative growth from the first part to the last up to which it counts as staying.
    """
    if time.size < 2:
        return False
    found = envelope(time, signal)
    return bool(found[-1] > above and (np.diff(found) > 0.0).all() and found[-1] > (1.0 + by) * found[0])
