"""Actuators that saturate: what a controller commands beyond a limit is cut."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from brunovsky.blocks.block import Block
from brunovsky.blocks.hardware import command
from brunovsky.blocks.library.actuators.values import one_for_each
from brunovsky.blocks.variables import Input, Output, Parameter, Relation, Variable, described


def actuator_limits(actuators: Sequence[Variable], limits: ArrayLike, *, name: str = "actuator_limits") -> Block:
    """Commands limited symmetrically: u = min(max(u_command, -u_max), u_max), with named relations.

    Relations are frozen over a step of the classical Runge-Kutta method: the limits hold at its ends, in between up to
    what the command moves in it; with Dormand-Prince, and where commands are held, always.

    Parameters
    ----------
    actuators : sequence of Variable, length m
        As for :func:`actuator_lags`.
    limits : float, or sequence of float, shape (m,)
        Defaults of the limits, in the units of the actuators. One whose limit is infinite has none.
    name : str
        Of the block.

    Returns
    -------
    Block
        Inputs ``u_command`` and outputs ``u`` for each actuator ``u``; tunable parameters ``u_max``, ``u1_max`` for
        ``u[1]``.

    Raises
    ------
    ModelError
        If there is no actuator, or not one limit for each.
    ParameterError
        If a limit is negative or no number.
    """
    values = one_for_each(actuators, limits, "limits", name, "give limits from 0 on, inf for an actuator without")
    parameters, relations, outputs = [], [], []
    for one, value in zip(actuators, values, strict=True):
        asked: sp.Expr = command(one).symbol
        given = asked
        if np.isfinite(value):
            stem = re.sub(r"\W", "", one.name)
            limit = Parameter(
                f"{stem}_max", one.unit, f"limit of abs({one.name})", value, 0.0, tunable=True, nominal=one.nominal
            )
            above = Relation(f"above_{limit.name}", asked - limit.symbol)
            below = Relation(f"below_minus_{limit.name}", -asked - limit.symbol, indicator=asked + limit.symbol)
            parameters.append(limit)
            relations += [above, below]
            given = sp.Piecewise((limit.symbol, above.symbol), (-limit.symbol, below.symbol), (asked, True))
        outputs.append(Output(**described(one) | {"description": f"{one.description}, as it acts"}, expression=given))
    return Block(
        name,
        "actuators that saturate",
        inputs=tuple(Input(**described(command(one))) for one in actuators),
        parameters=tuple(parameters),
        relations=tuple(relations),
        outputs=tuple(outputs),
    )
