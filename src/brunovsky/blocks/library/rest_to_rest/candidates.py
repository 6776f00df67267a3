"""What the planner chooses from: paths, a reversal, a turn in place with a straight drive; each with its cost.

All manoeuvres begin where the robot rests now. Only the first leg of one is driven; the next is planned where it ends,
which costs no more than what is left of the first plan.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from brunovsky.blocks.library.heading import direction, turned
from brunovsky.blocks.library.rest_to_rest.path import Pose, wrapped
from brunovsky.blocks.library.rest_to_rest.timing import Limits, turning_time

TANGENTS = (0.7, 1.5)
"""Tangents of paths to the goal, in parts of its distance."""
TURN_LENGTH = 0.1
"""What a turn of 1 rad counts as distance where paths are scaled, m."""
CUSP = 0.3
"""How far a reversal lies from the middle of the two poses, in parts of their distance."""
REVERSAL_FACTOR = 1.25
"""A reversal must be shorter in time than a path without one by this factor."""
TURN_FACTOR = 2.0
"""A turn in place must be shorter than a path by this factor."""


@dataclass(frozen=True)
class Leg:
    """A path between two poses, forward (``sense`` 1) or backward (-1); ``tangent`` (m): its derivative at the ends."""

    start: Pose
    end: Pose
    sense: int
    tangent: sp.Expr

    @classmethod
    def between(cls, start: Pose, end: Pose, sense: int, stretch: float) -> Leg:
        """Leg whose tangents are scaled with the distance of the poses."""
        return cls(start, end, sense, sense * stretch * start.reach(end, sp.Float(TURN_LENGTH)))

    @property
    def relative(self) -> tuple[sp.Expr, sp.Expr, sp.Expr, sp.Expr]:
        """End as the start sees it, along and to the left (m), turn (rad), and tangent (m)."""
        gap = self.end.position - self.start.position
        turn = self.end.heading - self.start.heading
        return (
            gap.dot(direction(self.start.heading)),
            gap.dot(turned(direction(self.start.heading))),
            turn,
            self.tangent,
        )


@dataclass(frozen=True)
class Candidate:
    """A manoeuvre: the path it drives first, and what else it costs.

    ``turn`` is the angle turned in place before the path (rad), ``after`` a path driven afterwards, ``extra`` the time
    of turns (s), ``factor`` what the time is multiplied by when it is compared.
    """

    leg: Leg
    turn: sp.Expr | None = None
    after: Leg | None = None
    extra: sp.Expr = sp.S.Zero
    factor: float = 1.0


def candidates(start: Pose, goal: Pose, limits: Limits) -> tuple[Candidate, ...]:
    """Manoeuvres from rest to rest, both forward and backward.

    Parameters
    ----------
    start, goal : Pose
        Where the robot rests, and where it shall.
    limits : Limits
        What plans may use, for the time of turns in place.
    """
    both = (1, -1)
    direct = [Candidate(Leg.between(start, goal, one, stretch)) for one in both for stretch in TANGENTS]
    return (
        *direct,
        *(_reversal(start, goal, one) for one in both),
        *(_turn_and_drive(start, goal, one, limits) for one in both),
    )


def _reversal(start: Pose, goal: Pose, sense: int) -> Candidate:
    """Beyond the middle of the two poses, with the heading halfway between theirs, and back to the goal."""
    heading = start.heading + wrapped(goal.heading - start.heading) / 2
    middle = (start.position + goal.position) / 2
    x, y = middle + sense * CUSP * start.reach(goal, sp.Float(TURN_LENGTH)) * direction(heading)
    cusp = Pose(x, y, heading)
    after = Leg.between(cusp, goal, -sense, 1.0)
    return Candidate(Leg.between(start, cusp, sense, 1.0), after=after, factor=REVERSAL_FACTOR)


def _turn_and_drive(start: Pose, goal: Pose, sense: int, limits: Limits) -> Candidate:
    """A turn in place towards the goal, or away from it, a straight drive, and a turn in place to its heading."""
    gap = sense * (goal.position - start.position)
    bearing = sp.atan2(-gap[0], gap[1])
    turn, last = wrapped(bearing - start.heading), wrapped(goal.heading - bearing)
    time = sum(turning_time(sp.sqrt(one**2), limits.yaw_acceleration) for one in (turn, last))
    drive = Leg.between(Pose(start.x, start.y, bearing), Pose(goal.x, goal.y, bearing), sense, 1.0)
    return Candidate(drive, turn=turn, extra=time, factor=TURN_FACTOR)
