"""What simulates a planned run: the FMU of the model under fmpy, or the native simulation.

Both record the same variables at the same instants and report how a run ended instead of raising.
"""

from __future__ import annotations

import contextlib
import hashlib
import tempfile
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, Protocol

import numpy as np
import xarray as xr

from brunovsky.blocks.engine import step_count
from brunovsky.comparison.metrics import position_error
from brunovsky.comparison.opened import RECORDED, OpenedFmu, check_variables, open_fmu, recorded, release
from brunovsky.comparison.study import Loop, PlannedRun
from brunovsky.comparison.study.signals import Array
from brunovsky.errors import SimulationError
from brunovsky.native import simulate

LOST = 1e3  # m; a position error beyond which, if it did not start there, a robot is lost


@dataclass(frozen=True)
class Status:
    """How a run ended.

    Attributes
    ----------
    state : {"ok", "singular", "diverged"}
        Whether it reached its end, and if not, why.
    time : float or None
        Start of the step that failed, s.
    message : str
        What the simulation or the FMU's log said.
    """

    state: Literal["ok", "singular", "diverged"] = "ok"
    time: float | None = None
    message: str = ""


@dataclass(frozen=True)
class Outcome:
    """Trajectory of a run, up to the failure if there was one, and how it ended."""

    trajectory: xr.Dataset
    status: Status


class Engine(Protocol):
    """What an engine offers."""

    @property
    def name(self) -> str:
        """Name in the study file and on the command line."""
        ...

    def run(self, planned: PlannedRun) -> Outcome:
        """Simulate one run; a failed step is an outcome, not an exception."""
        ...

    def provenance(self) -> dict[str, Any]:
        """What was run, for the record."""
        ...


@dataclass(frozen=True)
class NativeSimulation:
    """The native simulation of the planned loop."""

    name: str = "native"

    def run(self, planned: PlannedRun) -> Outcome:
        """Simulate with RK4 at the step size of the study."""
        try:
            trajectory = simulate(
                planned.loop.block,
                planned.duration,
                step_size=planned.step_size,
                parameters=planned.parameters,
                inputs=planned.series(instants_of(planned)),
                record=recorded(planned.loop.block),
            )
        except SimulationError as error:
            state: Literal["singular", "diverged"] = "singular" if error.reason == "singular" else "diverged"
            return Outcome(error.trajectory, Status(state, error.time, str(error)))
        return Outcome(trajectory, Status())

    def provenance(self) -> dict[str, Any]:
        """Name of the engine."""
        return {"engine": self.name}


@dataclass(frozen=True)
class FmuSimulation:
    """FMUs of the planned loops, driven by fmpy in co-simulation at the step size of the study.

    Parameters
    ----------
    fmus : mapping of Loop to OpenedFmu
        See :func:`opened_fmus`.
    own : bool
        Whether they are the user's own, which may lack what the study leaves at its default.
    """

    fmus: Mapping[Loop, OpenedFmu]
    own: bool = False
    name: str = "fmpy"

    def run(self, planned: PlannedRun) -> Outcome:
        """Simulate with fmpy; communication and internal step size are those of the study."""
        import fmpy
        from fmpy.fmi1 import FMICallException

        fmu = self.fmus[planned.loop]
        names = [name for name in fmu.variables if name in RECORDED]
        starts = {**planned.parameters, "step_size": planned.step_size}
        log: list[str] = []
        recorders: list[Any] = []

        def keep(_time: float, recorder: Any) -> bool:
            if not recorders:
                recorders.append(recorder)
            return True

        instance = fmu.instance(log)
        try:
            rows = fmpy.simulate_fmu(
                str(fmu.folder),
                fmi_type="CoSimulation",
                stop_time=planned.duration,
                step_size=planned.step_size,
                output_interval=planned.duration / step_count(planned.duration, planned.step_size),
                start_values={name: starts[name] for name in starts if not self.own or name in fmu.parameters},
                input=_inputs(planned, fmu.variables),
                output=names,
                model_description=fmu.description,
                fmu_instance=instance,
                step_finished=keep,
            )
        except FMICallException as error:
            partial = recorders[0].result() if recorders else None
            return failed(_dataset(fmu, names, partial), " ".join(log) or str(error))
        finally:
            release(instance)
        return Outcome(_dataset(fmu, names, rows), Status())

    def provenance(self) -> dict[str, Any]:
        """Name of the engine and of the FMUs, with their hashes and the version of FMI and fmpy."""
        import fmpy

        first = next(iter(self.fmus.values())).description
        hashes = hashes_of(one.path for one in self.fmus.values())
        return {
            "engine": self.name,
            "fmpy": fmpy.__version__,
            "fmu": ", ".join(hashes),
            "fmu_sha256": hashes if len(hashes) > 1 else next(iter(hashes.values())),
            "fmi_version": first.fmiVersion,
            "generation_tool": first.generationTool,
        }


