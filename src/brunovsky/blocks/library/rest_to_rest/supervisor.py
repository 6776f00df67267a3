"""The supervisor: modes from rest to rest, the plan of each leg, the reference of the chains and the inner loop."""

from __future__ import annotations

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.guard import Guard
from brunovsky.blocks.library.chains import ROBOT_CHAINS
from brunovsky.blocks.library.rest_to_rest.candidates import Candidate, candidates
from brunovsky.blocks.library.rest_to_rest.path import PARAMETER, Pose, forward, wrapped
from brunovsky.blocks.library.rest_to_rest.reference import Drive, Reference
from brunovsky.blocks.library.rest_to_rest.timing import (
    Limits,
    duration,
    path_timing,
    rise,
    turned,
    turning_time,
)
from brunovsky.blocks.library.robot import robot_linearization
from brunovsky.blocks.variables import (
    TIME,
    Check,
    Input,
    Mode,
    Output,
    Parameter,
    Relation,
    Sample,
    State,
    Transition,
    held,
    symbol,
    symbols,
)

REST, MOVING, BRAKING = 0, 1, 2
TURN, PATH = 0, 1
STILL = 0.005
"""Speed (m/s) and yaw rate (rad/s) below which the robot rests enough to plan."""
DISTURBED = 0.05
"""Speed (m/s) or yaw rate (rad/s) above which a robot that should rest is braked."""
NEAR_ALONG = 0.02
"""Distance along its heading from which the goal is reached by the law that holds it, m."""
ALIGNED = 0.05
"""Angle from which the heading of the goal is reached by the law that holds it, rad."""
LOST_HEADING = 0.6
"""Heading error at which a leg is given up, rad."""
LEAST_BRAKING = 0.05
"""Least time of braking, s."""
UNDECIDED = 1e9
"""Cost that any plan beats, s."""

GOAL = (
    Input("goal[1]", "m", "goal, x"),
    Input("goal[2]", "m", "goal, y"),
    Input("goal_heading", "rad", "heading at the goal"),
)
LIMITS = (
    Parameter("speed_limit", "m/s", "largest forward speed", 1.5, 0.0, tunable=True),
    Parameter("u_limit[1]", "m/s2", "largest forward acceleration", 2.0, 0.0, tunable=True),
    Parameter("u_limit[2]", "rad/s2", "largest yaw acceleration", 30.0, 0.0, tunable=True),
)
_ETA_MIN = Parameter("eta_min", "m/s", "speed below which the linearising law fades into one for the heading",
                     0.1, 1e-6, tunable=True)  # fmt: skip
_OTHERS = (
    Parameter("tolerance", "m", "distance to the side at which the goal counts as reached", 0.002, 1e-9, tunable=True),
    Parameter("tube", "m", "distance from its reference at which the robot brakes and plans anew", 0.2, 1e-6, tunable=True),
    Parameter("hold_rate", "1/s", "rate at which heading and rest are held", 8.0, 0.0, tunable=True),
    Parameter("observer_rate", "1/s", "rate of the observer of disturbances; 0: none", 20.0, 0.0, tunable=True),
)  # fmt: skip
_STATE = (
    Input("x", "m", "position of the robot along x"),
    Input("y", "m", "position of the robot along y"),
    Input("theta", "rad", "heading of the robot"),
    Input("eta[1]", "m/s", "forward velocity of the robot"),
    Input("eta[2]", "rad/s", "yaw rate of the robot"),
)
_PLAN = (
    held("from_x", "m", "start of the leg, x"),
    held("from_y", "m", "start of the leg, y"),
    held("from_heading", "rad", "heading at the start of the leg"),
    held("to_x", "m", "end of the leg, x"),
    held("to_y", "m", "end of the leg, y", 1),
    held("to_heading", "rad", "heading at the end of the leg"),
    held("tangent", "m", "derivative of the path at its ends, negative backward", 1),
    held("direction", "1", "1 forward, -1 backward", 1),
    held("turn", "rad", "angle of a turn in place"),
    held("begin", "s", "begin of the leg or of braking"),
    held("duration", "s", "duration of the leg or of braking", 1),
    held("cruise", "m/s", "cruising speed of the leg", 1),
    held("acceleration_limit", "m/s2", "first acceleration of the leg", 1),
    held("eta_brake[1]", "m/s", "forward velocity when braking began"),
    held("eta_brake[2]", "rad/s", "yaw rate when braking began"),
    held("planned_goal[1]", "m", "goal of the plan, x"),
    held("planned_goal[2]", "m", "goal of the plan, y"),
    held("planned_heading", "rad", "heading at the goal of the plan"),
)
_SEARCH = (
    held("leg_along", "m", "path that is timed: its end, along"),
    held("leg_left", "m", "path that is timed: its end, to the left"),
    held("leg_turn", "rad", "path that is timed: its turn"),
    held("leg_tangent", "m", "path that is timed: its tangent", 1),
    held("leg_extra", "s", "time of turns in place"),
    held("leg_factor", "1", "factor of the cost"),
    held("leg_after", "1", "1 where the path timed before is driven afterwards"),
    held("length", "m", "length of the path timed last", 1),
    held("speed", "m/s", "speed on the path timed last", 1),
    held("acceleration", "m/s2", "first acceleration on the path timed last", 1),
    held("time_of_leg", "s", "cost of the path timed last"),
    held("cost", "s", "cost of the manoeuvre timed last"),
    held("best_cost", "s", "least cost so far"),
    held("best_length", "m", "length of the path chosen so far", 1),
    held("best_speed", "m/s", "speed on the path chosen so far", 1),
    held("best_acceleration", "m/s2", "first acceleration on the path chosen so far", 1),
)


