"""Metrics of one run, as pure functions of its trajectory.

Integrals are trapezoidal sums over the recorded instants, which are the internal steps. The position error is the
distance between the robot and its reference. Everything is in SI units; `definitions.py` says what each metric is.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from brunovsky.comparison.chatter_metrics import Chatter, chatter

SETTLED = 0.01  # m; the position error below which a run counts as settled
REACHED = 0.01  # m/s2; the least band about S = 0 that counts as reached: no sampled relay holds S at zero
ARRIVED = (5e-3, 0.02, 1e-3, 1e-3)  # m, rad, m/s, rad/s; off by no more than these the robot rests at the goal
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
    min_speed_moving : float or None
        Smallest abs(eta1) while there is somewhere to go (m/s): all along if the reference moves by more than 1 cm,
        otherwise until the settling time; 0 if eta1 changes its sign meanwhile.
    peak_forward_acceleration : float
        Largest abs(u1) (m/s2).
    rms_u1, rms_u2 : float
        Root mean squares over the duration (m/s2, rad/s2).
    effort_v : float or None
        Integral of v1^2 + v2^2 (m2/s5).
    reaching_time : float or None
        Last time max(abs(S1), abs(S2)) exceeds the band about zero (s); 0 if it never does, None if it still does at
        the end.
    sliding_band : float or None
        Largest abs(S1), abs(S2) in the last quarter (m/s2).
    chatter_frequency, chatter_amplitude : float or None
        Mean angular frequency (rad/s) and half range (m/s2) of S in the last quarter; None where it does not chatter.
    chatter_amplitude_u1, chatter_amplitude_u2 : float or None
        Half ranges of u1 (m/s2) and u2 (rad/s2) within a period of the chatter.
    chatter_samples : float or None
        Recorded instants in a period of the chatter.
    final_heading_error : float or None
        Magnitude of the heading's error at the end, modulo 2 pi (rad); None where no heading of the goal is given.
    arrival_time : float or None
        Last time the pose is off the goal by more than 5 mm or 0.02 rad, or the robot moves faster than 1 mm/s or
        1 mrad/s (s); 0 if never, None if it still is so at the end or no heading of the goal is given.
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
    min_speed_moving: float | None = None
    peak_forward_acceleration: float | None = None
    rms_u1: float | None = None
    rms_u2: float | None = None
    effort_v: float | None = None
    reaching_time: float | None = None
    sliding_band: float | None = None
    chatter_frequency: float | None = None
    chatter_amplitude: float | None = None
    chatter_amplitude_u1: float | None = None
    chatter_amplitude_u2: float | None = None
    chatter_samples: float | None = None
    final_heading_error: float | None = None
    arrival_time: float | None = None

    def as_dict(self) -> dict[str, float | None]:
        """The same by name, ready for JSON."""
        return dict(vars(self))


def compute_metrics(
    trajectory: xr.Dataset,
    *,
    layer: float | None = None,
    band: float | None = None,
    goal_heading: float | None = None,
) -> Metrics:
    """Metrics of a complete trajectory.

    Parameters
    ----------
    trajectory : xarray.Dataset
        ``e1[1]``, ``e2[1]``, ``eta[1]``, ``u[1]`` and ``u[2]`` over ``time`` (at least two instants, at the internal
        steps); ``x``, ``y``, ``S[1]``, ``S[2]``, ``v[1]`` and ``v[2]`` for the metrics that are made of them, which
        are None without.
    layer : float, optional
        Half-width phi of the boundary layer (m/s2), 0 for a relay; None for a law that does not switch, which can't
        chatter.
    band : float, optional
        Within which S counts as reached (m/s2): one for all laws that are compared; by default the layer, at least
        0.01 m/s2.
    goal_heading : float, optional
        Heading that the robot should have at the end (rad), where the task names one.
    """
    if band is None:
        band = max(layer or 0.0, REACHED)
    with np.errstate(over="ignore", invalid="ignore"):
        found = _of_motion(trajectory) | _of_jerk(trajectory) | _of_switching(trajectory, layer, band)
        if goal_heading is not None:
            found |= _of_arrival(trajectory, goal_heading)
    return Metrics(**{name: _finite(value) for name, value in found.items()})


def _of_motion(trajectory: xr.Dataset) -> dict[str, float | None]:
    time, error = instants(trajectory), position_error(trajectory)
    velocity = values(trajectory, "eta[1]")
    speed = np.abs(velocity)
    u1, u2 = values(trajectory, "u[1]"), values(trajectory, "u[2]")
    settled = settling_time(time, error)
    return {
        "iae": integral(time, error),
        "ise": integral(time, error**2),
        "itae": integral(time, time * error),
        "settling_time": settled,
        "final_error": float(error[-1]),
        "rms_tail_error": root_mean_square(error[tail(time)]),
        "peak_speed": float(np.max(speed)),
        "min_speed": float(np.min(speed)),
        "peak_yaw_acceleration": float(np.max(np.abs(u2))),
        "effort_u1": integral(time, u1**2),
        "effort_u2": integral(time, u2**2),
        "total_variation_u1": total_variation(u1),
        "total_variation_u2": total_variation(u2),
        "min_speed_moving": _min_speed_moving(trajectory, time, velocity, settled),
        "peak_forward_acceleration": float(np.max(np.abs(u1))),
        "rms_u1": rms_over_time(time, u1),
        "rms_u2": rms_over_time(time, u2),
    }


def _min_speed_moving(trajectory: xr.Dataset, time: Array, velocity: Array, settled: float | None) -> float | None:
    if "x" not in trajectory or "y" not in trajectory:
        return None
    pairs = zip(("x", "y"), error_names(trajectory), strict=True)
    extents = [np.ptp(values(trajectory, own) - values(trajectory, off)) for own, off in pairs]
    moves = max(extents) > SETTLED
    moving = velocity if moves or settled is None else velocity[time <= settled]
    reverses = np.min(moving) < 0.0 < np.max(moving)
    return 0.0 if reverses else float(np.min(np.abs(moving)))


def _of_jerk(trajectory: xr.Dataset) -> dict[str, float | None]:
    if "v[1]" not in trajectory or "v[2]" not in trajectory:
        return {}
    squares = values(trajectory, "v[1]") ** 2 + values(trajectory, "v[2]") ** 2
    return {"effort_v": integral(instants(trajectory), squares)}


def _of_switching(trajectory: xr.Dataset, layer: float | None, band: float) -> dict[str, float | None]:
    if "S[1]" not in trajectory or "S[2]" not in trajectory:
        return {}
    time, last = instants(trajectory), tail(instants(trajectory))
    surfaces = [values(trajectory, "S[1]"), values(trajectory, "S[2]")]
    largest = np.max(np.abs(surfaces), axis=0)
    found = {
        "reaching_time": settling_time(time, largest, band),
        "sliding_band": float(np.max(largest[last])),
    }
    if layer is None:
        return found
    inputs = [values(trajectory, name)[last] for name in ("u[1]", "u[2]")]
    return found | _of_chatter(chatter(time[last], [S[last] for S in surfaces], inputs, layer))


def _of_arrival(trajectory: xr.Dataset, goal_heading: float) -> dict[str, float | None]:
    turn = values(trajectory, "theta") - goal_heading
    turn = np.abs(turn - 2.0 * math.pi * np.round(turn / (2.0 * math.pi)))
    speed, rate = (np.abs(values(trajectory, name)) for name in ("eta[1]", "eta[2]"))
    off = np.max(
        [
            position_error(trajectory) / ARRIVED[0],
            turn / ARRIVED[1],
            speed / ARRIVED[2],
            rate / ARRIVED[3],
        ],
        axis=0,
    )
    return {"final_heading_error": float(turn[-1]), "arrival_time": settling_time(instants(trajectory), off, 1.0)}


def _of_chatter(found: Chatter | None) -> dict[str, float | None]:
    if found is None:
        return {}
    return {
        "chatter_frequency": found.frequency,
        "chatter_amplitude": found.amplitude,
        "chatter_amplitude_u1": found.inputs[0],
        "chatter_amplitude_u2": found.inputs[1],
        "chatter_samples": found.samples,
    }


def values(trajectory: xr.Dataset, name: str) -> Array:
    """One variable of a trajectory as an array of floats."""
    return np.asarray(trajectory[name].values, dtype=np.float64)


def instants(trajectory: xr.Dataset) -> Array:
    """Recorded instants, s."""
    return values(trajectory, "time")


def position_error(trajectory: xr.Dataset) -> Array:
    """Distance between the robot and its reference at each instant, m."""
    first, second = error_names(trajectory)
    return np.hypot(values(trajectory, first), values(trajectory, second))


def error_names(trajectory: xr.Dataset) -> tuple[str, str]:
    """Names of the position errors: the true ones, where the loop's own are as it measures them."""
    true = ("position_error[1]", "position_error[2]")
    return true if true[0] in trajectory else ("e1[1]", "e2[1]")


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


def rms_over_time(time: Array, signal: Array) -> float | None:
    """Root of the integral of the square over the duration; None where there is no duration."""
    duration = float(time[-1] - time[0])
    return math.sqrt(integral(time, signal**2) / duration) if duration > 0.0 else None


def total_variation(signal: Array) -> float:
    """Sum of the absolute changes from one instant to the next."""
    return float(np.sum(np.abs(np.diff(signal))))


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None
