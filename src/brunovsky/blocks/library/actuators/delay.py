"""Actuators behind a transport delay: what a controller commands arrives later, unchanged."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import sympy as sp
from numpy.typing import ArrayLike

from brunovsky.blocks.block import Block
from brunovsky.blocks.hardware import command
from brunovsky.blocks.library.actuators.values import one_for_each
from brunovsky.blocks.library.sampling import hold_period
from brunovsky.blocks.linearized import start_parameter
from brunovsky.blocks.variables import TIME, Check, Input, Output, Parameter, Sample, Variable, described, symbol
from brunovsky.errors import ModelError, ParameterError

LEAST_DELAY = 1e-6
MOST_CELLS = 1000
_PARTS = 100  # of a sampling period, into which a delay of held commands may fall
_ROUNDING = 1e-9


def actuator_delays(
    actuators: Sequence[Variable],
    delays: ArrayLike = 0.01,
    *,
    cells: int = 10,
    period: float | None = None,
    name: str = "actuator_delays",
) -> Block:
    """Commands that act after a delay, u(t) = u_command(t - delay), and before it has passed u = u_start.

    A shift register keeps the commands of N + 1 instants, delay/N apart. At these instants the delay is exact; between
    them the command is interpolated linearly, which is what differs from a true delay: at the angular frequency w the
    gain is lower by (w delay/N)^2/12, the phase is exact, and a jump is spread over delay/N.

    Of commands that are held between samples (`period`) the register keeps what is held and interpolates nothing: they
    are delayed exactly. The delay must then be N/m periods with whole numbers N and m.

    Parameters
    ----------
    actuators : sequence of Variable, length m
        As for :func:`actuator_lags`.
    delays : float, or sequence of float, shape (m,)
        Defaults of the fixed parameters ``delay[i]``, s. An actuator whose delay is 0 has none.
    cells : int
        N, for commands that are not held.
    period : float, optional
        Default of the fixed parameter ``sampling_period`` at which the commands are held, s.
    name : str
        Of the block.

    Returns
    -------
    Block
        Inputs ``u_command`` and outputs ``u`` for each actuator ``u``; parameters ``delay[i]`` and ``u_start``.

    Raises
    ------
    ModelError
        If there is no actuator, not one delay for each, or N is not a positive whole number up to 1000.
    ParameterError
        If a delay or the period is negative or not finite, or a delay is no simple multiple of the period.

    References
    ----------
    K. J. Åström and B. Wittenmark, *Computer-Controlled Systems*, 3rd ed., 1997, on systems with time delay.
    """
    if isinstance(cells, bool) or not isinstance(cells, int) or not 1 <= cells <= MOST_CELLS:
        raise ModelError(f"{name}: cells = {cells!r}; give a whole number from 1 to {MOST_CELLS}")
    remedy = f"give delays in s from {LEAST_DELAY:g} on, 0 for an actuator without"
    values = one_for_each(actuators, delays, "delays", name, remedy, finite=True)
    held = hold_period(period, name) if period is not None else None
    parameters: list[Parameter] = []
    samples: list[Sample] = []
    outputs: list[Output] = []
    checks: list[Check] = []
    for i, (one, value) in enumerate(zip(actuators, values, strict=True), 1):
        shown: sp.Expr = command(one).symbol
        if 0.0 < value < LEAST_DELAY:
            raise ParameterError(f"{name}: delays has {value:g} s; {remedy}")
        if value > 0.0:
            delay = Parameter(f"delay[{i}]", "s", f"transport delay of {one.name}", value, LEAST_DELAY)
            parameters += [start_parameter(one), delay]
            ratio = Fraction(cells) if held is None else _ratio(value, held.value, name)
            register = _Register(one, i, delay, ratio.numerator, interpolated=held is None)
            samples += register.samples
            shown = register.output
            if held is not None:
                checks.append(_alignment(delay, held, ratio))
        outputs.append(Output(**described(one) | {"description": f"{one.description}, as it acts"}, expression=shown))
    return Block(
        name,
        "actuators behind a transport delay",
        inputs=tuple(Input(**described(command(one))) for one in actuators),
        parameters=(*parameters, *((held,) if held is not None and samples else ())),
        samples=tuple(samples),
        outputs=tuple(outputs),
        checks=tuple(checks),
    )


class _Register:
    """Shift register of the commands at the last N + 1 instants; the newest stands first."""

    def __init__(self, one: Variable, i: int, delay: Parameter, count: int, *, interpolated: bool) -> None:
        period = delay.symbol / count
        cells = [symbol(f"delayed[{i},{k}]") for k in range(1, count + 2)]
        sources = [command(one).symbol, *cells[:-1]]
        start = start_parameter(one).symbol
        self.samples = [
            Sample(
                f"delayed[{i},{k}]", one.unit, f"{one.description}, commanded {k - 1} instants before the last",
                nominal=one.nominal, update=source, start=start, period=period,
            )
            for k, source in enumerate(sources, 1)
        ]  # fmt: skip
        self.output: sp.Expr = cells[-1]
        if interpolated:
            instant = Sample(
                f"delayed_since[{i}]", "s", f"last instant of the register of {one.name}", update=TIME, period=period
            )
            self.samples.append(instant)
            self.output = cells[-1] + (TIME - instant.symbol) / period * (cells[-2] - cells[-1])


def _ratio(delay: float, period: float, name: str) -> Fraction:
    """Delay over period as a fraction of small numbers."""
    ratio = Fraction(delay / period).limit_denominator(_PARTS)
    if abs(ratio * period - delay) > _ROUNDING * delay or not 0 < ratio.numerator <= MOST_CELLS:
        raise ParameterError(
            f"{name}: a delay of {delay:g} s does not fit commands held for {period:g} s; give a multiple of the "
            f"period, or of a whole part of it (up to {_PARTS}), of no more than {MOST_CELLS} parts"
        )
    return ratio


def _alignment(delay: Parameter, period: Parameter, ratio: Fraction) -> Check:
    difference = ratio.denominator * delay.symbol - ratio.numerator * period.symbol
    return Check(
        "delay",
        sp.Abs(difference) <= _ROUNDING * delay.symbol,
        f"{delay.name} is not {ratio} of {period.name}, which the block was made for; change both, or make it anew",
    )
