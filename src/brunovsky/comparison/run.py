"""Running a study: every scenario under every law, cross-checked, with its metrics."""

from __future__ import annotations

import contextlib
import platform
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import xarray as xr

from brunovsky._frozen import FrozenMapping
from brunovsky.comparison.agreement import Agreement
from brunovsky.comparison.cross_check import agreement_with
from brunovsky.comparison.engines import (
    Engine,
    FmuSimulation,
    NativeSimulation,
    Outcome,
    Status,
    check_outcome,
    opened_fmus,
)
from brunovsky.comparison.facts import Facts, compute_facts
from brunovsky.comparison.metrics import Metrics, compute_metrics
from brunovsky.comparison.protocol_runs import ProtocolRun, run_protocol
from brunovsky.comparison.protocols import step_sensitive_metrics
from brunovsky.comparison.run_files import UNITS, run_files
from brunovsky.comparison.ssp_engine import SspSimulation, opened_ssps
from brunovsky.comparison.study import EngineName, Law, Loop, PlannedRun, Scenario, Study
from brunovsky.comparison.study.communication import check_communication
from brunovsky.errors import StudyError

Progress = Callable[[int, int, str], None]
_FOLDERS = {"fmpy": "fmus", "ssp": "ssps"}
_SUFFIXES = {"fmpy": ".fmu", "ssp": ".ssp"}
_PACKAGES = ("brunovsky", "numpy", "sympy", "control", "xarray", "matplotlib")


@dataclass(frozen=True)
class HalfStep:
    """A run at half its step: natively, through a file of the user's own if that is what ran.

    Attributes
    ----------
    metrics : Metrics
        All None if it failed.
    facts : Facts or None
        None if it failed.
    """

    metrics: Metrics
    facts: Facts | None


@dataclass(frozen=True, eq=False)
class Run:
    """One simulated run.

    Attributes
    ----------
    planned : PlannedRun
        What was asked for.
    trajectory : xarray.Dataset
        What happened, until the failure if there was one.
    status : Status
        How it ended.
    metrics : Metrics
        All None for a run that failed: they are defined over the whole duration.
    agreement : Agreement or None
        Against the native simulation; None where that is the engine.
    facts : Facts or None
        None for a run that failed.
    half_step : HalfStep or None
        What the same run gives at half the step; None for a run that failed.
    """

    planned: PlannedRun
    trajectory: xr.Dataset
    status: Status
    metrics: Metrics
    agreement: Agreement | None
    facts: Facts | None
    half_step: HalfStep | None

    @property
    def ok(self) -> bool:
        """Whether the run reached its end."""
        return self.status.state == "ok"


@dataclass(frozen=True, eq=False)
class Comparison:
    """A study that was run.

    Attributes
    ----------
    study : Study
        What was asked for.
    engine : str
        What simulated it.
    runs : tuple of Run
        Scenario by scenario, law by law.
    provenance : mapping
        Versions, engine, FMU and when it was made.
    protocols : tuple of ProtocolRun
        In the order of the study.
    """

    study: Study
    engine: str
    runs: tuple[Run, ...]
    provenance: Mapping[str, Any]
    protocols: tuple[ProtocolRun, ...] = ()

    @property
    def own_file(self) -> bool:
        """Whether a file of the study's own was run."""
        return any(run.agreement is not None and run.agreement.basis == "models" for run in self.runs)

    def of(self, scenario: Scenario) -> dict[str, Run]:
        """Runs of one scenario by law."""
        return {run.planned.law: run for run in self.runs if run.planned.scenario == scenario.name}

    def laws_of(self, scenario: Scenario) -> tuple[tuple[Law, Run], ...]:
        """Laws of one scenario with their runs."""
        runs = self.of(scenario)
        return tuple((law, runs[law.name]) for law in self.study.laws_of(scenario))


def run_study(
    study: Study,
    *,
    engine: EngineName | None = None,
    folder: str | Path | None = None,
    fmu: str | Path | None = None,
    progress: Progress | None = None,
) -> Comparison:
    """Run all scenarios of a study under all their laws.

    Parameters
    ----------
    study : Study
        From :func:`load_study`.
    engine : {"fmpy", "native", "ssp"}, optional
        In place of the study's own choice. With the other two each run is compared with the native simulation; with
        ``"ssp"`` it is repeated at half the communication step.
    folder : path, optional
        Where FMUs are built, in ``fmus/``, or packages, in ``ssps/``; by default a temporary folder.
    fmu : path, optional
        An FMU of the closed loop to use instead of building one.
    progress : function of (done, total, what), optional
        Called before each run and at the end.

    Returns
    -------
    Comparison
        A run that failed has its status and the trajectory until then; the others are not affected.

    Raises
    ------
    StudyError
        If a file of the study's own cannot be run or lacks a variable, or its communication step cannot be used.
    """
    report = progress or (lambda done, total, what: None)
    plan = study.plan()
    native = NativeSimulation()
    chosen = engine or study.engine
    study = study.run_by(chosen)
    if chosen == "ssp":
        try:
            check_communication(study)
        except ValueError as error:
            raise StudyError(f"study '{study.name}': {error}") from None
    with _engine(chosen, study, native, plan, folder, fmu, lambda what: report(0, len(plan), what)) as simulator:
        runs = []
        for index, planned in enumerate(plan):
            report(index, len(plan), planned.name)
            runs.append(_run(planned, simulator, native))
        protocols = _protocols(study, runs, simulator, native, report)
        report(len(plan), len(plan), "runs")
        provenance = study_provenance(
            study,
            **simulator.provenance(),
            step_size=study.step_size_s,
            units=UNITS,
            files=run_files(simulator, plan),
        )
    return Comparison(study, chosen, tuple(runs), FrozenMapping(provenance), protocols)


