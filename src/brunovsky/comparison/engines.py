"""What simulates a planned run: the FMU of the model under fmpy, or the native simulation.

Both record the same variables at the same instants and report how a run ended instead of raising.
"""

from __future__ import annotations

import contextlib
import hashlib
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, Protocol

import numpy as np
import xarray as xr

from brunovsky.blocks import Block
from brunovsky.blocks.engine import step_count
from brunovsky.comparison.study import Loop, PlannedRun
from brunovsky.comparison.study.signals import Array
from brunovsky.errors import SimulationError
from brunovsky.native import simulate

RECORDED = (
    *("x", "y", "theta", "eta[1]", "eta[2]", "u[1]", "u[2]", "singular"),
    *("position_error[1]", "position_error[2]", "e1[1]", "e1[2]", "e2[1]", "e2[2]", "S[1]", "S[2]", "v[1]", "v[2]"),
)  # of a loop, what it has of them


COMPUTED = ("e1[1]", "e1[2]", "e2[1]", "e2[2]", "S[1]", "S[2]", "v[1]", "v[2]")
"""Of these, what the law computes from measurements, as it does at its samples."""


def recorded(block: Block) -> list[str]:
    """What is recorded of a loop."""
    there = {one.name for one in block.outputs}
    return [name for name in RECORDED if name in there]


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
class OpenedFmu:
    """An FMU that is unpacked for several runs.

    Attributes
    ----------
    path, folder : Path
        The FMU, and where it is unpacked.
    description : object
        fmpy's model description of it.
    """

    path: Path
    folder: Path
    description: Any = field(repr=False)


@dataclass(frozen=True)
class FmuSimulation:
    """FMUs of the planned loops, driven by fmpy in co-simulation at the step size of the study.

    Parameters
    ----------
    fmus : mapping of Loop to OpenedFmu
        See :func:`opened_fmus`.
    """

    fmus: Mapping[Loop, OpenedFmu]
    name: str = "fmpy"

    def run(self, planned: PlannedRun) -> Outcome:
        """Simulate with fmpy; communication and internal step size are those of the study."""
        import fmpy
        from fmpy.fmi1 import FMICallException

        fmu = self.fmus[planned.loop]
        names = [one.name for one in fmu.description.modelVariables if one.name in RECORDED]
        log: list[str] = []
        recorders: list[Any] = []

        def keep(_time: float, recorder: Any) -> bool:
            if not recorders:
                recorders.append(recorder)
            return True

        instance = _instance(fmu, log)
        try:
            rows = fmpy.simulate_fmu(
                str(fmu.folder),
                fmi_type="CoSimulation",
                stop_time=planned.duration,
                step_size=planned.step_size,
                output_interval=planned.duration / step_count(planned.duration, planned.step_size),
                start_values={**planned.parameters, "step_size": planned.step_size},
                input=_inputs(planned),
                output=names,
                model_description=fmu.description,
                fmu_instance=instance,
                step_finished=keep,
            )
        except FMICallException as error:
            partial = recorders[0].result() if recorders else None
            trajectory = _dataset(fmu.description, names, partial)
            begin = float(trajectory["time"][-1]) if trajectory.sizes["time"] else 0.0
            text = " ".join(log) or str(error)
            return Outcome(trajectory, Status("singular" if "singular" in text else "diverged", begin, text))
        finally:
            with contextlib.suppress(Exception):  # some statuses forbid it
                instance.freeInstance()
        return Outcome(_dataset(fmu.description, names, rows), Status())

    def provenance(self) -> dict[str, Any]:
        """Name of the engine and of the FMUs, with their hashes and the version of FMI and fmpy."""
        import fmpy

        first = next(iter(self.fmus.values())).description
        hashes = {one.path.name: hashlib.sha256(one.path.read_bytes()).hexdigest() for one in self.fmus.values()}
        return {
            "engine": self.name,
            "fmpy": fmpy.__version__,
            "fmu": ", ".join(hashes),
            "fmu_sha256": hashes if len(hashes) > 1 else next(iter(hashes.values())),
            "fmi_version": first.fmiVersion,
            "generation_tool": first.generationTool,
        }


