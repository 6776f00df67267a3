"""Sample and hold: what a computer sees and gives only every ``sampling_period``."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.hardware import computed
from brunovsky.blocks.library.outer_loops.sampled_law import sampling_period
from brunovsky.blocks.library.outer_loops.surface_map import PERIOD
from brunovsky.blocks.variables import Input, Output, Parameter, Sample, Variable, described


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


def computer(results: Sequence[Variable], period: float, *, name: str = "computer") -> Block:
    """What a computer found at its last sample: each result is held, as ``S_computed[1]`` for ``S[1]``.

    Between samples what is measured is held while the reference moves on: a difference of the two is nobody's.

    Parameters
    ----------
    results : sequence of Variable
        What it computes from what sensors sample at the same instant.
    period : float
        Default of the fixed parameter ``sampling_period``, s.
    name : str
        Of the block.

    Raises
    ------
    ParameterError
        If the period is not positive and finite.
    """
    held = [computed(one) for one in results]
    return Block(
        name,
        "results of a computer at its samples",
        inputs=tuple(Input(**described(one)) for one in results),
        parameters=(hold_period(period, name),),
        samples=tuple(held_sample(one, seen.symbol, rank=1) for one, seen in zip(held, results, strict=True)),
        outputs=tuple(Output(**described(one), expression=one.symbol) for one in held),
    )
