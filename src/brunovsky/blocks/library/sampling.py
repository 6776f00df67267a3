"""Sample and hold: what a computer sees and gives only every ``sampling_period``."""

from __future__ import annotations

import dataclasses

import sympy as sp

from brunovsky.blocks.library.outer_loops.sampled_law import sampling_period
from brunovsky.blocks.library.outer_loops.surface_map import PERIOD
from brunovsky.blocks.variables import Parameter, Sample, Variable, described


def hold_period(period: float, where: str) -> Parameter:
    """Fixed parameter ``sampling_period`` of sensors and actuators with this default.

    Raises
    ------
    ParameterError
        If it is not a positive number; ``where`` names the block.
    """
    return dataclasses.replace(
        sampling_period(period, where, "none to have no sampling"),
        description="sampling period; what is sampled is held between samples",
    )


def held_sample(one: Variable, value: sp.Expr, rank: int = 0) -> Sample:
    """Sample that holds a value, under the name and unit of what it shows."""
    return Sample(**described(one), update=value, period=PERIOD.symbol, rank=rank)
