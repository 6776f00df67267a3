"""The scalar variables of an FMU: one table, with the value references that the C runtime computes from counts."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import sympy as sp

from brunovsky.blocks import TIME, Block, Input, Mode, Output, Parameter, Variable
from brunovsky.blocks.units import derivative_unit
from brunovsky.errors import ModelError

STEP_SIZE = 1e-3
"""Default of ``step_size``, s; the same number is in the runtime."""

MIN_STEP_SIZE = 1e-9
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
        ``"Real"``, ``"Integer"``, ``"Boolean"`` or ``"Enumeration"``.
    start : float, optional
        For inputs and parameters.
    minimum, maximum : float, optional
        Range, where it is finite.
    expression : sympy.Basic, optional
        What an output or a derivative is calculated from; the symbol itself where the variable is one.
    derivative_of : str
        For a derivative the name of its state.
    reinit : bool
        Whether a transition resets the state.
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
    expression: sp.Basic | None = None
    derivative_of: str = ""
    reinit: bool = False


def scalar_variables(block: Block) -> tuple[ScalarVariable, ...]:
    """Table of all variables of the FMU of a block, in the order of their value references.

    An output that is a state, sample or mode of the same name appears once, as the output.

    Raises
    ------
    ModelError
        If the block uses a name that every FMU has: ``step_size``, ``solver``.
    """
    base = 3
    offsets = {}
    for key in ("parameters", "inputs", "outputs", "states", "samples", "modes"):
        offsets[key] = base
        base += len(getattr(block, key))
    shown = {one.name for one in block.outputs}
    reset = {target for one in block.transitions for target in one.assign}
    table = [*_common(block)]
    table += [_parameter(one, offsets["parameters"] + i) for i, one in enumerate(block.parameters)]
    table += [_input(one, offsets["inputs"] + i) for i, one in enumerate(block.inputs)]
    table += [_output(block, one, offsets["outputs"] + i, reset) for i, one in enumerate(block.outputs)]
    for key in ("states", "samples", "modes"):
        for i, one in enumerate(getattr(block, key)):
            if one.name not in shown:
                table.append(_carrier(block, one, offsets[key] + i, reset))
    for i, one in enumerate(block.states):
        unit = derivative_unit(one.unit, 1)
        table.append(
            ScalarVariable(
                f"der({one.name})",
                base + i,
                unit=unit,
                description=f"time derivative of {one.name}",
                expression=one.derivative,
                derivative_of=one.name,
            )
        )
    _check_names(block)
    return tuple(table)


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
        return replace(row, type=same.type, variability=same.variability, reinit=same.reinit)
    if one.is_boolean:
        return replace(row, type="Boolean", variability="discrete")
    if isinstance(carrier, Mode):
        return replace(row, type="Integer", variability="discrete")
    held: tuple[Variable, ...] = (*block.parameters, *block.samples, *block.modes)
    discrete = {item.symbol for item in held} | {item.symbol for item in block.relations}
    return replace(row, variability="discrete" if one.expression.free_symbols <= discrete else "continuous")


def _carrier(block: Block, one: Variable, reference: int, reset: set[sp.Symbol]) -> ScalarVariable:
    row = replace(_described(one, reference), expression=one.symbol)
    if one in block.states:
        return replace(row, reinit=one.symbol in reset)
    return replace(row, variability="discrete", type="Integer" if isinstance(one, Mode) else "Real")


def _described(one: Variable, reference: int) -> ScalarVariable:
    return ScalarVariable(one.name, reference, unit=one.unit, description=one.description or one.name)
