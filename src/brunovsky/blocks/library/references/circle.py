"""Circular reference for two chains of three integrators; with radius 0 a set point."""

from __future__ import annotations

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS
from brunovsky.blocks.variables import TIME, Parameter

_PARAMETERS = (
    Parameter("center[1]", "m", "centre of the circle, x"),
    Parameter("center[2]", "m", "centre of the circle, y"),
    Parameter("radius", "m", "radius of the circle; 0: the set point is its centre", 2**0.5, 0.0),
    Parameter("rate", "rad/s", "angular rate along the circle", 0.5),
    Parameter("phase", "rad", "angle on the circle at t = 0", 0.0),
)


def circle() -> Block:
    """Circular reference; radius 0 is a set point.

    Its outputs are ``Z1d[1..3]``, ``Z2d[1..3]`` and the third derivative ``zd3[1..2]`` (m, m/s, m/s2; m/s3).

    The default is figure 6 of the paper, x^2 + y^2 = 2; the rate of 0.5 rad/s, not given there, is chosen here.
    All derivatives are taken symbolically from the position.
    """
    center_x, center_y, radius, rate, phase = (one.symbol for one in _PARAMETERS)
    angle = rate * TIME + phase
    position = (center_x + radius * sp.cos(angle), center_y + radius * sp.sin(angle))
    return Block("circle", "circular reference", parameters=_PARAMETERS, outputs=ROBOT_CHAINS.reference(position))
