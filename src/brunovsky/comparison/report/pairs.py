"""What the sentences of a verdict share: pairs of runs, pole placement first, and what is said of them."""

from __future__ import annotations

import re
from collections.abc import Iterable

from brunovsky.comparison.facts import joined, percent
from brunovsky.comparison.features import run_features
from brunovsky.comparison.findings_steady import HARDLY, STILL
from brunovsky.comparison.growth import grows
from brunovsky.comparison.metrics import instants, position_error
from brunovsky.comparison.run import Run
from brunovsky.comparison.sensitivity import both, is_tiny, spread_of

Pair = tuple[Run, Run]
PAIR = "A pair of runs is one scenario under two laws: pole placement, and the law that is named."
SHARE = {"settling_time": "the settling time to 1 cm", "rms_tail_error": "the RMS error of the last quarter"}
_ACTING = {
    "disturbance": "disturbances",
    "uncertainty": "parameter errors",
    "noise": "measurement noise",
    "lag": "actuator lags",
    "delay": "delays",
    "limits": "limits of the inputs",
    "sampling": "sampling",
}


def acting_on(pairs: list[Pair]) -> str:
    """What the runs of some pairs have that the nominal ones have not."""
    there = {one for pair in pairs for one in run_features(pair[0].planned)}
    return joined([text for name, text in _ACTING.items() if name in there] or ["other conditions"])


def rough(pairs: list[Pair]) -> list[Run]:
    """Runs in which the yaw acceleration varies more than under pole placement."""
    name = "total_variation_u2"
    return [b for a, b in pairs if (both(b, name)[0] or 0.0) > (1.0 + HARDLY) * (both(a, name)[0] or 0.0) + STILL]


def diverges(run: Run) -> bool:
    """Whether the position error still grows at the end of a run with nothing that varies to drive it."""
    planned, data = run.planned, run.trajectory
    if planned.noise or planned.signals or not run.ok:
        return False
    return grows(instants(data), position_error(data))


def growing(pairs: list[Pair]) -> str:
    """Under which laws of some pairs the error grows to the end, scenario by scenario."""
    laws: dict[str, list[str]] = {}
    for run in (run for pair in pairs for run in pair if diverges(run)):
        names = laws.setdefault(run.planned.scenario, [])
        names += [] if f"“{run.planned.law}”" in names else [f"“{run.planned.law}”"]
    parts = [f"the error grows to the end under {joined(names)} in {scenario}" for scenario, names in laws.items()]
    return f"{joined(parts)}, of which nothing is compared ({count_of(len(pairs))})"


def range_of(found: list[float]) -> str:
    """The least and the largest of some relative changes."""
    low, high = percent(min(found)), percent(max(found))
    return low if low == high else f"{low} to {high}"


def pairs_note(sentences: Iterable[str]) -> str:
    """What a pair of runs is, for sentences that speak of pairs; empty for others."""
    return PAIR if any(re.search(r"pairs? of runs", one) for one in sentences) else ""


def count_of(count: int) -> str:
    """A number of pairs in words."""
    return f"{count} pair{'' if count == 1 else 's'} of runs"


def tiny(pairs: list[Pair], name: str) -> list[Pair]:
    """Pairs whose metric is so small under pole placement that a share of it says nothing."""
    return [pair for pair in pairs if is_tiny(pair[0], name)]


def instead(pairs: list[Pair], name: str) -> str:
    """A metric, a length, under another law and under pole placement, as it is."""
    return (
        f"{spread_of([b for _, b in pairs], name, 'm', 2)} instead of {spread_of([a for a, _ in pairs], name, 'm', 2)}"
    )
