"""Pole placement on two chains of three integrators, the paper's "DFL" outer loop."""

from __future__ import annotations

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.outer_loop import CHAINS, INPUTS, outer_inputs, tracking_error
from brunovsky.blocks.variables import Parameter, symbol

_K = (
    Parameter("K[1]", "1/s3", "gain of the position error", 2500.0, tunable=True),
    Parameter("K[2]", "1/s2", "gain of the velocity error", 550.0, tunable=True),
    Parameter("K[3]", "1/s", "gain of the acceleration error", 15.0, tunable=True),
)


def pole_placement() -> Block:
    """Linear law v_i = -K e_i + zd3_i for each chain; the error obeys s^3 + k3 s^2 + k2 s + k1.

    The default is the linear part of the paper's sliding-mode law (C = [500, 10, 1], Q = 5): poles -5 and
    -5 +- 21.79j, since K = [Q c1, c1 + Q c2, c2 + Q c3]/c3.
    """
    gain = sp.Matrix([[one.symbol for one in _K]])
    law = {i: -(gain * tracking_error(i))[0] + symbol(f"zd3[{i}]") for i in CHAINS}
    return Block("pole_placement", "pole placement per chain", inputs=INPUTS, parameters=_K, outputs=outer_inputs(law))
