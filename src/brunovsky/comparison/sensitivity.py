"""What the numbers of a run owe to its step: each is compared with the same run at half the step."""

from __future__ import annotations

import math
from collections.abc import Sequence

from brunovsky.comparison.definitions import definition
from brunovsky.comparison.facts import CONVERGED, TINY, Facts, change, number
from brunovsky.comparison.metrics import TAIL
from brunovsky.comparison.run import Run

ALIKE = 0.1  # relative change at half the step up to which a difference between two laws is told
MARK = "≈\u00a0"  # before a number that is not


def step_note(engine: str, *, own: bool = False) -> str:
    """What the mark before a number means, for the engine that made it, and whether that ran a file of the user's."""
    share = f"{100 * CONVERGED:g}\u00a0%"
    if own:
        return (
            f"Each run was repeated through the same file at half the {'communication ' * (engine == 'ssp')}step: a "
            f"number marked {MARK.strip()} changes by more than {share}, so that it is a property of the step too, not "
            "of the law alone, and no law is ranked by it."
        )
    if engine == "ssp":
        return (
            "Each run was repeated natively, as one system and at half the internal step: a number marked "
            f"{MARK.strip()} differs by more than {share} there, by the error of the coupling, the step or both, so "
            "that it is no property of the law alone, and no law is ranked by it."
        )
    how = "natively at half the step and nothing else changed"
    if engine == "fmpy":
        how = "at half the step by the native simulation, which the provenance compares with the FMU at the step itself"
    return (
        f"Each run was repeated {how}: a number marked {MARK.strip()} "
        f"changes by more than {share}, so that it is a property of the step too, not of the law alone, and no law is "
        "ranked by it."
    )


def facts_of(run: Run) -> Facts:
    """Facts of a run that reached its end."""
    assert run.facts is not None, run.planned.name
    return run.facts


def both(run: Run, name: str) -> tuple[float | None, float | None]:
    """A metric or fact of a run, and the same at half the step."""
    half = run.half_step
    if name in vars(run.metrics):
        return getattr(run.metrics, name), None if half is None else getattr(half.metrics, name)
    return getattr(run.facts, name, None), None if half is None else getattr(half.facts, name, None)


def sensitivity(run: Run, name: str) -> float | None:
    """Relative change of a metric or fact at half the step; None where it is undefined."""
    value, half = both(run, name)
    if value is None or half is None:
        return None
    if value == half:
        return 0.0
    found = half / value - 1.0 if value else math.inf
    return found if math.isfinite(found) else None


def step_sensitivity(run: Run) -> dict[str, float | None]:
    """Relative change of each metric at half the step, for JSON."""
    return {name: sensitivity(run, name) for name in run.metrics.as_dict()}


def converged(run: Run, *names: str) -> bool:
    """Whether metrics or facts change by at most one per cent at half the step."""
    for name in names:
        found = sensitivity(run, name)
        if found is None and both(run, name) != (None, None):
            return False
        if found is not None and abs(found) > CONVERGED:
            return False
    return run.half_step is not None and run.half_step.facts is not None


def settled(run: Run, name: str = "settling_time") -> bool:
    """Whether the error was within the threshold of a settling time for at least the last quarter of the run.

    An error that swings or is noisy about the threshold, or a run that is cut short, has its last crossing later.
    """
    value = both(run, name)[0]
    return value is not None and value <= TAIL * run.planned.duration


def sure_change(run: Run, base: Run, name: str) -> float | None:
    """Relative change of a metric or fact from one run to another; None where the step decides on it.

    Both numbers must be converged, and their relative change must be the same within a tenth at half the step; of a
    settling time both runs must have settled for good.
    """
    if name.startswith("settling") and not (settled(run, name) and settled(base, name)):
        return None
    if not converged(run, name) or not converged(base, name):
        return None
    value, half = (change(a, b) for a, b in zip(both(run, name), both(base, name), strict=True))
    if value is None or half is None or abs(half - value) > ALIKE * abs(value):
        return None
    return value


def is_tiny(run: Run, name: str) -> bool:
    """Whether a metric is a length so small that a share of it says nothing."""
    value, known = both(run, name)[0], definition(name)
    return value is not None and known is not None and known.unit == "m" and value < TINY


def largest(run: Run, name: str) -> float:
    """The larger of a metric or fact and the same at half the step; infinite where one is missing."""
    return max(math.inf if one is None else one for one in both(run, name))


def least(run: Run, name: str) -> float:
    """The smaller of a metric or fact and the same at half the step; 0 where one is missing."""
    return min(0.0 if one is None else one for one in both(run, name))


def told(run: Run, name: str, digits: int = 3) -> str:
    """A metric or fact as text, marked and with two digits if it is not converged."""
    value = both(run, name)[0]
    if value is None or converged(run, name):
        return number(value, digits)
    return MARK + number(value, min(digits, 2))


def spread_of(runs: Sequence[Run], name: str, unit: str, digits: int = 3) -> str:
    """Range of a metric or fact over several runs, marked if it is not converged in one of them."""
    found = [value for value in (both(run, name)[0] for run in runs) if value is not None]
    sure = all(converged(run, name) for run in runs)
    digits = digits if sure else min(digits, 2)
    low, high = number(min(found), digits), number(max(found), digits)
    return f"{'' if sure else MARK}{low if low == high else f'{low} to {high}'}\u00a0{unit}"
