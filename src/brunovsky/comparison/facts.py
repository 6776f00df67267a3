"""What the paragraphs of a report are made of: facts of one run, and numbers as text."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from brunovsky.comparison.metrics import instants, position_error, settling_time, tail, total_variation, values

_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


CONVERGED = 0.01  # relative change at half the step up to which a number counts as converged
HARDLY = 0.05  # relative difference up to which laws hardly differ, and a metric hardly depends on a parameter
TINY = 1e-6  # m; an error below which no share of it is told, but the error itself
FINER = {"settling_1mm": 1e-3, "settling_100um": 1e-4}  # m; settling beyond the 1 cm of the metrics


@dataclass(frozen=True)
class Facts:
    """What happened in a run that reached its end, beyond its metrics.

    Attributes
    ----------
    settling_1mm, settling_100um : float or None
        Last time the position error exceeds 1 mm and 0.1 mm (s); None if it still does at the end.
    peak_yaw_time : float
        When the largest abs(u2) occurred (s).
    peak_yaw_speed : float
        abs(eta1) at the largest abs(u2) (m/s).
    guarded_share : float
        Part of the instants with abs(eta1) <= eta_min, where the law is regularised.
    guarded_first : float or None
        The first of them (s).
    reversals : int
        Changes of the sign of eta1 until the position error stays below 1 cm.
    heading_start, heading_end : float
        theta (rad).
    roughness_u1, roughness_u2 : float
        Total variation over the last quarter, for each second of it (m/s3, rad/s3).
    tail_speed, tail_fastest, tail_turning : float
        Smallest and largest abs(eta1) (m/s) and largest abs(eta2) (rad/s) over the last quarter.
    tail_forward, tail_yaw : float
        Largest abs(u1) (m/s2) and abs(u2) (rad/s2) over the last quarter.
    """

    settling_1mm: float | None
    settling_100um: float | None
    peak_yaw_time: float
    peak_yaw_speed: float
    guarded_share: float
    guarded_first: float | None
    reversals: int
    heading_start: float
    heading_end: float
    roughness_u1: float
    roughness_u2: float
    tail_speed: float
    tail_fastest: float
    tail_turning: float
    tail_forward: float
    tail_yaw: float


def compute_facts(data: xr.Dataset) -> Facts:
    """Facts of a run that reached its end, from its trajectory."""
    time, error = instants(data), position_error(data)
    speed, turning, u1, u2, theta = (values(data, name) for name in ("eta[1]", "eta[2]", "u[1]", "u[2]", "theta"))
    guarded = values(data, "singular") > 0.0 if "singular" in data else np.zeros(len(time), dtype=bool)
    last = tail(time)
    duration = float(time[-1] - time[last][0])
    settled = settling_time(time, error)
    moving = np.sign(speed[time <= (time[-1] if settled is None else settled)])
    moving = moving[moving != 0.0]
    return Facts(
        **{name: settling_time(time, error, threshold) for name, threshold in FINER.items()},
        peak_yaw_time=float(time[np.argmax(np.abs(u2))]),
        peak_yaw_speed=float(np.abs(speed[np.argmax(np.abs(u2))])),
        guarded_share=float(np.mean(guarded)),
        guarded_first=float(time[np.argmax(guarded)]) if guarded.any() else None,
        reversals=int(np.count_nonzero(np.diff(moving))),
        heading_start=float(theta[0]),
        heading_end=float(theta[-1]),
        roughness_u1=total_variation(u1[last]) / duration,
        roughness_u2=total_variation(u2[last]) / duration,
        tail_speed=float(np.min(np.abs(speed[last]))),
        tail_fastest=float(np.max(np.abs(speed[last]))),
        tail_turning=float(np.max(np.abs(turning[last]))),
        tail_forward=float(np.max(np.abs(u1[last]))),
        tail_yaw=float(np.max(np.abs(u2[last]))),
    )


def wrapped(angle: float) -> float:
    """An angle in (-pi, pi], rad."""
    return -((math.pi - angle) % (2.0 * math.pi) - math.pi)


def number(value: float | None, digits: int = 3) -> str:
    """A measured number for people: significant digits, powers of ten written out, a dash for None."""
    if value is None:
        return "–"
    if value == 0.0 or not math.isfinite(value):
        return f"{value:g}".replace("inf", "∞").replace("-", "−")
    rounded = float(f"{value:.{digits - 1}e}")
    exponent = math.floor(math.log10(abs(rounded)))
    if -4 < exponent < 4:
        return f"{rounded:.{max(digits - 1 - exponent, 0)}f}".replace("-", "−")
    mantissa = f"{rounded / 10.0**exponent:.{digits - 1}f}".replace("-", "−")
    return f"{mantissa}×10{str(exponent).translate(_SUPERSCRIPTS)}"


def given(value: float) -> str:
    """A number that was chosen, not measured: as short as it can be written, to four digits."""
    text = f"{value:.4g}"
    return number(value) if "e" in text else text.replace("-", "−")


def power_of_ten(value: float) -> str:
    """A power of ten, its negative or zero, as the label of an axis."""
    if value == 0.0:
        return "0"
    exponent = round(math.log10(abs(value)))
    short = {-2: "0.01", -1: "0.1", 0: "1", 1: "10", 2: "100"}
    text = short.get(exponent, f"10{str(exponent).translate(_SUPERSCRIPTS)}")
    return f"−{text}" if value < 0.0 else text


def seconds(value: float) -> str:
    """An instant, to the millisecond."""
    return f"{value:.3f}\u00a0s"


def percent(value: float) -> str:
    """A share or change, with a sign for changes below zero."""
    return f"{number(100.0 * value, 2)}\u00a0%"


def joined(parts: Sequence[str]) -> str:
    """Items of a list in a sentence."""
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}"


def spread(found: Sequence[float], unit: str, digits: int = 3) -> str:
    """Range of several numbers, or the one number if they agree as printed."""
    low, high = number(min(found), digits), number(max(found), digits)
    return f"{low}\u00a0{unit}" if low == high else f"{low} to {high}\u00a0{unit}"


def change(value: float | None, base: float | None) -> float | None:
    """Relative change from a base; None where it is undefined."""
    return None if value is None or not base else value / base - 1.0
