"""The model structure of an FMU: which unknown depends on which known, and how.

After initialisation the knowns are time, inputs and continuous states; in initialisation mode time, inputs and
parameters, behind which start values and the events of the first instant are resolved.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass

import sympy as sp

from brunovsky.blocks import Block, Sample, State, Variable
from brunovsky.fmi.variables import ScalarVariable

Dependencies = dict[sp.Symbol, frozenset[sp.Symbol]]


@dataclass(frozen=True)
class Unknown:
    """An unknown by its index (from 1), and the indices of its knowns in ascending order, each with its kind."""

    index: int
    dependencies: tuple[int, ...]
    kinds: tuple[str, ...]


@dataclass(frozen=True)
class ModelStructure:
    """Outputs, state derivatives, unknowns of initialisation and event indicators, ordered as the standard asks."""

    outputs: tuple[Unknown, ...]
    derivatives: tuple[Unknown, ...]
    initial_unknowns: tuple[Unknown, ...]
    event_indicators: tuple[Unknown, ...] = ()


def model_structure(block: Block, variables: Sequence[ScalarVariable], fmi_version: int = 2) -> ModelStructure:
    """Model structure of the FMU of a block whose table of variables this is."""
    expressions = {
        index: one.expression
        for index, one in enumerate(variables, 1)
        if one.expression is not None and one.causality in ("output", "local")
    }
    outputs = [index for index, one in enumerate(variables, 1) if one.causality == "output"]
    derivatives = [index for index, one in enumerate(variables, 1) if one.derivative_of]
    indicators = [index for index, one in enumerate(variables, 1) if one.indicator] if fmi_version == 3 else []
    states = {one.symbol for one in block.states}
    initial = [
        index
        for index, expression in expressions.items()
        if index in outputs or index in derivatives or expression in states
    ]
    known = _known(block, variables, states)
    kind = _Kinds(block)

    def running(index: int) -> Unknown:
        expression = expressions[index]
        found = block.depends_on(expression) & known.keys()
        return _unknown(index, {known[one]: kind(expression, one) for one in found})

    resolved = _initial_dependencies(block)
    start = _known(block, variables, {one.symbol for one in block.parameters})

    def initially(index: int) -> Unknown:
        expression = expressions[index]
        found: set[sp.Symbol] = set()
        for one in block.depends_on(expression):
            found |= resolved.get(one, frozenset({one}))
        plain = expression in states and expression not in _reset(block)
        at_start = next(one.start for one in block.states if one.symbol == expression) if plain else None
        return _unknown(
            index,
            {start[one]: "dependent" if at_start is None else kind(at_start, one, ("constant",)) for one in found},
        )

    return ModelStructure(
        tuple(map(running, outputs)),
        tuple(map(running, derivatives)),
        tuple(map(initially, sorted(initial))),
        tuple(map(running, indicators)),
    )


def _unknown(index: int, kinds: Mapping[int, str]) -> Unknown:
    order = sorted(kinds)
    return Unknown(index, tuple(order), tuple(kinds[one] for one in order))


def _known(block: Block, variables: Sequence[ScalarVariable], more: Collection[sp.Symbol]) -> dict[sp.Symbol, int]:
    """Index of time, of the inputs and of these other symbols."""
    symbols = {one.name: one.symbol for one in (*block.inputs, *block.states, *block.parameters)}
    inputs = {one.symbol for one in block.inputs}
    found = {}
    for index, one in enumerate(variables, 1):
        key = one.expression if one.causality == "independent" else symbols.get(one.name)
        if one.causality == "independent" or key in inputs or key in more:
            found[key] = index
    return found


class _Kinds:
    """How a known enters an expression: the strictest kind of factor that its derivative shows."""

    def __init__(self, block: Block) -> None:
        self._behind = {one.symbol: block.depends_on(one.symbol) for one in block.relations}
        fixed = {one.symbol for one in block.parameters if not one.tunable}
        tunable = fixed | {one.symbol for one in block.parameters}
        held: tuple[Variable, ...] = (*block.samples, *block.modes)
        discrete = tunable | {one.symbol for one in held} | {one.symbol for one in block.relations}
        self._levels = {"constant": set(), "fixed": fixed, "tunable": tunable, "discrete": discrete}

    def __call__(
        self,
        expression: sp.Basic,
        known: sp.Symbol,
        allowed: Collection[str] = ("constant", "fixed", "tunable", "discrete"),
    ) -> str:
        relations = expression.free_symbols & self._behind.keys()
        if not isinstance(expression, sp.Expr) or any(known in self._behind[one] for one in relations):
            return "dependent"
        factor = sp.diff(expression, known).free_symbols
        return next((name for name in allowed if factor <= self._levels[name]), "dependent")


def _reset(block: Block) -> frozenset[sp.Symbol]:
    return frozenset(target for one in block.transitions for target in one.assign)


def _initial_dependencies(block: Block) -> Dependencies:
    """What states, samples and modes depend on after the events of the first instant: time, inputs, parameters."""
    started: tuple[State | Sample, ...] = (*block.states, *block.samples)
    resolved: Dependencies = {one.symbol: frozenset(one.start.free_symbols) for one in started}
    resolved |= {one.symbol: frozenset() for one in block.modes}

    def behind(expression: sp.Basic) -> frozenset[sp.Symbol]:
        return frozenset().union(*(resolved.get(one, frozenset({one})) for one in block.depends_on(expression)))

    for rank in sorted({one.rank for one in block.samples}):
        resolved |= {one.symbol: behind(one.update) for one in block.samples if one.rank == rank}
    _close(block, resolved, behind)
    return resolved


def _close(block: Block, resolved: Dependencies, behind: Callable[[sp.Basic], frozenset[sp.Symbol]]) -> None:
    """Adds what transitions can bring in, until nothing changes: they may fire one after the other."""
    before = None
    while resolved != before:
        before = dict(resolved)
        for one in block.transitions:
            for target, value in one.assign.items():
                resolved[target] |= behind(one.guard) | behind(value)
