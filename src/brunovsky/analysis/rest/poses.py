"""Resting poses at random about a goal, the same for all that is compared."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from brunovsky.analysis._checks import finite_scalar
from brunovsky.errors import ParameterError

if TYPE_CHECKING:
    import xarray as xr


def resting_poses(number: int, radius: float = 10.0, seed: int = 0) -> xr.Dataset:
    """Draw poses at rest, uniformly in a disc about a goal at the origin, and headings of start and goal.

    Parameters
    ----------
    number : int
        How many, n >= 1.
    radius : float
        Of the disc, m.
    seed : int
        Of NumPy's default generator: equal arguments give equal poses. Fewer poses are not the first of more.

    Returns
    -------
    xarray.Dataset
        Over the dimension ``pose``, shape (n,): ``x_start``, ``y_start`` in m, ``theta_start`` and ``goal_heading`` in
        rad, from -pi to pi; named like the parameters of what is simulated.

    Raises
    ------
    ParameterError
        If `number` is not a positive whole number, `radius` not positive, or `seed` not a whole number >= 0.
    """
    where = "resting_poses"
    if isinstance(number, bool) or not isinstance(number, int | np.integer) or number < 1:
        raise ParameterError(f"{where}: number = {number!r}; pass a positive whole number")
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise ParameterError(f"{where}: seed = {seed!r}; pass a whole number >= 0")
    radius = finite_scalar(radius, "radius", where, minimum=0.0, strict=True)
    random = np.random.default_rng(seed)
    distance = radius * np.sqrt(random.random(number))
    bearing, theta, heading = random.uniform(-np.pi, np.pi, (3, number))
    columns = {
        "x_start": (distance * np.cos(bearing), "m", "start, x"),
        "y_start": (distance * np.sin(bearing), "m", "start, y"),
        "theta_start": (theta, "rad", "heading at the start"),
        "goal_heading": (heading, "rad", "heading at the goal"),
    }
    import xarray as xr  # takes as long as all of this package

    return xr.Dataset(
        {name: ("pose", value, {"units": unit, "long_name": what}) for name, (value, unit, what) in columns.items()}
    )
