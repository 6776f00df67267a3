"""What all sliding-mode laws share: the surface S = C e, what it must satisfy, and the law that moves it as wanted."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.library.gains import Gains, vector_gains
from brunovsky.blocks.variables import Check, Output, Parameter
from brunovsky.errors import ModelError, ParameterError

_ROBOT_SURFACE = (500.0, 10.0, 1.0)
_REMEDY = "brunovsky.analysis.surface_from_poles(poles) or surface_from_cost(weights) gives one per chain"


def surface_gains(chains: Chains, surface: Sequence[ArrayLike] | None, law: str) -> Gains:
    """Parameters ``C[k]``, by default, for the robot's chains alone, those of the paper.

    Raises
    ------
    ModelError
        If they are missing or do not fit the chains; ``law`` names the block.
    ParameterError
        If motion on the surface is not stable.
    """
    if surface is None:
        if chains != ROBOT_CHAINS:
            raise ModelError(f"{law}: the surface is missing; {_REMEDY}")
        surface = _ROBOT_SURFACE
    c = vector_gains(chains, "C", surface, lambda r, k: r - k, "surface gain of the error's derivative {k}")
    for row in dict.fromkeys(c.rows):
        _refuse_unstable(row, law)
    return c


def surface_unit(chains: Chains, i: int) -> str:
    """Unit of S_i, that of the output's derivative r_i - 1."""
    return chains.unit(i, chains.orders[i - 1] - 1)


def sliding_variables(chains: Chains, c: Gains) -> dict[int, sp.Expr]:
    """S_i = C e_i, by number of the chain."""
    return {i: (sp.Matrix([c[i]]) * chains.error(i))[0] for i in chains.numbers}


def sliding_outputs(chains: Chains, variables: dict[int, sp.Expr]) -> tuple[Output, ...]:
    """Outputs ``S[i]``."""
    return tuple(
        Output(f"S[{i}]", surface_unit(chains, i), f"sliding variable of chain {i}", one)
        for i, one in variables.items()
    )


def surface_law(chains: Chains, i: int, c: Sequence[sp.Symbol], reaching: sp.Expr) -> sp.Expr:
    """v_i that makes S_i' the given expression."""
    moved = sum(gain * error for gain, error in zip(c[:-1], chains.error(i)[1:], strict=True))
    return (reaching - moved) / c[-1] + chains.feedforward(i)


def surface_checks(c: Gains) -> tuple[Check, ...]:
    """Checks that S' contains v, and that motion on the surface is stable."""
    return tuple(one for row in dict.fromkeys(c.rows) for one in _row_checks(row))


def hurwitz(coefficients: Sequence[sp.Expr]) -> sp.logic.boolalg.Boolean:
    """Condition under which c_1 + c_2 s + ... + c_r s^(r-1) has its roots in the open left half plane.

    The criterion of Liénard and Chipart, which needs half of the minors of the Hurwitz matrix, beside positive
    coefficients; multiplied by c_r the polynomial begins with c_r^2 > 0.

    References
    ----------
    A. Liénard and M. H. Chipart, "Sur le signe de la partie réelle des racines d'une équation algébrique", J. Math.
    Pures Appl. 10, 291-346, 1914.
    """
    n = len(coefficients) - 1
    a = [coefficients[-1] * one for one in reversed(coefficients)]
    matrix = sp.Matrix(n, n, lambda i, j: a[2 * j - i + 1] if 0 <= 2 * j - i + 1 <= n else 0)
    minors = (sp.expand(matrix[:k, :k].det(method="berkowitz")) for k in range(n - 1, 1, -2))
    return sp.And(*(one > 0 for one in (*a[1:], *minors)))


def _row_checks(row: Sequence[Parameter]) -> tuple[Check, Check]:
    last = row[-1]
    names = ", ".join(one.name for one in row)
    return (
        Check("surface gain", sp.Ne(last.symbol, 0), _without_v(last)),
        Check(
            "stable surface",
            sp.Or(sp.Eq(last.symbol, 0), hurwitz([one.symbol for one in row])),
            f"on the surface {names} the error does not decay: the roots of its polynomial are not all in the open "
            f"left half plane; {_REMEDY}",
        ),
    )


def _without_v(last: Parameter) -> str:
    return f"{last.name} = 0 leaves v out of the surface; set {last.name} to another value, 1 say"


def _refuse_unstable(row: Sequence[Parameter], law: str) -> None:
    values = {one.symbol: sp.Float(one.value) for one in row}
    if not all(np.isfinite(one.value) for one in row):
        return  # the block refuses it
    gain, stable = _row_checks(row)
    if gain.condition.subs(values) == sp.false:
        raise ParameterError(f"{law}: {gain.message}")
    if stable.condition.subs(values) == sp.false:
        poles = np.sort_complex(np.roots([one.value for one in reversed(row)]))
        shown = ", ".join(f"{p.real:.4g}{p.imag:+.4g}j" if p.imag else f"{p.real:.4g}" for p in poles)
        names = f"{row[0].name}, ..., {row[-1].name} = {[one.value for one in row]}"
        raise ParameterError(
            f"{law}: the surface {names} has the poles {shown}, not all with negative real part, so that the error "
            f"does not decay on it; {_REMEDY}"
        )
