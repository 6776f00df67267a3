"""Chatter in a record: amplitude and frequency of what a simulation, a master or a robot has written down."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from brunovsky._suggest import unknown_name
from brunovsky.analysis._checks import finite_scalar
from brunovsky.errors import ParameterError

_BAND = 0.1  # of half the peak to peak, that a crossing must leave to be one
_FEWEST = 3  # whole periods


@dataclass(frozen=True)
class MeasuredChatter:
    """Oscillation of a recorded variable about its mean.

    Attributes
    ----------
    amplitude, largest : float
        Half of peak to peak (unit of the variable), the mean over the periods and the largest of them.
    frequency : float
        Mean angular frequency (rad/s).
    mean : float
        About which it oscillates (unit of the variable).
    periods : int
        Whole periods that were seen.
    samples : float
        Instants of the record in a period; where there are but a few, the oscillation is that of the step with which
        a relay is sampled, and the variable slides.
    """

    amplitude: float
    largest: float
    frequency: float
    mean: float
    periods: int
    samples: float


def measured_chatter(
    trajectory: xr.Dataset, name: str = "S[1]", start: float | None = None, end: float | None = None
) -> MeasuredChatter | None:
    """Measure amplitude and frequency of an oscillation in a part of a record.

    A period lasts from one upward crossing of the mean to the next; a crossing counts if the variable leaves a tenth of
    half its peak to peak on both sides.

    Parameters
    ----------
    trajectory : xarray.Dataset
        With the coordinate ``time`` (s), as `brunovsky.simulate` returns it.
    name : str
        Variable to look at.
    start, end : float, optional
        Part of the record (s); by default its last half.

    Returns
    -------
    MeasuredChatter or None
        None where there are fewer than three whole periods.

    Raises
    ------
    ParameterError
        If there is no such variable or no ``time``, the values are not finite, or the part holds no instants.

    See Also
    --------
    simulated_cycle : simulates a `SwitchingLoop` until it is steady, and locates each switching.
    """
    where = "measured_chatter"
    if not isinstance(trajectory, xr.Dataset) or "time" not in trajectory.coords:
        raise ParameterError(f"{where}: pass a data set over the coordinate time, as brunovsky.simulate returns it")
    if name not in trajectory:
        raise ParameterError(f"{where}: the record has {unknown_name('variable', name, list(map(str, trajectory)))}")
    time, values = trajectory["time"].values, trajectory[name].values.astype(float)
    if time.ndim != 1 or values.shape != time.shape or time.size == 0 or not np.all(np.isfinite([time, values])):
        raise ParameterError(f"{where}: {name} is no finite value at each instant of a record; look where it ends")
    first = 0.5 * (time[0] + time[-1]) if start is None else finite_scalar(start, "start", where)
    last = time[-1] if end is None else finite_scalar(end, "end", where)
    part = (time >= first) & (time <= last)
    if np.count_nonzero(part) < 2:
        raise ParameterError(
            f"{where}: no instants between {first:g} and {last:g} s; the record is from {time[0]:g} to {time[-1]:g} s"
        )
    return _measured(time[part], values[part])


def _measured(t: NDArray[np.float64], values: NDArray[np.float64]) -> MeasuredChatter | None:
    mean = 0.5 * float(np.max(values) + np.min(values))
    for _ in range(2):  # about the middle first, then about the mean over whole periods
        starts, instants = _upward(t, values - mean)
        if starts.size <= _FEWEST:
            return None
        mean = float(np.mean(values[starts[0] : starts[-1]]))
    whole = values[: starts[-1]]
    sizes = 0.5 * (np.maximum.reduceat(whole, starts[:-1]) - np.minimum.reduceat(whole, starts[:-1]))
    count = starts.size - 1
    return MeasuredChatter(
        amplitude=float(np.mean(sizes)),
        largest=float(np.max(sizes)),
        frequency=float(2.0 * np.pi * count / (instants[-1] - instants[0])),
        mean=mean,
        periods=count,
        samples=float((starts[-1] - starts[0]) / count),
    )


def _upward(t: NDArray[np.float64], values: NDArray[np.float64]) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Index after each upward crossing of zero that leaves the band, and its instant."""
    band = _BAND * 0.5 * np.ptp(values)
    outside = np.flatnonzero(np.abs(values) > band)
    signs = np.sign(values[outside])
    rises = outside[np.flatnonzero((signs[:-1] < 0.0) & (signs[1:] > 0.0))]
    crossings = np.flatnonzero((values[:-1] < 0.0) & (values[1:] >= 0.0))
    before = crossings[np.searchsorted(crossings, rises)]
    after = before + 1
    weight = values[before] / (values[before] - values[after])
    return after, np.asarray(t[before] + weight * (t[after] - t[before]))
