"""Actuators with first-order lags: what a controller commands arrives late."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import sympy as sp
from numpy.typing import ArrayLike

from brunovsky.blocks.block import Block
from brunovsky.blocks.hardware import command
from brunovsky.blocks.library.actuators.values import one_for_each
from brunovsky.blocks.linearized import start_parameter
from brunovsky.blocks.variables import Check, Input, Output, Parameter, State, Variable, described
from brunovsky.errors import ModelError


def actuator_lags(
    actuators: Sequence[Variable], lags: ArrayLike = 0.005, *, number: int = 1, name: str = "actuator_lags"
) -> Block:
    """Behind each command, first-order lags in series: x_1' = (command - x_1)/lag, x_2' = (x_1 - x_2)/lag, ...

    Parameters
    ----------
    actuators : sequence of Variable, length m
        The plant's inputs, with name, unit and description; ``plant_block`` has them as its inputs.
    lags : float, or sequence of float, shape (m,)
        Defaults of the time constants, in s. An actuator whose lag is 0 has none: its command passes.
    number : int
        How many equal lags each actuator has, in series.
    name : str
        Of the block.

    Returns
    -------
    Block
        Inputs ``u_command`` and outputs ``u`` for each actuator ``u`` (``u_command[1]`` for ``u[1]``); parameters
        ``lag[i]`` of the i-th actuator (s, above 0) and ``u_start``, at which all its lags are at rest. For
        ``actuators`` of :func:`linearized_block`.

    Raises
    ------
    ModelError
        If there is no actuator, `number` is not positive, or there is not one lag for each actuator.
    ParameterError
        If a lag is negative or not finite.

    References
    ----------
    K. J. Åström and R. M. Murray, *Feedback Systems*, 2008, doi:10.1515/9781400828739, on first-order systems.
    """
    if isinstance(number, bool) or not isinstance(number, int) or number < 1:
        raise ModelError(f"{name}: {number!r} lag(s) for each actuator; give at least one")
    remedy = "give time constants in s, 0 for an actuator without"
    values = one_for_each(actuators, lags, "lags", name, remedy, finite=True)
    constants, starts, states, outputs = [], [], [], []
    for i, (one, value) in enumerate(zip(actuators, values, strict=True), 1):
        last: sp.Expr = command(one).symbol
        if value > 0.0:
            constants.append(Parameter(f"lag[{i}]", "s", f"time constant of the lag of {one.name}", value, 0.0))
            starts.append(start_parameter(one))
            for stage in range(1, number + 1):
                derivative = (last - _stage(one, stage, number).symbol) / constants[-1].symbol
                states.append(_state(_stage(one, stage, number), derivative, starts[-1].symbol))
                last = states[-1].symbol
        outputs.append(Output(**described(one) | {"description": f"{one.description}, as it acts"}, expression=last))
    return Block(
        name,
        f"actuators with {'a first-order lag' if number == 1 else f'{number} equal first-order lags in series'}",
        inputs=tuple(Input(**described(other)) for other in map(command, actuators)),
        parameters=(*starts, *constants),
        states=tuple(states),
        outputs=tuple(outputs),
        checks=tuple(
            Check("lag", one.symbol > 0, f"{one.name} = 0 divides by zero; make the block with lag 0 to have none")
            for one in constants
        ),
    )


def _stage(one: Variable, stage: int, number: int) -> Variable:
    """Output of a lag in the series; the last is the actuator's own."""
    if stage == number:
        return one
    stem, bracket, indices = one.name.partition("[")
    return dataclasses.replace(
        one, name=f"{stem}_stage{stage}{bracket}{indices}", description=f"{one.description}, after lag {stage}"
    )


def _state(one: Variable, derivative: sp.Expr, start: sp.Expr) -> State:
    return State(**described(one), derivative=derivative, start=start)
