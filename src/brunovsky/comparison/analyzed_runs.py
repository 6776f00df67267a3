"""What is known of each run of a study before it is simulated: reaching, disturbance bounds, margins, singularity."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from brunovsky._frozen import FrozenMapping
from brunovsky.analysis import (
    DiskMargin,
    Margins,
    SteadyMotion,
    actuator_loop,
    actuator_loop_transfer,
    disk_margin,
    forward_disturbance_bound,
    loop_margins,
    reaching_time,
    steady_motion,
    yaw_disturbance_bound,
)
from brunovsky.blocks import TIME, circle, robot_linearization
from brunovsky.comparison.analyzed_loops import gains, law_numbers
from brunovsky.comparison.residuals import predicted_residual
from brunovsky.comparison.study import Law, PlannedRun
from brunovsky.errors import ParameterError
from brunovsky.linearization import chain_values, forecast
from brunovsky.linearization.numeric import numeric_function

Array = NDArray[np.float64]
_INSTANTS = 5001  # of a forecast, before its smallest distance is refined
_START = {
    "x": "x_start",
    "y": "y_start",
    "theta": "theta_start",
    "eta_1": "eta_start[1]",
    "eta_2": "eta_start[2]",
    "u_1": "u_start[1]",
}


@dataclass(frozen=True)
class ActuatorMargins:
    """Margins of the robot's loop at its actuators under v = -K e, along a steady motion of the nominal robot.

    Attributes
    ----------
    u1, u2 : Margins
        Cut at one actuator, the other one working.
    disk_u1, disk_u2, disk_both : DiskMargin
        Gain and phase varied together: at one of them, and at both independently.
    """

    u1: Margins
    u2: Margins
    disk_u1: DiskMargin
    disk_u2: DiskMargin
    disk_both: DiskMargin


@dataclass(frozen=True)
class NearestApproach:
    """How near a linear law brings the robot to the singularity eta1 = 0 of its inner loop.

    Attributes
    ----------
    closest_speed, closest_time : float
        Smallest abs(eta1) (m/s), and when (s).
    peak_yaw_acceleration : float
        Largest abs(u2) at the instants of the forecast (rad/s2); inf where the law does not exist.
    guarded : bool
        Whether abs(eta1) falls to eta_min, below which the law that runs is the guarded one, and goes elsewhere.
    """

    closest_speed: float
    closest_time: float
    peak_yaw_acceleration: float
    guarded: bool


@dataclass(frozen=True, eq=False)
class AnalyzedRun:
    """One scenario under one law.

    Attributes
    ----------
    name, scenario, law : str
        ``scenario/law`` and its parts.
    sliding_start : tuple of float
        S of both chains at the start (m/s2).
    reaching_time : tuple of float
        Time (s) to S = 0 for ``sign``, to abs(S) = phi for ``saturation``, inf for ``linear``, of each chain of the
        nominal robot without disturbance, if abs(eta1) stays above eta_min until then (it does not on the way to a set
        point, and S arrives later).
    speed, yaw_rate : float
        Of the reference (m/s, rad/s); 0 at a set point.
    forward_disturbance_bound, yaw_disturbance_bound : float
        What P rejects of d1 (m/s2) and d2 (rad/s2) on the reference; inf where the disturbance does not reach the
        chains, 0 for a law without switching.
    predicted_residual : float or None
        Position error that constant disturbances leave (m); None without any, at a set point or with rho not 1.
    actuators : mapping of str to ActuatorMargins, or None
        For ``linear_part`` and ``boundary_layer``; see `actuators_reason` for None.
    forecast : NearestApproach or None
        See `forecast_reason` for None.
    actuators_reason, forecast_reason : str or None
        Why there is none.
    """

    name: str
    scenario: str
    law: str
    sliding_start: tuple[float, ...]
    reaching_time: tuple[float, ...]
    speed: float
    yaw_rate: float
    forward_disturbance_bound: float
    yaw_disturbance_bound: float
    predicted_residual: float | None
    actuators: Mapping[str, ActuatorMargins] | None
    actuators_reason: str | None
    forecast: NearestApproach | None
    forecast_reason: str | None


def analyzed_run(run: PlannedRun, law: Law) -> AnalyzedRun:
    """Everything about one run that needs no simulation of it."""
    p = run.parameters
    *C, _, P, _ = law_numbers(run)
    chains = chain_values(robot_linearization(), {state: p[start] for state, start in _START.items()})
    reference = circle_reference(p)
    sliding = tuple(float(np.dot(C, z - zd[:-1])) for z, zd in zip(chains, reference(0.0), strict=True))
    speed, yaw_rate = (abs(p["radius"] * p["rate"]), p["rate"]) if p["radius"] else (0.0, 0.0)
    actuators, actuators_reason = _actuators(run, law)
    nearest, forecast_reason = _forecast(run, law, chains, reference)
    return AnalyzedRun(
        name=run.name,
        scenario=run.scenario,
        law=run.law,
        sliding_start=sliding,
        reaching_time=tuple(_reaching_time(one, run, law) for one in sliding),
        speed=speed,
        yaw_rate=yaw_rate,
        forward_disturbance_bound=forward_disturbance_bound(C, P, yaw_rate),
        yaw_disturbance_bound=yaw_disturbance_bound(C, P, speed) if P else 0.0,
        predicted_residual=predicted_residual(run, law),
        actuators=actuators,
        actuators_reason=actuators_reason,
        forecast=nearest,
        forecast_reason=forecast_reason,
    )


def circle_reference(parameters: Mapping[str, float]) -> Callable[[float], tuple[Array, Array]]:
    """Reference of a run as a function of time: z_d and its three derivatives on each axis."""
    block = circle()
    values = {one.symbol: parameters[one.name] for one in block.parameters}
    outputs = {one.name: one.expression for one in block.outputs}
    names = [f"Z{i}d[{k}]" for i in (1, 2) for k in (1, 2, 3)]
    order = [*names[:3], "zd3[1]", *names[3:], "zd3[2]"]
    at = numeric_function([TIME], [outputs[name].subs(values) for name in order])

    def reference(time: float) -> tuple[Array, Array]:
        found = np.array(at(time), dtype=float)
        return found[:4], found[4:]

    return reference


def _reaching_time(start: float, run: PlannedRun, law: Law) -> float:
    *_, Q, P, phi = law_numbers(run)
    if law.kind == "linear" or P == 0.0:
        return float("inf")
    layer = min(phi if law.kind == "saturation" else 0.0, abs(start))
    return reaching_time(start, Q, P) - reaching_time(layer, Q, P)


def _actuators(run: PlannedRun, law: Law) -> tuple[Mapping[str, ActuatorMargins] | None, str | None]:
    try:
        block = circle()
        motion = steady_motion(block, {one.name: run.parameters[one.name] for one in block.parameters})
        found = {name: _actuator_margins(gain, motion) for name, gain in gains(run, law.kind).items()}
    except ParameterError as error:
        return None, str(error)
    return FrozenMapping(found), None


@lru_cache(maxsize=64)
def _actuator_margins(gain: tuple[float, ...], motion: SteadyMotion) -> ActuatorMargins:
    one, two = (actuator_loop_transfer(gain, motion, actuator) for actuator in (1, 2))
    both = disk_margin(actuator_loop(gain, motion))
    return ActuatorMargins(loop_margins(one), loop_margins(two), disk_margin(one), disk_margin(two), both)


def _forecast(
    run: PlannedRun, law: Law, chains: tuple[Array, ...], reference: Callable[[float], tuple[Array, Array]]
) -> tuple[NearestApproach | None, str | None]:
    p = run.parameters
    if law.kind != "linear":
        return None, f"the law '{law.name}' switches, so that its chains are not linear; simulate it"
    if not run.is_undisturbed or run.is_uncertain:
        return None, "the plant is disturbed or not the nominal one, so that its chains are not linear; simulate it"
    gain = gains(run, law.kind)["linear_part"]
    found = forecast(robot_linearization(), [gain, gain], chains, reference, run.duration, samples=_INSTANTS)
    return NearestApproach(
        found.closest_distance,
        found.closest_time,
        next(peak for symbol, peak in found.peaks.items() if str(symbol) == "u_2"),
        found.closest_distance <= p["eta_min"],
    ), None
