"""What became of a manoeuvre from rest to rest: reached, or the reason why not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from brunovsky.errors import ParameterError

if TYPE_CHECKING:
    import xarray as xr

OUTCOMES = ("reached", "singular", "diverged", "away", "reversed", "tilted", "limits")
"""In the order in which they are asked for; `goal_frame_runs` says what they mean."""

POSITION, HEADING, SPEED, YAW_RATE = 5e-3, 0.02, 1e-3, 1e-3  # m, rad, m/s, rad/s


class Limits(NamedTuple):
    """Limits of a manoeuvre on absolute values.

    Parameters
    ----------
    speed : float
        Of eta[1], m/s.
    forward_acceleration : float
        Of u[1], m/s2.
    yaw_acceleration : float
        Of u[2], rad/s2.
    """

    speed: float
    forward_acceleration: float
    yaw_acceleration: float


LIMITS = (1.5, 2.0, 30.0)
"""Limits by default, m/s, m/s2, rad/s2."""


class Arrival(NamedTuple):
    """How one manoeuvre went; the names and units are those of the data of `goal_frame_runs`."""

    launch: float
    minimum_speed: float
    peak_speed: float
    peak_forward_acceleration: float
    peak_yaw_acceleration: float
    position_error: float
    heading_error: float
    is_at_rest: bool
    has_failed: bool
    arrival_time: float

    def outcome(self, eta_min: float, limits: Limits) -> str:
        """Word of `OUTCOMES`."""
        away = self.position_error > POSITION or not self.is_at_rest
        tilted = abs(self.heading_error) > HEADING
        peaks = (self.peak_speed, self.peak_forward_acceleration, self.peak_yaw_acceleration)
        beyond = any(one > limit * (1 + 1e-9) for one, limit in zip(peaks, limits, strict=True))
        if not (self.has_failed or away or tilted or beyond):
            return "reached"
        reasons = (
            ("singular", self.minimum_speed < eta_min),
            ("diverged", self.has_failed),
            ("away", away),
            ("reversed", abs(self.heading_error) > np.pi / 2),
            ("tilted", tilted),
        )
        return next((name for name, holds in reasons if holds), "limits")


_UNITS = {
    "launch": ("1", "direction of the launch: 1 forward, -1 backward, 0 none"),
    "minimum_speed": ("m/s", "smallest speed while the law tracks, before the last slowing down"),
    "peak_speed": ("m/s", "largest speed"),
    "peak_forward_acceleration": ("m/s2", "largest forward acceleration"),
    "peak_yaw_acceleration": ("rad/s2", "largest yaw acceleration"),
    "position_error": ("m", "distance from the goal in the end"),
    "heading_error": ("rad", "heading less that of the goal in the end"),
    "arrival_time": ("s", "time from which on pose and rest are within the tolerances"),
}


def dataset(arrivals: Sequence[Arrival], eta_min: Sequence[float], limits: Limits) -> xr.Dataset:
    """Arrivals as labelled columns, with their outcomes."""
    import xarray as xr  # takes as long as all of this package

    columns = {
        name: ("pose", np.array([getattr(one, name) for one in arrivals], float), {"units": unit, "long_name": what})
        for name, (unit, what) in _UNITS.items()
    }
    words = [one.outcome(floor, limits) for one, floor in zip(arrivals, eta_min, strict=True)]
    return xr.Dataset({"outcome": ("pose", np.array(words, dtype="<U8")), **columns})


def last_dip(growth: NDArray[np.float64]) -> int:
    """Index of the last instant at which the speed grows, 0 if it never does: from there on the robot slows down."""
    growing = np.flatnonzero(growth > 0)
    return int(growing[-1]) if growing.size else 0


def wrapped(angle: float) -> float:
    """Angle from -pi to pi."""
    return float(np.remainder(angle + np.pi, 2 * np.pi) - np.pi)


def outcome_table(forecast: xr.Dataset, simulation: xr.Dataset) -> xr.DataArray:
    """Count the poses by what was forecast and what came.

    Parameters
    ----------
    forecast, simulation : xarray.Dataset
        With the variable ``outcome`` of the same n poses, as `goal_frame_forecast` and `goal_frame_runs` give it.

    Returns
    -------
    xarray.DataArray, shape (7, 7)
        Counts over ``forecast`` and ``simulation``, both labelled by outcome.

    Raises
    ------
    ParameterError
        If the two have no outcomes, or not equally many.
    """
    import xarray as xr

    pair: Mapping[str, xr.Dataset] = {"forecast": forecast, "simulation": simulation}
    if missing := [name for name, one in pair.items() if "outcome" not in one]:
        raise ParameterError(
            f"outcome_table: {missing[0]} has no outcome; pass what goal_frame_forecast or _runs gives"
        )
    sizes = {name: one["outcome"].size for name, one in pair.items()}
    if len(set(sizes.values())) > 1:
        raise ParameterError(f"outcome_table: {sizes} outcomes; pass those of the same poses")
    counts = np.zeros((len(OUTCOMES), len(OUTCOMES)), dtype=int)
    for told, came in zip(forecast["outcome"].values, simulation["outcome"].values, strict=True):
        counts[OUTCOMES.index(str(told)), OUTCOMES.index(str(came))] += 1
    return xr.DataArray(counts, coords={name: list(OUTCOMES) for name in pair}, dims=tuple(pair))
