"""Which imperfections of a real robot the runs of a study have, so that nothing is said to be missing that is there."""

from __future__ import annotations

from typing import Literal

from brunovsky.comparison.study import PlannedRun, Study

Feature = Literal["noise", "lag", "delay", "limits", "sampling", "disturbance", "uncertainty"]


def features(study: Study) -> frozenset[Feature]:
    """Imperfections that at least one scenario of a study has."""
    return frozenset().union(*(scenario_features(study, one.name) for one in study.scenarios))


def scenario_features(study: Study, scenario: str) -> frozenset[Feature]:
    """Imperfections of one scenario, under any of its laws."""
    return frozenset().union(*(run_features(run) for run in study.plan() if run.scenario == scenario))


def run_features(run: PlannedRun) -> frozenset[Feature]:
    """Imperfections of one run."""
    hardware = run.loop.hardware
    has: dict[Feature, bool] = {
        "noise": bool(run.noise),
        "lag": any(hardware.lags),
        "delay": any(hardware.delays),
        "limits": any(limit < float("inf") for limit in hardware.limits),
        "sampling": hardware.period is not None or "sampling_period" in run.parameters,
        "disturbance": any(run.inputs.values()) or bool(run.signals),
        "uncertainty": run.is_uncertain,
    }
    return frozenset(name for name, there in has.items() if there)
