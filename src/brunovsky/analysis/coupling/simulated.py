"""A master in a few lines: the components of a diagram as FMUs in this process, coupled at communication points."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

import numpy as np

from brunovsky.analysis._checks import finite_scalar
from brunovsky.analysis.coupling.master import Part, coupled_rows
from brunovsky.analysis.coupling.scheme import Scheme, check_scheme
from brunovsky.blocks import Diagram
from brunovsky.errors import ModelError, SimulationError
from brunovsky.fmi import ComponentError, component
from brunovsky.fmi.ssp.wiring import SYSTEM, Wiring, wiring

if TYPE_CHECKING:
    import xarray as xr


def coupled_simulation(
    diagram: Diagram,
    t_end: float,
    communication_step: float,
    *,
    scheme: Scheme = "jacobi",
    order: int = 0,
    step_size: float = 1e-3,
    parameters: Mapping[str, float] | None = None,
) -> xr.Dataset:
    """Simulate a diagram as a master couples its FMUs: values are exchanged at communication points alone.

    Each component is the FMU of its block (FMI 2.0, co-simulation, in process). Before the first step outputs are
    exchanged until all inputs agree with them, as initialisation mode admits.

    Parameters
    ----------
    diagram : Diagram
        Of two components or more; its components are stepped in the order of their declaration.
    t_end : float
        Duration, s; cut into ``ceil(t_end/communication_step - 1e-9)`` equal steps.
    communication_step : float
        Longest communication step, s.
    scheme : {"jacobi", "gauss_seidel"}
        All components at once, or one after the other.
    order : int
        How many derivatives of each signal are exchanged as well, 0 to 3; 0 holds inputs over a step.
    step_size : float
        Longest internal step of each component, s.
    parameters : mapping of str to float, optional
        Values that replace the diagram's defaults.

    Returns
    -------
    xarray.Dataset
        Outputs of the diagram at the communication points (coordinate ``time``, s), with ``units``; what has no input
        behind it keeps its start value.

    Raises
    ------
    ModelError
        If it is no diagram of two components or more, or a component has clocks.
    ParameterError
        For unknown schemes, orders and parameters, and durations or steps that are not positive.
    SimulationError
        If a component refuses a call: a step that fails, or fewer derivatives than `order`; ``trajectory`` holds what
        there was until then, None before the first step.

    References
    ----------
    M. Arnold, C. Clauß and T. Schierz, "Error analysis and error estimates for co-simulation in FMI for model exchange
    and co-simulation v2.0", Archive of Mechanical Engineering 60(1), 75-94, 2013, doi:10.2478/meceng-2013-0005.
    """
    where = "coupled_simulation"
    longest = check_scheme(scheme, order, communication_step, where)
    duration = finite_scalar(t_end, "t_end", where, minimum=0.0, strict=True)
    inner = finite_scalar(step_size, "step_size", where, minimum=0.0, strict=True)
    if not isinstance(diagram, Diagram) or len(diagram.components) < 2:
        raise ModelError(
            f"{where} takes a Diagram of two components or more, not {diagram!r}; br.simulate takes others"
        )
    count = int(np.ceil(duration / longest - 1e-9))
    plan = wiring(diagram, 2, True)
    values = diagram.parameter_values(parameters)
    with ExitStack() as stack:
        parts = {name: _part(name, diagram, plan, values, inner, order, stack) for name in diagram.components}
        behind = {one.target[1]: one.source for one in plan.wires if one.target[0] == SYSTEM}
        times = np.linspace(0.0, duration, count + 1)
        rows: list[list[float]] = []
        try:
            for row in coupled_rows(parts, times, scheme, [behind[one.name] for one in diagram.outputs]):
                rows.append(row)
        except ComponentError as error:
            time = float(times[max(len(rows) - 1, 0)])
            failure = SimulationError(f"{where}: {error}", block=diagram.name, time=time)
            failure.trajectory = _dataset(diagram, times[: len(rows)], rows) if rows else None
            raise failure from None
    return _dataset(diagram, times, rows)


def _part(
    name: str,
    diagram: Diagram,
    plan: Wiring,
    values: Mapping[str, float],
    step_size: float,
    order: int,
    stack: ExitStack,
) -> Part:
    """A component in process, in initialisation mode with its parameters set."""
    fmu: Any = stack.enter_context(component(diagram.components[name]))
    starts = {
        variable: values[key] for key, ports in plan.parameters.items() for part, variable in ports if part == name
    }
    starts["step_size"] = step_size
    outputs = {
        key: [one.name for one in block.outputs if not one.is_boolean] for key, block in diagram.components.items()
    }
    part = Part(name, fmu, fmu.references, outputs, plan.wires, order=order)
    fmu.setReal([fmu.references[key] for key in starts], list(starts.values()))
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    return part


def _dataset(diagram: Diagram, times: Any, rows: list[list[float]]) -> xr.Dataset:
    import xarray as xr

    table = np.array(rows)
    data = {
        one.name: ("time", table[:, i] > 0 if one.is_boolean else table[:, i], {"units": one.unit})
        for i, one in enumerate(diagram.outputs)
    }
    return xr.Dataset(data, {"time": ("time", np.asarray(times), {"units": "s"})})
