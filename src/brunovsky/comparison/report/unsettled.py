"""Runs whose error never settles, or grows to the end, told by law and scenario."""

from __future__ import annotations

from brunovsky.comparison.facts import given, joined
from brunovsky.comparison.metrics import SETTLED
from brunovsky.comparison.report.pairs import diverges
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.sensitivity import both, told

LISTED = 6  # scenarios, beyond which the rest are counted


def unsettled(comparison: Comparison) -> list[str]:
    """Sentence that names the laws whose error exceeds 1 cm to the end, scenario by scenario, if there are any.

    Runs that failed are told elsewhere.
    """
    parts, count = [], 0
    for scenario in comparison.study.scenarios:
        lost = [run for run in comparison.of(scenario).values() if run.ok and _never(run)]
        count += len(lost)
        if lost:
            parts.append(f"“{scenario.title}” under {joined([_law(run) for run in lost])}")
    if not parts:
        return []
    left = f"; and in {len(parts) - LISTED} more scenarios" if len(parts) > LISTED else ""
    runs = "1 run" if count == 1 else f"{count} runs"
    return [
        f"In {runs} the error never settles to {given(100.0 * SETTLED)} cm (RMS error of the last quarter in "
        f"brackets): {'; '.join(parts[:LISTED])}{left}."
    ]


def _never(run: Run) -> bool:
    return both(run, "settling_time")[0] is None


def _law(run: Run) -> str:
    word = ", and grows to the end" if diverges(run) else ""
    return f"“{run.planned.law}” ({told(run, 'rms_tail_error')}\u00a0m{word})"