@contextlib.contextmanager
def opened_fmus(paths: Mapping[Loop, Path], *, checked_for: Sequence[PlannedRun] = ()) -> Iterator[FmuSimulation]:
    """Unpack the FMUs of loops for several runs, and clean up; those of the user are checked for the runs."""
    with tempfile.TemporaryDirectory() as folder:
        files = {path: open_fmu(path, Path(folder, str(k))) for k, path in enumerate(dict.fromkeys(paths.values()))}
        for planned in checked_for:
            path = paths[planned.loop]
            fmu = files[path]
            inputs = {name for name, one in fmu.variables.items() if one.causality == "input" and one.type == "Real"}
            outputs = {name for name, one in fmu.variables.items() if one.type in ("Real", "Boolean")}
            check_variables(str(path), planned, fmu.parameters, inputs, outputs)
        yield FmuSimulation({loop: files[path] for loop, path in paths.items()}, own=bool(checked_for))


def hashes_of(paths: Iterable[Path]) -> dict[str, str]:
    """SHA-256 of files by name."""
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in paths}


def instants_of(planned: PlannedRun) -> Array:
    """Instants of a run, at its steps."""
    return np.linspace(0.0, planned.duration, step_count(planned.duration, planned.step_size) + 1)


def _inputs(planned: PlannedRun, known: Collection[str]) -> Any:
    """Inputs as fmpy wants them; None where there are none, one row where all are constant."""
    if planned.is_undisturbed:
        return None
    times = np.zeros(1) if planned.is_constant else instants_of(planned)
    series = {name: values for name, values in planned.series(times).items() if name in known}
    table = np.empty(len(times), dtype=[("time", np.float64), *((name, np.float64) for name in series)])
    table["time"] = times
    for name, values in series.items():
        table[name] = values
    return table


def _dataset(fmu: OpenedFmu, names: Sequence[str], rows: Any) -> xr.Dataset:
    """Recorded rows of fmpy as a Dataset of the same form as the native simulation's."""
    columns = {name: np.asarray(rows[name]) if rows is not None else np.empty(0) for name in names}
    about = {name: (fmu.variables[name].unit or "1", fmu.variables[name].description or "") for name in names}
    return labelled(np.asarray(rows["time"]) if rows is not None else np.empty(0), columns, about)


def labelled(times: Array, columns: Mapping[str, Any], about: Mapping[str, tuple[str, str]]) -> xr.Dataset:
    """Columns over time (s) as a Dataset of the native simulation's form; ``about`` has units and descriptions."""
    data = {
        name: ("time", one, {"units": about[name][0], "long_name": about[name][1]}) for name, one in columns.items()
    }
    return xr.Dataset(data, coords={"time": ("time", times, {"units": "s"})})


def failed(trajectory: xr.Dataset, text: str) -> Outcome:
    """Outcome of a run that an FMU ended, with what it logged: singular where that says so."""
    begin = float(trajectory["time"][-1]) if trajectory.sizes["time"] else 0.0
    return Outcome(trajectory, Status("singular" if "singular" in text else "diverged", begin, text))


def check_outcome(outcome: Outcome, planned: PlannedRun) -> Outcome:
    """Call a trajectory that is not finite, or lost, diverged from its first such instant on, whatever the engine said.

    Lost is a position error above 1 km and a hundred times that at the start.

    Where the loop has a goal and records no error, the distance to the goal is its position error.
    """
    trajectory = _with_distance(outcome.trajectory, planned)
    table = np.array([np.asarray(one.values, dtype=float) for one in trajectory.data_vars.values()])
    finite = np.isfinite(table).all(axis=0)
    error = np.nan_to_num(position_error(trajectory), nan=np.inf) if trajectory.sizes["time"] else np.empty(0)
    bound = max(LOST, 100.0 * error[0]) if error.size else LOST
    fine = finite & (error <= bound)
    if fine.all() or outcome.status.state != "ok":
        return Outcome(trajectory, outcome.status)
    first = int(np.argmin(fine))
    time = float(trajectory["time"][first])
    what = f"the position error exceeds {bound:g} m" if finite[first] else "the trajectory is not finite"
    message = f"{what} from t = {time:g} s on"
    return Outcome(trajectory.isel(time=slice(0, first)), Status("diverged", time, message))


def _with_distance(trajectory: xr.Dataset, planned: PlannedRun) -> xr.Dataset:
    if "e1[1]" in trajectory or "goal[1]" not in planned.parameters:
        return trajectory
    errors = {
        f"position_error[{k}]": (trajectory[one] - planned.parameters[f"goal[{k}]"]).assign_attrs(
            units="m", long_name=f"distance to the goal along {one}"
        )
        for k, one in ((1, "x"), (2, "y"))
    }
    return trajectory.assign(errors)
