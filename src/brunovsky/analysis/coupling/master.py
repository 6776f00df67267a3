"""The loop over communication points, for components of any origin behind the calls of fmpy's ``FMU2Slave``."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from brunovsky.analysis.coupling.scheme import Array, Scheme, shifted
from brunovsky.fmi.ssp.wiring import SYSTEM, Port, Wire


class Part:
    """A component in initialisation mode, with the signals it exchanges: rows are derivatives, columns variables.

    Parameters
    ----------
    name : str
        Of the component.
    fmu : object
        Instance with the methods of ``fmpy.fmi2.FMU2Slave``; it is the caller's to free.
    references : mapping of str to int
        Value references of its variables.
    outputs : mapping of str to sequence of str
        Outputs of each component that are real numbers.
    wires : sequence of Wire
        Of the whole system; those that begin at the system itself set inputs from outside.
    inputs : sequence of str
        Names of the inputs of the system.
    order : int
        How many derivatives are exchanged.
    """

    def __init__(
        self,
        name: str,
        fmu: Any,
        references: Mapping[str, int],
        outputs: Mapping[str, Sequence[str]],
        wires: Sequence[Wire],
        inputs: Sequence[str] = (),
        order: int = 0,
    ) -> None:
        self.name, self.fmu, self.references, self.order = name, fmu, references, order
        entering = [one for one in wires if one.target[0] == name and one.source[0] != SYSTEM]
        self.sources = [one.source for one in entering]
        self.inputs = [references[one.target[1]] for one in entering]
        self.columns = {variable: column for column, variable in enumerate(outputs[name])}
        self.outputs = [references[variable] for variable in outputs[name]]
        self.driving = sorted(
            {self.columns[one.source[1]] for one in wires if one.source[0] == name and one.target[0] != SYSTEM}
        )
        self.sources_by_part: dict[str, tuple[list[int], list[int]]] = {}
        for index, (source, variable) in enumerate(self.sources):
            targets, columns = self.sources_by_part.setdefault(source, ([], []))
            targets.append(index)
            columns.append(list(outputs[source]).index(variable))
        outside = [
            one for one in wires if one.target[0] == name and one.source[0] == SYSTEM and one.source[1] in inputs
        ]
        self.outside = [references[one.target[1]] for one in outside]
        self.outside_columns = [list(inputs).index(one.source[1]) for one in outside]
        self.signals: Array = np.zeros((order + 1, len(self.outputs)))

    def set_outside(self, values: Array) -> None:
        """Inputs that come from outside the system, which are held over a step."""
        if self.outside:
            self.fmu.setReal(self.outside, values[self.outside_columns].tolist())

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

    def value(self, variable: str) -> float:
        """Value of an output as it was read last; 0 or 1 where it is Boolean."""
        if variable in self.columns:
            return float(self.signals[0, self.columns[variable]])
        return float(self.fmu.getBoolean([self.references[variable]])[0])


def coupled_rows(
    parts: Mapping[str, Part],
    times: Array,
    scheme: Scheme,
    shown: Sequence[Port],
    outside: Array | None = None,
) -> Iterator[list[float]]:
    """Outputs at one communication point after the other; what a component raises passes through.

    Parameters
    ----------
    parts : mapping of str to Part
        In the order in which they are stepped; all in initialisation mode.
    times : ndarray, shape (k + 1,)
        Communication points, s.
    scheme : {"jacobi", "gauss_seidel"}
        All components at once, or one after the other.
    shown : sequence of Port
        Component and variable of each output.
    outside : ndarray, shape (k + 1, number of inputs), optional
        Inputs of the system at each point, held over the step that begins there.

    Yields
    ------
    list of float
        Values of `shown`.
    """
    table = np.zeros((len(times), 0)) if outside is None else outside
    _settle(parts, table[0])
    yield [parts[name].value(variable) for name, variable in shown]
    for index, (begin, end) in enumerate(pairwise(times)):
        for part in parts.values():
            part.set_outside(table[index])
        _step(parts, scheme, float(begin), float(end - begin))
        yield [parts[name].value(variable) for name, variable in shown]


def stepping_order(components: Sequence[str], direct: Collection[tuple[str, str]]) -> tuple[str, ...]:
    """Order in which components step in sequence: each after those that drive it directly, else as they are given.

    Parameters
    ----------
    components : sequence of str
        In the order that holds where nothing else is known; also where direct connections close a loop.
    direct : collection of (str, str)
        Source and target of connections without a state behind them: they carry what the source was given just before.
    """
    left, order = list(components), list[str]()
    while left:
        ready = (one for one in left if not any((other, one) in direct for other in left if other != one))
        order.append(next(ready, left[0]))
        left.remove(order[-1])
    return tuple(order)


def _collected(part: Part, parts: Mapping[str, Part], shifts: Mapping[str, float]) -> Array:
    """Signals of the inputs of a part at the beginning of its step; ``shifts`` from where their source is, s."""
    signals = np.empty((part.order + 1, len(part.sources)))
    for source, (targets, columns) in part.sources_by_part.items():
        signals[:, targets] = shifted(parts[source].signals[:, columns], shifts.get(source, 0.0))
    return signals


def _settle(parts: Mapping[str, Part], outside: Array) -> None:
    """Exchange until inputs agree: as often as there are parts for values, and again for each derivative."""
    for part in parts.values():
        part.set_outside(outside)
    sweeps = len(parts)
    for derivative in range(max(one.order for one in parts.values()) + 1):
        for _ in range(sweeps):
            for part in parts.values():
                part.set_inputs(_collected(part, parts, {}), derivative)
                part.read(derivative)
        if derivative == 0:
            for part in parts.values():
                part.fmu.exitInitializationMode()


def _step(parts: Mapping[str, Part], scheme: Scheme, begin: float, length: float) -> None:
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
