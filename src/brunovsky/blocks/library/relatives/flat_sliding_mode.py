"""Flatness-based multivariable sliding mode: one switching element for both flat outputs."""

from __future__ import annotations

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS
from brunovsky.blocks.library.outer_loops import sliding_mode
from brunovsky.blocks.variables import symbols


def flat_sliding_mode() -> Block:
    """Unit-vector law v = (-Q S - P S/max(norm(S), phi) - c1 e' - c2 e'')/c3 + zd3 with S = c1 e + c2 e' + c3 e''.

    S is a vector, e the error of the flat outputs (x, y). Outside the disc of radius phi abs(S)' = -Q abs(S) - P,
    whatever the direction: a disturbance of the jerk is rejected up to P/c3 in Euclidean norm, independent of the
    heading, where the paper's law, which switches per axis, has P/c3 on each axis. Gains, defaults and checks are those
    of ``sliding_mode``, and with ``P = 0`` the two are the same law.

    Needs C with roots on the left, Q >= 0, c3 != 0, and eta[1] != 0 for the inner loop; ``phi = 0`` is sampled once a
    step in co-simulation and refused in model exchange. Tracks, and regulates the position but not the heading.

    Source: reference [27] of the paper could not be identified; this is the standard law of that class. Unit vector:
    S. Gutman, Uncertain dynamical systems - a Lyapunov min-max approach, IEEE Trans. Autom. Control 24 (1979) 437-443;
    flat outputs: M. Fliess, J. Lévine, P. Martin and P. Rouchon, Flatness and defect of non-linear systems,
    Int. J. Control 61 (1995) 1327-1361, doi:10.1080/00207179508921959.
    """
    base = sliding_mode()
    c3, p, phi = symbols("C[3]", "P", "phi")
    known = {one.name: one.expression for one in base.outputs}
    surface = {i: known[f"S[{i}]"] for i in ROBOT_CHAINS.numbers}
    square = sum(one**2 for one in surface.values())
    reciprocal = sp.Piecewise((1 / sp.sqrt(square), square > phi**2), (1 / phi, phi > 0), (0, True))
    law = {i: known[f"v[{i}]"].subs(p, 0) - p * surface[i] * reciprocal / c3 for i in ROBOT_CHAINS.numbers}
    return Block(
        "flat_sliding_mode",
        "multivariable sliding mode on the flat outputs",
        inputs=base.inputs,
        parameters=base.parameters,
        outputs=(*ROBOT_CHAINS.outer_inputs(law), *(one for one in base.outputs if one.name.startswith("S["))),
        checks=base.checks,
    )
