"""The modes of the supervisor: the conditions it watches and what it does where they hold."""

from __future__ import annotations

import sympy as sp

from brunovsky.blocks.library.heading import direction, turned
from brunovsky.blocks.library.rest_to_rest.follow import Target
from brunovsky.blocks.library.rest_to_rest.motion import BRAKED, COMMAND, DRIVE, SPEEDS, Following, braking_time
from brunovsky.blocks.library.rest_to_rest.path import Pose, wrapped
from brunovsky.blocks.library.rest_to_rest.plan import BRAKING, MOVING, PLANNED_GOAL, REST, TURN, turn_in_place
from brunovsky.blocks.library.rest_to_rest.search import begin_search
from brunovsky.blocks.library.rest_to_rest.timing import Limits
from brunovsky.blocks.variables import TIME, Parameter, Relation, Transition, symbol, symbols

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

TOLERANCE = Parameter("tolerance", "m", "distance to the side at which the goal counts as reached",
                      0.002, 1e-9, tunable=True)  # fmt: skip
TUBE = Parameter("tube", "m", "distance from its reference at which the robot brakes and plans anew",
                 0.2, 1e-6, tunable=True)  # fmt: skip


def watched(here: Pose, goal: Pose, path: Following) -> dict[str, Relation]:
    """Conditions of the transitions, by name."""
    gap, moved = goal.position - here.position, goal.position - PLANNED_GOAL.position
    off = path.reference.position - here.position
    speed2 = SPEEDS[0] ** 2 + SPEEDS[1] ** 2
    aligned = sp.cos(ALIGNED)
    conditions = {
        "beside": gap.dot(turned(direction(goal.heading))) ** 2 - TOLERANCE.symbol**2,
        "beyond": gap.dot(direction(goal.heading)) ** 2 - NEAR_ALONG**2,
        "askew": aligned - sp.cos(here.heading - goal.heading),
        "still": STILL**2 - speed2,
        "disturbed": speed2 - DISTURBED**2,
        "before": DRIVE.begin + DRIVE.duration - TIME,
        "off": off.dot(off) - TUBE.symbol**2,
        "turned_away": sp.cos(LOST_HEADING) - path.heading_cosine,
        "goal_moved": moved.dot(moved) - TOLERANCE.symbol**2,
        "goal_turned": aligned - sp.cos(goal.heading - PLANNED_GOAL.heading),
    }
    return {name: Relation(name, expression) for name, expression in conditions.items()}


def changes(
    here: Pose,
    goal: Pose,
    limits: Limits,
    watch: dict[str, Relation],
    target: Target,
) -> tuple[Transition, ...]:
    """Transitions between rest, moving and braking; the first declared has precedence."""
    is_ = {name: one.symbol for name, one in watch.items()}
    mode, leg, search = symbols("mode", "leg", "search")
    idle = sp.And(sp.Eq(mode, REST), sp.Eq(search, 0), target.ready)
    moving, over = sp.Eq(mode, MOVING), sp.Not(is_["before"])
    away = sp.Or(is_["beside"], is_["beyond"])
    lost = sp.And(sp.Ne(leg, TURN), sp.Or(is_["off"], is_["turned_away"]))
    brake = {
        mode: sp.Integer(BRAKING),
        symbol("begin"): TIME,
        symbol("duration"): braking_time(limits) + LEAST_BRAKING,
        COMMAND: sp.S.Zero,
        **dict(zip(BRAKED, SPEEDS, strict=True)),
    }
    stop = {mode: sp.Integer(REST), COMMAND: sp.S.Zero}
    align = turn_in_place(here, goal, wrapped(goal.heading - here.heading), limits)
    course = target.course
    close = sp.And(target.ready, is_["still"], sp.Not(away), sp.Not(is_["askew"]))
    return (
        *(course.transitions(limits, close, sp.And(sp.Not(over), lost), over) if course else ()),
        Transition("plan", sp.And(idle, is_["still"], away), begin_search()),
        Transition("align", sp.And(idle, is_["still"], sp.Not(away), is_["askew"]), align),
        Transition("catch", sp.And(idle, is_["disturbed"]), brake),
        Transition("arrive", sp.And(moving, over, sp.Not(is_["disturbed"])), stop),
        Transition("overrun", sp.And(moving, over, is_["disturbed"]), brake),
        Transition("give_up", sp.And(moving, sp.Not(over), sp.Or(lost, is_["goal_moved"], is_["goal_turned"])), brake),
        Transition("stop", sp.And(sp.Eq(mode, BRAKING), over), stop),
    )
