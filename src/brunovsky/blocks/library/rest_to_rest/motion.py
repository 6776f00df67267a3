"""What the robot is asked to do in each mode: forward and yaw acceleration, before disturbances are taken out."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from brunovsky.blocks.guard import Guard
from brunovsky.blocks.library.heading import direction
from brunovsky.blocks.library.rest_to_rest.path import PARAMETER, Pose, wrapped
from brunovsky.blocks.library.rest_to_rest.plan import COURSE, FROM, TO
from brunovsky.blocks.library.rest_to_rest.reference import Drive, Reference
from brunovsky.blocks.library.rest_to_rest.timing import Limits, rise, swept
from brunovsky.blocks.library.robot import robot_linearization
from brunovsky.blocks.variables import TIME, Parameter, Relation, symbol, symbols

ETA_MIN = Parameter("eta_min", "m/s", "speed below which the linearising law fades into one for the heading",
                    0.1, 1e-6, tunable=True)  # fmt: skip
RATE = Parameter("hold_rate", "1/s", "rate at which heading and rest are held", 8.0, 0.0, tunable=True)
COMMAND = symbol("u_command")
"""State of the compensator: the forward acceleration that is asked for, m/s2."""
DRIVE = Drive(*symbols("begin", "duration", "cruise", "acceleration_limit"))
SPEEDS = symbols("eta[1]", "eta[2]")
BRAKED = symbols("eta_brake[1]", "eta_brake[2]")
Pair = tuple[sp.Expr, sp.Expr]


@dataclass(frozen=True)
class Following:
    """Path of the leg as the chains see it.

    ``reference`` (shape (2, 1) each) and its derivatives are taken at the path parameter; ``jerk`` is the compensator's
    input w1, m/s3; ``accelerations`` are u1 (m/s2) and u2 (rad/s2); ``heading_cosine`` is that of the heading error.
    """

    reference: Reference
    jerk: sp.Expr
    accelerations: Pair
    heading_cosine: sp.Expr


def following(theta: sp.Expr, course: Reference | None = None) -> Following:
    """Tracking of the leg's path by the linearising law, which fades near rest into a law for the heading.

    On the leg ``COURSE`` it tracks the reference ``course``, if there is one.

    The law of the linearisation is ``u2 = n/eta1``. Below ``eta_min`` ``u2 = n eta1/eta_min^2 + (1 - eta1^2/eta_min^2)
    u2_heading``: regular at rest, where ``u2_heading`` is the path's own, and continuous at ``eta_min``.
    """
    parameter = {PARAMETER: symbol("path_parameter")}
    one = Reference.along(FROM.path_to(TO, symbol("tangent")), DRIVE, symbol("direction")).at(parameter)
    if course:
        one = one.unless(sp.Eq(symbol("leg"), COURSE), course)
    chains = robot_linearization()
    (jerk,) = set(chains.law) - {symbol("u[2]")}
    new = dict(zip(chains.outer_inputs, symbols("v[1]", "v[2]"), strict=True)) | {symbol("u[1]"): COMMAND}
    eta1, eta2 = SPEEDS
    facing, heading = one.direction, direction(theta)
    cosine, sine = facing.dot(heading), facing[0] * heading[1] - facing[1] * heading[0]
    own = one.yaw_acceleration + 2 * RATE.symbol * (one.yaw_rate - eta2) - RATE.symbol**2 * sp.atan2(sine, cosine)
    inverse = guard().reciprocal
    yaw = inverse * sp.simplify(chains.law[symbol("u[2]")].xreplace(new) * eta1) + (1 - eta1 * inverse) * own
    return Following(one, chains.law[jerk].xreplace(new), (COMMAND, yaw), cosine)


def guard() -> Guard:
    """Guard of the law against its singularity at rest."""
    return Guard(SPEEDS[0], ETA_MIN, "eta[1]")


def turning(here: Pose) -> Pair:
    """A turn in place from where the leg began, with minimum jerk."""
    rate = RATE.symbol
    swing = FROM.heading + symbol("turn") * swept((TIME - DRIVE.begin) / DRIVE.duration)
    return (
        -2 * rate * SPEEDS[0] - rate**2 * direction(here.heading).dot(here.position - FROM.position),
        swing.diff(TIME, 2) + 2 * rate * (swing.diff(TIME) - SPEEDS[1]) + rate**2 * wrapped(swing - here.heading),
    )


def resting(here: Pose, goal: Pose, away: sp.Basic, askew: sp.Basic) -> Pair:
    """Rest, drawn to the goal along the heading unless ``away`` from it, and to its heading unless ``askew``."""
    rate = RATE.symbol
    ahead = direction(here.heading).dot(goal.position - here.position)
    aside = wrapped(goal.heading - here.heading)
    return (
        -2 * rate * SPEEDS[0] + rate**2 * sp.Piecewise((0, away), (ahead, True)),
        -2 * rate * SPEEDS[1] + rate**2 * sp.Piecewise((0, sp.Or(away, askew)), (aside, True)),
    )


def braking() -> Pair:
    """Both velocities to rest along the polynomial of minimum jerk that a rise is, mirrored."""
    fading = 1 - rise((TIME - DRIVE.begin) / DRIVE.duration)
    first, second = (
        start * fading.diff(TIME) + 2 * RATE.symbol * (start * fading - now)
        for start, now in zip(BRAKED, SPEEDS, strict=True)
    )
    return first, second


def braking_time(limits: Limits) -> sp.Expr:
    """Time in which both velocities can be braked, s: their decays begin with 3/2 of the mean slope."""
    return sp.Rational(3, 2) * sp.sqrt(
        (SPEEDS[0] / limits.acceleration) ** 2 + (SPEEDS[1] / limits.yaw_acceleration) ** 2
    )


def relations() -> tuple[Relation, ...]:
    """What the expressions of this module switch on."""
    return (*DRIVE.relations, *guard().relations)
