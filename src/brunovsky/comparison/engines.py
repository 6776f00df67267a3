"""What simulates a planned run: the FMU of the model under fmpy, or the native simulation.

Both record the same variables at the same instants and report how a run ended instead of raising.
"""

from __future__ import annotations

import contextlib
import hashlib
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, Protocol

import numpy as np
import xarray as xr

from brunovsky.blocks import Block
from brunovsky.blocks.engine import step_count
from brunovsky.comparison.study import PlannedRun
from brunovsky.errors import SimulationError
from brunovsky.native import simulate

RECORDED = (
    *("x", "y", "theta", "eta[1]", "eta[2]", "u[1]", "u[2]", "singular"),
    *("e1[1]", "e2[1]", "S[1]", "S[2]", "v[1]", "v[2]"),
)


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
    """The native simulation of a block."""

    block: Block
    name: str = "native"

    def run(self, planned: PlannedRun) -> Outcome:
        """Simulate with RK4 at the step size of the study."""
        try:
            trajectory = simulate(
                self.block,
                planned.duration,
                step_size=planned.step_size,
                parameters=planned.parameters,
                inputs=planned.inputs,
                record=RECORDED,
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
    """An FMU of a block, driven by fmpy in co-simulation at the step size of the study.

    Parameters
    ----------
    path : Path
        The FMU.
    folder : Path
        Where it is unpacked; see :func:`opened_fmu`.
    description : object
        fmpy's model description of it.
    """

    path: Path
    folder: Path
    description: Any = field(repr=False)
    name: str = "fmpy"

    def run(self, planned: PlannedRun) -> Outcome:
        """Simulate with fmpy; communication and internal step size are those of the study."""
        import fmpy
        from fmpy.fmi1 import FMICallException

        log: list[str] = []
        recorders: list[Any] = []

        def keep(_time: float, recorder: Any) -> bool:
            if not recorders:
                recorders.append(recorder)
            return True

        instance = self._instance(log)
        try:
            rows = fmpy.simulate_fmu(
                str(self.folder),
                fmi_type="CoSimulation",
                stop_time=planned.duration,
                step_size=planned.step_size,
                output_interval=planned.duration / step_count(planned.duration, planned.step_size),
                start_values={**planned.parameters, "step_size": planned.step_size},
                input=_constant_inputs(planned),
                output=list(RECORDED),
                model_description=self.description,
                fmu_instance=instance,
                step_finished=keep,
            )
        except FMICallException as error:
            partial = recorders[0].result() if recorders else None
            trajectory = _dataset(self.description, partial)
            begin = float(trajectory["time"][-1]) if trajectory.sizes["time"] else 0.0
            text = " ".join(log) or str(error)
            return Outcome(trajectory, Status("singular" if "singular" in text else "diverged", begin, text))
        finally:
            with contextlib.suppress(Exception):  # some statuses forbid it
                instance.freeInstance()
        return Outcome(_dataset(self.description, rows), Status())

    def _instance(self, log: list[str]) -> Any:
        """Instance whose messages go to the log."""
        from fmpy.fmi2 import FMU2Slave

        from brunovsky.fmi.callbacks import logging_callbacks

        instance = FMU2Slave(
            guid=self.description.guid,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            unzipDirectory=str(self.folder),
            instanceName=self.description.modelName,
        )
        instance.instantiate(callbacks=logging_callbacks(lambda _category, message: log.append(message)))
        return instance

    def provenance(self) -> dict[str, Any]:
        """Name of the engine and of the FMU, with its hash and the version of FMI and fmpy."""
        import fmpy

        return {
            "engine": self.name,
            "fmpy": fmpy.__version__,
            "fmu": self.path.name,
            "fmu_sha256": hashlib.sha256(self.path.read_bytes()).hexdigest(),
            "fmi_version": self.description.fmiVersion,
            "generation_tool": self.description.generationTool,
        }


@contextlib.contextmanager
def opened_fmu(path: Path) -> Iterator[FmuSimulation]:
    """Unpack an FMU for several runs, and clean up afterwards."""
    import fmpy

    with tempfile.TemporaryDirectory() as folder:
        fmpy.extract(str(path), unzipdir=folder)
        yield FmuSimulation(path, Path(folder), fmpy.read_model_description(folder))


def _constant_inputs(planned: PlannedRun) -> Any:
    """Inputs as fmpy wants them, all that were planned from the start on; None where there are none."""
    if not any(planned.inputs.values()):
        return None
    columns = [("time", np.float64), *((name, np.float64) for name in planned.inputs)]
    return np.array([(0.0, *planned.inputs.values())], dtype=columns)


def _dataset(description: Any, rows: Any) -> xr.Dataset:
    """Recorded rows of fmpy as a Dataset of the same form as the native simulation's."""
    variables = {one.name: one for one in description.modelVariables}
    data = {}
    for name in RECORDED:
        column = rows[name] if rows is not None else np.empty(0)
        one = variables[name]
        unit = one.unit or "1"
        data[name] = ("time", np.asarray(column), {"units": unit, "long_name": one.description or ""})
    times = np.asarray(rows["time"]) if rows is not None else np.empty(0)
    return xr.Dataset(data, coords={"time": ("time", times, {"units": "s"})})


def check_outcome(outcome: Outcome) -> Outcome:
    """Call a trajectory that is not finite diverged from its first such instant on, whatever the engine said."""
    table = np.array([np.asarray(outcome.trajectory[name].values, dtype=float) for name in RECORDED])
    finite = np.isfinite(table).all(axis=0)
    if finite.all() or outcome.status.state != "ok":
        return outcome
    first = int(np.argmin(finite))
    time = float(outcome.trajectory["time"][first])
    shorter = outcome.trajectory.isel(time=slice(0, first))
    return Outcome(shorter, Status("diverged", time, f"the trajectory is not finite from t = {time:g} s on"))
