"""Sliding-mode outer loop of the paper, (20)-(23), with a boundary layer."""

from __future__ import annotations

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.outer_loop import CHAINS, INPUTS, outer_inputs, tracking_error
from brunovsky.blocks.variables import Check, Output, Parameter, symbol

_C = (
    Parameter("C[1]", "1/s2", "surface gain of the position error", 500.0, tunable=True),
    Parameter("C[2]", "1/s", "surface gain of the velocity error", 10.0, tunable=True),
    Parameter("C[3]", "1", "surface gain of the acceleration error", 1.0, tunable=True),
)
_Q = Parameter("Q", "1/s", "gain of the exponential part of the reaching law", 5.0, tunable=True)
_P = Parameter("P", "m/s3", "gain of the switching part of the reaching law", 2.5, 0.0, tunable=True)
_PHI = Parameter("phi", "m/s2", "half-width of the boundary layer; 0: sign function", 0.05, 0.0, tunable=True)


def saturation(value: sp.Expr, half_width: sp.Expr) -> sp.Expr:
    """sat(value/half_width): -1 to 1, linear within; the sign function for half_width = 0."""
    return sp.Piecewise(
        (1, value > half_width), (-1, value < -half_width), (value / half_width, half_width > 0), (0, True)
    )


def sliding_mode() -> Block:
    """Sliding-mode law v_i = (-Q S_i - P sat(S_i/phi) - c1 e_i2 - c2 e_i3)/c3 + zd3_i with S_i = C e_i.

    Surface S' = -Q S - P sat(S/phi), (22) of the paper, with sign replaced by a saturation of half-width ``phi``.
    ``P = 0`` leaves pole placement at the roots of c3 s^2 + c2 s + c1 and at -Q. Needs c3 != 0; with ``phi = 0`` it
    is sampled once a step in co-simulation and refused in model exchange, where it has no end of events.

    Source: (20)-(23) of the paper; boundary layer: J.-J. E. Slotine and S. S. Sastry, Int. J. Control 38 (1983),
    doi:10.1080/00207178308933088.
    """
    c = [one.symbol for one in _C]
    q, p, phi = _Q.symbol, _P.symbol, _PHI.symbol
    surfaces = {i: (sp.Matrix([c]) * tracking_error(i))[0] for i in CHAINS}
    law = {
        i: (-q * surfaces[i] - p * saturation(surfaces[i], phi) - c[0] * e[1] - c[1] * e[2]) / c[2]
        + symbol(f"zd3[{i}]")
        for i, e in ((i, tracking_error(i)) for i in CHAINS)
    }
    return Block(
        "sliding_mode",
        "sliding-mode outer loop with a boundary layer",
        inputs=INPUTS,
        parameters=(*_C, _Q, _P, _PHI),
        outputs=(
            *outer_inputs(law),
            *(Output(f"S[{i}]", "m/s2", f"sliding variable of chain {i}", surfaces[i]) for i in CHAINS),
        ),
        checks=(
            Check(
                "surface gain", sp.Ne(c[2], 0), "C[3] = 0 leaves v out of the surface; set C[3] to another value, 1 say"
            ),
            Check(
                "sign function",
                sp.Or(phi > 0, sp.Eq(p, 0)),
                "phi = 0 (sign function) has no end of events in model exchange; set phi > 0, or P = 0, "
                "or use co-simulation, which samples it once an internal step",
                when="model exchange",
            ),
        ),
    )
