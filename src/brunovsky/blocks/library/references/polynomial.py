"""Minimum-jerk motion from point to point, for two chains of three integrators."""

from __future__ import annotations

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS
from brunovsky.blocks.library.references.pieces import (
    SHORTEST,
    Acceleration,
    check_acceleration,
    in_turn,
    quintic,
    switches,
)
from brunovsky.blocks.units import derivative_unit
from brunovsky.blocks.variables import TIME, Parameter, symbols

_ENDS = {"start": (0.0, 0.0), "end": (0.0, 2.0)}
_TIMES = (
    Parameter("start_time", "s", "when the motion begins", 0.0),
    Parameter("duration", "s", "how long it takes", 4.0, SHORTEST),
)


def polynomial(*, acceleration: Acceleration = "given") -> Block:
    """Reference from point to point with the least jerk.

    Its outputs are ``Z1d[1..3]``, ``Z2d[1..3]`` and the third derivative ``zd3[1..2]`` (m, m/s, m/s2; m/s3).

    The polynomial of fifth degree that goes from ``start[1..2]`` to ``end[1..2]`` within ``duration``, with
    ``start_velocity[1..2]`` and ``end_velocity[1..2]``: of all motions with this boundary the one with the least
    integral of the squared jerk. Before and after it the velocity is constant, which by default is rest.

    Parameters
    ----------
    acceleration : {"given", "free"}
        At both ends. Given, by the parameters ``start_acceleration[1..2]`` and ``end_acceleration[1..2]``: with their
        defaults, 0, the motion from rest to rest along a straight line, (10 s^3 - 15 s^4 + 6 s^5) in s from 0 to 1,
        whose jerk alone jumps at its ends. Free, so that the cost is least over it as well and the jerk is zero there:
        from rest to rest 5/2 s^2 - 5/2 s^4 + s^5, which starts with an acceleration, as the robot's law needs it for a
        regular start at rest; the acceleration jumps at the ends.

    Returns
    -------
    Block
        A function of time. Fixed parameters ``start[i]``, ``end[i]`` (m), ``start_velocity[i]``, ``end_velocity[i]``
        (m/s), where given ``start_acceleration[i]``, ``end_acceleration[i]`` (m/s2), ``start_time``, ``duration`` (s).
        RK4 sees the ends at its steps: put them on the grid of steps, or one is up to a step late.

    Raises
    ------
    ModelError
        If there is no such choice of the acceleration.

    References
    ----------
    T. Flash and N. Hogan, "The coordination of arm movements: an experimentally confirmed mathematical model", Journal
    of Neuroscience 5(7), 1985, https://doi.org/10.1523/JNEUROSCI.05-07-01688.1985.
    """
    check_acceleration("polynomial", acceleration)
    orders = (0, 1, 2) if acceleration == "given" else (0, 1)
    parameters = tuple(
        Parameter(
            f"{_name(end, order)}[{i}]", derivative_unit("m", order), f"{words} at the {end}, {axis}",
            _ENDS[end][i - 1] if order == 0 else 0.0,
        )
        for order, words in zip(orders, ("position", "velocity", "acceleration"), strict=False)
        for end in _ENDS
        for i, axis in enumerate("xy", 1)
    )  # fmt: skip
    start_time, duration = (one.symbol for one in _TIMES)
    before = switches((start_time, start_time + duration))
    return Block(
        "polynomial",
        f"minimum-jerk motion from point to point, acceleration at its ends {acceleration}",
        parameters=(*parameters, *_TIMES),
        outputs=ROBOT_CHAINS.reference(
            [in_turn(_motion(i, orders, start_time, duration), before) for i in ROBOT_CHAINS.numbers]
        ),
        relations=before,
    )


def _name(end: str, order: int) -> str:
    return end + ("", "_velocity", "_acceleration")[order]


def _motion(i: int, orders: tuple[int, ...], start_time: sp.Expr, duration: sp.Expr) -> tuple[sp.Expr, ...]:
    """Coordinate i before, in and after the motion."""
    natural = orders if len(orders) == 3 else (0, 1, 3)  # jerk zero, where the acceleration is free
    boundary = {end: symbols(*(f"{_name(end, order)}[{i}]" for order in orders)) for end in _ENDS}
    data = [boundary[end][k] * duration**k if k in orders else sp.S.Zero for end in _ENDS for k in natural]
    time = TIME - start_time
    (start, start_velocity), (end, end_velocity) = (boundary[one][:2] for one in _ENDS)
    return (
        start + start_velocity * time,
        sum(c * (time / duration) ** k for k, c in enumerate(quintic(natural) * sp.Matrix(data))),
        end + end_velocity * (time - duration),
    )