def _protocols(
    study: Study, runs: Sequence[Run], engine: Engine, native: NativeSimulation, report: Progress
) -> tuple[ProtocolRun, ...]:
    done = []
    for table in study.protocols:
        laws = [law.name for law in study.laws_of_protocol(table)]
        own = [one for one in runs if one.planned.scenario == table.scenario and one.planned.law in laws]
        pairs = [one for one in own if one.half_step is not None]
        sensitive = step_sensitive_metrics(
            [one.metrics.as_dict() for one in pairs],
            [one.half_step.metrics.as_dict() for one in pairs if one.half_step is not None],
        )

        def count(trial: int, kind: str = table.kind) -> None:
            report(len(runs), len(runs), f"{kind.replace('_', ' ')}: trial {trial + 1}")

        done.append(run_protocol(study, table, engine, native, sensitive, count))
    return tuple(done)


def _run(planned: PlannedRun, engine: Engine, native: NativeSimulation) -> Run:
    outcome = check_outcome(engine.run(planned), planned)
    agreement = None if engine is native else agreement_with(native, planned, engine, outcome)
    metrics, facts = _measured(planned, outcome)
    half = _half_step(planned, engine, native) if facts is not None else None
    return Run(planned, outcome.trajectory, outcome.status, metrics, agreement, facts, half)


def _half_step(planned: PlannedRun, engine: Engine, native: NativeSimulation) -> HalfStep:
    """The run at half the step, natively or through the user's own file, of which another model tells nothing."""
    finer = replace(planned, step_size=0.5 * planned.step_size)
    if isinstance(engine, SspSimulation) and engine.own:
        return HalfStep(*_measured(planned, check_outcome(engine.halved().run(planned), planned)))
    twin = engine if isinstance(engine, FmuSimulation) and engine.own else native
    return HalfStep(*_measured(finer, check_outcome(twin.run(finer), finer)))


def _measured(planned: PlannedRun, outcome: Outcome) -> tuple[Metrics, Facts | None]:
    if outcome.status.state != "ok":
        return Metrics(), None
    metrics = compute_metrics(outcome.trajectory, **planned.measured)
    return metrics, compute_facts(outcome.trajectory)


@contextlib.contextmanager
def _engine(
    name: EngineName,
    study: Study,
    native: NativeSimulation,
    plan: Sequence[PlannedRun],
    folder: str | Path | None,
    fmu: str | Path | None,
    building: Callable[[str], None],
) -> Iterator[Engine]:
    if name == "native":
        yield native
        return
    loops = dict.fromkeys(one.loop for one in plan)
    own = study.own_file(name)
    given = fmu if name == "fmpy" and fmu is not None else own
    checked_for = plan if own is not None and given is own else ()
    with contextlib.ExitStack() as stack:
        if given is None:
            target = Path(folder) if folder is not None else Path(stack.enter_context(tempfile.TemporaryDirectory()))
            paths = _built(loops, target / _FOLDERS[name], _SUFFIXES[name], building)
        else:
            paths = dict.fromkeys(loops, Path(given))
        simulator: Engine
        try:
            if name == "ssp":
                step, scheme = study.communication_step, study.scheme
                simulator = stack.enter_context(opened_ssps(paths, step, scheme, checked_for=checked_for))
            else:
                simulator = stack.enter_context(opened_fmus(paths, checked_for=checked_for))
        except StudyError as error:
            if given is not own:
                raise
            raise StudyError(f"{study.own_place(name)}: {error}") from None
        yield simulator


def check_own_file(study: Study, engine: EngineName | None = None) -> None:
    """Open the file of a study's own that an engine would run, if it has one, before anything is run.

    Raises
    ------
    StudyError
        With study file, line and key, if it is missing, cannot be run or lacks a variable.
    """
    chosen = engine or study.engine
    if study.own_file(chosen) is not None:
        with _engine(chosen, study, NativeSimulation(), study.plan(), None, None, lambda what: None):
            pass


def _built(loops: Iterable[Loop], folder: Path, suffix: str, building: Callable[[str], None]) -> dict[Loop, Path]:
    """FMUs or packages of loops; a name that several have is numbered."""
    from brunovsky.fmi import export_fmu, export_ssp

    folder.mkdir(parents=True, exist_ok=True)
    paths: dict[Loop, Path] = {}
    stems = Counter[str]()
    for loop in loops:
        stem = loop.block.name if loop.controller == "sliding_mode" else f"{loop.block.name}_{loop.controller}"
        stems[stem] += 1
        paths[loop] = folder / f"{stem}{f'_{stems[stem]}' if stems[stem] > 1 else ''}{suffix}"
        building(f"building {paths[loop].stem}")
        if suffix == ".ssp":
            export_ssp(loop.block, paths[loop])
        else:
            export_fmu(loop.block, paths[loop], fmi_version=2, platforms=("host",))
    return paths


def study_provenance(study: Study, **more: Any) -> dict[str, Any]:
    """What made the results of a study, and when; `more` is what simulated it."""
    return {
        "made": datetime.now(UTC).isoformat(timespec="seconds"),
        **more,
        "study_sha256": study.digest(),
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        "versions": {name: _version(name) for name in _PACKAGES},
    }


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "source checkout"


__all__ = ["Comparison", "Progress", "Run", "Status", "run_study"]
