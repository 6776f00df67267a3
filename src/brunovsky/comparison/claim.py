"""What a claim of the paper is, and what the tests of all claims share."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from brunovsky.analysis import surface_poles
from brunovsky.comparison.metrics import SETTLED, TAIL
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.study import Law, Scenario

PRINTED = {"C[1]": 500.0, "C[2]": 10.0, "C[3]": 1.0, "Q": 5.0}  # the paper's gains of the linear part
PRINTED_P = 2.5  # and of the switching term
SLIDING = ("saturation", "sign")  # kinds of the paper's laws with a switching term

Case = tuple[Scenario, dict[str, Run]]


Verdict = Literal["confirmed", "confirmed under conditions", "contradicted", "not examined"]


@dataclass(frozen=True)
class Finding:
    """What the runs say about a claim, as far as they go: with what was run here, and no further.

    Attributes
    ----------
    verdict : str
        ``confirmed``, ``confirmed under conditions`` (which `shown` names) or ``contradicted``.
    shown : str
        What the runs show, with the numbers.
    """

    verdict: Verdict
    shown: str


@dataclass(frozen=True)
class Claim:
    """One claim of the paper, held against the runs of a study.

    Attributes
    ----------
    quote : str
        What the paper says.
    verdict : str
        That of the finding, or ``not examined`` where the runs cannot speak to it.
    shown : str
        What the runs show; for a claim that is not examined what it would take.
    """

    quote: str
    verdict: Verdict
    shown: str


def is_nominal(run: Run) -> bool:
    """Whether a run has no disturbance, constant or not, no noise, no parameter error, and ideal hardware."""
    return run.planned.is_undisturbed and run.planned.is_ideal and not run.planned.is_uncertain


def is_regulation(run: Run) -> bool:
    """Whether the reference is a point."""
    return run.planned.target is not None


def has_printed_gains(run: Run) -> bool:
    """Whether the gains are those that the paper prints; pole placement has its linear part alone."""
    p = run.planned.parameters
    return all(p[name] == value for name, value in PRINTED.items()) and p["P"] in (0.0, PRINTED_P)


def decay_rates(run: Run) -> tuple[float, float]:
    """How fast the error decays in the end, once sliding and under pole placement, from the gains, 1/s."""
    p = run.planned.parameters
    sliding = -float(np.max(np.real(surface_poles([p[f"C[{k}]"] for k in (1, 2, 3)]))))
    return sliding, min(sliding, p["Q"])


def is_long_enough(run: Run) -> bool:
    """Whether the slowest mode takes the start's distance below 1 cm before the last quarter of the run.

    Gains that are not stable have all the time they need.
    """
    p, rate = run.planned, min(decay_rates(run))
    distance = math.dist([p.parameters[name] for name in ("x_start", "y_start")], p.aim)
    return rate <= 0.0 or math.log(max(distance / SETTLED, 1.0)) <= rate * TAIL * p.duration


def of_kind(comparison: Comparison, kinds: Sequence[str]) -> list[Law]:
    """Laws of these kinds."""
    return [law for law in comparison.study.laws if law.kind in kinds]


def pairs(comparison: Comparison, cases: list[Case], kinds: Sequence[str]) -> list[tuple[Scenario, Run, Run]]:
    """Run under pole placement and run under a law of these kinds, of each scenario that has both."""
    linear, others = of_kind(comparison, ["linear"]), of_kind(comparison, kinds)
    return [
        (scenario, runs[a.name], runs[b.name])
        for scenario, runs in cases
        for a in linear
        for b in others
        if a.name in runs and b.name in runs
    ]
