"""What the paper claims, held against the runs of a study; each verdict follows from a threshold."""

from __future__ import annotations

from collections.abc import Callable

from brunovsky.comparison import (
    claim_limits,
    claim_noise,
    claim_orientation,
    claim_performance,
    claim_robustness,
    claim_starts,
)
from brunovsky.comparison.claim import Case, Claim, Finding
from brunovsky.comparison.facts import joined
from brunovsky.comparison.run import Comparison, Run

__all__ = ["Claim", "claims", "examined"]

Test = Callable[[Comparison, list[Case]], Finding | None]

_FROM_PLAIN = "pole placement and a sliding mode in the same scenario"
# What the paper says, what it takes to examine it, and the test.
_TESTS: tuple[tuple[str, str, Test], ...] = (
    (
        "“the improvement of the trajectory tracking and the stabilization process”, “the convergence itself, its "
        "rate”",
        f"{_FROM_PLAIN}, without disturbance, with settling times that are converged with the step",
        claim_performance.convergence,
    ),
    (
        "“good performances concerning […] the steady state errors”",
        f"{_FROM_PLAIN}, along a trajectory and without disturbance, in runs that are long enough to settle",
        claim_performance.errors,
    ),
    (
        "chattering “is considerably reduced, particularly for the first control input u1”",
        "a boundary layer and a sign function that chatters in the same scenario, along a trajectory and without "
        "disturbance",
        claim_performance.chattering,
    ),
    (
        "“satisfactory in terms of applicability of the method to both stabilization, and tracking convergence and "
        "control smoothness”",
        "a scenario that stands for a figure of the paper, with a run that reaches its end",
        claim_performance.smoothness,
    ),
    (
        "“The robustness is guaranteed in the presence of parameter uncertainty or unmodeled dynamics”",
        "pole placement and the sign function in the same scenario, with a disturbance, uncertainty that tells or "
        "lags, delays, limits or sampling of the actuators",
        claim_robustness.robustness,
    ),
    (
        "“SMC is robust against external disturbance and noise”, as to noise",
        "pole placement and a sliding mode in the same scenario with measurement noise",
        claim_noise.noise,
    ),
    (
        "“Important errors introduced in the initial conditions show the strength of convergence in different cases”",
        "sliding mode from at least two starts, without disturbance, whose errors exceed 1 cm, in runs that are long "
        "enough to settle",
        claim_starts.starts,
    ),
    (
        "“the impact of the initial orientation on trajectory tracking, which greatly influences the subsequent robot "
        "behavior”",
        "two scenarios that differ in the initial heading alone, or a map over it",
        claim_orientation.orientation,
    ),
    (
        "“only position is stabilized to the desired values and not the orientation”",
        "regulation to a point, with a final heading that is converged with the step",
        claim_limits.heading,
    ),
    (
        "“stabilization to any point in the phase plane”",
        "regulation to a point",
        claim_limits.stabilization,
    ),
)


def claims(comparison: Comparison) -> list[Claim]:
    """All claims of the paper, each with what the runs under its laws say to it; in the order of the paper's quotes.

    The paper's loop has ideal actuators, is one system and starts off the law's singularity: runs with others, or from
    rest, speak to its robustness alone, and runs through packages, which differ by the error of the coupling, to none.
    """
    every = _cases(comparison, lambda run: True) if comparison.engine != "ssp" else []
    ideal = _cases(comparison, _is_the_papers) if every else []
    failed = [run.planned.name for run in comparison.runs if not run.ok and run.planned.in_family]
    return [
        _claim(quote, needs, test(comparison, every if test is claim_robustness.robustness else ideal), failed)
        for quote, needs, test in _TESTS
    ]


def _is_the_papers(run: Run) -> bool:
    """Whether a run is one that the paper speaks of: ideal actuators, and a start off the law's singularity."""
    guard = run.planned.guard
    moving = guard is None or abs(run.planned.parameters["eta_start[1]"]) > guard
    return run.planned.has_ideal_actuators and moving


def _cases(comparison: Comparison, counts: Callable[[Run], bool]) -> list[Case]:
    """Scenarios with their runs under the paper's laws that reached their end and count."""
    cases: list[Case] = []
    for scenario in comparison.study.scenarios:
        runs = comparison.of(scenario).items()
        good = {name: run for name, run in runs if run.ok and run.planned.in_family and counts(run)}
        if good:
            cases.append((scenario, good))
    return cases


def examined(found: list[Claim]) -> list[Claim]:
    """Claims that the runs speak to."""
    return [claim for claim in found if claim.verdict != "not examined"]


def _claim(quote: str, needs: str, finding: Finding | None, failed: list[str]) -> Claim:
    """A claim with its finding; where runs failed it is confirmed under the condition that a run ends at all."""
    if finding is None:
        return Claim(quote, "not examined", f"It would take {needs}.")
    if not failed:
        return Claim(quote, finding.verdict, finding.shown)
    verdict = "confirmed under conditions" if finding.verdict == "confirmed" else finding.verdict
    return Claim(quote, verdict, f"{finding.shown} Runs that failed are not in these numbers: {joined(failed)}.")
