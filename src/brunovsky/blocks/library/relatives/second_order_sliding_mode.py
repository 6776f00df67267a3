"""Second-order sliding mode: twisting on a surface of relative degree two."""

from __future__ import annotations

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS
from brunovsky.blocks.library.outer_loops import saturation
from brunovsky.blocks.variables import Check, Output, Parameter

_C = Parameter("c", "1/s", "pole of the error on the surface is -c", 2.0, 0.0, tunable=True)
_R = (
    Parameter("r[1]", "m/s3", "gain of the switching in S", 30.0, 0.0, tunable=True),
    Parameter("r[2]", "m/s3", "gain of the switching in the derivative of S", 15.0, 0.0, tunable=True),
)
_PHI = (
    Parameter("phi[1]", "m/s", "half-width of the layer in S; 0: sign function", 0.1, 0.0, tunable=True),
    Parameter(
        "phi[2]", "m/s2", "half-width of the layer in the derivative of S; 0: sign function", 0.5, 0.0, tunable=True
    ),
)


def second_order_sliding_mode() -> Block:
    """Twisting law v_i = zd3_i - c e_i'' - r1 sat(S_i/phi1) - r2 sat(S_i'/phi2) with S_i = c e_i + e_i'.

    S has relative degree two, S'' = -r1 sat(S/phi1) - r2 sat(S'/phi2) + p for a disturbance p of the jerk, and S' comes
    from the chain. With ``phi = 0`` (sign functions) S and S' vanish in finite time for every abs(p) below min(r2,
    r1 - r2), which needs r1 > r2 > 0 (checked). With ``phi > 0`` that holds outside the layers; within them S obeys
    s^2 + (r2/phi2) s + (r1/phi1), and a constant p leaves S = p phi1/r1. Then e decays with the pole -c. The jerk is
    bounded by r1 + r2 + abs(c e'' - zd3), so that the time from far starts grows with the root of the distance.

    Needs eta[1] != 0 for the inner loop; ``phi[k] = 0`` is sampled once a step in co-simulation and refused in model
    exchange. Tracks, and regulates the position but not the heading.

    Source: references [15] and [12], [13] of the paper could not be had; this is the standard law of that class.
    Twisting and its conditions: A. Levant, Sliding order and sliding accuracy in sliding mode control, Int. J. Control
    58 (1993) 1247-1263, doi:10.1080/00207179308923053. The layers are this project's.
    """
    c, (r1, r2), (phi1, phi2) = _C.symbol, (one.symbol for one in _R), (one.symbol for one in _PHI)
    errors = {i: ROBOT_CHAINS.error(i) for i in ROBOT_CHAINS.numbers}
    surface = {i: c * e[0] + e[1] for i, e in errors.items()}
    rate = {i: c * e[1] + e[2] for i, e in errors.items()}
    switching = {i: r1 * saturation(surface[i], phi1) + r2 * saturation(rate[i], phi2) for i in errors}
    law = {i: ROBOT_CHAINS.feedforward(i) - c * errors[i][2] - switching[i] for i in errors}
    return Block(
        "second_order_sliding_mode",
        "twisting on a surface of relative degree two",
        inputs=ROBOT_CHAINS.inputs,
        parameters=(_C, *_R, *_PHI),
        outputs=(
            *ROBOT_CHAINS.outer_inputs(law),
            *(Output(f"S[{i}]", "m/s", f"sliding variable of chain {i}", surface[i]) for i in ROBOT_CHAINS.numbers),
            *(Output(f"S_rate[{i}]", "m/s2", f"derivative of S[{i}]", rate[i]) for i in ROBOT_CHAINS.numbers),
        ),
        checks=(
            Check("surface", c > 0, "c = 0 leaves the position error on the surface as it is; set c > 0"),
            Check(
                "twisting",
                sp.And(r1 > r2, r2 > 0),
                "twisting converges for r[1] > r[2] > 0 only, and rejects up to min(r[2], r[1] - r[2]); "
                "set r[1] to twice r[2], say",
            ),
            Check(
                "sign function",
                sp.And(phi1 > 0, phi2 > 0),
                "phi[k] = 0 (sign function) has no end of events in model exchange; set phi[1] and phi[2] > 0, "
                "or use co-simulation, which samples it once an internal step",
                when="model exchange",
            ),
        ),
    )
