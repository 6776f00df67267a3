"""The scalar variables of an FMU: one table, with the value references that the C runtime computes from counts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import sympy as sp

from brunovsky.blocks import TIME, Block, Input, Mode, Output, Parameter, State, Variable
from brunovsky.blocks.units import derivative_unit
from brunovsky.errors import ModelError
from brunovsky.fmi.clocking import clocks_by_name
from brunovsky.fmi.indicators import indicators
from brunovsky.fmi.interfaces import has_model_exchange

STEP_SIZE = 1e-3
"""Default of ``step_size``, s; the same number is in the runtime."""

MIN_STEP_SIZE = 1e-9
_KINDS = ("parameters", "inputs", "outputs", "states", "samples", "modes")
SOLVERS = {"RK4": "classical Runge-Kutta, fixed step", "DormandPrince": "5(4), step by tolerance, events located"}


@dataclass(frozen=True)
class ScalarVariable:
    """One row of the table.

    Parameters
    ----------
    name, unit, description : str
        As in the block; ``der(NAME)`` for derivatives.
    reference : int
        Value reference.
    causality, variability, initial : str
        As in the standard; ``initial`` is empty where it has none.
    type : str
        ``"Real"``, ``"Integer"``, ``"Boolean"``, ``"Enumeration"`` or ``"Clock"``.
    start : float, optional
        For inputs and parameters.
    minimum, maximum : float, optional
        Range, where it is finite.
    nominal : float
        Magnitude that is typical of it, in its unit.
    expression : sympy.Basic, optional
        What an output, a derivative or an event indicator is calculated from; the symbol itself where the variable is
        one; the period of a clock.
    derivative_of : str
        For a derivative the name of its state.
    reinit : bool
        Whether a transition resets the state, where the FMU has model exchange.
    indicator : bool
        Whether it is an event indicator (a variable of its own in FMI 3).
    clocks : tuple of str
        Clocks at whose ticks alone the variable changes (FMI 3).
    """

    name: str
    reference: int
    causality: str = "local"
    variability: str = "continuous"
    initial: str = "calculated"
    type: str = "Real"
    unit: str = "1"
    description: str = ""
    start: float | None = None
    minimum: float | None = None
    maximum: float | None = None
    nominal: float = 1.0
    expression: sp.Basic | None = None
    derivative_of: str = ""
    reinit: bool = False
    indicator: bool = False
    clocks: tuple[str, ...] = ()


@lru_cache(maxsize=64)
def scalar_variables(block: Block, fmi_version: int = 2) -> tuple[ScalarVariable, ...]:
    """Table of all variables of the FMU of a block, in the order of their value references.

    An output that is a state, sample or mode of the same name appears once, as the output. Event indicators and
    clocks are variables in FMI 3 only; their value references come last, so that all others are those of FMI 2.

    Parameters
    ----------
    block : Block
        Any block or diagram.
    fmi_version : int
        2 or 3.

    Raises
    ------
    ModelError
        If the block uses a name that every FMU has: ``step_size``, ``solver``.
    """
    offsets = reference_offsets(block)
    shown = {one.name for one in block.outputs}
    transitions = block.transitions if has_model_exchange(block) else ()
    reset = {target for one in transitions for target in one.assign}
    table = [*_common(block)]
    table += [_parameter(one, offsets["parameters"] + i) for i, one in enumerate(block.parameters)]
    table += [_input(one, offsets["inputs"] + i) for i, one in enumerate(block.inputs)]
    table += [_output(block, one, offsets["outputs"] + i, reset) for i, one in enumerate(block.outputs)]
    for key in ("states", "samples", "modes"):
        for i, one in enumerate(getattr(block, key)):
            if one.name not in shown:
                table.append(_carrier(block, one, offsets[key] + i, reset))
    table += [_derivative(one, offsets["derivatives"] + i) for i, one in enumerate(block.states)]
    _check_names(block)
    if fmi_version == 2:
        return tuple(table)
    table += [
        ScalarVariable(
            one.name,
            offsets["indicators"] + i,
            unit=one.unit,
            description=one.description,
            expression=one.expression,
            indicator=True,
        )
        for i, one in enumerate(indicators(block))
    ]
    clocks = clocks_by_name(block)
    table = [_clocked(one, clocks) for one in table]
    table += [
        ScalarVariable(
            one.name,
            offsets["clocks"] + i,
            "input",
            "discrete",
            initial="",
            type="Clock",
            unit="s",
            description=one.description or one.name,
            expression=one.period,
        )
        for i, one in enumerate(block.clocks)
    ]
    return tuple(table)


def reference_offsets(block: Block) -> dict[str, int]:
    """First value reference of each kind of variable, and as ``"end"`` that after the last one; as in the runtime."""
    counts = [(key, len(getattr(block, key))) for key in _KINDS]
    counts += [
        ("derivatives", len(block.states)),
        ("indicators", len(indicators(block))),
        ("clocks", len(block.clocks)),
    ]
    offsets, base = {}, 3
    for key, count in counts:
        offsets[key] = base
        base += count
    return offsets | {"end": base}


def _check_names(block: Block) -> None:
    for one in block.variables:
        if one.name in ("step_size", "solver"):
            raise ModelError(f"{block.name}: '{one.name}' is a parameter that every FMU has; rename the variable")


def _common(block: Block) -> list[ScalarVariable]:
    time = ScalarVariable("time", 0, "independent", initial="", unit="s", description="time", expression=TIME)
    step = ScalarVariable(
        "step_size", 1, "parameter", "fixed", "exact",
        unit="s", description="longest internal step of RK4 in co-simulation", start=STEP_SIZE, minimum=MIN_STEP_SIZE,
    )  # fmt: skip
    solver = ScalarVariable(
        "solver", 2, "parameter", "fixed", "exact", "Enumeration", description="method of co-simulation", start=1
    )
    return [time, step, solver] if block.states else [time, step]


def _parameter(one: Parameter, reference: int) -> ScalarVariable:
    return replace(
        _described(one, reference),
        causality="parameter",
        variability="tunable" if one.tunable else "fixed",
        initial="exact",
        start=one.value,
        minimum=one.minimum if math.isfinite(one.minimum) else None,
        maximum=one.maximum if math.isfinite(one.maximum) else None,
    )


def _input(one: Input, reference: int) -> ScalarVariable:
    return replace(_described(one, reference), causality="input", initial="", start=one.start)


def _output(block: Block, one: Output, reference: int, reset: set[sp.Symbol]) -> ScalarVariable:
    carriers: tuple[Variable, ...] = (*block.states, *block.samples, *block.modes)
    carrier = next((item for item in carriers if item.symbol == one.expression), None)
    row = replace(_described(one, reference), causality="output", expression=one.expression)
    if carrier is not None and carrier.name == one.name:
        same = _carrier(block, carrier, reference, reset)
        return replace(row, type=same.type, variability=same.variability, reinit=same.reinit, nominal=same.nominal)
    if one.is_boolean:
        return replace(row, type="Boolean", variability="discrete")
    if isinstance(carrier, Mode):
        return replace(row, type="Integer", variability="discrete")
    held: tuple[Variable, ...] = (*block.parameters, *block.samples, *block.modes)
    discrete = {item.symbol for item in held} | {item.symbol for item in block.relations}
    return replace(row, variability="discrete" if one.expression.free_symbols <= discrete else "continuous")


def _carrier(block: Block, one: Variable, reference: int, reset: set[sp.Symbol]) -> ScalarVariable:
    row = replace(_described(one, reference), expression=one.symbol)
    if isinstance(one, State):
        return replace(row, reinit=one.symbol in reset)
    return replace(row, variability="discrete", type="Integer" if isinstance(one, Mode) else "Real")


def _derivative(one: State, reference: int) -> ScalarVariable:
    return ScalarVariable(
        f"der({one.name})",
        reference,
        unit=derivative_unit(one.unit, 1),
        description=f"time derivative of {one.name}",
        expression=one.derivative,
        derivative_of=one.name,
    )


def _clocked(one: ScalarVariable, clocks: Mapping[str, tuple[str, ...]]) -> ScalarVariable:
    return replace(one, clocks=clocks[one.name], variability="discrete") if one.name in clocks else one


def _described(one: Variable, reference: int) -> ScalarVariable:
    nominal = one.nominal if isinstance(one, Input | State | Output) else 1.0
    return ScalarVariable(one.name, reference, unit=one.unit, description=one.description or one.name, nominal=nominal)
