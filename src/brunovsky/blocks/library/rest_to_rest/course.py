"""A reference that waits: the same motion by a clock of its own, which is an input."""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS
from brunovsky.blocks.library.references.preview import check_timed
from brunovsky.blocks.variables import TIME, Check, Input, Output, Relation
from brunovsky.errors import ModelError

EDGE = 1e-3
"""How far from its rest a reference begins and ends, s: at rest itself it has no heading."""
NEVER = 1e9
"""Span of a reference that does not come to rest, s."""
CLOCK = Input("clock", "s", "time of the reference since its begin")
WANTED = ROBOT_CHAINS.reference((sp.S.Zero, sp.S.Zero))
"""What is taken from a reference: its outputs by name and unit."""


def course(reference: Block) -> Block:
    """A reference that begins where it leaves rest, or at t = 0, and ends where it comes to rest for ever.

    Parameters
    ----------
    reference : Block
        A function of time for the robot's chains, whose pieces change at given times.

    Returns
    -------
    Block
        Input ``clock`` (s); outputs ``Z1d[1..3]``, ``Z2d[1..3]``, ``zd3[1..2]`` and ``span`` (s), the time from its
        begin to its end.

    Raises
    ------
    ModelError
        If it is no such function, or rests for ever.
    """
    check_timed(reference, "tracker")
    found = {one.name: one.expression for one in reference.outputs}
    lacking = [one.name for one in WANTED if one.name not in found]
    if lacking:
        raise ModelError(f"{reference.name} has no outputs {', '.join(lacking)}; give a reference such as circle()")
    speed2 = found["Z1d[2]"] ** 2 + found["Z2d[2]"] ** 2
    if speed2.is_zero:
        raise ModelError(f"{reference.name} rests for ever and has no heading; rest_to_rest brings the robot to a goal")
    begin, span = _extent(reference, speed2)
    own: dict[sp.Basic, sp.Basic] = {TIME: begin + CLOCK.symbol}
    relations = tuple(Relation(one.name, one.expression.xreplace(own)) for one in reference.relations)
    at_begin: dict[sp.Basic, sp.Basic] = {TIME: begin}
    at_begin |= {one.symbol: one.expression.xreplace({TIME: begin}) > 0 for one in reference.relations}
    return Block(
        reference.name,
        f"{reference.description}, from its begin",
        inputs=(CLOCK,),
        parameters=reference.parameters,
        outputs=(
            *(Output(one.name, one.unit, one.description, found[one.name].xreplace(own)) for one in WANTED),
            Output("span", "s", "time from the begin of the reference to its rest", span),
        ),
        relations=relations,
        checks=(
            *reference.checks,
            Check("moves", sp.And(speed2.xreplace(at_begin) > 0, span > 0),
                  f"the reference {reference.name} does not move, so that it has no heading; let it move for more than "
                  "a few ms after t = 0, or bring the robot to a goal by rest_to_rest"),
        ),
    )  # fmt: skip


def _extent(reference: Block, speed2: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """When a reference begins, and how long it lasts, s: without pieces from t = 0 for ever."""
    knots = [_knot(reference.name, one) for one in reference.relations if TIME in one.expression.free_symbols]
    if not knots:
        return sp.S.Zero, sp.Float(NEVER)
    before, after = (_moving(speed2, reference, past) for past in (False, True))
    begin = sp.Piecewise((0, before), (sp.Max(0, sp.Min(*knots)) + EDGE, True))
    return begin, sp.Piecewise((NEVER, after), (sp.Max(*knots) - EDGE - begin, True))


def _knot(name: str, one: Relation) -> sp.Expr:
    """Instant at which a relation switches."""
    slope = one.expression.diff(TIME)
    if not slope.is_number or slope == 0:
        raise ModelError(f"{name}: '{one.name}' does not switch at a given time, so that its end is not known; tracker "
                         "takes references whose pieces change at given times")  # fmt: skip
    return sp.expand(TIME - one.expression / slope)


def _moving(speed2: sp.Expr, reference: Block, past: bool) -> sp.logic.boolalg.Boolean:
    """Whether the first piece (or, all switches past, the last one) moves; one that depends on time does."""
    settled: Mapping[sp.Basic, sp.Basic] = {
        one.symbol: sp.sympify((one.expression.diff(TIME) > 0) == past)
        for one in reference.relations
        if TIME in one.expression.free_symbols
    }
    piece = sp.sympify(speed2).xreplace(dict(settled))
    return sp.true if TIME in piece.free_symbols else sp.sympify(piece > 0)
