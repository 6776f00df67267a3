"""The claim of the paper about different starts."""

from __future__ import annotations

from collections.abc import Sequence

from brunovsky.comparison.claim import SLIDING, Case, Finding, Verdict, is_long_enough, is_nominal, of_kind
from brunovsky.comparison.facts import spread
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.sensitivity import settled

_START = ("x_start", "y_start", "theta_start", "eta_start[1]", "eta_start[2]", "u_start[1]")


def starts(comparison: Comparison, cases: list[Case]) -> Finding | None:
    """Whether the error settles from every start that was run, under sliding mode and under pole placement.

    Only runs are judged whose error exceeds the threshold at all, and that are long enough to settle.
    """
    nominal = _nominal(comparison, cases, SLIDING)
    sliding = [run for run in nominal if _can_be_judged(run)]
    count = len({_start(run) for run in sliding})
    failed = _failed(comparison)
    good = [run for run in sliding if settled(run)]
    never = [run for run in sliding if run.metrics.settling_time is None]
    late = len(sliding) - len(good) - len(never)
    if count + failed < 2 or not sliding or late == len(sliding):
        return None
    times = [run.metrics.settling_time or 0.0 for run in good]
    text = f"{len(good)} of {len(sliding) + failed} undisturbed runs under sliding mode, from {count} starts, "
    text += f"settle to 1 cm, within {spread(times, 's')}" if good else "settle to 1 cm"
    text += f"; {late} of the others had not settled for good (within 1 cm for the last quarter)" if late else ""
    linear = [run for run in _nominal(comparison, cases, ["linear"]) if _can_be_judged(run)]
    if linear:
        as_well = sum(map(settled, linear))
        text += f"; under pole placement {as_well} of {len(linear)} do, so that this is no merit of the switching term"
        text += "" if as_well == len(linear) else " alone"
    text += "."
    left = len(nominal) - len(sliding)
    if left:
        text += (
            f" {left} more under sliding mode cannot be judged: they never exceed 1 cm, or are too short for the gains."
        )
    complete = len(good) == len(sliding) + failed
    lost = sum(trial.failure is not None for one in comparison.protocols for trial in getattr(one.result, "trials", ()))
    word: Verdict = "confirmed" if complete and not lost else "confirmed under conditions" if good else "contradicted"
    if not comparison.protocols:
        return Finding(word, f"{text} Other starts were not run.")
    return Finding(word, f"{text} The protocols are not counted here; {lost or 'none'} of their runs failed.")


def _can_be_judged(run: Run) -> bool:
    """Whether there is an error to speak of, and time for it to settle."""
    return run.metrics.settling_time != 0.0 and is_long_enough(run)


def _nominal(comparison: Comparison, cases: list[Case], kinds: Sequence[str]) -> list[Run]:
    names = {law.name for law in of_kind(comparison, kinds)}
    return [run for _, runs in cases for name, run in runs.items() if name in names and is_nominal(run)]


def _failed(comparison: Comparison) -> int:
    """Undisturbed runs under sliding mode that did not reach their end."""
    names = {law.name for law in of_kind(comparison, SLIDING)}
    return sum(not run.ok and run.planned.law in names and is_nominal(run) for run in comparison.runs)


def _start(run: Run) -> tuple[float, ...]:
    return tuple(run.planned.parameters[name] for name in _START)