def _one(name: str) -> sp.Symbol:
    return symbol(name)


def supervisor() -> Block:
    """Supervisor of :func:`regulator`: everything but the outer loop.

    Returns
    -------
    Block
        Inputs the goal, the robot's state and ``v[1..2]``; outputs ``u[1..2]``, ``mode``, the chains ``Z1[k]``,
        ``Z2[k]`` and their reference ``Z1d[k]``, ``Z2d[k]``, ``zd3[i]``. The search takes its candidates one after
        the other in event iterations, so that the timing of a path stands once in the code.
    """
    mode, kind, awake = symbols("mode", "leg", "awake")
    x, y, theta, eta1, eta2 = (one.symbol for one in _STATE)
    v = symbols("v[1]", "v[2]")
    limits = Limits(*(one.symbol for one in LIMITS)).planned
    rate, observer = symbols("hold_rate", "observer_rate")
    tolerance, tube = symbols("tolerance", "tube")
    path_state, command = symbols("path_parameter", "u_command")
    xi = symbols("xi[1]", "xi[2]")
    here, goal = Pose(x, y, theta), Pose(*(one.symbol for one in GOAL))
    begin, time = symbols("begin", "duration")
    drive = Drive(begin, time, *symbols("cruise", "acceleration_limit"))
    leg = (Pose(*symbols("from_x", "from_y", "from_heading")), Pose(*symbols("to_x", "to_y", "to_heading")))
    direction = _one("direction")
    reference = Reference.along(leg[0].path_to(leg[1], _one("tangent")), drive, direction)
    on_path = {PARAMETER: path_state}

    gap = goal.position - here.position
    across = sp.Matrix([sp.cos(goal.heading), sp.sin(goal.heading)])
    planned = Pose(*symbols("planned_goal[1]", "planned_goal[2]", "planned_heading"))
    ahead = (reference.position - here.position).xreplace(on_path)
    facing = reference.direction.xreplace(on_path)
    heading_cos, heading_sin = facing.dot(forward(theta)), facing[0] * forward(theta)[1] - facing[1] * forward(theta)[0]
    moved = goal.position - planned.position
    relations = {
        "beside": gap.dot(across) ** 2 - tolerance**2,
        "beyond": gap.dot(forward(goal.heading)) ** 2 - NEAR_ALONG**2,
        "askew": sp.cos(ALIGNED) - sp.cos(theta - goal.heading),
        "still": STILL**2 - eta1**2 - eta2**2,
        "disturbed": eta1**2 + eta2**2 - DISTURBED**2,
        "before": begin + time - TIME,
        "off": ahead.dot(ahead) - tube**2,
        "turned_away": sp.cos(LOST_HEADING) - heading_cos,
        "goal_moved": moved.dot(moved) - tolerance**2,
        "goal_turned": sp.cos(ALIGNED) - sp.cos(goal.heading - planned.heading),
        "cheaper": _one("best_cost") - _one("cost"),
    }
    named = {key: Relation(key, sp.sympify(value)) for key, value in relations.items()}
    is_ = {key: one.symbol for key, one in named.items()}
    away = sp.Or(is_["beside"], is_["beyond"])

    # what the robot is asked to do, u before the observer
    chains = robot_linearization()
    new = dict(zip(chains.outer_inputs, v, strict=True)) | {_one("u[1]"): command}
    jerk = chains.law[_jerk(chains)].xreplace(new)
    guard = Guard(eta1, _ETA_MIN, "eta[1]")
    yaw_law = sp.simplify(chains.law[_one("u[2]")].xreplace(new) * eta1)
    heading_error = sp.atan2(heading_sin, heading_cos)
    yaw_rate, yaw_acceleration = (one.xreplace(on_path) for one in (reference.yaw_rate, reference.yaw_acceleration))
    heading_law = yaw_acceleration + 2 * rate * (yaw_rate - eta2) - rate**2 * heading_error
    follow = (command, guard.reciprocal * yaw_law + (1 - eta1 * guard.reciprocal) * heading_law)
    part = (TIME - begin) / time
    swing = leg[0].heading + _one("turn") * turned(part)
    held_at = leg[0].position
    turn = (
        -2 * rate * eta1 - rate**2 * forward(theta).dot(here.position - held_at),
        swing.diff(TIME, 2) + 2 * rate * (swing.diff(TIME) - eta2) + rate**2 * wrapped(swing - theta),
    )
    rest = (
        -2 * rate * eta1 + rate**2 * sp.Piecewise((0, away), (forward(theta).dot(gap), True)),
        -2 * rate * eta2
        + rate**2 * sp.Piecewise((0, sp.Or(away, is_["askew"])), (wrapped(goal.heading - theta), True)),
    )
    fading = 1 - rise(part)
    brake = tuple(
        start * fading.diff(TIME) + 2 * rate * (start * fading - now)
        for start, now in zip(symbols("eta_brake[1]", "eta_brake[2]"), (eta1, eta2), strict=True)
    )
    is_moving, is_braking, is_turning = sp.Eq(mode, MOVING), sp.Eq(mode, BRAKING), sp.Eq(kind, TURN)
    wanted = [
        sp.Piecewise((turn[i], sp.And(is_moving, is_turning)), (follow[i], is_moving), (brake[i], is_braking), (rest[i], True))
        for i in (0, 1)
    ]
    following = sp.And(is_moving, sp.Eq(kind, PATH))
    disturbance = [observer * (now - model) for now, model in zip((eta1, eta2), xi, strict=True)]
    zd = [reference.position, *reference.derivatives]
    zd = [one.xreplace(on_path) for one in zd]
    z = [[one.xreplace({_one("u[1]"): command}) for one in chain] for chain in chains.chains]
    return Block(
        "supervisor",
        "planner, modes, reference and inner loop of the regulator",
        inputs=(*GOAL, *_STATE, *(Input(f"v[{i}]", "m/s3", f"input of chain {i}") for i in (1, 2))),
        parameters=(*LIMITS, *_OTHERS, _ETA_MIN),
        states=(
            State("path_parameter", "1", "path parameter of the reference",
                  sp.Piecewise((reference.parameter_rate.xreplace(on_path), following), (0, True))),
            State("u_command", "m/s2", "compensator: commanded forward acceleration",
                  sp.Piecewise((jerk, following), (0, True))),
            State("xi[1]", "m/s", "forward velocity without disturbance", wanted[0]),
            State("xi[2]", "rad/s", "yaw rate without disturbance", wanted[1]),
        ),
        samples=(*_PLAN, *_SEARCH),
        modes=(
            Mode("mode", "1", "0 at rest, 1 moving, 2 braking"),
            Mode("leg", "1", "0 a turn in place, 1 a path"),
            Mode("search", "1", "step of the search for a plan, 0 if there is none"),
            Mode("choice", "1", "manoeuvre chosen so far"),
            Mode("awake", "1", "1 after the first instant"),
        ),
        outputs=(
            *(Output(f"u[{i}]", unit, f"{what} acceleration", wanted[i - 1] - disturbance[i - 1])
              for i, unit, what in ((1, "m/s2", "forward"), (2, "rad/s2", "yaw"))),
            Output("mode", "1", "0 at rest, 1 moving, 2 braking", mode),
            *(Output(f"Z{i}[{k}]", ROBOT_CHAINS.unit(i, k - 1), f"chain {i}, element {k}", one)
              for i, chain in enumerate(z, 1) for k, one in enumerate(chain, 1)),
            *(Output(f"Z{i}d[{k}]", ROBOT_CHAINS.unit(i, k - 1), f"reference of chain {i}, element {k}", zd[k - 1][i - 1])
              for i in (1, 2) for k in (1, 2, 3)),
            *(Output(f"zd3[{i}]", ROBOT_CHAINS.unit(i, 3), f"third derivative of the reference of chain {i}", zd[3][i - 1])
              for i in (1, 2)),
        ),
        relations=(*named.values(), *drive.relations, *guard.relations),
        transitions=(
            Transition("wake", sp.Eq(awake, 0), {awake: sp.S.One, xi[0]: eta1, xi[1]: eta2}),
            *_changes(is_, away, here, goal, limits),
            *_search(candidates(here, goal, limits), here, goal, limits, is_["cheaper"]),
        ),
        checks=_checks(),
    )  # fmt: skip


