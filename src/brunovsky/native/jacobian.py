"""Derivatives of a block's equations: symbolic, of the frozen branch, and as the C text of an FMU.

Relations, modes and what transitions do are constants between events, so an entry is the derivative of the branch that
acts. Only entries that are not identically zero exist.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import sympy as sp

from brunovsky.blocks import TIME, Block, Sample, State, Variable
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

    def row(self, index: int) -> dict[int, sp.Expr]:
        """Entries of one row by column."""
        return {j: one for i, j, one in zip(self.rows, self.columns, self.entries, strict=True) if i == index}


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
        _differentiated([*(one.derivative for one in block.states), *outputs], knowns),
        _differentiated([one.update for one in block.samples], knowns),
        _differentiated([one.start for one in started], [one.symbol for one in block.parameters]),
    )


def _differentiated(rows: Iterable[sp.Basic], knowns: Sequence[sp.Symbol]) -> SparseMatrix:
    found = []
    for i, expression in enumerate(rows):
        symbols = sp.sympify(expression).free_symbols
        for j, known in enumerate(knowns):
            if known in symbols and (entry := sp.diff(expression, known)) != 0:
                found.append((i, j, entry))
    return SparseMatrix(*(tuple(one[k] for one in found) for k in range(3)))


def jacobian_source(block: Block) -> str:
    """C99 source of the derivatives of a block, which an FMU has beside its ``model.c``.

    Parameters
    ----------
    block : Block
        Any block or diagram.

    Returns
    -------
    str
        Defines ``const Jacobian brunovsky_jacobian`` of ``jacobian.h``.
    """
    text, derivatives = BlockText(block), jacobian(block)
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
