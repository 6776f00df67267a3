"""The search for a plan: one candidate after the other in event iterations, so that a path's timing stands once."""

from __future__ import annotations

import sympy as sp

from brunovsky.blocks.library.rest_to_rest.candidates import Candidate, Leg
from brunovsky.blocks.library.rest_to_rest.path import Pose
from brunovsky.blocks.library.rest_to_rest.plan import drive_path, turn_in_place
from brunovsky.blocks.library.rest_to_rest.timing import Limits, path_timing
from brunovsky.blocks.variables import Relation, Transition, held, symbol, symbols

UNDECIDED = 1e9
"""Cost that any plan beats, s."""
NO_TURN = 0.05
"""Angle below which a turn in place before a path is left out, rad."""

SEARCH = (
    held("leg_along", "m", "path that is timed: its end, along"),
    held("leg_left", "m", "path that is timed: its end, to the left"),
    held("leg_turn", "rad", "path that is timed: its turn"),
    held("leg_tangent", "m", "path that is timed: its tangent", 1),
    held("leg_extra", "s", "time of turns in place"),
    held("leg_factor", "1", "factor of the cost"),
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


_STEP, _CHOICE, _CARRY = symbols("search", "choice", "carry")
_PATH = symbols("leg_along", "leg_left", "leg_turn", "leg_tangent")
_MEASURED = symbols("length", "speed", "acceleration")
_EXTRA, _FACTOR, _LAST = symbols("leg_extra", "leg_factor", "time_of_leg")

CHEAPER = Relation("cheaper", symbol("best_cost") - symbol("cost"))
"""Whether the manoeuvre timed last beats the best so far."""


def begin_search() -> dict[sp.Symbol, sp.Expr]:
    """Assignments that begin a search."""
    return {symbol("search"): sp.S.One, symbol("choice"): sp.S.Zero, symbol("best_cost"): sp.Float(UNDECIDED)}


def search_transitions(choices: tuple[Candidate, ...], here: Pose, goal: Pose, limits: Limits) -> list[Transition]:
    """Search for the cheapest manoeuvre: set a path, time it, compare; then begin its first leg.

    One path a step of ``search``, so that step k sets path k while path k - 1 is timed and path k - 2 compared. A path
    driven afterwards comes before the one that is driven first, which is thus the one timed when the two are compared.
    """
    paths = [(number, one, leg) for number, one in enumerate(choices, 1) for leg in (one.after, one.leg) if leg]
    drive_first = {step: number for step, (number, one, leg) in enumerate(paths, 1) if leg is one.leg}
    end = len(paths) + 3
    return [
        *(each for number, one in enumerate(choices, 1) for each in _begin(end, number, one, here, goal, limits)),
        *(_set_path(step, one, leg) for step, (_, one, leg) in enumerate(paths, 1)),
        _time_path(end, limits),
        *(_compare(step, number) for step, number in drive_first.items()),
        Transition("next", sp.And(sp.Ne(_STEP, 0), sp.Ne(_STEP, end)), {_STEP: _STEP + 1}),
    ]


def _begin(end: int, number: int, one: Candidate, here: Pose, goal: Pose, limits: Limits) -> list[Transition]:
    """Begin of the manoeuvre that was chosen: its turn in place, unless there is none to make, or its path."""
    chosen = sp.And(sp.Eq(_STEP, end), sp.Eq(_CHOICE, number))
    drive = Transition(f"drive_{number}", chosen, drive_path(here, goal, one))
    if one.turn is None:
        return [drive]
    small = sp.cos(one.turn) > sp.cos(sp.Float(NO_TURN))
    turn = turn_in_place(here, goal, one.turn, limits)
    return [
        Transition(f"turn_{number}", sp.And(chosen, sp.Not(small)), turn),
        Transition(drive.name, sp.And(chosen, small), drive.assign),
    ]


def _set_path(step: int, one: Candidate, leg: Leg) -> Transition:
    values = {
        **dict(zip(_PATH, leg.relative, strict=True)),
        _EXTRA: one.extra,
        _FACTOR: sp.Float(one.factor),
        _CARRY: sp.Integer(leg is one.leg and one.after is not None),
    }
    return Transition(f"set_{step}", sp.Eq(_STEP, step), values)


def _time_path(end: int, limits: Limits) -> Transition:
    along, left, turn, tangent = _PATH
    timing = path_timing(along, left, turn, tangent, limits)
    afterwards = sp.Piecewise((_LAST, sp.Eq(_CARRY, 1)), (0, True))
    values = {
        **dict(zip(_MEASURED, (timing.length, timing.speed, timing.acceleration), strict=True)),
        _LAST: timing.cost,
        symbol("cost"): _FACTOR * (timing.cost + _EXTRA + afterwards),
    }
    return Transition("time", sp.And(*(sp.Ne(_STEP, one) for one in (0, 1, end - 1, end))), values)


def _compare(step: int, number: int) -> Transition:
    best = dict(zip(symbols("best_length", "best_speed", "best_acceleration"), _MEASURED, strict=True))
    values = {_CHOICE: sp.Integer(number), symbol("best_cost"): symbol("cost"), **best}
    return Transition(f"better_{number}", sp.And(sp.Eq(_STEP, step + 2), CHEAPER.symbol), values)
