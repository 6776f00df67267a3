"""Chatter of a run as numbers: how fast and how far its sliding variables, and its inputs, swing about zero."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from brunovsky.analysis import MeasuredChatter, measured_chatter

RESOLUTION = 1e-9  # m/s2; a sliding variable that oscillates by less has only rounding to show

Array = np.ndarray[Any, np.dtype[np.float64]]


@dataclass(frozen=True)
class Chatter:
    """Chatter of the sliding variable that oscillates most, and of the inputs in its periods.

    Attributes
    ----------
    frequency : float
        Mean angular frequency (rad/s).
    amplitude : float
        Half of the range of the sliding variable, mean over the periods (m/s2).
    samples : float
        Recorded instants in a period; where there are but a few, the step makes the chatter, not the law.
    inputs : tuple of float
        Half of the range of each input within a period, mean over the part.
    """

    frequency: float
    amplitude: float
    samples: float
    inputs: tuple[float, ...]


def chatter(time: Array, surfaces: list[Array], inputs: list[Array], layer: float) -> Chatter | None:
    """Chatter in a part of a run.

    A switching law acts linearly within its boundary layer, so that only an oscillation about zero that leaves the
    layer is kept up by the switching, and only that is called chatter.

    Parameters
    ----------
    time : ndarray, shape (n,)
        Evenly spaced instants of the part, s.
    surfaces, inputs : list of ndarray, each of shape (n,)
        S_i (m/s2) and the inputs.
    layer : float
        Half-width of the boundary layer (m/s2), 0 for a relay.

    Returns
    -------
    Chatter or None
        None where no sliding variable makes three whole periods about zero with an amplitude above the layer.
    """
    found = [one for one in (_oscillation(time, S, max(layer, RESOLUTION)) for S in surfaces) if one is not None]
    if not found:
        return None
    most = max(found, key=lambda one: one.amplitude)
    sizes = tuple(_half_range(signal, most.samples) for signal in inputs)
    return Chatter(most.frequency, most.amplitude, most.samples, sizes)


def _oscillation(time: Array, S: Array, above: float) -> MeasuredChatter | None:
    if time.size < 2 or not np.isfinite(S).all():
        return None
    record = xr.Dataset({"S": ("time", S)}, {"time": time})
    found = measured_chatter(record, "S", start=float(time[0]))
    return found if found is not None and found.amplitude > max(above, abs(found.mean)) else None


def _half_range(signal: Array, samples: float) -> float:
    """Half of the range in a window of one period, mean over all windows that fit."""
    width = math.ceil(samples - 1e-9) + 1
    ranges = maximum_filter1d(signal, width) - minimum_filter1d(signal, width)
    margin = width // 2
    return 0.5 * float(np.mean(ranges[margin : signal.size - margin]))
