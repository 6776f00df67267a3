"""Flatness-based multivariable sliding mode: one switching element for both flat outputs."""

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
_PHI = Parameter("phi", "m/s2", "radius of the boundary layer; 0: unit vector", 0.05, 0.0, tunable=True)


def flat_sliding_mode() -> Block:
    """Unit-vector law v = (-Q S - P S/max(|S|, phi) - c1 e' - c2 e'')/c3 + zd3 with S = c1 e + c2 e' + c3 e''.

    S is a vector, e the error of the flat outputs (x, y), so |S|' = -Q |S| - P outside the disc |S| <= phi, whatever the direction:
    a disturbance of the jerk is rejected up to P/c3 in Euclidean norm, independent of the heading, where the paper's
    law, which switches per axis, has P/c3 on each axis. Gains and defaults are those of ``sliding_mode``, and with
    ``P = 0`` the two are the same law.

    Needs C with roots on the left, Q >= 0, c3 != 0, and eta[1] != 0 for the inner loop; ``phi = 0`` is sampled once a
    step in co-simulation and refused in model exchange. Tracks, and regulates the position but not the heading.

    Source: reference [27] of the paper could not be identified; this is the standard law of that class. Unit vector:
    S. Gutman, Uncertain dynamical systems - a Lyapunov min-max approach, IEEE Trans. Autom. Control 24 (1979) 437-443;
    flat outputs: M. Fliess, J. Lévine, P. Martin and P. Rouchon, Flatness and defect of non-linear systems,
    Int. J. Control 61 (1995) 1327-1361, doi:10.1080/00207179508921959.
    """
    c = [one.symbol for one in _C]
    q, p, phi = _Q.symbol, _P.symbol, _PHI.symbol
    errors = {i: tracking_error(i) for i in CHAINS}
    surface = {i: (sp.Matrix([c]) * errors[i])[0] for i in CHAINS}
    square = sum(one**2 for one in surface.values())
    reciprocal = sp.Piecewise((1 / sp.sqrt(square), square > phi**2), (1 / phi, phi > 0), (0, True))
    law = {
        i: (-q * surface[i] - p * surface[i] * reciprocal - c[0] * errors[i][1] - c[1] * errors[i][2]) / c[2]
        + symbol(f"zd3[{i}]")
        for i in CHAINS
    }
    return Block(
        "flat_sliding_mode",
        "multivariable sliding mode on the flat outputs",
        inputs=INPUTS,
        parameters=(*_C, _Q, _P, _PHI),
        outputs=(
            *outer_inputs(law),
            *(Output(f"S[{i}]", "m/s2", f"sliding variable of chain {i}", surface[i]) for i in CHAINS),
        ),
        checks=(
            Check(
                "surface gain", sp.Ne(c[2], 0), "C[3] = 0 leaves v out of the surface; set C[3] to another value, 1 say"
            ),
            Check(
                "unit vector",
                sp.Or(phi > 0, sp.Eq(p, 0)),
                "phi = 0 (unit vector) has no end of events in model exchange; set phi > 0, or P = 0, "
                "or use co-simulation, which samples it once an internal step",
                when="model exchange",
            ),
        ),
    )
