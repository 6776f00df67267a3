"""The leg on which a reference is tracked: its clock, how fast it may run, and how the leg is entered and left.

The clock of the reference stands while the robot is elsewhere and runs on this leg, with the rate by which every leg is
driven: from rest, up to its cruise, and to rest again where the reference ends. Before, the reference is examined for
its peaks, a few points of it at an instant, while the robot drives to its begin.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from brunovsky.blocks.library.rest_to_rest.course import EDGE, ELAPSED, NEVER, WANTED
from brunovsky.blocks.library.rest_to_rest.motion import COMMAND, DRIVE
from brunovsky.blocks.library.rest_to_rest.path import Pose
from brunovsky.blocks.library.rest_to_rest.plan import COURSE, MOVING, PLANNED_GOAL, REST, assigned
from brunovsky.blocks.library.rest_to_rest.reference import Reference
from brunovsky.blocks.library.rest_to_rest.timing import Limits, Timing, duration
from brunovsky.blocks.variables import (
    TIME,
    Input,
    Mode,
    Parameter,
    Relation,
    Sample,
    State,
    Transition,
    described,
    held,
    symbol,
    symbols,
)

POINTS = 300
"""Intervals of a reference at whose ends it is examined."""
BATCH = 12
"""Points examined at one instant; events are iterated at most twenty times."""
PAUSE = 5e-4
"""Time from one batch to the next, s: less than a step."""
CRUISE_SHARE, RISE_SHARE = 0.9, 0.5
"""Parts of the accelerations for the reference at its cruising rate and for the first acceleration of its clock; the
two peaks are apart: no part of a rise needs more than 0.9 rise^2 + 0.5 (1 - s^2) < 1."""

COURSE_INPUTS = (
    *(Input(f"course.{one.name}", one.unit, one.description) for one in WANTED),
    Input("course.span", "s", "time from the begin of the reference to its rest", 1.0),
)
HORIZON = Parameter("horizon", "s", "time for which a reference without end is examined for the limits", 60.0, 1.0)
PEAKS = (
    held("peak_speed", "m/s", "largest speed of the reference at its own rate", EDGE),
    held("peak_acceleration", "m/s2", "largest acceleration of the reference along its path"),
    held("peak_yaw_rate", "rad/s", "largest yaw rate of the reference"),
    held("peak_yaw_acceleration", "rad/s2", "largest yaw acceleration of the reference"),
)
_SPEED, _ACCELERATION, _YAW_RATE, _YAW_ACCELERATION = (one.symbol for one in PEAKS)
_SURVEY, _BATCH, _RESUME, _LEG, _MODE = symbols("survey", "batch", "resume", "leg", "mode")


@dataclass(frozen=True)
class Follow:
    """What a supervisor has more where it tracks a reference: parts of its block, by group, and the goal.

    ``ready`` is when the goal, which is the pose of the reference, is known.
    """

    reference: Reference
    relations: tuple[Relation, ...]
    path: tuple[sp.Matrix, ...]

    @classmethod
    def course(cls) -> Follow:
        """Tracking of the reference that the inputs give."""
        given = {one.name.removeprefix("course."): one.symbol for one in COURSE_INPUTS}
        names = ("Z{}d[1]", "Z{}d[2]", "Z{}d[3]", "zd3[{}]")
        path = tuple(sp.Matrix([given[name.format(i)] for i in (1, 2)]) for name in names)
        return cls(
            Reference.driven(path, DRIVE, sp.S.One, _SPEED),
            (
                Relation("to_come", _span() - ELAPSED.symbol - EDGE),
                Relation("resumed", TIME - _RESUME),
                Relation("endless", _span() - NEVER / 2),
            ),
            path,
        )

    @property
    def pose(self) -> Pose:
        """Where the reference stands, and its heading."""
        (x, y), (along_x, along_y) = self.path[0], self.path[1]
        return Pose(x, y, sp.atan2(-along_x, along_y))

    @property
    def speed(self) -> sp.Expr:
        """Speed of the reference at its own rate, m/s."""
        return sp.sqrt(self.path[1].dot(self.path[1]))

    @property
    def peaks(self) -> tuple[sp.Expr, ...]:
        """What :data:`PEAKS` are the largest of, where the reference stands."""
        _, first, second, third = self.path
        speed2, along, cross = first.dot(first), first.dot(second), _cross(first, second)
        yaw_acceleration = _cross(first, third) / speed2 - 2 * cross * along / speed2**2
        squares = (speed2, along**2 / speed2, (cross / speed2) ** 2, yaw_acceleration**2)
        return tuple(sp.sqrt(one) for one in squares)

    def states(self) -> tuple[State, ...]:
        """The clock of the reference."""
        running = sp.And(sp.Eq(_MODE, MOVING), sp.Eq(_LEG, COURSE))
        rate = sp.Piecewise((self.reference.parameter_rate, running), (0, True))
        return (State(**described(ELAPSED), derivative=rate),)

    def transitions(self, limits: Limits, close: sp.logic.boolalg.Boolean, lost: sp.logic.boolalg.Boolean,
                    over: sp.logic.boolalg.Boolean) -> tuple[Transition, ...]:  # fmt: skip
        """Begin and end of the leg: ``close`` is where it may begin, ``lost`` and ``over`` are where it ends."""
        to_come = self.relations[0].symbol
        following = sp.And(sp.Eq(_MODE, MOVING), sp.Eq(_LEG, COURSE))
        idle = sp.And(sp.Eq(_MODE, REST), sp.Eq(symbol("search"), 0), sp.Eq(_SURVEY, 0))
        timing = course_timing(sp.sqrt((_span() - ELAPSED.symbol) ** 2 + EDGE**2), limits)
        begin = {
            _MODE: sp.Integer(MOVING),
            _LEG: sp.Integer(COURSE),
            DRIVE.begin: TIME,
            DRIVE.duration: timing.cost,
            DRIVE.speed: timing.speed,
            DRIVE.acceleration: timing.acceleration,
            COMMAND: timing.acceleration * self.speed / _SPEED,
            **assigned(PLANNED_GOAL, GOAL_POSE),
        }
        return (
            Transition("follow", sp.And(idle, close, to_come), begin),
            Transition("finish", sp.And(following, over), {ELAPSED.symbol: _span(), **assigned(GOAL_POSE, self.pose)}),
            Transition("leave", sp.And(following, lost), assigned(GOAL_POSE, self.pose)),
            *self._survey(),
        )

    def _survey(self) -> tuple[Transition, ...]:
        """Examination of the reference: some of its points at an instant."""
        _, resumed, endless = (one.symbol for one in self.relations)
        step = sp.Piecewise((HORIZON.symbol, endless), (_span(), True)) / POINTS
        largest = {one.symbol: sp.Max(one.symbol, new) for one, new in zip(PEAKS, self.peaks, strict=True)}
        last = POINTS + 2
        examining = sp.And(sp.Ne(_SURVEY, 0), sp.Ne(_SURVEY, last), sp.Ne(_BATCH, BATCH))
        return (
            Transition("examine", examining, {**largest, ELAPSED.symbol: ELAPSED.symbol + step, _SURVEY: _SURVEY + 1,
                                              _BATCH: _BATCH + 1}),
            Transition("examine_on", sp.And(sp.Eq(_BATCH, BATCH), resumed), {_BATCH: sp.S.Zero, _RESUME: TIME + PAUSE}),
            Transition("examined", sp.Eq(_SURVEY, last), {_SURVEY: sp.S.Zero, ELAPSED.symbol: sp.S.Zero}),
        )  # fmt: skip


GOAL_SAMPLES = (
    held("goal[1]", "m", "pose of the reference where the robot goes: x"),
    held("goal[2]", "m", "pose of the reference where the robot goes: y"),
    held("goal_heading", "rad", "pose of the reference where the robot goes: heading"),
)
GOAL_POSE = Pose(*(one.symbol for one in GOAL_SAMPLES))
SAMPLES: tuple[Sample, ...] = (*GOAL_SAMPLES, *PEAKS, held("resume", "s", "when the reference is examined further"))
MODES = (
    Mode("survey", "1", "number of the next point of the reference to be examined, 0 if there is none", 1),
    Mode("batch", "1", "points examined at this instant"),
)


def woken(follow: Follow) -> dict[sp.Symbol, sp.Expr]:
    """Assignments of the first instant."""
    return {_RESUME: TIME + PAUSE, **assigned(GOAL_POSE, follow.pose)}


def course_timing(time: sp.Expr, limits: Limits) -> Timing:
    """How fast the clock of a reference runs for what is left of it, ``time`` (s).

    The speed of the drive is that of the reference where it is fastest, so that the rate of the clock is the drive's
    speed over ``peak_speed``: 1 where the limits let it, else less.
    """
    length = _SPEED * time
    steepness = sp.Max(1 / limits.acceleration, _YAW_RATE / (_SPEED * limits.yaw_acceleration)) / RISE_SHARE
    squares: Sequence[sp.Expr] = (
        _SPEED**-2,
        limits.speed**-2,
        _ACCELERATION / (CRUISE_SHARE * limits.acceleration * _SPEED**2),
        _YAW_ACCELERATION / (CRUISE_SHARE * limits.yaw_acceleration * _SPEED**2),
        sp.Rational(15, 8) * steepness / length,
    )
    speed, acceleration = 1 / sp.sqrt(sp.Max(*squares)), 1 / steepness
    return Timing(length, speed, acceleration, duration(length, speed, acceleration))


def _span() -> sp.Expr:
    return COURSE_INPUTS[-1].symbol


def _cross(first: sp.Matrix, second: sp.Matrix) -> sp.Expr:
    return first[0] * second[1] - first[1] * second[0]
