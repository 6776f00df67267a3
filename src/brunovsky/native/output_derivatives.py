"""C99 text of the time derivatives of a block's outputs, exact and of the branch that relations are frozen in.

Along a solution with x' = f(t, x, u), the derivative of an expression follows from those of its parts: the chain rule.
Written out it would grow with every order, so nothing is written out: outputs and f are cut into small pieces (common
subexpressions), and each piece is differentiated in terms of the derivatives of the pieces it is made of. That is
Taylor arithmetic on the graph of the expressions (A. Griewank, A. Walther, Evaluating Derivatives, 2nd ed., SIAM 2008,
chapter 13, doi:10.1137/1.9780898717761), done once in symbols.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache

import sympy as sp

from brunovsky.blocks import TIME, Block
from brunovsky.native.chain_rule import ChainRule
from brunovsky.native.code import BlockText

HIGHEST_ORDER = 3
"""As many orders as a step follows of its inputs' derivatives: ``INPUT_ORDERS`` of engine.h."""

MOST_OPERATIONS = 6000
"""Of the code for all orders; a block whose code would be longer gets fewer orders, but at least one."""

Statement = tuple[sp.Symbol, sp.Expr]


@dataclass(frozen=True)
class OutputDerivatives:
    """Straight-line code of the derivatives of a block's outputs.

    Parameters
    ----------
    statements : tuple of (sympy.Symbol, sympy.Expr)
        To be evaluated in this order.
    values : tuple of tuple of sympy.Expr
        For order 1, 2, … the derivative of each output, in terms of the block's symbols, those of the statements and
        :func:`input_derivative`; 0 for Boolean outputs.
    """

    statements: tuple[Statement, ...]
    values: tuple[tuple[sp.Expr, ...], ...]

    @property
    def order(self) -> int:
        """Highest order there is."""
        return len(self.values)

    @property
    def operations(self) -> int:
        """How many operations an evaluation takes."""
        expressions = [*(value for _, value in self.statements), *(one for row in self.values for one in row)]
        return int(sp.count_ops(expressions))


def input_derivative(index: int, order: int) -> sp.Symbol:
    """Symbol of a derivative of an input."""
    return sp.Symbol(f"du[{HIGHEST_ORDER * index + order - 1}]")


@lru_cache(maxsize=64)
def output_derivatives(block: Block) -> OutputDerivatives:
    """Time derivatives of the outputs of a block, of order 1 to N.

    N is :data:`HIGHEST_ORDER`, or the highest order whose code, with that of all lower ones, takes no more than
    :data:`MOST_OPERATIONS` operations, but at least 1. Parameters, samples, modes and relations are constant, so the
    derivative of a held sample is 0.

    Parameters
    ----------
    block : Block
        Any block or diagram.
    """
    graph = _Graph(block)
    rows = [graph.next_order() for _ in range(HIGHEST_ORDER)]
    for order in range(HIGHEST_ORDER, 1, -1):
        code = _straight_line(graph.statements, rows[:order])
        if code.operations <= MOST_OPERATIONS:
            return code
    return _straight_line(graph.statements, rows[:1])


class _Graph:
    """Pieces of the outputs and of f, and their derivatives, order by order.

    ``statements`` define the pieces and their derivatives; ``after`` has the derivative of each symbol.
    """

    def __init__(self, block: Block) -> None:
        outputs = [one.expression if isinstance(one.expression, sp.Expr) else sp.S.Zero for one in block.outputs]
        slopes = [one.derivative for one in block.states]
        pieces, reduced = sp.cse([*slopes, *outputs], symbols=sp.numbered_symbols("c"))
        self.values: list[sp.Expr] = reduced[len(slopes) :]
        self.statements: list[Statement] = list(pieces)
        self.after: dict[sp.Symbol, sp.Expr] = {TIME: sp.S.One}
        self._slopes = dict(zip((one.symbol for one in block.states), reduced, strict=False))
        self._inputs = [one.symbol for one in block.inputs]
        self._order = 0
        self._names = sp.numbered_symbols("d")
        self._derivative = ChainRule(self.after)

    def next_order(self) -> tuple[sp.Expr, ...]:
        """Derivatives of the outputs, of order 1 at the first call, then 2 and so on."""
        self._order += 1
        latest = [input_derivative(index, self._order) for index in range(len(self._inputs))]
        self.after.update(zip(self._inputs, latest, strict=True))
        self._inputs = latest
        pending = [one for one in self.statements if one[0] not in self.after]
        for state, slope in self._slopes.items():
            if state not in self.after:
                self.after[state] = self._named(slope)
        for symbol, expression in pending:
            self.after[symbol] = self._named(self._derivative(expression))
        self.values = [self._derivative(one) for one in self.values]
        return tuple(self.values)

    def _named(self, expression: sp.Expr) -> sp.Expr:
        if expression.is_Atom:
            return expression
        name = next(self._names)
        self.statements.append((name, expression))
        return name


def _straight_line(statements: Sequence[Statement], rows: Sequence[Sequence[sp.Expr]]) -> OutputDerivatives:
    """The statements that the rows need, each after those it needs itself, common subexpressions taken out."""
    known = dict(statements)
    needed = list(_behind([one for row in rows for one in row], known))
    flat = [*(known[one] for one in needed), *(one for row in rows for one in row)]
    common, reduced = sp.cse(flat, symbols=sp.numbered_symbols("e"))
    known = dict(common) | dict(zip(needed, reduced, strict=False))
    values = iter(reduced[len(needed) :])
    table = tuple(tuple(next(values) for _ in row) for row in rows)
    order = _behind([one for row in table for one in row], known)
    return OutputDerivatives(tuple((one, known[one]) for one in order), table)


def _behind(expressions: Sequence[sp.Expr], known: dict[sp.Symbol, sp.Expr]) -> Iterator[sp.Symbol]:
    """Symbols of statements that expressions need, each after those it needs itself."""
    done: set[sp.Symbol] = set()
    pending = [one for expression in reversed(expressions) for one in _symbols(expression, known)]
    while pending:
        one = pending[-1]
        missing = [other for other in _symbols(known[one], known) if other not in done]
        if missing and one not in done:
            pending += missing
            continue
        pending.pop()
        if one not in done:
            done.add(one)
            yield one


def _symbols(expression: sp.Expr, known: dict[sp.Symbol, sp.Expr]) -> list[sp.Symbol]:
    return sorted(expression.free_symbols & known.keys(), key=str)


def output_derivatives_source(block: Block) -> str:
    """C99 source of the output derivatives of a block, which an FMU has beside its ``model.c``.

    Parameters
    ----------
    block : Block
        Any block or diagram.

    Returns
    -------
    str
        Defines ``const OutputDerivatives brunovsky_output_derivatives`` of ``output_derivatives.h``. What has a
        function that C does not have is not a number, which is refused when it is asked for.
    """
    code, count = output_derivatives(block), len(block.outputs)
    values = {
        f"dy[{row * count + column}]": value
        for row, line in enumerate(code.values)
        for column, value in enumerate(line)
    }
    header = "void evaluate(ARGUMENTS, const double *du, double *dy)"
    return "\n".join(
        [
            f'/* Generated from the block "{block.name}". Do not edit. */',
            "#include <math.h>",
            '#include "output_derivatives.h"',
            "",
            BlockText(block, missing="NAN").program(header, [*code.statements, *values.items()]),
            f"const OutputDerivatives brunovsky_output_derivatives = {{{code.order}, evaluate}};",
            "",
        ]
    )
