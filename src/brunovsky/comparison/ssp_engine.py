"""The third engine: components of a loop as FMUs of a package, coupled at communication points."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from brunovsky.analysis.coupling.master import Part, coupled_rows, stepping_order
from brunovsky.analysis.coupling.scheme import Array, Scheme
from brunovsky.blocks.engine import step_count
from brunovsky.comparison.engines import Outcome, Status, failed, hashes_of, labelled
from brunovsky.comparison.opened import OpenedFmu, check_variables, open_fmu, recorded, release, unusable
from brunovsky.comparison.study import Loop, PlannedRun
from brunovsky.errors import StudyError
from brunovsky.fmi.checks.unpacking import unpack_ssp
from brunovsky.fmi.ssp.reading import SystemStructure, read_structure
from brunovsky.fmi.ssp.wiring import SYSTEM, Port


@dataclass(frozen=True)
class OpenedSsp:
    """A package that is unpacked for several runs.

    Attributes
    ----------
    path : Path
        The package.
    structure : SystemStructure
        What it says.
    fmus : mapping of str to OpenedFmu
        Its components, in the order in which they are stepped in sequence.
    """

    path: Path
    structure: SystemStructure
    fmus: Mapping[str, OpenedFmu]

    @property
    def shown(self) -> dict[str, Port]:
        """Component and variable behind each output of the system that is a real number or Boolean."""
        wires = (one for one in self.structure.wires if one.target[0] == SYSTEM)
        return {one.target[1]: one.source for one in wires if self.type_of(one.source) in ("Real", "Boolean")}

    def type_of(self, port: Port) -> str:
        """Type of a variable of a component, as fmpy has it."""
        return str(self.fmus[port[0]].variables[port[1]].type)

    @property
    def inputs(self) -> list[str]:
        """Inputs of the system that drive a component."""
        return list(dict.fromkeys(one.source[1] for one in self.structure.wires if one.source[0] == SYSTEM))

    def settable(self, name: str) -> tuple[Port, ...]:
        """Parameters of components that a parameter of the system sets."""
        return tuple((key, one) for key, one in self.structure.ports(name) if one in self.fmus[key].parameters)

    def starts(self, planned: PlannedRun) -> dict[Port, float]:
        """What is set before a run: what the package binds, then the study's values through its mapping."""
        found = dict(self.structure.values)
        for name, value in planned.parameters.items():
            found |= dict.fromkeys(self.settable(name), value)
        return found | {
            (key, "step_size"): planned.step_size for key, one in self.fmus.items() if "step_size" in one.parameters
        }


@dataclass(frozen=True)
class SspSimulation:
    """Packages of the planned loops, in a master of our own.

    Parameters
    ----------
    packages : mapping of Loop to OpenedSsp
        See :func:`opened_ssps`.
    communication_step : float
        Longest step over which inputs are held, s.
    scheme : {"jacobi", "gauss_seidel"}
        All components at once, or in sequence.
    own : bool
        Whether the packages are the user's own.
    """

    packages: Mapping[Loop, OpenedSsp]
    communication_step: float
    scheme: Scheme
    own: bool = False
    name: str = "ssp"

    def halved(self) -> SspSimulation:
        """The same with half the communication step."""
        return replace(self, communication_step=0.5 * self.communication_step)

    def run(self, planned: PlannedRun) -> Outcome:
        """Simulate one run; recorded are the communication points."""
        from fmpy.fmi1 import FMICallException

        package = self.packages[planned.loop]
        times = np.linspace(0.0, planned.duration, step_count(planned.duration, self.communication_step) + 1)
        names = recorded(planned.loop.block)
        shown = [package.shown[name] for name in names]
        rows: list[list[float]] = []
        log: list[str] = []
        with ExitStack() as stack:
            try:
                parts = _parts(package, package.starts(planned), log, stack)
                for row in coupled_rows(parts, times, self.scheme, shown, _outside(package, planned, times)):
                    rows.append(row)
            except FMICallException as error:
                return failed(_dataset(package, names, times[: len(rows)], rows), " ".join(log) or str(error))
        return Outcome(_dataset(package, names, times, rows), Status())

    def provenance(self) -> dict[str, Any]:
        """Name of the engine, packages with their hashes, and how they were coupled."""
        import fmpy

        hashes = hashes_of(one.path for one in self.packages.values())
        return {
            "engine": self.name,
            "fmpy": fmpy.__version__,
            "ssp": ", ".join(hashes),
            "ssp_sha256": hashes if len(hashes) > 1 else next(iter(hashes.values())),
            "communication_step": self.communication_step,
            "scheme": self.scheme,
        }


