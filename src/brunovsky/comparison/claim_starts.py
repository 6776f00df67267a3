"""Claims of the paper about different starts, and about noise."""

from __future__ import annotations

from brunovsky.comparison.claim import Case, Finding, Verdict, is_nominal, of_kind, pairs
from brunovsky.comparison.facts import percent, spread
from brunovsky.comparison.features import scenario_features
from brunovsky.comparison.findings_steady import HARDLY
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.sensitivity import sure_change

_START = ("x_start", "y_start", "theta_start", "eta_start[1]", "eta_start[2]", "u_start[1]")


def starts(comparison: Comparison, cases: list[Case]) -> Finding | None:
    """Whether the error settles from every start that was run, under sliding mode and under pole placement."""
    sliding = _nominal(comparison, cases, ["saturation", "sign"])
    count = len({_start(run) for run in sliding})
    failed = _failed(comparison)
    if count + failed < 2 or not sliding:
        return None
    settled = [run for run in sliding if run.metrics.settling_time is not None]
    times = [run.metrics.settling_time or 0.0 for run in settled]
    text = f"{len(settled)} of {len(sliding) + failed} undisturbed runs under sliding mode, from {count} starts, "
    text += f"settle to 1 cm, within {spread(times, 's')}" if settled else "settle to 1 cm"
    linear = _nominal(comparison, cases, ["linear"])
    if linear:
        as_well = sum(run.metrics.settling_time is not None for run in linear)
        text += f"; under pole placement {as_well} of {len(linear)} do, so that this is no merit of the switching term"
        text += "" if as_well == len(linear) else " alone"
    complete = len(settled) == len(sliding) + failed
    lost = sum(trial.failure is not None for one in comparison.protocols for trial in getattr(one.result, "trials", ()))
    word: Verdict = (
        "confirmed" if complete and not lost else "confirmed under conditions" if settled else "contradicted"
    )
    if not comparison.protocols:
        return Finding(word, f"{text}. Other starts were not run.")
    return Finding(word, f"{text}. The protocols are not counted here; {lost or 'none'} of their runs failed.")


def _nominal(comparison: Comparison, cases: list[Case], kinds: list[str]) -> list[Run]:
    names = {law.name for law in of_kind(comparison, kinds)}
    return [run for _, runs in cases for name, run in runs.items() if name in names and is_nominal(run)]


def _failed(comparison: Comparison) -> int:
    """Undisturbed runs under sliding mode that did not reach their end."""
    names = {law.name for law in of_kind(comparison, ["saturation", "sign"])}
    return sum(not run.ok and run.planned.law in names and is_nominal(run) for run in comparison.runs)


def _start(run: Run) -> tuple[float, ...]:
    return tuple(run.planned.parameters[name] for name in _START)


def noise(comparison: Comparison, cases: list[Case]) -> Finding | None:
    """What measurement noise leaves under sliding mode, against pole placement."""
    noisy = [one for one in cases if "noise" in scenario_features(comparison.study, one[0].name)]
    changes = [
        change
        for _, a, b in pairs(comparison, noisy, ["saturation", "sign"])
        for change in [sure_change(b, a, "rms_tail_error")]
        if change is not None
    ]
    if not changes:
        return None
    worst, best = max(changes), min(changes)
    text = (
        f"With measurement noise the RMS error of the last quarter changes by {percent(best)} to {percent(worst)} "
        f"against pole placement ({len(changes)} pairs of runs)."
    )
    if worst <= HARDLY:
        return Finding("confirmed", text)
    return Finding("confirmed under conditions" if best <= HARDLY else "contradicted", text)