@contextlib.contextmanager
def opened_fmus(paths: Mapping[Loop, Path]) -> Iterator[FmuSimulation]:
    """Unpack the FMUs of loops for several runs, and clean up afterwards."""
    import fmpy

    with tempfile.TemporaryDirectory() as folder:
        opened = {}
        for loop, path in paths.items():
            target = Path(folder) / path.stem
            fmpy.extract(str(path), unzipdir=str(target))
            opened[loop] = OpenedFmu(path, target, fmpy.read_model_description(str(target)))
        yield FmuSimulation(opened)


def instants_of(planned: PlannedRun) -> Array:
    """Instants of a run, at its steps."""
    return np.linspace(0.0, planned.duration, step_count(planned.duration, planned.step_size) + 1)


def _instance(fmu: OpenedFmu, log: list[str]) -> Any:
    """Instance whose messages go to the log."""
    from fmpy.fmi2 import FMU2Slave

    from brunovsky.fmi.callbacks import logging_callbacks

    instance = FMU2Slave(
        guid=fmu.description.guid,
        modelIdentifier=fmu.description.coSimulation.modelIdentifier,
        unzipDirectory=str(fmu.folder),
        instanceName=fmu.description.modelName,
    )
    instance.instantiate(callbacks=logging_callbacks(lambda _category, message: log.append(message)))
    return instance


def _inputs(planned: PlannedRun) -> Any:
    """Inputs as fmpy wants them; None where there are none, one row where all are constant."""
    if planned.is_undisturbed:
        return None
    times = np.zeros(1) if planned.is_constant else instants_of(planned)
    series = planned.series(times)
    table = np.empty(len(times), dtype=[("time", np.float64), *((name, np.float64) for name in series)])
    table["time"] = times
    for name, values in series.items():
        table[name] = values
    return table


def _dataset(description: Any, names: Sequence[str], rows: Any) -> xr.Dataset:
    """Recorded rows of fmpy as a Dataset of the same form as the native simulation's."""
    variables = {one.name: one for one in description.modelVariables}
    data = {}
    for name in names:
        column = rows[name] if rows is not None else np.empty(0)
        one = variables[name]
        unit = one.unit or "1"
        data[name] = ("time", np.asarray(column), {"units": unit, "long_name": one.description or ""})
    times = np.asarray(rows["time"]) if rows is not None else np.empty(0)
    return xr.Dataset(data, coords={"time": ("time", times, {"units": "s"})})


def check_outcome(outcome: Outcome, planned: PlannedRun) -> Outcome:
    """Call a trajectory that is not finite diverged from its first such instant on, whatever the engine said.

    Where the loop has a goal and records no error, the distance to the goal is its position error. What a computer that
    samples has computed is held until its next sample.
    """
    trajectory = _as_computed(_with_distance(outcome.trajectory, planned), planned)
    table = np.array([np.asarray(one.values, dtype=float) for one in trajectory.data_vars.values()])
    finite = np.isfinite(table).all(axis=0)
    if finite.all() or outcome.status.state != "ok":
        return Outcome(trajectory, outcome.status)
    first = int(np.argmin(finite))
    time = float(trajectory["time"][first])
    message = f"the trajectory is not finite from t = {time:g} s on"
    return Outcome(trajectory.isel(time=slice(0, first)), Status("diverged", time, message))


def _as_computed(trajectory: xr.Dataset, planned: PlannedRun) -> xr.Dataset:
    """Errors, S and v held between the samples of a computer, which compares no held measurement with what moves on.

    Where its samples are not among the instants recorded, these are not known, and left out.
    """
    if planned.loop.hardware.period is None:
        return trajectory
    own = [name for name in COMPUTED if name in trajectory]
    share = planned.parameters["sampling_period"] / planned.step_size
    if abs(share - round(share)) > 1e-6 * share or "position_error[1]" not in trajectory:
        return trajectory.drop_vars(own)
    steps = np.round(trajectory["time"].values / planned.step_size).astype(int)
    last = np.arange(len(steps)) - steps % max(round(share), 1)
    held = {name: trajectory[name].copy(data=trajectory[name].values[last]) for name in own}
    return trajectory.assign(held)


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
