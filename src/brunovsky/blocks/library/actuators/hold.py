"""Actuators that get a new command only at samples."""

from __future__ import annotations

from collections.abc import Sequence

from brunovsky.blocks.block import Block
from brunovsky.blocks.hardware import command
from brunovsky.blocks.library.sampling import held_sample, hold_period
from brunovsky.blocks.variables import Input, Output, Variable, described
from brunovsky.errors import ModelError


def actuator_holds(actuators: Sequence[Variable], period: float = 0.01, *, name: str = "actuator_holds") -> Block:
    """Commands held between samples: u(t) = u_command(k h) for k h <= t < (k + 1) h.

    Parameters
    ----------
    actuators : sequence of Variable, length m
        As for :func:`actuator_lags`.
    period : float
        Default of the fixed parameter ``sampling_period`` h, s.
    name : str
        Of the block.

    Returns
    -------
    Block
        Inputs ``u_command`` and outputs ``u`` for each actuator ``u``.

    Raises
    ------
    ModelError
        If there is no actuator.
    ParameterError
        If the period is not positive and finite.
    """
    if not actuators:
        raise ModelError(f"{name}: there is no actuator; give at least one")
    return Block(
        name,
        "actuators that get their commands sampled",
        inputs=tuple(Input(**described(command(one))) for one in actuators),
        parameters=(hold_period(period, name),),
        samples=tuple(held_sample(one, command(one).symbol) for one in actuators),
        outputs=tuple(Output(**described(one), expression=one.symbol) for one in actuators),
    )
