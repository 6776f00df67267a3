"""The model structure of an FMU: which unknown depends on which known, and how.

After initialisation the knowns are time, inputs and continuous states, for FMI 3 parameters too; in initialisation mode
time, inputs and parameters, behind which start values and the events of the first instant are resolved.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache

import sympy as sp

from brunovsky.blocks import Block
from brunovsky.fmi.dependencies import InitialDependencies, Kinds, RunningDependencies
from brunovsky.fmi.variables import ScalarVariable

Dependencies = Callable[[sp.Basic], Kinds]


@dataclass(frozen=True)
class Unknown:
    """An unknown by its index (from 1), and the indices of its knowns in ascending order, each with its kind."""

    index: int
    dependencies: tuple[int, ...]
    kinds: tuple[str, ...]


@dataclass(frozen=True)
class ModelStructure:
    """Outputs, state derivatives, unknowns of initialisation and event indicators, ordered as the standard asks.

    FMI 2 has no variables for event indicators, so that their list is empty there.
    """

    outputs: tuple[Unknown, ...]
    derivatives: tuple[Unknown, ...]
    initial_unknowns: tuple[Unknown, ...]
    event_indicators: tuple[Unknown, ...] = ()


def model_structure(block: Block, variables: Sequence[ScalarVariable], fmi_version: int = 2) -> ModelStructure:
    """Model structure of the FMU of a block.

    Parameters
    ----------
    block : Block
        What the FMU runs.
    variables : sequence of ScalarVariable
        Its table of variables.
    fmi_version : int
        2, or 3, where parameters are knowns after initialisation too.

    Returns
    -------
    ModelStructure
        Indices are those of the table, from 1.
    """
    return _model_structure(block, tuple(variables), fmi_version)


@lru_cache(maxsize=64)
def _model_structure(block: Block, variables: tuple[ScalarVariable, ...], fmi_version: int) -> ModelStructure:
    rows = dict(enumerate(variables, 1))
    states = {one.symbol for one in block.states}
    parameters = {one.symbol for one in block.parameters}
    expressions = {
        index: one.expression
        for index, one in rows.items()
        if one.expression is not None and one.causality in ("output", "local")
    }
    outputs = [index for index, one in rows.items() if one.causality == "output"]
    derivatives = [index for index, one in rows.items() if one.derivative_of]
    indicators = [index for index, one in rows.items() if one.indicator]
    initial = [
        index
        for index, expression in expressions.items()
        if index in outputs or index in derivatives or (expression in states and index not in indicators)
    ]
    symbols = _knowns(block, variables)
    running, initially = _dependencies_of(block)
    changing = symbols.keys() - (parameters if fmi_version == 2 else set())
    clocks = {one.name: index for index, one in rows.items() if one.type == "Clock"}

    def unknown(index: int, kinds: Kinds, ticks: bool = True) -> Unknown:
        by_index = {symbols[one]: kind if rows[index].type == "Real" else "dependent" for one, kind in kinds.items()}
        by_index |= {clocks[name]: "dependent" for name in rows[index].clocks if ticks}
        order = sorted(by_index)
        return Unknown(index, tuple(order), tuple(by_index[one] for one in order))

    def at_run_time(expression: sp.Basic) -> Kinds:
        return {one: kind for one, kind in running(expression).items() if one in changing}

    def at_ticks(expression: sp.Basic) -> Kinds:
        return at_run_time(expression) | _behind_ticks(block, at_run_time, expression)

    return ModelStructure(
        tuple(unknown(index, at_ticks(expressions[index])) for index in outputs),
        tuple(unknown(index, at_ticks(expressions[index])) for index in derivatives),
        tuple(unknown(index, initially(expressions[index]), ticks=False) for index in sorted(initial)),
        tuple(unknown(index, at_run_time(expressions[index])) for index in indicators),
    )


@lru_cache(maxsize=64)
def _dependencies_of(block: Block) -> tuple[Dependencies, Dependencies]:
    """Dependencies after and in initialisation, found once for both versions of the standard."""
    return cache(RunningDependencies(block)), cache(InitialDependencies(block))


def _behind_ticks(block: Block, running: Dependencies, expression: sp.Basic, below: float = float("inf")) -> Kinds:
    """What an expression depends on while a clock ticks: what its samples of clocks are computed from."""
    found: Kinds = {}
    for one in block.samples:
        if one.clock and one.rank < below and one.symbol in block.depends_on(expression):
            behind = _behind_ticks(block, running, one.update, one.rank)
            found |= dict.fromkeys([*running(one.update), *behind], "dependent")
    return found


def _knowns(block: Block, variables: Sequence[ScalarVariable]) -> dict[sp.Symbol, int]:
    """Index of time and of each input, state and parameter."""
    symbols = {one.name: one.symbol for one in (*block.inputs, *block.states, *block.parameters)}
    found = {}
    for index, one in enumerate(variables, 1):
        key = one.expression if one.causality == "independent" else symbols.get(one.name)
        if key is not None:
            found[key] = index
    return found


def dependency_tables(block: Block, variables: Sequence[ScalarVariable]) -> list[str]:
    """C tables ``initial`` and ``running`` of ``description.h``: dependencies by value reference, knowns as in FMI 3.

    The last row of each is a blank, for a compiler takes no empty table.
    """
    structure = model_structure(block, variables, 3)
    unknowns = {
        "initial": structure.initial_unknowns,
        "running": (*structure.outputs, *structure.derivatives, *structure.event_indicators),
    }
    return [
        f"static const Dependency {name}[] = {{{', '.join([*_dependencies(items, variables), '{0, 0, DEPENDENT}'])}}};"
        for name, items in unknowns.items()
    ]


def _dependencies(unknowns: Sequence[Unknown], variables: Sequence[ScalarVariable]) -> Iterator[str]:
    for unknown in unknowns:
        for known, kind in zip(unknown.dependencies, unknown.kinds, strict=True):
            yield f"{{{variables[unknown.index - 1].reference}, {variables[known - 1].reference}, {kind.upper()}}}"
