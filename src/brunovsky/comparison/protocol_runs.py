"""Protocols of a study, evaluated by its engine: each trial is a run like any other."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import xarray as xr

from brunovsky._frozen import FrozenMapping
from brunovsky.analysis import resting_poses
from brunovsky.comparison.agreement import Agreement
from brunovsky.comparison.coupling_runs import run_coupling
from brunovsky.comparison.cross_check import agreement_with
from brunovsky.comparison.engines import Engine, NativeSimulation, Outcome, check_outcome
from brunovsky.comparison.margin_runs import run_margins
from brunovsky.comparison.metrics import compute_metrics
from brunovsky.comparison.protocols import (
    Axis,
    Coupling,
    Distribution,
    EqualEffort,
    Failure,
    Knob,
    Map,
    MeasuredLoopMargins,
    MonteCarlo,
    Pareto,
    Swept,
    equal_effort,
    mapped,
    monte_carlo,
    noise_seed,
    pareto,
    swept,
)
from brunovsky.comparison.study import PlannedRun, Study
from brunovsky.comparison.study.keys import unit_suffix
from brunovsky.comparison.study.protocols import (
    AxisTable,
    CouplingTable,
    EqualEffortTable,
    MapTable,
    MarginsTable,
    ParetoTable,
    Protocol,
    SweptTable,
)
from brunovsky.errors import StudyError

WORST = 10  # cases that are drawn as paths
Measured: TypeAlias = Mapping[str, float | None] | Failure
Result: TypeAlias = Swept | EqualEffort | Pareto | MonteCarlo | Map | MeasuredLoopMargins | Coupling


@dataclass(frozen=True, eq=False)
class Path:
    """One of the worst cases of a Monte-Carlo protocol.

    Attributes
    ----------
    law : str
        Under which law.
    case : int
        Number of the case.
    value : float or None
        The metric by which it is one of the worst; None for a run that failed.
    trajectory : xarray.Dataset
        What happened.
    """

    law: str
    case: int
    value: float | None
    trajectory: xr.Dataset


@dataclass(frozen=True, eq=False)
class ProtocolRun:
    """A protocol of a study that was run.

    Attributes
    ----------
    table : Protocol
        What was asked for.
    result : Swept, EqualEffort, Pareto, MonteCarlo, Map, MeasuredLoopMargins or Coupling
        What came out.
    agreement : tuple of Agreement
        Of the trials that were repeated by the native simulation.
    worst : tuple of Path
        The worst cases, law by law; empty unless asked for.
    drawn : mapping of str to tuple of float
        Starts that were drawn together, by the keys of the study: a value for each case.
    """

    table: Protocol
    result: Result
    agreement: tuple[Agreement, ...]
    worst: tuple[Path, ...]
    drawn: Mapping[str, tuple[float, ...]]


@dataclass(eq=False)
class _Trials:
    """Evaluates the trials of one protocol, and counts them."""

    study: Study
    table: Protocol
    engine: Engine
    native: NativeSimulation
    progress: Callable[[int], None]
    poses: Mapping[str, list[float]] | None = None
    seed: int | None = None
    count: int = 0
    agreement: list[Agreement] = field(default_factory=list)

    def __call__(self, law: str, parameters: Mapping[str, float], case: int) -> Measured:
        """Metrics of one run, or why it has none."""
        self.progress(self.count)
        planned = self._planned(law, parameters, case)
        outcome = check_outcome(self.engine.run(planned), planned)
        self.count += 1
        if self.engine is not self.native and self.count & (self.count - 1) == 0:  # the 1st, 2nd, 4th, 8th, ...
            self.agreement.append(agreement_with(self.native, planned, self.engine, outcome))
        return _measured(planned, outcome)

    def at_half_step(
        self, law: str, parameters: Mapping[str, float], case: int
    ) -> Mapping[str, float | None] | Failure:
        """Metrics of the native simulation of the same run at half its step, or why it has none."""
        self.progress(self.count)
        planned = self._planned(law, parameters, case)
        planned = replace(planned, step_size=0.5 * planned.step_size)
        self.count += 1
        return _measured(planned, check_outcome(self.native.run(planned), planned))

    def drawn(self) -> dict[str, tuple[float, ...]]:
        """Poses by key, a value for each case."""
        return {key: tuple(values) for key, values in (self.poses or {}).items()}

    def path(self, law: str, parameters: Mapping[str, float], case: int, value: float | None) -> Path:
        """The trajectory of one case."""
        planned = self._planned(law, parameters, case)
        return Path(law, case, value, check_outcome(self.native.run(planned), planned).trajectory)

    def _planned(self, law: str, parameters: Mapping[str, float], case: int) -> PlannedRun:
        seed = None if self.seed is None else (noise_seed(self.seed, case),)
        changed = {**parameters, **self.pose(case)}
        return self.study.planned_case(self.table, self.study.law(law), changed, seed)

    def pose(self, case: int) -> dict[str, float]:
        """Start and heading of the goal of one case, by the keys of the study; nothing unless poses are drawn."""
        return {} if self.poses is None else {key: float(one[case]) for key, one in self.poses.items()}


def _measured(planned: PlannedRun, outcome: Outcome) -> Measured:
    if outcome.status.state != "ok":
        singular = outcome.status.state == "singular"
        return Failure(outcome.status.message, singular, "ended at the singularity" if singular else "diverged")
    return compute_metrics(outcome.trajectory, **planned.measured).as_dict()


def run_protocol(
    study: Study,
    table: Protocol,
    engine: Engine,
    native: NativeSimulation,
    step_sensitive: Collection[str],
    progress: Callable[[int], None],
) -> ProtocolRun:
    """Run one protocol of a study.

    Parameters
    ----------
    study, table
        What is asked for.
    engine, native
        What runs the trials, and what repeats the first, second, fourth, eighth, ... of them.
    step_sensitive : collection of str
        Metrics of the scenario that depend on the step.
    progress : function of int
        Called before each trial with the number of those before.

    Raises
    ------
    StudyError
        If the effort that is to be equalled is undefined.
    """
    if isinstance(table, MarginsTable):
        return ProtocolRun(table, run_margins(study, table, native, progress), (), (), FrozenMapping({}))
    if isinstance(table, CouplingTable):
        return ProtocolRun(table, run_coupling(study, table, progress), (), (), FrozenMapping({}))
    trials = _Trials(study, table, engine, native, progress)
    laws: dict[str, Mapping[str, float]] = {law.name: {} for law in study.laws_of_protocol(table)}
    worst: tuple[Path, ...] = ()
    result: Result
    if isinstance(table, SweptTable):
        result = swept(trials, laws, table.knob, table.values, metrics=table.metrics, step_sensitive=step_sensitive)
    elif isinstance(table, EqualEffortTable):
        result = equal_effort(
            trials,
            laws,
            {name: Knob(one.knob, one.low, one.high) for name, one in table.tuned.items()},
            table.effort,
            _target(table, trials),
            metrics=table.metrics,
            budget=table.budget,
            step_sensitive=step_sensitive,
            finer=trials.at_half_step,
        )
    elif isinstance(table, ParetoTable):
        result = pareto(
            trials,
            laws,
            {name: table.spaces[name] for name in laws},
            objectives=table.objectives,
            budget=table.budget,
            seed=study.seed,
            step_sensitive=step_sensitive,
        )
    elif isinstance(table, MapTable):
        result = mapped(
            trials,
            laws,
            _axis(table.across),
            _axis(table.up) if table.up else None,
            metrics=table.metrics,
            step_sensitive=step_sensitive,
            finer=trials.at_half_step,
        )
    else:
        trials.seed = study.seed
        if table.resting_poses_within_m is not None:
            trials.poses = _poses(table.cases, table.resting_poses_within_m, study.seed)
        result = monte_carlo(
            trials,
            laws,
            {key: Distribution(one.shape, *one.pair) for key, one in table.distributions.items()},
            metrics=table.metrics,
            cases=table.cases,
            seed=study.seed,
            singular_below=table.near_m_per_s,
            step_sensitive=step_sensitive,
        )
        if table.worst is not None:
            worst = _worst(result, table.worst, trials)
    return ProtocolRun(table, result, tuple(trials.agreement), worst, FrozenMapping(trials.drawn()))


def _axis(table: AxisTable) -> Axis:
    return Axis(table.knob, table.values)


def _target(table: EqualEffortTable, trials: _Trials) -> float:
    """The effort to be equalled: as given, or that of a law as it is."""
    if table.target is not None:
        return table.target
    assert table.target_law is not None
    found = trials(table.target_law, {}, 0)
    value = None if isinstance(found, Failure) else found[table.effort]
    if not value:
        why = found.reason if isinstance(found, Failure) else f"its {table.effort} is {value}"
        raise StudyError(f"equal effort: law '{table.target_law}' has no effort to equal: {why}; give target instead")
    return value


def _poses(number: int, radius: float, seed: int) -> dict[str, list[float]]:
    """Poses by the keys of a study."""
    drawn = resting_poses(number, radius, seed)
    return {
        f"{name}{unit_suffix(str(one.attrs['units']))}": [float(value) for value in one.values]
        for name, one in drawn.data_vars.items()
    }


def _worst(result: MonteCarlo, metric: str, trials: _Trials) -> tuple[Path, ...]:
    """The cases of each law in which a metric is largest, failures and undefined ones before all."""
    found = []
    for law in result.laws:
        own = [one for one in result.trials if one.law == law]
        own.sort(key=lambda one: -math.inf if one.value(metric) is None else -(one.value(metric) or 0.0))
        found += [trials.path(law, one.parameters, one.case, one.value(metric)) for one in own[:WORST]]
    return tuple(found)
