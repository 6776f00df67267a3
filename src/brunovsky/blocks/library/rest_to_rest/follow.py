"""The leg on which a reference is tracked: its clock, how fast it may run, and how the leg is entered and left.

The clock of the reference stands while the robot is elsewhere and runs on this leg, with the rate by which every leg is
driven: from rest, up to its cruise, and to rest again where the reference ends. Before, the reference is examined for
its peaks, a few points of it at an instant, while the robot drives to its begin.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import sympy as sp

from brunovsky.blocks.library.rest_to_rest.course import CLOCK, EDGE, NEVER, WANTED
from brunovsky.blocks.library.rest_to_rest.motion import COMMAND, DRIVE
from brunovsky.blocks.library.rest_to_rest.path import Pose
from brunovsky.blocks.library.rest_to_rest.plan import COURSE, MOVING, PLANNED_GOAL, REST, assigned
from brunovsky.blocks.library.rest_to_rest.reference import Reference
from brunovsky.blocks.library.rest_to_rest.timing import Limits, Timing, duration
from brunovsky.blocks.variables import (
    TIME,
    Input,
    Mode,
    Output,
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
    held("peak_acceleration2", "m2/s4", "square of its largest acceleration along its path"),
    held("peak_yaw_rate2", "rad2/s2", "square of its largest yaw rate"),
    held("peak_yaw_acceleration2", "rad2/s4", "square of its largest yaw acceleration"),
)
_SPEED, _ACCELERATION2, _YAW_RATE2, _YAW_ACCELERATION2 = (one.symbol for one in PEAKS)
_SURVEY, _BATCH, _RESUME, _LEG, _MODE = symbols("survey", "batch", "resume", "leg", "mode")
_SPAN = COURSE_INPUTS[-1].symbol
_TO_COME = Relation("to_come", _SPAN - CLOCK.symbol - EDGE)
_RESUMED = Relation("resumed", TIME - _RESUME)
_ENDLESS = Relation("endless", _SPAN - NEVER / 2)
_FOLLOWING = sp.And(sp.Eq(_MODE, MOVING), sp.Eq(_LEG, COURSE))
GOAL_SAMPLES = (
    held("goal[1]", "m", "pose of the reference where the robot goes: x"),
    held("goal[2]", "m", "pose of the reference where the robot goes: y"),
    held("goal_heading", "rad", "pose of the reference where the robot goes: heading"),
)
GOAL_POSE = Pose(*(one.symbol for one in GOAL_SAMPLES))


@dataclass(frozen=True)
class Course:
    """A reference as the supervisor sees it: position (m) and its derivatives 1 to 3 by its own time, (2, 1) each."""

    path: tuple[sp.Matrix, ...]

    @classmethod
    def given(cls) -> Course:
        """The reference that the inputs give."""
        inputs = {one.name.removeprefix("course."): one.symbol for one in COURSE_INPUTS}
        names = ("Z{}d[1]", "Z{}d[2]", "Z{}d[3]", "zd3[{}]")
        return cls(tuple(sp.Matrix([inputs[name.format(i)] for i in (1, 2)]) for name in names))

    @property
    def reference(self) -> Reference:
        """What the chains follow while the clock runs as the leg is driven."""
        return Reference.driven(self.path, DRIVE, sp.S.One, _SPEED)

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
        return self.speed, along**2 / speed2, (cross / speed2) ** 2, yaw_acceleration**2

    def transitions(
        self,
        limits: Limits,
        close: sp.logic.boolalg.Boolean,
        lost: sp.logic.boolalg.Boolean,
        over: sp.logic.boolalg.Boolean,
    ) -> tuple[Transition, ...]:
        """Begin of the leg where the robot rests ``close`` to the goal, its ends, ``lost`` or ``over``, and the survey.

        Where the leg ends the reference's pose becomes the goal: of the plan back to it, or of the rest it came to.
        """
        idle = sp.And(sp.Eq(_MODE, REST), sp.Eq(symbol("search"), 0), sp.Eq(_SURVEY, 0))
        timing = course_timing(sp.sqrt((_SPAN - CLOCK.symbol) ** 2 + EDGE**2), limits)
        begin = {
            _MODE: sp.Integer(MOVING),
            _LEG: sp.Integer(COURSE),
            DRIVE.begin: TIME,
            DRIVE.duration: timing.cost,
            DRIVE.speed: timing.speed,
            DRIVE.acceleration: timing.acceleration,
            COMMAND: timing.acceleration * self.speed / _SPEED,
        }
        here = assigned(GOAL_POSE, self.pose)
        return (
            Transition("follow", sp.And(idle, close, _TO_COME.symbol), begin | assigned(PLANNED_GOAL, GOAL_POSE)),
            Transition("finish", sp.And(_FOLLOWING, over), {CLOCK.symbol: _SPAN, **here}),
            Transition("leave", sp.And(_FOLLOWING, lost), here),
            *self._survey(),
        )

    def _survey(self) -> tuple[Transition, ...]:
        """Examination of the reference, a batch of its points at an instant."""
        step = sp.Piecewise((HORIZON.symbol, _ENDLESS.symbol), (_SPAN, True)) / POINTS
        largest = {one.symbol: sp.Max(one.symbol, new) for one, new in zip(PEAKS, self.peaks, strict=True)}
        last = POINTS + 2
        examining = sp.And(sp.Ne(_SURVEY, 0), sp.Ne(_SURVEY, last), sp.Ne(_BATCH, BATCH))
        on = {CLOCK.symbol: CLOCK.symbol + step, _SURVEY: _SURVEY + 1, _BATCH: _BATCH + 1}
        next_batch = {_BATCH: sp.S.Zero, _RESUME: TIME + PAUSE}
        return (
            Transition("examine", examining, largest | on),
            Transition("examine_on", sp.And(sp.Eq(_BATCH, BATCH), _RESUMED.symbol), next_batch),
            Transition("examined", sp.Eq(_SURVEY, last), {_SURVEY: sp.S.Zero, CLOCK.symbol: sp.S.Zero}),
        )


@dataclass(frozen=True)
class Target:
    """Where a supervisor brings the robot: parts of its block, by group, that only such a target needs.

    ``wake`` are assignments of the first instant, before which the goal is not known unless ``ready``; ``course`` is
    the reference that is tracked from there, if there is one.
    """

    inputs: tuple[Input, ...]
    parameters: tuple[Parameter, ...] = ()
    states: tuple[State, ...] = ()
    samples: tuple[Sample, ...] = ()
    modes: tuple[Mode, ...] = ()
    outputs: tuple[Output, ...] = ()
    relations: tuple[Relation, ...] = ()
    wake: Mapping[sp.Symbol, sp.Expr] = field(default_factory=dict)
    ready: sp.logic.boolalg.Boolean = sp.true
    course: Course | None = None


def reference_target() -> Target:
    """The pose at which a reference stands, from where it is tracked."""
    course = Course.given()

    def standing(before: sp.Expr, now: sp.Expr) -> sp.Expr:
        return sp.Piecewise((before, sp.Ne(_SURVEY, 0)), (now, True))

    pace = sp.Piecewise((DRIVE.speed / _SPEED, _FOLLOWING), (0, True))
    return Target(
        COURSE_INPUTS,
        parameters=(HORIZON,),
        states=(
            State(**described(CLOCK),
                  derivative=sp.Piecewise((course.reference.parameter_rate, _FOLLOWING), (0, True))),
        ),
        samples=(*GOAL_SAMPLES, *PEAKS, held("resume", "s", "when the reference is examined further")),
        modes=(
            Mode("survey", "1", "number of the next point of the reference to be examined, 0 if there is none", 1),
            Mode("batch", "1", "points examined at this instant"),
        ),
        outputs=(
            Output(**described(CLOCK), expression=CLOCK.symbol),
            Output("elapsed", "s", "time of the reference that has been tracked", standing(sp.S.Zero, CLOCK.symbol)),
            Output("pace", "1", "rate at which the reference is tracked, 1 its own; 0 while it waits", pace),
            *(Output(f"reference[{i}]", "m", f"where the reference stands, {axis}", standing(before, now))
              for i, (axis, before, now) in enumerate(zip("xy", GOAL_POSE.position, course.path[0], strict=True), 1)),
        ),
        relations=(_TO_COME, _RESUMED, _ENDLESS),
        wake={_RESUME: TIME + PAUSE, **assigned(GOAL_POSE, course.pose)},
        ready=sp.Eq(symbol("awake"), 1),
        course=course,
    )  # fmt: skip


def course_timing(time: sp.Expr, limits: Limits) -> Timing:
    """How fast the clock of a reference runs for what is left of it, ``time`` (s).

    The speed of the drive is that of the reference where it is fastest, so that the rate of the clock is the drive's
    speed over ``peak_speed``: 1 where the limits let it, else less.
    """
    length = _SPEED * time
    yaw_rate = sp.sqrt(_YAW_RATE2)
    steepness = sp.Max(1 / limits.acceleration, yaw_rate / (_SPEED * limits.yaw_acceleration)) / RISE_SHARE
    squares: Sequence[sp.Expr] = (
        _SPEED**-2,
        limits.speed**-2,
        sp.sqrt(_ACCELERATION2) / (CRUISE_SHARE * limits.acceleration * _SPEED**2),
        sp.sqrt(_YAW_ACCELERATION2) / (CRUISE_SHARE * limits.yaw_acceleration * _SPEED**2),
        sp.Rational(15, 8) * steepness / length,
    )
    speed, acceleration = 1 / sp.sqrt(sp.Max(*squares)), 1 / steepness
    return Timing(length, speed, acceleration, duration(length, speed, acceleration))


def _cross(first: sp.Matrix, second: sp.Matrix) -> sp.Expr:
    return first[0] * second[1] - first[1] * second[0]
