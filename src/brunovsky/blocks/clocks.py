"""Clocks of a block: what they must satisfy, and the samples that take their period from them."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import sympy as sp

from brunovsky._suggest import unknown_name
from brunovsky.blocks.variables import Clock, Parameter, Sample
from brunovsky.errors import ModelError


def checked_clocks(
    block: str, clocks: Sequence[Clock], parameters: Sequence[Parameter], samples: Sequence[Sample]
) -> tuple[Clock, ...]:
    """Clocks with their periods as expressions; ``block`` is the name for messages.

    Raises
    ------
    ModelError
        If a period is neither a positive number nor the symbol of a fixed parameter with a positive value, or if a
        clock has no samples.
    """
    used = {one.clock for one in samples}
    for one in clocks:
        if one.name not in used:
            raise ModelError(
                f"{block}: the clock '{one.name}' has no samples; write Sample(…, clock='{one.name}'), or leave it out"
            )
    return tuple(dataclasses.replace(one, period=_period(block, one, parameters)) for one in clocks)


def _period(block: str, clock: Clock, parameters: Sequence[Parameter]) -> sp.Expr:
    where = f"{block}: the period of clock '{clock.name}'"
    try:
        period = sp.sympify(clock.period)
        number = float(period) if period.is_number else None
    except (sp.SympifyError, TypeError, ValueError, AttributeError):
        raise ModelError(
            f"{where} is {clock.period!r}, not a positive number or the symbol of a fixed parameter"
        ) from None
    if number is None:
        owner = next((one for one in parameters if one.symbol == period), None)
        if owner is None:
            raise ModelError(f"{where} is {period}, not a positive number or the symbol of a parameter of the block")
        if owner.tunable:
            raise ModelError(f"{where} is the tunable parameter '{owner.name}'; a period must be fixed")
        number = owner.value
    if not 0 < number < float("inf"):
        raise ModelError(f"{where} is {number:g} s; it must be positive and finite")
    return period


def clocked_samples(block: str, samples: Sequence[Sample], clocks: Sequence[Clock]) -> tuple[Sample, ...]:
    """Samples, each that names a clock with the clock's period.

    Raises
    ------
    ModelError
        If the clock is unknown, or the sample has a period that is not the clock's.
    """
    periods = {one.name: one.period for one in clocks}

    def resolved(one: Sample) -> Sample:
        if not one.clock:
            return one if one.period is not None else dataclasses.replace(one, period=sp.S.One)
        if one.clock not in periods:
            raise ModelError(f"{block}: sample '{one.name}' has {unknown_name('clock', one.clock, periods)}")
        period = periods[one.clock]
        if one.period is not None and sp.sympify(one.period) != period:
            raise ModelError(
                f"{block}: sample '{one.name}' has the clock '{one.clock}' and the period {one.period} as well; "
                "leave the period out, it is the clock's"
            )
        return dataclasses.replace(one, period=period)

    return tuple(resolved(one) for one in samples)
