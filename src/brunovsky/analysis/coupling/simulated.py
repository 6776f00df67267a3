"""A master in a few lines: the components of a diagram as FMUs in this process, coupled at communication points."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from brunovsky.analysis._checks import finite_scalar
from brunovsky.analysis.coupling.scheme import Array, Scheme, check_scheme, shifted
from brunovsky.blocks import Diagram
from brunovsky.errors import ModelError, SimulationError
from brunovsky.fmi import ComponentError, component
from brunovsky.fmi.ssp.wiring import Wiring, wiring

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
        parts = {
            name: stack.enter_context(_Part(name, diagram, plan, values, inner, order)) for name in diagram.components
        }
        times = np.linspace(0.0, duration, count + 1)
        rows: list[list[float]] = []
        try:
            _settle(parts, order)
            rows.append(_row(diagram, parts))
            for begin, end in pairwise(times):
                _step(parts, scheme, float(begin), float(end - begin))
                rows.append(_row(diagram, parts))
        except ComponentError as error:
            time = float(times[max(len(rows) - 1, 0)])
            failure = SimulationError(f"{where}: {error}", block=diagram.name, time=time)
            failure.trajectory = _dataset(diagram, times[: len(rows)], rows) if rows else None
            raise failure from None
    return _dataset(diagram, times, rows)


class _Part:
    """A running component with the signals it exchanges: rows are derivatives, columns variables."""

    def __init__(
        self, name: str, diagram: Diagram, plan: Wiring, values: Mapping[str, float], step_size: float, order: int
    ) -> None:
        self.name, self.order = name, order
        self.fmu = component(diagram.components[name])
        references = self.fmu.references
        starts = {
            variable: values[key] for key, ports in plan.parameters.items() for part, variable in ports if part == name
        }
        starts["step_size"] = step_size
        wires = [one for one in plan.wires if one.target[0] == name and one.source[0]]
        self.sources = [one.source for one in wires]
        self.inputs = [references[one.target[1]] for one in wires]
        real = _real_outputs(diagram, name)
        self.columns = {variable: column for column, variable in enumerate(real)}
        self.outputs = [references[variable] for variable in real]
        self.driving = sorted(
            {self.columns[one.source[1]] for one in plan.wires if one.source[0] == name and one.target[0]}
        )
        self.sources_by_part: dict[str, tuple[list[int], list[int]]] = {}
        for index, (source, variable) in enumerate(self.sources):
            targets, columns = self.sources_by_part.setdefault(source, ([], []))
            targets.append(index)
            columns.append(_real_outputs(diagram, source).index(variable))
        self.signals: Array = np.zeros((order + 1, len(real)))
        self.fmu.setReal([references[key] for key in starts], list(starts.values()))
        self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()

    def __enter__(self) -> _Part:
        return self

    def __exit__(self, *_error: object) -> None:
        self.fmu.freeInstance()

    def set_inputs(self, signals: Array, order: int) -> None:
        """Values of the inputs, and `order` derivatives."""
        if not self.inputs:
            return
        self.fmu.setReal(self.inputs, signals[0].tolist())
        for row in range(1, order + 1):
            self.fmu.setRealInputDerivatives(self.inputs, [row] * len(self.inputs), signals[row].tolist())

    def read(self, order: int) -> None:
        """Values of the outputs, and `order` derivatives of those that drive others."""
        if self.outputs:
            self.signals[0] = self.fmu.getReal(self.outputs)
        references = [self.outputs[column] for column in self.driving]
        for row in range(1, order + 1 if references else 1):
            self.signals[row, self.driving] = self.fmu.getRealOutputDerivatives(references, [row] * len(references))


def _real_outputs(diagram: Diagram, name: str) -> list[str]:
    return [one.name for one in diagram.components[name].outputs if not one.is_boolean]


def _collected(part: _Part, parts: Mapping[str, _Part], shifts: Mapping[str, float]) -> Array:
    """Signals of the inputs of a part at the beginning of its step; ``shifts`` from where their source is, s."""
    signals = np.empty((part.order + 1, len(part.sources)))
    for source, (targets, columns) in part.sources_by_part.items():
        signals[:, targets] = shifted(parts[source].signals[:, columns], shifts.get(source, 0.0))
    return signals


def _settle(parts: Mapping[str, _Part], order: int) -> None:
    """Exchange until inputs agree: as often as there are parts for values, and again for each derivative."""
    sweeps = len(parts)
    for derivative in range(order + 1):
        for _ in range(sweeps):
            for part in parts.values():
                part.set_inputs(_collected(part, parts, {}), derivative)
                part.read(derivative)
        if derivative == 0:
            for part in parts.values():
                part.fmu.exitInitializationMode()


def _step(parts: Mapping[str, _Part], scheme: Scheme, begin: float, length: float) -> None:
    if scheme == "jacobi":
        for part, signals in [(one, _collected(one, parts, {})) for one in parts.values()]:
            part.set_inputs(signals, part.order)
        for part in parts.values():
            part.fmu.doStep(currentCommunicationPoint=begin, communicationStepSize=length)
        for part in parts.values():
            part.read(part.order)
        return
    ahead: dict[str, float] = {}
    for name, part in parts.items():
        part.set_inputs(_collected(part, parts, ahead), part.order)
        part.fmu.doStep(currentCommunicationPoint=begin, communicationStepSize=length)
        part.read(part.order)
        ahead[name] = -length


def _row(diagram: Diagram, parts: Mapping[str, _Part]) -> list[float]:
    row = []
    for one in diagram.outputs:
        behind = diagram.exports[one.name][0]
        name = max((key for key in parts if behind.startswith(f"{key}.")), key=len)
        part, variable = parts[name], behind.removeprefix(f"{name}.")
        if variable in part.columns:
            row.append(float(part.signals[0, part.columns[variable]]))
        else:
            row.append(float(part.fmu.getBoolean([part.fmu.references[variable]])[0]))
    return row


def _dataset(diagram: Diagram, times: Any, rows: list[list[float]]) -> xr.Dataset:
    import xarray as xr

    table = np.array(rows)
    data = {
        one.name: ("time", table[:, i] > 0 if one.is_boolean else table[:, i], {"units": one.unit})
        for i, one in enumerate(diagram.outputs)
    }
    return xr.Dataset(data, {"time": ("time", np.asarray(times), {"units": "s"})})
