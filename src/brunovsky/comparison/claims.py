"""What the paper claims, held against the runs of a study; each verdict follows from a threshold."""

from __future__ import annotations

from collections.abc import Callable

from brunovsky.comparison import claim_limits, claim_performance
from brunovsky.comparison.claim import Case, Claim
from brunovsky.comparison.run import Comparison

__all__ = ["Claim", "claims"]

_TESTS: tuple[Callable[[Comparison, list[Case]], Claim | None], ...] = (
    claim_performance.convergence,
    claim_performance.errors,
    claim_performance.chattering,
    claim_performance.smoothness,
    claim_limits.robustness,
    claim_limits.orientation,
    claim_limits.heading,
    claim_limits.stabilization,
)


def claims(comparison: Comparison) -> list[Claim]:
    """Claims of the paper that the runs of this study can speak to."""
    cases: list[Case] = []
    for scenario in comparison.study.scenarios:
        good = {name: run for name, run in comparison.of(scenario).items() if run.ok}
        if good:
            cases.append((scenario, good))
    return [claim for claim in (test(comparison, cases) for test in _TESTS) if claim is not None]
