"""Forecast of goal-frame manoeuvres from the chains alone: no robot is simulated."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any, NamedTuple

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
    forward, turn = _direction(values["theta_start"]), wrapped(values["theta_start"] - values["goal_heading"])
    distance = float(np.linalg.norm(start))
    if distance <= values["park_distance"]:
        return Arrival(0.0, np.inf, 0.0, 0.0, 0.0, distance, turn, True, False, np.nan)
    launch = -1.0 if start @ _direction(values["goal_heading"]) > 0 else 1.0
    speed, acceleration = launch * values["launch_speed"], launch * values["launch_acceleration"]
    duration = speed / acceleration
    if duration >= t_end:  # so slow that the launch has no end
        stop = float(np.linalg.norm(start + acceleration * t_end**2 / 2 * forward))
        return Arrival(
            launch, np.inf, abs(acceleration) * t_end, abs(acceleration), 0.0, stop, turn, False, False, np.nan
        )
    launched = (goal + start + speed * duration / 2 * forward, speed * forward, acceleration * forward)
    parameters = {f"Z{i}_start[{k}]": float(one[i - 1]) for i in (1, 2) for k, one in enumerate(launched, 1)}
    parameters |= {f"target[{i}]": float(goal[i - 1]) for i in (1, 2)}
    parameters |= {one.name: values[one.name] for one in loop.parameters if one.name in values}
    run = simulate(loop, t_end - duration, step_size=step_size, parameters=parameters, record=_RECORD)
    tracked = _tracked(run, goal, values)
    left = t_end - duration - float(run["time"][len(tracked.speed) - 1]) if tracked.parks else 0.0
    return _parked(tracked, launch, acceleration, left, values)


class _Tracked(NamedTuple):
    """What the robot would have to do until it parks; all but the last are arrays over time."""

    position: Floats
    velocity: Floats
    speed: Floats
    growth: Floats
    yaw_acceleration: Floats
    direction: Floats
    yaw_rate: Floats
    parks: bool


def _tracked(run: xr.Dataset, goal: Floats, values: Mapping[str, float]) -> _Tracked:
    seen = np.array([run[name].values for name in _RECORD])
    position, velocity = seen[[0, 3]].T - goal, seen[[1, 4]].T
    near = np.linalg.norm(position, axis=1) <= values["park_distance"]
    parks = near & (np.linalg.norm(velocity, axis=1) <= values["park_speed"])
    count = int(np.argmax(parks)) + 1 if parks.any() else len(parks)
    with np.errstate(all="ignore"):
        speed, growth, yaw, direction, yaw_rate = np.broadcast_arrays(*_motion()(*seen[:, :count]))
    return _Tracked(position[:count], velocity[:count], speed, growth, yaw, direction, yaw_rate, bool(parks.any()))


def _parked(tracked: _Tracked, launch: float, acceleration: float, left: float, values: Mapping[str, float]) -> Arrival:
    """Arrival after the time that is left for parking: both speeds decay exponentially, the heading hardly turns."""
    brakes = (values["brake[1]"], values["brake[2]"])
    fades = [np.exp(-one * left) for one in brakes]
    covered = [(1 - fade) / one for fade, one in zip(fades, brakes, strict=True)]
    speed, yaw_rate = float(tracked.speed[-1]), float(tracked.yaw_rate[-1])
    braking = (brakes[0] * speed, brakes[1] * abs(yaw_rate)) if tracked.parks else (0.0, 0.0)
    final = tracked.position[-1] + tracked.velocity[-1] * covered[0]
    heading = float(tracked.direction[-1]) + (np.pi if launch < 0 else 0.0) + yaw_rate * covered[1]
    return Arrival(
        launch=launch,
        minimum_speed=_nearest_to_zero(tracked.velocity[: last_dip(tracked.growth) + 1]),
        peak_speed=float(tracked.speed.max()),
        peak_forward_acceleration=max(float(abs(tracked.growth).max()), abs(acceleration), braking[0]),
        peak_yaw_acceleration=max(float(np.nan_to_num(abs(tracked.yaw_acceleration), nan=np.inf).max()), braking[1]),
        position_error=float(np.linalg.norm(final)),
        heading_error=wrapped(heading - values["goal_heading"]),
        is_at_rest=bool(speed * fades[0] <= SPEED and abs(yaw_rate) * fades[1] <= YAW_RATE),
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
