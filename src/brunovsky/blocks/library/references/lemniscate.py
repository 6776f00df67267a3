"""Figure of eight for two chains of three integrators, at a speed that is never zero."""

from __future__ import annotations

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS
from brunovsky.blocks.variables import TIME, Parameter

_PARAMETERS = (
    Parameter("center[1]", "m", "crossing of the lemniscate, x"),
    Parameter("center[2]", "m", "crossing of the lemniscate, y"),
    Parameter("half_width", "m", "half of its width along x; its height is the same half", 2.0, 0.0),
    Parameter("rate", "rad/s", "angular rate: one round takes 2 pi/rate", 0.5),
    Parameter("phase", "rad", "angle at t = 0; 0: the end at the right, pi/2: the crossing", 0.0),
)


def lemniscate() -> Block:
    """Figure of eight as a reference, the lemniscate of Gerono.

    Its outputs are ``Z1d[1..3]``, ``Z2d[1..3]`` and the third derivative ``zd3[1..2]`` (m, m/s, m/s2; m/s3).

    The lemniscate of Gerono, ``half_width (cos(a), sin(a) cos(a))`` with ``a = rate t + phase``. Its speed lies between
    sqrt(7)/4 and sqrt(2) times ``half_width rate`` and is never zero, so that the robot's law is regular all along it,
    unless one of the two is zero. All derivatives are taken symbolically from the position.
    """
    center_x, center_y, half_width, rate, phase = (one.symbol for one in _PARAMETERS)
    angle = rate * TIME + phase
    position = (center_x + half_width * sp.cos(angle), center_y + half_width * sp.sin(2 * angle) / 2)
    return Block("lemniscate", "reference along a figure of eight", parameters=_PARAMETERS,
                 outputs=ROBOT_CHAINS.reference(position))  # fmt: skip