@contextlib.contextmanager
def opened_ssps(
    paths: Mapping[Loop, Path],
    communication_step: float,
    scheme: Scheme,
    *,
    checked_for: Sequence[PlannedRun] = (),
) -> Iterator[SspSimulation]:
    """Unpack the packages of loops for several runs, and clean up; those of the user are checked for the runs."""
    with tempfile.TemporaryDirectory() as folder:
        files = {path: _opened(path, Path(folder, str(k))) for k, path in enumerate(dict.fromkeys(paths.values()))}
        for planned in checked_for:
            package = files[paths[planned.loop]]
            parameters = {name for name in planned.given if package.settable(name)}
            check_variables(str(package.path), planned, parameters, package.inputs, package.shown)
        packages = {loop: files[path] for loop, path in paths.items()}
        yield SspSimulation(packages, communication_step, scheme, own=bool(checked_for))


def _opened(path: Path, folder: Path) -> OpenedSsp:
    folder.mkdir()
    with unusable(str(folder), str(path)):
        unpack_ssp(path, folder)
        structure = read_structure(folder, str(path))
    fmus = {
        name: open_fmu(file, Path(folder, "unpacked", str(k)), f"{path}: {file.relative_to(folder.resolve())}")
        for k, (name, file) in enumerate(structure.components.items())
    }
    direct = set()
    for wire in structure.wires:
        for (part, name), causality in ((wire.source, "output"), (wire.target, "input")):
            if part != SYSTEM:
                _check_port(path, fmus, part, name, causality, any_type=wire.target[0] == SYSTEM)
        if SYSTEM not in (wire.source[0], wire.target[0]) and _is_direct(fmus[wire.source[0]], wire.source[1]):
            direct.add((wire.source[0], wire.target[0]))
    for part, name in structure.values:
        one = fmus[part].variables.get(name)
        settable = one is not None and (one.causality in ("parameter", "input") or one.initial in ("exact", "approx"))
        if one is None or not settable or one.type == "String":
            raise StudyError(
                f"{path}: binds '{part}.{name}', which is no number that its FMU lets be set; correct the package"
            )
    return OpenedSsp(path, structure, {name: fmus[name] for name in stepping_order(list(fmus), direct)})


def _check_port(
    path: Path, fmus: Mapping[str, OpenedFmu], part: str, name: str, causality: str, *, any_type: bool
) -> None:
    found = fmus[part].variables.get(name) if part in fmus else None
    if found is None or found.causality != causality or not (any_type or found.type == "Real"):
        raise StudyError(
            f"{path}: connects '{part}.{name}', which is no {causality} of its FMU that is a real number; "
            "correct the package"
        )


def _is_direct(fmu: OpenedFmu, name: str) -> bool:
    """Whether an output follows an input without a state between, or the FMU has no inputs."""
    inputs = [one for one in fmu.description.modelVariables if one.causality == "input"]
    unknown = next((one for one in fmu.description.outputs if one.variable.name == name), None)
    if not inputs or unknown is None or unknown.dependencies is None:
        return True
    return any(one.causality == "input" for one in unknown.dependencies)


def _parts(package: OpenedSsp, starts: Mapping[Port, float], log: list[str], stack: ExitStack) -> dict[str, Part]:
    """Running components in initialisation mode, in the order of their steps."""
    outputs = {
        key: [name for name, one in fmu.variables.items() if one.causality == "output" and one.type == "Real"]
        for key, fmu in package.fmus.items()
    }
    parts = {}
    for key, fmu in package.fmus.items():
        instance = fmu.instance(log, key)
        stack.callback(release, instance)
        references = {name: one.valueReference for name, one in fmu.variables.items()}
        for (part, name), value in starts.items():
            if part == key:
                _set(instance, fmu.variables[name].type, references[name], value)
        parts[key] = Part(key, instance, references, outputs, package.structure.wires, package.inputs)
        instance.setupExperiment(startTime=0.0)
        instance.enterInitializationMode()
    return parts


def _set(instance: Any, kind: str, reference: int, value: float) -> None:
    if kind == "Boolean":
        instance.setBoolean([reference], [bool(value)])
    elif kind in ("Integer", "Enumeration"):
        instance.setInteger([reference], [round(value)])
    else:
        instance.setReal([reference], [value])


def _outside(package: OpenedSsp, planned: PlannedRun, times: Array) -> Array:
    """Inputs of the system at each communication point; those that the study doesn't know keep their start values."""
    series = planned.series(times)
    starts = {
        one.source[1]: float(package.fmus[one.target[0]].variables[one.target[1]].start or 0.0)
        for one in package.structure.wires
        if one.source[0] == SYSTEM
    }
    columns = [np.broadcast_to(series.get(name, starts[name]), len(times)) for name in package.inputs]
    return np.column_stack(columns) if columns else np.zeros((len(times), 0))


def _dataset(package: OpenedSsp, names: Sequence[str], times: Array, rows: Sequence[Sequence[float]]) -> xr.Dataset:
    table = np.array(rows).reshape(len(rows), len(names))
    columns, about = {}, {}
    for index, name in enumerate(names):
        part, variable = package.shown[name]
        one = package.fmus[part].variables[variable]
        columns[name] = table[:, index] > 0 if one.type == "Boolean" else table[:, index]
        about[name] = (one.unit or "1", one.description or "")
    return labelled(times, columns, about)