def _jerk(chains: object) -> sp.Symbol:
    """Input that the dynamic extension added."""
    (jerk,) = set(chains.law) - {_one("u[2]")}  # type: ignore[attr-defined]
    return jerk


def _at(goal: Pose) -> dict[sp.Symbol, sp.Expr]:
    planned = symbols("planned_goal[1]", "planned_goal[2]", "planned_heading")
    return dict(zip(planned, (goal.x, goal.y, goal.heading), strict=True))


def _from(here: Pose) -> dict[sp.Symbol, sp.Expr]:
    return dict(zip(symbols("from_x", "from_y", "from_heading"), (here.x, here.y, here.heading), strict=True))


def _turning(here: Pose, goal: Pose, angle: sp.Expr, limits: Limits) -> dict[sp.Symbol, sp.Expr]:
    """Assignments that begin a turn in place."""
    time = turning_time(sp.sqrt(angle**2), limits.yaw_acceleration)
    mode, kind, turn, begin, length, search = symbols("mode", "leg", "turn", "begin", "duration", "search")
    values = {mode: sp.Integer(MOVING), kind: sp.Integer(TURN), turn: angle, begin: TIME, length: time, search: sp.S.Zero}
    return values | _from(here) | _at(goal)


def _driving(here: Pose, goal: Pose, one: Candidate) -> dict[sp.Symbol, sp.Expr]:
    """Assignments that begin to drive the first path of a manoeuvre, timed as the best so far."""
    length, speed, acceleration = symbols("best_length", "best_speed", "best_acceleration")
    end = one.leg.end
    return {
        **dict(zip(symbols("mode", "leg", "search"), map(sp.Integer, (MOVING, PATH, 0)), strict=True)),
        **dict(zip(symbols("to_x", "to_y", "to_heading"), (end.x, end.y, end.heading), strict=True)),
        _one("tangent"): one.leg.tangent,
        _one("direction"): sp.Integer(one.leg.direction),
        _one("begin"): TIME,
        _one("duration"): duration(length, speed, acceleration),
        _one("cruise"): speed,
        _one("acceleration_limit"): acceleration,
        _one("path_parameter"): sp.S.Zero,
        _one("u_command"): one.leg.direction * acceleration,
    } | _from(here) | _at(goal)  # fmt: skip


