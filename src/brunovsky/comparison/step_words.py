"""Which step the numbers of a report are of: that of the simulation, or the one at which components exchange values."""

from __future__ import annotations

from brunovsky.comparison.facts import given
from brunovsky.comparison.run import Comparison


def step_text(comparison: Comparison) -> str:
    """The step of all numbers, such as "step of 1 ms"."""
    internal = f"{given(1e3 * comparison.study.step_size_s)} ms"
    return (
        f"communication step of {_exchange(comparison)} (internal {internal})"
        if _coupled(comparison)
        else (f"step of {internal}")
    )


def instants_text(comparison: Comparison) -> str:
    """The instants that metrics are made of."""
    if not _coupled(comparison):
        return "the internal steps"
    return f"the communication points, {_exchange(comparison)} apart"


def working_text(comparison: Comparison) -> str:
    """When a law without sampling of its own has new measurements."""
    internal = f"{given(1e3 * comparison.study.step_size_s)} ms"
    if not _coupled(comparison):
        return f"works at each internal step of {internal}"
    return f"has new measurements at each communication step of {_exchange(comparison)} (internal {internal})"


def _coupled(comparison: Comparison) -> bool:
    return comparison.engine == "ssp"


def _exchange(comparison: Comparison) -> str:
    return f"{given(1e3 * comparison.study.communication_step)} ms"
