"""Sensors between a plant and its inner loop: additive noise, sampling."""

from __future__ import annotations

from collections.abc import Sequence

from brunovsky.blocks.block import Block
from brunovsky.blocks.hardware import measured
from brunovsky.blocks.library.sampling import held_sample, hold_period
from brunovsky.blocks.variables import Input, Output, Variable, described
from brunovsky.errors import ModelError


def sensors(
    quantities: Sequence[Variable], *, noisy: bool = True, period: float | None = None, name: str = "sensors"
) -> Block:
    """Each quantity with additive noise, an input ``n[i]``; sampled and held where there is a period.

    Parameters
    ----------
    quantities : sequence of Variable, length n
        What is measured, with name, unit and description; ``plant_block`` has its states as outputs.
    noisy : bool
        Whether there are inputs ``n[i]``, in the units of the quantities, 0 unless given.
    period : float, optional
        Default of the fixed parameter ``sampling_period``, s; without it nothing is sampled.
    name : str
        Of the block.

    Returns
    -------
    Block
        Inputs ``x`` and outputs ``x_measured`` for each quantity ``x`` (``eta_measured[1]`` for ``eta[1]``), and
        ``n[i]``. For ``sensors`` of :func:`linearized_block`.

    Raises
    ------
    ModelError
        If nothing is measured.
    ParameterError
        If the period is not positive and finite.
    """
    if not quantities:
        raise ModelError(f"{name}: nothing to measure; give at least one quantity")
    noise = [
        Input(f"n[{i}]", one.unit, f"measurement noise of {one.name}") for i, one in enumerate(quantities, 1) if noisy
    ]
    sums = [one.symbol + (noise[i].symbol if noisy else 0) for i, one in enumerate(quantities)]
    shown = [measured(one) for one in quantities]
    sampled = period is not None
    return Block(
        name,
        "sensors" + (" with additive noise" if noisy else "") + (", sampled" if sampled else ""),
        inputs=(*(Input(**described(one)) for one in quantities), *noise),
        parameters=(hold_period(period, name),) if period is not None else (),
        samples=tuple(held_sample(one, value) for one, value in zip(shown, sums, strict=True) if sampled),
        outputs=tuple(
            Output(**described(one), expression=one.symbol if sampled else value)
            for one, value in zip(shown, sums, strict=True)
        ),
    )
