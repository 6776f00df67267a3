"""Straight line at constant speed, for two chains of three integrators."""

from __future__ import annotations

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS
from brunovsky.blocks.variables import TIME, Parameter

_PARAMETERS = (
    Parameter("origin[1]", "m", "point of the line at t = 0, x"),
    Parameter("origin[2]", "m", "point of the line at t = 0, y"),
    Parameter("speed", "m/s", "speed along the line", 0.5),
    Parameter("heading", "rad", "heading of the line, along (-sin, cos)"),
)


def line() -> Block:
    """Straight reference at constant speed.

    Its outputs are ``Z1d[1..3]``, ``Z2d[1..3]`` and the third derivative ``zd3[1..2]`` (m, m/s, m/s2; m/s3).

    A straight line along (-sin(heading), cos(heading)), as the robot's heading is counted.
    """
    x, y, speed, heading = (one.symbol for one in _PARAMETERS)
    position = (x - speed * TIME * sp.sin(heading), y + speed * TIME * sp.cos(heading))
    return Block("line", "straight line at constant speed", parameters=_PARAMETERS,
                 outputs=ROBOT_CHAINS.reference(position))  # fmt: skip
