"""Whether static state feedback linearises a system exactly: with some output, without an extension."""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from brunovsky.linearization.affine import AffineSystem
from brunovsky.linearization.board import Explained, Formula, Heading, Line, Sentence, text
from brunovsky.linearization.lie import lie_bracket
from brunovsky.linearization.numeric import point_of
from brunovsky.linearization.rank import generic_rank
from brunovsky.linearization.simplify import tidy


@dataclass(frozen=True)
class StaticLinearizability(Explained):
    """Answer to the question whether static feedback and a change of coordinates make a system linear, and why.

    Parameters
    ----------
    answer : bool
        Whether they do, near almost every point, or near the operating point if one was given.
    reason : str
        One sentence.
    ranks : tuple of int
        Generic ranks of the distributions G_0, G_1, ...: G_i is spanned by ad_f^k g_j for k <= i and all inputs j. They
        end where the rank is n, stays, or a distribution is not involutive.
    involutive : tuple of bool
        For each of these whether the brackets of its fields stay in it.
    controllability_indices : tuple of int
        The lengths of the chains; empty unless the answer is yes.
    """

    answer: bool
    reason: str
    ranks: tuple[int, ...]
    involutive: tuple[bool, ...]
    controllability_indices: tuple[int, ...] = ()

    def lines(self) -> Iterator[Line]:
        """Yield the lines that `explain`, `latex` and notebooks show."""
        yield Heading("Static feedback linearisation")
        for i, (rank, closed) in enumerate(zip(self.ranks, self.involutive, strict=True)):
            fields = Formula(
                f"G_{i} = span{{ad_f^k g_j, k <= {i}}}",
                rf"G_{{{i}}} = \mathrm{{span}}\{{\mathrm{{ad}}_f^k g_j, k \le {i}\}}",
            )
            yield Sentence(f"{{}}: rank {rank}, {'' if closed else 'not '}involutive", (fields,))
        verdict = "Exactly linearisable" if self.answer else "Not exactly linearisable"
        yield Sentence(f"{verdict} by static feedback: {{}}.", (text(self.reason),))


def static_linearizability(
    system: AffineSystem, *, operating_point: Mapping[sp.Symbol | str, Any] | None = None
) -> StaticLinearizability:
    """Decide whether static feedback makes a system exactly linear, whatever its outputs.

    It does so near a point if and only if there the distributions G_i have constant ranks, G_(n-1) has rank n and
    G_0, ..., G_(n-2) are involutive. Disturbances are taken as zero.

    Parameters
    ----------
    system : AffineSystem
        The plant (n states); its outputs do not matter.
    operating_point : mapping of sympy.Symbol or str to number, optional
        A point near which the ranks have to be constant; generic where it says nothing.

    Returns
    -------
    StaticLinearizability
        Answer, reason and ranks.

    Raises
    ------
    ParameterError
        If the operating point names something else than a state or a parameter.

    References
    ----------
    A. Isidori, *Nonlinear Control Systems*, 3rd ed., 1995, theorem 5.2.3, doi:10.1007/978-1-84628-615-5;
    B. Jakubczyk and W. Respondek, "On linearization of control systems", *Bull. Acad. Pol. Sci.* 28 (1980) 517-522.
    """
    n = len(system.states)
    point = point_of(system, operating_point or {})
    newest = {f"g({symbol})": system.input_matrix.col(j) for j, symbol in enumerate(system.inputs)}
    basis: dict[str, sp.Matrix] = {}
    spanning: list[sp.Matrix] = []
    ranks: list[int] = []
    involutive: list[bool] = []

    def answer(reason: str) -> StaticLinearizability:
        return StaticLinearizability(False, reason, tuple(ranks), tuple(involutive))

    for i in itertools.count():
        spanning += newest.values()
        for name, field in newest.items():
            if generic_rank(sp.Matrix.hstack(*basis.values(), field)) > len(basis):
                basis[name] = field
        ranks.append(len(basis))
        bracket = _leaving(basis, system) if len(basis) < n else None
        involutive.append(bracket is None)
        there = generic_rank(sp.Matrix.hstack(*spanning).subs(point)) if point else len(basis)
        if there < len(basis):
            return answer(f"G_{i} has rank {there} at the operating point and {len(basis)} near it")
        if bracket:
            return answer(f"G_{i} is not involutive, [{bracket[0]}, {bracket[1]}] is not in it")
        if len(basis) == n:
            break
        if i and ranks[i] == ranks[i - 1]:
            return answer(f"the inputs reach only {len(basis)} of {n} dimensions (G_{i} = G_{i - 1})")
        newest = {
            f"ad_f{f'^{i + 1}' if i else ''} {name.split()[-1]}": lie_bracket(
                system.drift, field, system.states
            ).applyfunc(tidy)
            for name, field in newest.items()
        }
    growth = [one - other for one, other in zip(ranks, [0, *ranks], strict=False)]
    indices = tuple(sum(step > j for step in growth) for j in range(growth[0]))
    return StaticLinearizability(
        True,
        f"G_{len(ranks) - 1} has rank n = {n} and the distributions before it are involutive; "
        f"the chains have the lengths {', '.join(map(str, indices))}",
        tuple(ranks),
        tuple(involutive),
        indices,
    )


def is_involutive(fields: Sequence[Any], states: Sequence[sp.Symbol]) -> bool:
    """Whether the brackets of vector fields lie in their span, almost everywhere.

    Parameters
    ----------
    fields : sequence of vector fields
        Each with one entry per state.
    states : sequence of sympy.Symbol
        The coordinates, shape (n,).

    Returns
    -------
    bool
        True also for a single field.

    References
    ----------
    A. Isidori, *Nonlinear Control Systems*, 3rd ed., 1995, section 1.3, doi:10.1007/978-1-84628-615-5.
    """
    columns = [sp.Matrix(list(field)) for field in fields]
    rank = generic_rank(sp.Matrix.hstack(*columns))
    return all(
        generic_rank(sp.Matrix.hstack(*columns, lie_bracket(one, other, states))) == rank
        for one, other in itertools.combinations(columns, 2)
    )


def _leaving(basis: Mapping[str, sp.Matrix], system: AffineSystem) -> tuple[str, str] | None:
    """Names of two fields of a basis whose bracket leaves its span."""
    for one, other in itertools.combinations(basis, 2):
        bracket = lie_bracket(basis[one], basis[other], system.states)
        if not bracket.is_zero_matrix and generic_rank(sp.Matrix.hstack(*basis.values(), bracket)) > len(basis):
            return one, other
    return None
