"""Metrics of one run, as pure functions of its trajectory.

Integrals are trapezoidal sums over the recorded instants, which are the internal steps. The position error is the
distance between the robot and its reference. Everything is in SI units.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import xarray as xr

SETTLED = 0.01  # m; the position error below which a run counts as settled
TAIL = 0.75  # the last quarter begins at this part of the duration

Array = np.ndarray[Any, np.dtype[np.float64]]


@dataclass(frozen=True)
class Metrics:
    """Metrics of a run over its whole duration; None where undefined, which is all of them for a run that failed.

    Attributes
    ----------
    iae, ise, itae : float
        Integrals of the position error (m s), its square (m2 s), and time times it (m s2).
    settling_time : float or None
        Last time the position error exceeds 1 cm (s); 0 if it never does, None if it still does at the end.
    final_error, rms_tail_error : float
        Position error at the end, and its root mean square over the last quarter of the duration (m).
    peak_speed, min_speed : float
        Largest and smallest abs(eta1) (m/s).
    peak_yaw_acceleration : float
        Largest abs(u2) (rad/s2).
    effort_u1, effort_u2 : float
        Integrals of the squares of u1 (m2/s3) and u2 (rad2/s3).
    total_variation_u1, total_variation_u2 : float
        Sums of absolute changes from one internal step to the next (m/s2, rad/s2).
    """

    iae: float | None = None
    ise: float | None = None
    itae: float | None = None
    settling_time: float | None = None
    final_error: float | None = None
    rms_tail_error: float | None = None
    peak_speed: float | None = None
    min_speed: float | None = None
    peak_yaw_acceleration: float | None = None
    effort_u1: float | None = None
    effort_u2: float | None = None
    total_variation_u1: float | None = None
    total_variation_u2: float | None = None

    def as_dict(self) -> dict[str, float | None]:
        """The same by name, ready for JSON."""
        return asdict(self)


def compute_metrics(trajectory: xr.Dataset) -> Metrics:
    """Metrics of a complete trajectory.

    Parameters
    ----------
    trajectory : xarray.Dataset
        ``e1[1]``, ``e2[1]``, ``eta[1]``, ``u[1]`` and ``u[2]`` over ``time`` (at least two instants, at the internal
        steps).
    """
    time, error = instants(trajectory), position_error(trajectory)
    speed = np.abs(values(trajectory, "eta[1]"))
    u1, u2 = values(trajectory, "u[1]"), values(trajectory, "u[2]")
    with np.errstate(over="ignore"):
        found = _metrics(time, error, speed, u1, u2)
    return Metrics(**{name: _finite(value) for name, value in found.as_dict().items()})


def _metrics(time: Array, error: Array, speed: Array, u1: Array, u2: Array) -> Metrics:
    return Metrics(
        iae=integral(time, error),
        ise=integral(time, error**2),
        itae=integral(time, time * error),
        settling_time=settling_time(time, error),
        final_error=float(error[-1]),
        rms_tail_error=root_mean_square(error[tail(time)]),
        peak_speed=float(np.max(speed)),
        min_speed=float(np.min(speed)),
        peak_yaw_acceleration=float(np.max(np.abs(u2))),
        effort_u1=integral(time, u1**2),
        effort_u2=integral(time, u2**2),
        total_variation_u1=total_variation(u1),
        total_variation_u2=total_variation(u2),
    )


def values(trajectory: xr.Dataset, name: str) -> Array:
    """One variable of a trajectory as an array of floats."""
    return np.asarray(trajectory[name].values, dtype=np.float64)


def instants(trajectory: xr.Dataset) -> Array:
    """Recorded instants, s."""
    return values(trajectory, "time")


def position_error(trajectory: xr.Dataset) -> Array:
    """Distance between the robot and its reference at each instant, m."""
    names = ("position_error[1]", "position_error[2]")  # where the loop's errors are those that it measures
    first, second = names if names[0] in trajectory else ("e1[1]", "e2[1]")
    return np.hypot(values(trajectory, first), values(trajectory, second))


def integral(time: Array, signal: Array) -> float:
    """Trapezoidal integral of a signal over time."""
    return float(np.sum(0.5 * (signal[1:] + signal[:-1]) * np.diff(time)))


def settling_time(time: Array, error: Array, threshold: float = SETTLED) -> float | None:
    """Last time the error exceeds the threshold, s; 0 if it never does, None if it still does at the end."""
    above = np.flatnonzero(~(error <= threshold))
    if above.size == 0:
        return 0.0
    return None if above[-1] == error.size - 1 else float(time[above[-1]])


def tail(time: Array) -> slice:
    """Instants of the last quarter of the duration."""
    first, last = float(time[0]), float(time[-1])
    begin = first + TAIL * (last - first)
    return slice(int(np.searchsorted(time, begin - 1e-9 * (last - first))), None)


def root_mean_square(signal: Array) -> float:
    """Root of the mean of the squares."""
    return float(np.sqrt(np.mean(signal**2)))


def total_variation(signal: Array) -> float:
    """Sum of the absolute changes from one instant to the next."""
    return float(np.sum(np.abs(np.diff(signal))))


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None