def _changes(is_: dict[str, sp.Symbol], away: sp.Basic, here: Pose, goal: Pose, limits: Limits) -> tuple[Transition, ...]:
    """Transitions between the modes."""
    mode, kind, search = symbols("mode", "leg", "search")
    eta1, eta2 = symbols("eta[1]", "eta[2]")
    resting = sp.And(sp.Eq(mode, REST), sp.Eq(search, 0))
    over = sp.Not(is_["before"])
    lost = sp.And(sp.Eq(kind, PATH), sp.Or(is_["off"], is_["turned_away"]))
    braking_time = rise_slope(eta1, eta2, limits) + LEAST_BRAKING
    brake = {mode: sp.Integer(BRAKING), _one("begin"): TIME, _one("duration"): braking_time,
             _one("eta_brake[1]"): eta1, _one("eta_brake[2]"): eta2, _one("u_command"): sp.S.Zero}  # fmt: skip
    moving = sp.Eq(mode, MOVING)
    stop = {mode: sp.Integer(REST), _one("u_command"): sp.S.Zero}
    return (
        Transition("plan", sp.And(resting, is_["still"], away),
                   {search: sp.S.One, _one("choice"): sp.S.Zero, _one("best_cost"): sp.Float(UNDECIDED)}),
        Transition("align", sp.And(resting, is_["still"], sp.Not(away), is_["askew"]),
                   _turning(here, goal, wrapped(goal.heading - here.heading), limits)),
        Transition("catch", sp.And(resting, is_["disturbed"]), brake),
        Transition("arrive", sp.And(moving, over, sp.Not(is_["disturbed"])), stop),
        Transition("overrun", sp.And(moving, over, is_["disturbed"]), brake),
        Transition("give_up", sp.And(moving, sp.Not(over), sp.Or(lost, is_["goal_moved"], is_["goal_turned"])), brake),
        Transition("stop", sp.And(sp.Eq(mode, BRAKING), over), stop),
    )  # fmt: skip


