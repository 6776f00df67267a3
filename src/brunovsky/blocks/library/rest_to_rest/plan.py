"""The plan that a supervisor follows: what it holds, and what begins a turn in place or a path."""

from __future__ import annotations

import sympy as sp

from brunovsky.blocks.library.rest_to_rest.candidates import Candidate
from brunovsky.blocks.library.rest_to_rest.path import Pose
from brunovsky.blocks.library.rest_to_rest.timing import Limits, duration, turning_time
from brunovsky.blocks.variables import TIME, held, symbol, symbols

REST, MOVING, BRAKING = 0, 1, 2
"""Values of ``mode``."""
TURN, PATH, COURSE = 0, 1, 2
"""Values of ``leg``: a turn in place, a path, and a reference that is tracked."""

PLAN = (
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
FROM = Pose(*symbols("from_x", "from_y", "from_heading"))
"""Pose at which the leg began."""
TO = Pose(*symbols("to_x", "to_y", "to_heading"))
"""Pose at which the path of the leg ends."""
PLANNED_GOAL = Pose(*symbols("planned_goal[1]", "planned_goal[2]", "planned_heading"))
"""Goal for which the leg was planned."""


def assigned(pose: Pose, value: Pose) -> dict[sp.Symbol, sp.Expr]:
    """Assignments of one pose to another, whose elements are symbols."""
    return {pose.x: value.x, pose.y: value.y, pose.heading: value.heading}


def turn_in_place(here: Pose, goal: Pose, angle: sp.Expr, limits: Limits) -> dict[sp.Symbol, sp.Expr]:
    """Assignments that begin a turn in place."""
    time = turning_time(sp.sqrt(angle**2), limits.yaw_acceleration)
    mode, kind, turn, begin, length, search = symbols("mode", "leg", "turn", "begin", "duration", "search")
    values = {
        mode: sp.Integer(MOVING),
        kind: sp.Integer(TURN),
        turn: angle,
        begin: TIME,
        length: time,
        search: sp.S.Zero,
    }
    return values | assigned(FROM, here) | assigned(PLANNED_GOAL, goal)


def drive_path(here: Pose, goal: Pose, one: Candidate) -> dict[sp.Symbol, sp.Expr]:
    """Assignments that begin to drive the first path of a manoeuvre, timed as the best so far."""
    length, speed, acceleration = symbols("best_length", "best_speed", "best_acceleration")
    return {
        **dict(zip(symbols("mode", "leg", "search"), map(sp.Integer, (MOVING, PATH, 0)), strict=True)),
        symbol("tangent"): one.leg.tangent,
        symbol("direction"): sp.Integer(one.leg.sense),
        symbol("begin"): TIME,
        symbol("duration"): duration(length, speed, acceleration),
        symbol("cruise"): speed,
        symbol("acceleration_limit"): acceleration,
        symbol("path_parameter"): sp.S.Zero,
        symbol("u_command"): one.leg.sense * acceleration,
    } | assigned(FROM, here) | assigned(TO, one.leg.end) | assigned(PLANNED_GOAL, goal)  # fmt: skip
