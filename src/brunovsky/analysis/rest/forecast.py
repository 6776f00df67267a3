"""Forecast of goal-frame manoeuvres from the chains alone: no robot is simulated."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from brunovsky.analysis._checks import finite_scalar
from brunovsky.analysis.rest.manoeuvre import checked_limits, manoeuvre_parameters
from brunovsky.analysis.rest.outcome import LIMITS, SPEED, YAW_RATE, Arrival, dataset, last_dip, wrapped
from brunovsky.blocks import (
    Block,
    Chains,
    Diagram,
    Output,
    State,
    closed_loop,
    goal_frame_law,
    goal_frame_manoeuvre,
    robot_linearization,
    set_point,
    symbol,
)
from brunovsky.blocks.linearized import start_parameter
from brunovsky.blocks.variables import Input, described
from brunovsky.errors import LinearizationError
from brunovsky.linearization.numeric import numeric_function
from brunovsky.native import simulate

Floats = NDArray[np.float64]
_CHAINS = Chains()
_RECORD = (*(one.name for one in _CHAINS.states), "v[1]", "v[2]")


def goal_frame_forecast(
    poses: xr.Dataset,
    law: Block | None = None,
    *,
    rate: ArrayLike = 1.0,
    parameters: Mapping[str, float] | None = None,
    limits: tuple[float, float, float] = LIMITS,
    t_end: float = 120.0,
    step_size: float = 5e-3,
) -> xr.Dataset:
    """Say what will become of the goal-frame manoeuvre from each pose, from its chains alone.

    Launch and parking have closed forms. Between them the flat outputs are chains of integrators under the law,
    linear for P = 0, whatever the robot does; speed, heading and inputs follow from them by the inverse of the
    coordinate map. That holds while abs(eta[1]) stays above ``eta_min``: beyond it the forecast is ``singular``, and
    what it says of the end is no longer meant. An end turned by pi is forecast where the slow mode has the sign that
    makes the robot come in from the other side than its launch has it.

    Parameters
    ----------
    poses, law, rate, parameters, limits, t_end
        As those of `goal_frame_runs`.
    step_size : float
        Of RK4 on the chains, s; between two steps the velocity is taken as linear in time.

    Returns
    -------
    xarray.Dataset
        As `goal_frame_runs` gives it, but for the ``arrival_time``, which is NaN: of parking only the end is told.

    Raises
    ------
    ParameterError
        For poses, rates, limits or parameters that cannot be used.
    ModelError
        If `law` is no goal-frame law.
    """
    where = "goal_frame_forecast"
    bounds, duration = checked_limits(limits, where), finite_scalar(t_end, "t_end", where, minimum=0.0, strict=True)
    law = law or goal_frame_law()
    manoeuvre = goal_frame_manoeuvre(law)
    loop = closed_loop(law, plant=_integrators(), reference=set_point(), name="goal_frame_chains")
    arrivals, floors = [], []
    for values in manoeuvre_parameters(poses, manoeuvre, rate, parameters, where):
        arrivals.append(_arrival(loop, values, duration, step_size))
        floors.append(values["eta_min"])
    return dataset(arrivals, floors, bounds)


def _arrival(loop: Diagram, values: Mapping[str, float], t_end: float, step_size: float) -> Arrival:
    goal = np.array([values["goal[1]"], values["goal[2]"]])
    start = np.array([values["x_start"], values["y_start"]]) - goal
    heading, theta = values["goal_heading"], values["theta_start"]
    if np.hypot(*start) <= values["park_distance"]:
        return Arrival(
            0.0, np.inf, 0.0, 0.0, 0.0, float(np.hypot(*start)), wrapped(theta - heading), True, False, np.nan
        )
    launch = -1.0 if start @ _direction(heading) > 0 else 1.0
    speed, acceleration = launch * values["launch_speed"], launch * values["launch_acceleration"]
    duration = speed / acceleration
    if duration >= t_end:  # a launch that is driven so slowly that it has no end
        stop = start + acceleration * t_end**2 / 2 * _direction(theta)
        peak = abs(acceleration) * t_end
        away, turn = float(np.hypot(*stop)), wrapped(theta - heading)
        return Arrival(launch, np.inf, peak, abs(acceleration), 0.0, away, turn, False, False, np.nan)
    launched = np.array(
        [
            start + goal + speed * duration / 2 * _direction(theta),
            *(one * _direction(theta) for one in (speed, acceleration)),
        ]
    )
    starts = {f"Z{i}_start[{k}]": float(launched[k - 1, i - 1]) for i in (1, 2) for k in (1, 2, 3)}
    law = {one.name: values[one.name] for one in loop.parameters if one.name in values}
    targets = {f"target[{i}]": float(goal[i - 1]) for i in (1, 2)}
    run = simulate(loop, t_end - duration, step_size=step_size, parameters=starts | law | targets, record=_RECORD)
    seen = np.array([run[name].values for name in _RECORD])
    position, velocity = seen[[0, 3]].T - goal, seen[[1, 4]].T
    rate = np.linalg.norm(velocity, axis=1)
    parks = (np.linalg.norm(position, axis=1) <= values["park_distance"]) & (rate <= values["park_speed"])
    end = int(np.argmax(parks)) if parks.any() else len(parks) - 1
    with np.errstate(all="ignore"):
        motion = np.broadcast_arrays(*_motion()(*seen[:, : end + 1]))
    dip = last_dip(motion[1])
    eta1, u1, u2 = (abs(one) for one in motion[:3])
    last_theta, last_eta2 = float(motion[3][-1]) + (np.pi if launch < 0 else 0.0), float(motion[4][-1])
    left = t_end - duration - float(run["time"][end]) if parks.any() else 0.0
    fades = [np.exp(-values[f"brake[{k}]"] * left) for k in (1, 2)]
    braking = [values[f"brake[{k}]"] * abs(float(motion[column][end])) * (left > 0) for k, column in ((1, 0), (2, 4))]
    covered = [(1 - fade) / values[f"brake[{k}]"] for k, fade in enumerate(fades, 1)]
    final = position[end] + velocity[end] * covered[0]
    return Arrival(
        launch=launch,
        minimum_speed=_nearest_to_zero(velocity[: dip + 1]),
        peak_speed=float(eta1.max()),
        peak_forward_acceleration=max(float(u1.max()), abs(acceleration), braking[0]),
        peak_yaw_acceleration=max(float(np.nan_to_num(u2, nan=np.inf).max()), braking[1]),
        position_error=float(np.hypot(*final)),
        heading_error=wrapped(last_theta + last_eta2 * covered[1] - heading),
        is_at_rest=bool(eta1[-1] * fades[0] <= SPEED and abs(last_eta2) * fades[1] <= YAW_RATE),
        has_failed=False,
        arrival_time=np.nan,
    )


def _direction(angle: float) -> Floats:
    return np.array([-np.sin(angle), np.cos(angle)])


def _nearest_to_zero(velocity: Floats) -> float:
    """Smallest distance of a polygon from the origin."""
    if len(velocity) == 1:
        return float(np.hypot(*velocity[0]))
    first, along = velocity[:-1], np.diff(velocity, axis=0)
    square = np.einsum("ij,ij->i", along, along)
    with np.errstate(all="ignore"):
        part = np.nan_to_num(np.clip(-np.einsum("ij,ij->i", first, along) / square, 0.0, 1.0))
    return float(np.linalg.norm(first + part[:, None] * along, axis=1).min())


def _integrators() -> Block:
    """The chains with nothing behind them: inputs ``v[i]``, states and outputs ``Zi[k]``, starts ``Zi_start[k]``."""
    elements = {one.symbol: one for one in _CHAINS.states}
    inputs = [Input(f"v[{i}]", _CHAINS.unit(i, 3), f"input of chain {i}") for i in _CHAINS.numbers]
    starts = {key: start_parameter(one) for key, one in elements.items()}
    following = {
        symbol(f"Z{i}[{k}]"): symbol(f"Z{i}[{k + 1}]" if k < order else f"v[{i}]")
        for i, order in enumerate(_CHAINS.orders, 1)
        for k in range(1, order + 1)
    }
    return Block(
        "integrators",
        "chains of integrators",
        inputs=tuple(inputs),
        parameters=tuple(starts.values()),
        states=tuple(
            State(**described(one), derivative=following[key], start=starts[key].symbol)
            for key, one in elements.items()
        ),
        outputs=tuple(Output(**described(one), expression=key) for key, one in elements.items()),
    )


@lru_cache
def _motion() -> Any:
    """From chains and v to eta1, u1, u2, theta and eta2, where eta1 > 0: the inverse of the coordinate map."""
    linearization = robot_linearization()
    normal_form, system = linearization.normal_form, linearization.extended_system
    _, _, theta, eta1, eta2, u1 = system.states
    inverse = normal_form.inverse
    if inverse is None:
        raise LinearizationError("the robot's coordinate map has lost its inverse in closed form")
    yaw = linearization.law[system.inputs[0]].xreplace(dict(inverse))
    arguments = [*(name for chain in normal_form.chains for name in chain), *linearization.outer_inputs]
    return numeric_function(arguments, [inverse[eta1], inverse[u1], yaw, inverse[theta], inverse[eta2]])
