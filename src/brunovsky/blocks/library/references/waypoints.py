"""Minimum-jerk motion through points at given times, for two chains of three integrators."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS
from brunovsky.blocks.library.gains import numbers
from brunovsky.blocks.library.references.pieces import (
    SHORTEST,
    Acceleration,
    check_acceleration,
    derivative_row,
    in_turn,
    quintic,
    switches,
)
from brunovsky.blocks.variables import TIME, Output, Parameter, Relation
from brunovsky.errors import ModelError

_MOST = 20


def waypoints(points: ArrayLike, times: ArrayLike, *, acceleration: Acceleration = "given") -> Block:
    """Reference through points at given times with the least jerk.

    Its outputs are ``Z1d[1..3]``, ``Z2d[1..3]`` and the third derivative ``zd3[1..2]`` (m, m/s, m/s2; m/s3).

    The spline of fifth degree through points at given times, at rest before the first and after the last: of all
    motions with these the one with the least integral of the squared jerk. Its derivatives are continuous up to the
    fourth at the points between. It is linear in the points, which therefore stay parameters; the times do not.

    Parameters
    ----------
    points : array_like of float, shape (n, 2)
        Defaults of the fixed parameters ``point[k,i]``: coordinate i of point k, m; two to twenty points.
    times : array_like of float, shape (n,)
        When the reference is there, s, increasing; those before 0 are past when a simulation starts at 0.
    acceleration : {"given", "free"}
        At both ends: given, as 0, so that the jerk alone jumps there, or free, so that the cost is least over it as
        well and the jerk is zero there. See :func:`polynomial`, which two points give.

    Returns
    -------
    Block
        A function of time. RK4 sees the ends at its steps: put them on the grid of steps, or one is up to a step late;
        at the points between that makes no difference.

    Raises
    ------
    ModelError
        If there are too few or too many points, not one time for each, times that do not increase by 1 ms at least,
        numbers that are not finite, or there is no such choice of the acceleration.

    References
    ----------
    T. Flash and N. Hogan, "The coordination of arm movements: an experimentally confirmed mathematical model", Journal
    of Neuroscience 5(7), 1985, https://doi.org/10.1523/JNEUROSCI.05-07-01688.1985, for the cost.
    """
    check_acceleration("waypoints", acceleration)
    where, when = _checked(points, times)
    parameters = tuple(
        tuple(Parameter(f"point[{k},{i}]", "m", f"point {k}, {axis}", value)
              for i, (axis, value) in enumerate(zip("xy", point, strict=True), 1))
        for k, point in enumerate(where, 1)
    )  # fmt: skip
    matrices = _coefficients(when, acceleration)
    before = switches([sp.Float(one) for one in when])
    rows = [[one.symbol for one in row] for row in zip(*parameters, strict=True)]
    return Block(
        "waypoints",
        f"minimum-jerk motion through {len(when)} points, acceleration at its ends {acceleration}",
        parameters=tuple(one for point in parameters for one in point),
        outputs=_reference(when, matrices, before, rows),
        relations=before,
    )


def _checked(points: Any, times: Any) -> tuple[list[list[float]], list[float]]:
    """Points and times as lists, or the reason why they are none."""
    when = numbers("waypoints, times", times)
    try:
        where = np.asarray(points, dtype=float)
    except (TypeError, ValueError):
        where = np.array(np.nan)
    if where.ndim != 2 or where.shape[1] != 2 or not np.all(np.isfinite(where)):
        raise ModelError(f"waypoints: points {points!r} are no list of pairs of finite real numbers; give [[x, y], …]")
    if len(where) != len(when):
        raise ModelError(f"waypoints: {len(when)} time(s) for {len(where)} point(s); give one for each")
    if not 2 <= len(when) <= _MOST:
        raise ModelError(
            f"waypoints: {len(when)} point(s); give from 2 to {_MOST}, or set_point for one and a block of your own, "
            "with its position as a function of time, for more"
        )
    intervals = np.diff(when)
    if not np.all(intervals >= SHORTEST * (1 - 1e-9)):
        k = int(np.argmin(intervals))
        raise ModelError(
            f"waypoints: times[{k + 1}] = {when[k + 1]:g} s does not follow times[{k}] = {when[k]:g} s by "
            f"{SHORTEST:g} s at least; give increasing times"
        )
    return where.tolist(), when


def _coefficients(times: Sequence[float], acceleration: Acceleration) -> list[sp.Matrix]:
    """From the points to the coefficients of each piece, powers of the time since it began; shape (6, n), exact.

    The minimum of the cost is the spline of degree 2 * 3 - 1: its third and fourth derivatives are continuous, at its
    ends the acceleration or, where that is free, the jerk is zero. Unknown are velocity and acceleration at the points.
    """
    number = len(times)
    lengths = [sp.Rational(end) - sp.Rational(begin) for begin, end in pairwise(times)]
    pieces = [_from_ends(length) for length in lengths]
    jumps, last = sp.zeros(2 * number, 3 * number), 3 * number - 3
    jumps[0, 1] = jumps[1, last + 1] = 1  # at rest
    if acceleration == "given":
        jumps[2, 2] = jumps[3, last + 2] = 1
    else:
        jumps[2, :6] = _derivative(3, 0, lengths[0]) * pieces[0]
        jumps[3, last - 3 :] = _derivative(3, 1, lengths[-1]) * pieces[-1]
    for k in range(1, number - 1):
        for row, order in zip((2 * k + 2, 2 * k + 3), (3, 4), strict=True):
            jumps[row, 3 * k - 3 : 3 * k + 3] = _derivative(order, 1, lengths[k - 1]) * pieces[k - 1]
            jumps[row, 3 * k : 3 * k + 6] -= _derivative(order, 0, lengths[k]) * pieces[k]
    known = list(range(0, 3 * number, 3))
    unknown = [k for k in range(3 * number) if k % 3]
    rows = range(2 * number)
    solution = (
        jumps.extract(rows, unknown).to_DM(sp.QQ).lu_solve((-jumps.extract(rows, known)).to_DM(sp.QQ)).to_Matrix()
    )
    nodes = sp.zeros(3 * number, number)
    for k in range(number):
        nodes[3 * k, k] = 1
        nodes[3 * k + 1 : 3 * k + 3, :] = solution[2 * k : 2 * k + 2, :]
    return [piece * nodes[3 * k : 3 * k + 6, :] for k, piece in enumerate(pieces)]


def _from_ends(length: sp.Rational) -> sp.Matrix:
    """From position, velocity and acceleration at both ends to the coefficients of a piece, shape (6, 6)."""
    scale = [length**order for order in range(3)] * 2
    return sp.diag(*(length**-power for power in range(6))) * quintic((0, 1, 2)) * sp.diag(*scale)


def _derivative(order: int, place: int, length: sp.Rational) -> sp.Matrix:
    """Row that takes the coefficients of a piece to a derivative at its begin (0) or end (1), shape (1, 6)."""
    row = derivative_row(order, place)
    return sp.Matrix([[row[power] * length ** max(power - order, 0) for power in range(6)]])


def _reference(
    when: list[float],
    matrices: Sequence[sp.Matrix],
    before: tuple[Relation, ...],
    rows: Sequence[Sequence[sp.Symbol]],
) -> tuple[Output, ...]:
    """Outputs, differentiated with a symbol for each coefficient, which is then replaced: the sums are long."""
    values: dict[sp.Basic, sp.Basic] = {}
    positions = []
    for points in rows:
        pieces = []
        for begin, point, matrix in zip(when, points, matrices, strict=False):
            unknown = sp.symbols("c1:6", cls=sp.Dummy, real=True)
            sums = (sp.Add(*(sp.Float(m) * p for m, p in zip(matrix.row(k), points, strict=True))) for k in range(1, 6))
            values |= dict(zip(unknown, sums, strict=True))
            pieces.append(point + sum(c * (TIME - sp.Float(begin)) ** k for k, c in enumerate(unknown, 1)))
        positions.append(in_turn([points[0], *pieces, points[-1]], before))
    return tuple(
        dataclasses.replace(one, expression=one.expression.xreplace(values))
        for one in ROBOT_CHAINS.reference(positions)
    )
