"""Goal-frame manoeuvres, simulated from many resting poses."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from brunovsky.analysis._checks import finite_scalar
from brunovsky.analysis.rest.manoeuvre import checked_limits, manoeuvre_parameters
from brunovsky.analysis.rest.outcome import (
    HEADING,
    LIMITS,
    POSITION,
    SPEED,
    YAW_RATE,
    Arrival,
    dataset,
    last_dip,
    wrapped,
)
from brunovsky.blocks import Block, goal_frame_manoeuvre
from brunovsky.errors import SimulationError
from brunovsky.native import simulate

_RECORD = ("x", "y", "theta", "eta[1]", "eta[2]", "u[1]", "u[2]", "mode")
TRACKING = 2


def goal_frame_runs(
    poses: xr.Dataset,
    law: Block | None = None,
    *,
    rate: ArrayLike = 1.0,
    parameters: Mapping[str, float] | None = None,
    limits: tuple[float, float, float] = LIMITS,
    t_end: float = 120.0,
    step_size: float = 2e-3,
) -> xr.Dataset:
    """Simulate the goal-frame manoeuvre from each pose, and say what became of it.

    The outcome is ``reached`` where, at the end, the robot is within 5 mm and 0.02 rad (modulo 2 pi) of the goal and
    rests (1 mm/s, 1 mrad/s), and all limits were kept. Else it is the first of these that holds: ``singular``,
    abs(eta[1]) fell below ``eta_min`` while the law tracked, before the robot last slowed
    down; ``diverged``, a step failed; ``away``, not there or not
    at rest; ``reversed``, there with a heading that is off by more than a right angle; ``tilted``, off by less;
    ``limits``, the pose is reached beyond a limit.

    Parameters
    ----------
    poses : xarray.Dataset
        n poses, as `resting_poses` gives them.
    law : Block, optional
        What :func:`brunovsky.blocks.goal_frame_law` returns; its default otherwise.
    rate : float, or array_like, shape (n,)
        Factor on all rates, as `goal_frame_rate` finds it.
    parameters : mapping of str to float, optional
        Of the manoeuvre, for all poses, at the rate 1.
    limits : tuple of float, shape (3,)
        On abs(eta[1]) in m/s, abs(u[1]) in m/s2, abs(u[2]) in rad/s2.
    t_end, step_size : float
        Time that is allowed, and the step of RK4, s.

    Returns
    -------
    xarray.Dataset
        Over ``pose``, shape (n,): ``outcome``; ``launch`` (1 forward, -1 backward, 0 none); ``minimum_speed`` in m/s
        while the law tracks, before the robot last slows down; ``peak_speed`` in m/s, ``peak_forward_acceleration``
        in m/s2, ``peak_yaw_acceleration`` in rad/s2; ``position_error`` in m and ``heading_error`` in rad in the end;
        ``arrival_time`` in s, NaN where the robot doesn't arrive.

    Raises
    ------
    ParameterError
        For poses, rates, limits or parameters that cannot be used.
    ModelError
        If `law` is no goal-frame law.
    """
    where = "goal_frame_runs"
    bounds, duration = checked_limits(limits, where), finite_scalar(t_end, "t_end", where, minimum=0.0, strict=True)
    manoeuvre = goal_frame_manoeuvre(law)
    arrivals, floors = [], []
    for values in manoeuvre_parameters(poses, manoeuvre, rate, parameters, where):
        failed = False
        try:
            run = simulate(manoeuvre, duration, step_size=step_size, parameters=values, record=_RECORD)
        except SimulationError as error:
            run, failed = error.trajectory, True
        arrivals.append(_arrival(run, values, has_failed=failed))
        floors.append(values["eta_min"])
    return dataset(arrivals, floors, bounds)


def _arrival(run: xr.Dataset, values: Mapping[str, float], *, has_failed: bool) -> Arrival:
    x, y, theta, eta1, eta2, u1, u2, mode = (run[name].values for name in _RECORD)
    distance = np.hypot(x - values["goal[1]"], y - values["goal[2]"])
    turn = np.remainder(theta - values["goal_heading"] + np.pi, 2 * np.pi) - np.pi
    rests = (abs(eta1) <= SPEED) & (abs(eta2) <= YAW_RATE)
    outside = np.flatnonzero(~(rests & (distance <= POSITION) & (abs(turn) <= HEADING)))
    arrived = int(outside[-1]) + 1 if outside.size else 0
    tracked = eta1[mode == TRACKING]
    tracked = tracked[: last_dip(u1[mode == TRACKING] * np.sign(tracked)) + 1]
    crosses = tracked.size and tracked.min() < 0 < tracked.max()
    launched = eta1[mode > 0]
    return Arrival(
        launch=float(np.sign(launched[np.flatnonzero(launched)[0]])) if launched.any() else 0.0,
        minimum_speed=0.0 if crosses else float(abs(tracked).min(initial=np.inf)),
        peak_speed=float(abs(eta1).max()),
        peak_forward_acceleration=float(abs(u1).max()),
        peak_yaw_acceleration=float(abs(u2).max()),
        position_error=float(distance[-1]),
        heading_error=wrapped(float(theta[-1]) - values["goal_heading"]),
        is_at_rest=bool(rests[-1]),
        has_failed=has_failed,
        arrival_time=float(run["time"][arrived]) if arrived < len(x) and not has_failed else np.nan,
    )
