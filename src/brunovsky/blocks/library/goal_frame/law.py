"""Poles placed in the frame of the goal: the path becomes tangent to the heading with which the robot is to arrive."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS
from brunovsky.blocks.library.gains import numbers
from brunovsky.blocks.library.heading import direction, turned
from brunovsky.blocks.library.outer_loops import sliding_mode
from brunovsky.blocks.variables import Parameter, symbols
from brunovsky.errors import ParameterError

ALONG = (-0.12, -0.5, -0.6)
ACROSS = (-0.5, -0.6, -0.7)
_HEADING = Parameter("goal_heading", "rad", "heading of the goal, about which the frame of the law is turned")


def goal_frame_law(
    along: Sequence[float] = ALONG, across: Sequence[float] = ACROSS, *, P: float = 0.0, phi: float = 0.05
) -> Block:
    """Outer loop of two chains along and across the goal's heading, the slowest pole of all along it.

    The chains are seen in the frame of h = (-sin goal_heading, cos goal_heading) and of its normal to the left. There
    the law is that of :func:`sliding_mode` with the sliding variables S[1] along and S[2] across: the first two poles
    of each axis are those of its surface, the last one is the rate -Q at which S decays. With ``P = 0`` it is pole
    placement. All modes but the slow one die out before it, so that the error is a multiple of h in the end and the
    robot's path tangent to it: forward if the robot comes from behind the goal and drives forward, or from ahead
    and backward; turned by pi otherwise. The heading is reached by the direction of arrival alone, it isn't controlled.

    Needs eta[1] != 0 all along, which the chains decide and :func:`brunovsky.analysis.goal_frame_forecast` tells
    beforehand, and a set point as reference.

    Parameters
    ----------
    along : sequence of float, shape (3,)
        Poles along the goal's heading, 1/s; the first one the slowest of all six.
    across : sequence of float, shape (3,)
        Poles across it, 1/s.
    P : float
        Gain of the switching term, m/s3; 0 for the linear law.
    phi : float
        Half-width of its boundary layer, m/s2.

    Returns
    -------
    Block
        Inputs those of :class:`Chains`, outputs ``v[1..2]`` in the plane and ``S[1..2]``; parameters
        ``goal_heading``, ``C1[1..3]`` and ``Q[1]`` along, ``C2[1..3]`` and ``Q[2]`` across, ``P``, ``phi``.

    Raises
    ------
    ParameterError
        If the poles are not three negative numbers for each axis, or the first is not the slowest of all.
    ModelError
        If the poles are no numbers.

    References
    ----------
    The idea, for the kinematic robot with chains of two integrators: G. Oriolo, A. De Luca and M. Vendittelli, "WMR
    control via dynamic feedback linearization: design, implementation, and experimental validation", IEEE Trans.
    Control Syst. Technol. 10(6), 835-852, 2002, doi:10.1109/TCST.2002.804116. Chains of three and the switching term
    are this project's.
    """
    axes = [numbers("along", along), numbers("across", across)]
    _refuse(axes)
    base = sliding_mode(
        surface=[np.poly(poles[:2])[::-1].tolist() for poles in axes], Q=[-poles[2] for poles in axes], P=P, phi=phi
    )
    h = direction(_HEADING.symbol)
    frame = sp.Matrix.hstack(h, turned(h))
    pairs = [symbols(f"Z1{end}[{k}]", f"Z2{end}[{k}]") for end in ("", "d") for k in (1, 2, 3)]
    seen = {
        one: coordinate
        for pair in (*pairs, symbols("zd3[1]", "zd3[2]"))
        for one, coordinate in zip(pair, frame.T * sp.Matrix(pair), strict=True)
    }
    shown = {one.name: one.expression.xreplace(seen) for one in base.outputs}
    in_plane = frame * sp.Matrix([shown["v[1]"], shown["v[2]"]])
    return Block(
        "goal_frame_law",
        "outer loop with poles placed in the frame of the goal",
        inputs=base.inputs,
        parameters=(_HEADING, *base.parameters),
        outputs=(
            *ROBOT_CHAINS.outer_inputs(dict(zip(ROBOT_CHAINS.numbers, in_plane, strict=True))),
            *(dataclasses.replace(one, expression=shown[one.name]) for one in base.outputs if one.name[0] == "S"),
        ),
        relations=tuple(
            dataclasses.replace(
                one,
                expression=one.expression.xreplace(seen),
                indicator=None if one.indicator is None else one.indicator.xreplace(seen),
            )
            for one in base.relations
        ),
        checks=base.checks,
    )


def _refuse(axes: Sequence[Sequence[float]]) -> None:
    (slow, *others), across = axes
    if [len(one) for one in axes] != [3, 3] or max(*axes[0], *across) >= 0:
        raise ParameterError(
            f"goal_frame_law: along = {list(axes[0])}, across = {list(across)}; give three negative poles for each"
        )
    if slow <= max(*others, *across):
        raise ParameterError(
            f"goal_frame_law: the first pole along, {slow:g}, is not the slowest of along = {list(axes[0])}, "
            f"across = {list(across)}, so that the path does not become tangent to the goal's heading; make it slower"
        )
