"""What a run takes from a description: times, and which variables are set and compared."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from fmpy.model_description import ModelDescription

REALS = ("Real", "Float64")
MOST_STEPS = 100
MOST_ELEMENTS = 100_000


@dataclass(frozen=True)
class Experiment:
    """Start in s, communication step in s, and number of steps: the default experiment's beginning."""

    start: float
    step: float
    steps: int

    @property
    def stop(self) -> float:
        """End, in s."""
        return self.start + self.steps * self.step


def experiment(description: ModelDescription) -> Experiment:
    """Default experiment of an FMU, at most ``MOST_STEPS`` steps of it; 0 to 1 s where it names none."""
    given = description.defaultExperiment
    start = _number(given and given.startTime, 0.0)
    stop = _number(given and given.stopTime, start + 1.0)
    stop = stop if stop > start else start + 1.0
    step = _number(given and given.stepSize, (stop - start) / MOST_STEPS)
    fixed = _number(description.coSimulation and description.coSimulation.fixedInternalStepSize, 0.0)
    step = min(step, stop - start) if step > 0 else (stop - start) / MOST_STEPS
    if fixed > 0:
        step = fixed * max(1, round(step / fixed))
    return Experiment(start, step, max(1, min(MOST_STEPS, math.floor((stop - start) / step + 1e-9))))


def _number(text: Any, default: float) -> float:
    try:
        number = float(text) if text not in (None, "") else default
    except ValueError:  # a failed check by itself
        return default
    return number if math.isfinite(number) else default


def size(variable: Any) -> int:
    """Number of elements of a variable."""
    return math.prod(variable.shape or (1,))


def real_variables(variables: Iterable[Any], causality: str, variability: str = "") -> list[Any]:
    """Scalars and arrays of doubles of a causality that no clock guards."""
    return [
        one
        for one in variables
        if one.type in REALS
        and one.causality == causality
        and not one.clocks
        and not one.alias
        and variability in ("", one.variability)
        and size(one) <= MOST_ELEMENTS
    ]
