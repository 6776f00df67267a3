"""Simulation of a block from one call, as labelled arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from brunovsky._suggest import unknown_name
from brunovsky.blocks import Block, NumpyEngine, Output, Variable
from brunovsky.blocks.engine import Solver, step_count
from brunovsky.errors import ModelError, ParameterError, SimulationError
from brunovsky.native.engine import NativeEngine

if TYPE_CHECKING:
    import xarray as xr

Signal = float | ArrayLike | Callable[[float], float]
ENGINES: dict[str, type[NativeEngine] | type[NumpyEngine]] = {"native": NativeEngine, "numpy": NumpyEngine}


def simulate(
    block: Block,
    t_end: float,
    *,
    step_size: float = 1e-3,
    parameters: Mapping[str, float] | None = None,
    inputs: Mapping[str, Signal] | None = None,
    record: Sequence[str] | None = None,
    engine: Literal["native", "numpy"] = "native",
    solver: Solver = "rk4",
    tolerance: float = 1e-6,
) -> xr.Dataset:
    """Simulate a block from t = 0, with switching frozen over each step or located within it.

    Parameters
    ----------
    block : Block
        What to simulate. Start values are parameters (``x_start``, …).
    t_end : float
        Duration, s; cut into ``ceil(t_end/step_size)`` equal steps.
    step_size : float
        Longest step between recorded instants, s, over which inputs are held. RK4 takes no others.
    parameters : mapping of str to float, optional
        Values that replace defaults.
    inputs : mapping of str to float, array or function of time, optional
        Constant, one value for each instant (shape (n + 1,)), or a function evaluated there; held over each step.
    record : sequence of str, optional
        Outputs, states, samples and modes to return; by default all.
    engine : {"native", "numpy"}
        Compiled code, or the slow plain NumPy evaluation of the same block.
    solver : {"rk4", "dormand_prince"}
        Classical Runge-Kutta of order 4 with switching frozen over each step; or the embedded pair 5(4) of Dormand and
        Prince, which chooses its steps between the recorded instants and locates events within them.
    tolerance : float
        Of Dormand-Prince, 1e-13 to 1: relative error of a step; a hundredth of it is added as the absolute one, in
        the unit of each state.

    Returns
    -------
    xarray.Dataset
        One variable for each name over the coordinate ``time`` (n + 1 instants, s), with ``units`` and
        ``long_name``; Boolean outputs as bool, modes as int.

    Raises
    ------
    ParameterError
        For unknown names or solvers, values that are not finite or out of range, and arrays of the wrong length.
    SimulationError
        If a step fails; its ``trajectory`` is the Dataset until then.
    ModelError
        If ``block`` is not a block.
    CompilerError
        If the native engine finds no compiler.
    """
    if not isinstance(block, Block):
        raise ModelError(f"simulate takes a Block, not {block!r}; was a pair of parentheses forgotten?")
    if not all(isinstance(one, int | float) for one in (t_end, step_size)):
        raise ParameterError(f"t_end = {t_end!r} and step_size = {step_size!r} must be numbers, in s")
    if not (np.isfinite(t_end) and np.isfinite(step_size) and t_end > 0 and step_size > 0):
        raise ParameterError(f"t_end = {t_end} s and step_size = {step_size} s must be positive and finite")
    count = step_count(t_end, step_size)
    times = np.linspace(0.0, t_end, count + 1)
    recorded = _recorded(block)
    unknown = [name for name in record or () if name not in recorded]
    if unknown:
        raise ParameterError(f"{block.name} has {unknown_name('variable to record', unknown[0], recorded)}")
    values = block.parameter_values(parameters)
    table = _input_table(block, times, inputs or {})
    instance = ENGINES[engine](block, step_size, solver, tolerance)
    instance.set_parameters(values)
    instance.inputs = table[0]
    try:
        instance.initialize()
        rows = instance.run(table, t_end / count)
    except SimulationError as error:
        rows = error.rows if error.rows is not None else np.empty((0, len(block.outputs) + len(recorded)))
        error.trajectory = _dataset(recorded, times[: len(rows)], rows, record)
        raise
    return _dataset(recorded, times, rows, record)


def _recorded(block: Block) -> dict[str, tuple[int, Variable]]:
    """Column and variable of everything that can be recorded, by name; an output goes before the state it shows."""
    variables = (*block.outputs, *block.states, *block.samples, *block.modes)
    found: dict[str, tuple[int, Variable]] = {}
    for column, one in enumerate(variables):
        found.setdefault(one.name, (column, one))
    return found


def _input_table(block: Block, times: Any, inputs: Mapping[str, Signal]) -> Any:
    table = np.tile([one.start for one in block.inputs], (len(times), 1)).astype(float)
    columns = {one.name: index for index, one in enumerate(block.inputs)}
    for name, signal in inputs.items():
        if name not in columns:
            raise ParameterError(f"{block.name} has {unknown_name('input', name, columns)}")
        values = np.array([signal(time) for time in times]) if callable(signal) else np.asarray(signal, dtype=float)
        if values.shape not in ((), (len(times),)):
            raise ParameterError(
                f"input '{name}' has shape {values.shape}; give one value or {len(times)}, one an instant"
            )
        if not np.isfinite(values).all():
            raise ParameterError(f"input '{name}' is not finite at every instant")
        table[:, columns[name]] = values
    return table


def _dataset(
    recorded: Mapping[str, tuple[int, Variable]], times: Any, rows: Any, record: Sequence[str] | None
) -> xr.Dataset:
    data = {}
    for name in record or recorded:
        column, one = recorded[name]
        values = rows[:, column]
        if isinstance(one, Output) and one.is_boolean:
            values = values.astype(bool)
        data[name] = ("time", values.copy(), {"units": one.unit, "long_name": one.description})
    import xarray as xr  # takes as long as all of this package; only results need it

    return xr.Dataset(data, coords={"time": ("time", times, {"units": "s"})})
