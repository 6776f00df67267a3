"""Derivatives of a block's equations: symbolic, of the frozen branch, and as the C text of an FMU.

Relations, modes and what transitions do are constants between events, so an entry is the derivative of the branch that
acts. Only entries that are not identically zero exist.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import count

import sympy as sp

from brunovsky.blocks import TIME, Block, Sample, State, Variable
from brunovsky.native.chain_rule import ChainRule
from brunovsky.native.code import BlockText


@dataclass(frozen=True)
class SparseMatrix:
    """Entries of a matrix that are not identically zero, row by row.

    Parameters
    ----------
    rows, columns : tuple of int
        Where each entry stands, from 0.
    entries : tuple of Expr
        As many.
    """

    rows: tuple[int, ...]
    columns: tuple[int, ...]
    entries: tuple[sp.Expr, ...]

    def by_row(self, count: int) -> list[dict[int, sp.Expr]]:
        """Entries of each of so many rows by column."""
        found: list[dict[int, sp.Expr]] = [{} for _ in range(count)]
        for i, j, entry in zip(self.rows, self.columns, self.entries, strict=True):
            found[i][j] = entry
        return found


@dataclass(frozen=True)
class BlockJacobian:
    """Derivatives of the equations of a block.

    Parameters
    ----------
    equations : SparseMatrix
        Of the state derivatives, then the outputs (Boolean ones have no entries), with respect to :func:`columns`.
    updates : SparseMatrix
        Of the updates of the samples with respect to the same.
    starts : SparseMatrix
        Of the start values of the states, then the samples, with respect to the parameters.
    """

    equations: SparseMatrix
    updates: SparseMatrix
    starts: SparseMatrix


def columns(block: Block) -> tuple[sp.Symbol, ...]:
    """What equations are differentiated by: time, states, inputs, parameters, samples, each in order of declaration."""
    groups: tuple[Sequence[Variable], ...] = (block.states, block.inputs, block.parameters, block.samples)
    return (TIME, *(one.symbol for group in groups for one in group))


@lru_cache(maxsize=64)
def jacobian(block: Block) -> BlockJacobian:
    """Derivatives of the equations of a block, of the frozen branch.

    Parameters
    ----------
    block : Block
        Any block or diagram.

    Returns
    -------
    BlockJacobian
        Its entries are expressions in the symbols of the block.
    """
    started: tuple[State | Sample, ...] = (*block.states, *block.samples)
    outputs = [one.expression if isinstance(one.expression, sp.Expr) else sp.S.Zero for one in block.outputs]
    knowns = columns(block)
    return BlockJacobian(
        differentiated([*(one.derivative for one in block.states), *outputs], knowns),
        differentiated([one.update for one in block.samples], knowns),
        differentiated([one.start for one in started], [one.symbol for one in block.parameters]),
    )


def differentiated(rows: Sequence[sp.Basic], knowns: Sequence[sp.Symbol]) -> SparseMatrix:
    """Derivatives of expressions by symbols, through their common subexpressions, each differentiated once.

    Parameters
    ----------
    rows : sequence of Expr
        One for each row; a condition has no entries.
    knowns : sequence of Symbol
        One for each column.
    """
    common, reduced = sp.cse(list(rows), symbols=(sp.Dummy(real=True) for _ in count()))
    totals = {known: {known: sp.S.One} for known in knowns}
    for name, expression in common:
        totals[name] = _total(expression, totals)
    whole: dict[sp.Symbol, sp.Basic] = {}
    for name, expression in common:
        whole[name] = expression.xreplace(whole)
    found = []
    for i, expression in enumerate(reduced):
        total = _total(expression, totals)
        for j, known in enumerate(knowns):
            if known in total and (entry := total[known].xreplace(whole)) != 0:
                found.append((i, j, entry))
    return SparseMatrix(*(tuple(one[k] for one in found) for k in range(3)))


def _total(expression: sp.Basic, totals: Mapping[sp.Symbol, Mapping[sp.Symbol, sp.Expr]]) -> dict[sp.Symbol, sp.Expr]:
    """Total derivatives of an expression in symbols whose own are known; a condition has none."""
    terms: dict[sp.Symbol, list[sp.Expr]] = {}
    symbols = expression.free_symbols if isinstance(expression, sp.Expr) else set()
    for one in (one for one in totals if one in symbols and totals[one]):
        partial = ChainRule({one: sp.S.One})(expression)
        for known, total in totals[one].items() if partial != 0 else ():
            terms.setdefault(known, []).append(partial * total)
    return {known: sp.Add(*products) for known, products in terms.items()}


def jacobian_source(block: Block) -> str:
    """C99 source of the derivatives of a block, which an FMU has beside its ``model.c``.

    Parameters
    ----------
    block : Block
        Any block or diagram.

    Returns
    -------
    str
        Defines ``const Jacobian brunovsky_jacobian`` of ``jacobian.h``. An entry with a function that C does not have
        (the derivative of the gamma function) is not a number, which is refused where it acts.
    """
    text, derivatives = BlockText(block, missing="NAN"), jacobian(block)
    parts = {"equations": derivatives.equations, "updates": derivatives.updates, "starts": derivatives.starts}
    lines = [
        f'/* Generated from the block "{block.name}". Do not edit. */',
        "#include <math.h>",
        '#include "jacobian.h"',
        "",
    ]
    fields = []
    for name, matrix in parts.items():
        lines += [_indices(f"{name}_row", matrix.rows), _indices(f"{name}_column", matrix.columns)]
        fields.append(f"    .{name} = {{{len(matrix.entries)}, {name}_row, {name}_column}},")
    lines.append("")
    for name, matrix in parts.items():
        arguments = ("const double *p",) if name == "starts" else ()
        lines.append(text.function(f"differentiate_{name}", "entries", matrix.entries, *arguments))
        fields.append(f"    .differentiate_{name} = differentiate_{name},")
    return "\n".join([*lines, "const Jacobian brunovsky_jacobian = {", *fields, "};", ""])


def _indices(name: str, items: Iterable[int]) -> str:
    return f"static const int {name}[] = {{{', '.join([*map(str, items), '0'])}}};"
