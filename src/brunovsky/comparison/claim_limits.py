"""Claims of the paper about the heading at the end, and the reach of the method."""

from __future__ import annotations

import math

from brunovsky.comparison.claim import Case, Finding, is_regulation
from brunovsky.comparison.facts import given, joined, spread, wrapped
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.sensitivity import MARK, both, facts_of, settled

AIMED = 0.1  # rad; a heading that ends this near to a wanted one counts as stabilised, and one that moves by more at
# half the step as not converged


def heading(comparison: Comparison, cases: list[Case]) -> Finding | None:
    """Whether the heading ends where it began, from the runs that settle and whose final heading is converged."""
    runs = [run for _, found in cases for run in found.values() if is_regulation(run)]
    sure = [run for run in runs if heading_converged(run) and settled(run)]
    if not sure:
        return None
    away = [min(abs(one) for one in _away(run)) for run in sure]
    ends = spread([abs(_away(run)[0]) for run in sure], "rad", 2)
    text = (
        f"Nothing controls the heading. In regulation it ends {MARK}{ends} "
        "(modulo 2π) from the initial one, which in the paper is the desired one too, after "
        f"{spread([abs(_turns(run)) for run in sure], 'turns', 2)}"
    )
    if len(sure) < len(runs):
        laws = joined(sorted({f"“{run.planned.law}”" for run in runs if run not in sure}))
        text += (
            f"; under {laws} it had not settled for good, or where it ends is not converged with the step: not counted"
        )
    return Finding("confirmed" if max(away) > AIMED else "contradicted", f"{text}.")


def heading_converged(run: Run) -> bool:
    """Whether the final heading moves by at most a tenth of a radian at half the step."""
    value, half = both(run, "heading_end")
    return value is not None and half is not None and abs(half - value) <= AIMED


def _away(run: Run) -> tuple[float, ...]:
    start = facts_of(run).heading_start
    return tuple(wrapped(one - start) for one in both(run, "heading_end") if one is not None)


def _turns(run: Run) -> float:
    return (facts_of(run).heading_end - facts_of(run).heading_start) / (2.0 * math.pi)


def stabilization(comparison: Comparison, cases: list[Case]) -> Finding | None:
    """Whether the printed law can bring the robot to rest, and how much of a run the guard stands in for it."""
    runs = [run for _, found in cases for run in found.values() if is_regulation(run)]
    if not runs or max(facts_of(run).guarded_share for run in runs) == 0.0:
        return None
    limits = joined(sorted({f"{given(run.planned.parameters['eta_min'])} m/s" for run in runs}))
    targets = len({tuple(run.planned.parameters[f"center[{k}]"] for k in (1, 2)) for run in runs})
    never = any(run.metrics.settling_time is None for run in runs)
    rests = all(map(settled, runs))
    shares = [100.0 * facts_of(run).guarded_share for run in runs]
    tested = "One target was tested" if targets == 1 else f"{targets} targets were tested"
    return Finding(
        "contradicted" if never else "confirmed under conditions",
        f"{tested}. The robot does {'come' if rests else 'not always come'} to rest there for good, but rest is the "
        f"singularity of the law: for {spread(shares, '%', 2)} of the run a guard (|η₁| ≤ {limits}) stands in for the "
        "printed law, which can neither stop nor start.",
    )
