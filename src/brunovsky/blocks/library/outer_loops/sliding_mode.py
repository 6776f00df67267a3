"""Sliding-mode outer loop of the paper, (20)-(23), with a boundary layer."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp
from numpy.typing import ArrayLike

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.library.gains import scalar_gains, vector_gains
from brunovsky.blocks.variables import Check, Output
from brunovsky.errors import ModelError

_ROBOT_SURFACE = (500.0, 10.0, 1.0)


def saturation(value: sp.Expr, half_width: sp.Expr) -> sp.Expr:
    """sat(value/half_width): -1 to 1, linear within; the sign function for half_width = 0."""
    return sp.Piecewise(
        (1, value > half_width), (-1, value < -half_width), (value / half_width, half_width > 0), (0, True)
    )


def sliding_mode(
    chains: Chains | Block = ROBOT_CHAINS,
    surface: Sequence[ArrayLike] | None = None,
    *,
    Q: ArrayLike = 5.0,
    P: ArrayLike = 2.5,
    phi: ArrayLike = 0.05,
) -> Block:
    """Sliding-mode law v_i = (-Q S_i - P sat(S_i/phi) - c_1 e_i2 - ... - c_(r-1) e_ir)/c_r + y_d^(r), S_i = C e_i.

    The surface obeys S' = -Q S - P sat(S/phi), (22) of the paper, with sign replaced by a saturation of half-width
    ``phi``. ``P = 0`` leaves pole placement at the roots of c_r s^(r-1) + ... + c_1 and at -Q. Needs c_r != 0; with
    ``phi = 0`` it is sampled once a step in co-simulation and refused in model exchange, where it has no end of events.

    Parameters
    ----------
    chains : Chains or Block
        The chains, or the linearised plant that has them; the robot's by default.
    surface : sequence of float, or one sequence per chain
        C = (c_1, ..., c_r) in 1/s^(r-1), ..., 1: :func:`brunovsky.analysis.surface_from_poles` gives it for poles. The
        default, for the robot's chains alone, is the paper's.
    Q, P, phi : float, or one per chain
        Gain of the exponential part (1/s), gain of the switching part (unit of S per s), half-width of the boundary
        layer (unit of S, that of the output's derivative r - 1).

    Returns
    -------
    Block
        Inputs those of :class:`Chains`, outputs ``v[i]`` and ``S[i]``; parameters ``C[k]``, ``Q``, ``P``, ``phi``, or
        ``Ci[k]``, ``Q[i]``, ... where chains differ.

    Raises
    ------
    ModelError
        If the numbers do not fit the chains.

    References
    ----------
    The paper's (20)-(23); boundary layer: J.-J. E. Slotine and S. S. Sastry, "Tracking control of non-linear systems
    using sliding surfaces, with application to robot manipulators", Int. J. Control 38(2), 465-492, 1983,
    doi:10.1080/00207178308933088.
    """
    chains = Chains.of(chains)
    if surface is None:
        if chains != ROBOT_CHAINS:
            raise ModelError(
                "sliding_mode: the surface is missing; brunovsky.analysis.surface_from_poles(poles) gives one per chain"
            )
        surface = _ROBOT_SURFACE

    def surface_unit(i: int) -> str:
        return chains.unit(i, chains.orders[i - 1] - 1)

    c = vector_gains(chains, "C", surface, lambda r, k: r - k, "surface gain of the error's derivative {k}")
    q = scalar_gains(chains, "Q", Q, lambda i: "1/s", "gain of the exponential part of the reaching law")
    p = scalar_gains(
        chains,
        "P",
        P,
        lambda i: chains.unit(i, chains.orders[i - 1]),
        "gain of the switching part of the reaching law",
        0.0,
    )
    width = scalar_gains(chains, "phi", phi, surface_unit, "half-width of the boundary layer; 0: sign function", 0.0)
    surfaces = {i: (sp.Matrix([c[i]]) * chains.error(i))[0] for i in chains.numbers}
    law = {i: _law(chains, i, surfaces[i], c[i], q[i][0], p[i][0], width[i][0]) for i in chains.numbers}
    return Block(
        "sliding_mode",
        "sliding-mode outer loop with a boundary layer",
        inputs=chains.inputs,
        parameters=(*c.parameters, *q.parameters, *p.parameters, *width.parameters),
        outputs=(
            *chains.outer_inputs(law),
            *(Output(f"S[{i}]", surface_unit(i), f"sliding variable of chain {i}", surfaces[i]) for i in surfaces),
        ),
        checks=(
            *(
                Check(
                    "surface gain",
                    sp.Ne(row[-1].symbol, 0),
                    f"{row[-1].name} = 0 leaves v out of the surface; set {row[-1].name} to another value, 1 say",
                )
                for row in dict.fromkeys(c.rows)
            ),
            *(
                Check(
                    "sign function",
                    sp.Or(thickness.symbol > 0, sp.Eq(gain.symbol, 0)),
                    f"{thickness.name} = 0 (sign function) has no end of events in model exchange; set "
                    f"{thickness.name} > 0, or {gain.name} = 0, or use co-simulation, which samples it once an "
                    "internal step",
                    when="model exchange",
                )
                for (thickness,), (gain,) in dict.fromkeys(zip(width.rows, p.rows, strict=True))
            ),
        ),
    )


def _law(
    chains: Chains, i: int, s: sp.Expr, c: Sequence[sp.Symbol], q: sp.Symbol, p: sp.Symbol, phi: sp.Symbol
) -> sp.Expr:
    """v_i that makes S' = -q S - p sat(S/phi)."""
    moved = sum(gain * error for gain, error in zip(c[:-1], chains.error(i)[1:], strict=True))
    return (-q * s - p * saturation(s, phi) - moved) / c[-1] + chains.feedforward(i)
