"""Parameters of goal-frame manoeuvres, pose by pose, and the same manoeuvre driven more slowly."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from brunovsky.analysis._checks import finite_scalar
from brunovsky.analysis.rest.outcome import LIMITS, Limits
from brunovsky.blocks import Block
from brunovsky.blocks.units import BASE_UNITS, unit_exponents
from brunovsky.errors import ParameterError

_SECOND = BASE_UNITS.index("s")


def manoeuvre_parameters(
    poses: xr.Dataset, manoeuvre: Block, rate: ArrayLike, parameters: Mapping[str, float] | None, where: str
) -> Iterator[dict[str, float]]:
    """Parameters of the manoeuvre for each pose; those with seconds in their unit as the rate asks.

    Raises
    ------
    ParameterError
        If columns of the poses are missing or not finite, or a rate is not positive; ``where`` names the function.
    """
    names = ("x_start", "y_start", "theta_start", "goal_heading")
    if missing := [one for one in names if one not in poses]:
        raise ParameterError(f"{where}: the poses have no {', '.join(missing)}; resting_poses gives them")
    count = poses["x_start"].size
    rates = np.asarray(rate, dtype=float)
    if rates.shape not in ((), (count,)) or not (np.isfinite(rates) & (rates > 0)).all():
        raise ParameterError(f"{where}: rate = {rate!r}; pass one positive number, or one for each of {count} poses")
    values = manoeuvre.parameter_values(parameters)
    seconds = {one.name: unit_exponents(one.unit)[_SECOND] for one in manoeuvre.parameters}
    columns = [np.asarray(poses[one], dtype=float) for one in names]
    for pose, factor in zip(zip(*columns, strict=True), np.broadcast_to(rates, count), strict=True):
        scaled = {name: value * float(factor) ** -seconds[name] for name, value in values.items()}
        yield scaled | {name: float(one) for name, one in zip(names, pose, strict=True)}


def goal_frame_rate(forecast: xr.Dataset, limits: tuple[float, float, float] = LIMITS) -> xr.DataArray:
    """Factor on all rates with which the manoeuvres that were forecast just keep within limits.

    With poles, launch speed and all else that has seconds in its unit scaled by the rate, the path is the same and
    driven 1/rate times as long: speeds scale with the rate, accelerations with its square.

    Parameters
    ----------
    forecast : xarray.Dataset
        Of n poses, as `goal_frame_forecast` gives it for the rate 1.
    limits : tuple of float, shape (3,)
        On abs(eta[1]) in m/s, abs(u[1]) in m/s2, abs(u[2]) in rad/s2; positive.

    Returns
    -------
    xarray.DataArray, shape (n,)
        The rate for `goal_frame_forecast` and `goal_frame_runs`, at most 1.

    Raises
    ------
    ParameterError
        If a limit is not positive.
    """
    bounds = checked_limits(limits, "goal_frame_rate")
    ratios = [
        bounds.speed / forecast["peak_speed"],
        (bounds.forward_acceleration / forecast["peak_forward_acceleration"]) ** 0.5,
        (bounds.yaw_acceleration / forecast["peak_yaw_acceleration"]) ** 0.5,
    ]
    found = np.minimum.reduce([np.ones(forecast["outcome"].size), *(one.values for one in ratios)])
    return xr.DataArray(found, dims="pose", attrs={"units": "1", "long_name": "factor on all rates"})


def checked_limits(limits: tuple[float, float, float], where: str) -> Limits:
    """Limits as such, or ParameterError."""
    if len(tuple(limits)) != len(Limits._fields):
        raise ParameterError(f"{where}: limits = {limits!r}; pass three, on speed, forward and yaw acceleration")
    pairs = zip(limits, Limits._fields, strict=True)
    return Limits(*(finite_scalar(one, f"limit of {name}", where, minimum=0.0, strict=True) for one, name in pairs))
