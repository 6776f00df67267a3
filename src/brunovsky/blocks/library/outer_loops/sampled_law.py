"""What sampled outer loops share: the period, the inputs, and v[i] computed at each sample and held."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Mapping

import numpy as np
import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import Chains
from brunovsky.blocks.library.gains import Gains
from brunovsky.blocks.library.outer_loops.surface_map import PERIOD, SurfaceMap, mean_rate, references_ahead
from brunovsky.blocks.variables import Clock, Input, Output, Parameter, Sample
from brunovsky.errors import ParameterError


def sampling_period(period: float, block: str, instead: str = "take a law that is not sampled") -> Parameter:
    """Parameter ``sampling_period`` with this default.

    Raises
    ------
    ParameterError
        If it is not a positive number; ``block`` is its name, ``instead`` the other way out.
    """
    number = isinstance(period, int | float | np.number) and not isinstance(period, bool)
    if not number or not PERIOD.minimum <= period < float("inf"):
        raise ParameterError(
            f"{block}: the sampling period {period!r} s is not a finite number from {PERIOD.minimum:g} s on; give the "
            f"time between two samples, or {instead}"
        )
    return dataclasses.replace(PERIOD, value=float(period))


def warned(block: Block, *, depth: int = 3) -> Block:
    """The block, with a warning for each check of its defaults that explains failures without refusing them.

    ``depth`` leads from here to who called for the block.
    """
    for check in block.failed_checks(block.parameter_values(), "failure"):
        warnings.warn(f"{block.name}: {check.message}", stacklevel=depth)
    return block


def sampled_inputs(chains: Chains, *, preview: bool) -> tuple[Input, ...]:
    """Inputs of the chains, and with ``preview`` the reference at the next sample."""
    ahead = (one for i in chains.numbers for one in references_ahead(chains, i)) if preview else ()
    return (*chains.inputs, *ahead)


def held_law(
    chains: Chains,
    reaching: Mapping[int, sp.Expr],
    c: Gains,
    surface_map: SurfaceMap,
    *,
    preview: bool,
    clock: Clock | None = None,
) -> tuple[tuple[Sample, ...], tuple[Output, ...]]:
    """Samples and outputs ``v[i]`` for which (S_i+ - S_i)/h is as given; samples of the clock where there is one."""
    law = {}
    for i, wanted in reaching.items():
        rest, gain = mean_rate(chains, i, c[i], surface_map, preview=preview)
        law[i] = (wanted - rest) / gain
    computed = chains.outer_inputs(law)
    samples = tuple(
        Sample(
            one.name,
            one.unit,
            f"{one.description}, held",
            one.expression,
            period=PERIOD.symbol,
            clock=clock.name if clock else "",
        )
        for one in computed
    )
    return samples, tuple(dataclasses.replace(one, expression=one.symbol) for one in computed)