def rise_slope(eta1: sp.Expr, eta2: sp.Expr, limits: Limits) -> sp.Expr:
    """Time in which both velocities can be braked, s: their decays begin with 3/2 of the mean slope."""
    return sp.Rational(3, 2) * sp.sqrt((eta1 / limits.acceleration) ** 2 + (eta2 / limits.yaw_acceleration) ** 2)


def _search(
    choices: tuple[Candidate, ...], here: Pose, goal: Pose, limits: Limits, cheaper: sp.Symbol
) -> tuple[Transition, ...]:
    """Search for the cheapest manoeuvre: set a path, time it, compare; then begin its first leg."""
    search, choice = symbols("search", "choice")
    data = symbols("leg_along", "leg_left", "leg_turn", "leg_tangent")
    extra, factor, after, last = symbols("leg_extra", "leg_factor", "leg_after", "time_of_leg")
    timing = path_timing(*data, limits)
    measured = symbols("length", "speed", "acceleration")
    legs = [(number, leg) for number, one in enumerate(choices, 1) for leg in (one.after, one.leg) if leg is not None]
    complete = {step: number for step, (number, leg) in enumerate(legs, 1) if leg is choices[number - 1].leg}
    setting = []
    for step, (number, leg) in enumerate(legs, 1):
        one = choices[number - 1]
        setting.append(
            Transition(f"set_{step}", sp.Eq(search, step), {
                **dict(zip(data, leg.relative, strict=True)),
                extra: one.extra, factor: sp.Float(one.factor), after: sp.Integer(step in complete and one.after is not None),
            })
        )  # fmt: skip
    end = len(legs) + 2
    best = dict(zip(symbols("best_length", "best_speed", "best_acceleration"), measured, strict=True))
    comparing = [
        Transition(f"better_{number}", sp.And(sp.Eq(search, step + 2), cheaper),
                   {choice: sp.Integer(number), _one("best_cost"): _one("cost"), **best})
        for step, number in complete.items()
    ]  # fmt: skip
    timed = sp.And(sp.Ne(search, 0), sp.Ne(search, 1), *(sp.Ne(search, end + k) for k in (0, 1)))
    begin = []
    for number, one in enumerate(choices, 1):
        chosen = sp.And(sp.Eq(search, end + 1), sp.Eq(choice, number))
        if one.turn is not None:
            small = sp.cos(one.turn) - sp.cos(ALIGNED)
            begin.append(Transition(f"turn_{number}", sp.And(chosen, sp.Not(small > 0)),
                                    _turning(here, goal, one.turn, limits)))  # fmt: skip
            chosen = sp.And(chosen, small > 0)
        begin.append(Transition(f"drive_{number}", chosen, _driving(here, goal, one)))
    return (
        *begin,
        *setting,
        Transition("time", timed, {
            **dict(zip((*measured, last), (timing.length, timing.speed, timing.acceleration, timing.cost), strict=True)),
            _one("cost"): factor * (timing.cost + extra + after * last),
        }),
        *comparing,
        Transition("next", sp.And(sp.Ne(search, 0), sp.Ne(search, end + 1)), {search: search + 1}),
    )  # fmt: skip


def _checks() -> tuple[Check, ...]:
    return tuple(
        Check(
            "limit",
            one.symbol > 0,
            f"{one.name} must be positive: a robot that may not {what} cannot be brought to the goal; raise it",
        )
        for one, what in zip(LIMITS, ("move", "accelerate", "turn"), strict=True)
    )


__all__ = ["GOAL", "LIMITS", "Sample", "supervisor"]
