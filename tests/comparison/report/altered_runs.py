"""Runs of a comparison with other numbers, and what is then said of them."""

from collections.abc import Callable, Mapping
from dataclasses import replace

from brunovsky.comparison import Comparison, Run, Status
from brunovsky.comparison.claims import claims
from brunovsky.comparison.metrics import Metrics
from brunovsky.comparison.report.verdict import verdict


def altered(
    comparison: Comparison, change: Callable[[Run], Mapping[str, float | None]], factor: float = 1.0
) -> Comparison:
    """Runs with other metrics or facts, and these times a factor at half the step."""
    return replace(comparison, runs=tuple(_altered(run, change(run), factor) for run in comparison.runs))


def _altered(run: Run, values: Mapping[str, float | None], factor: float) -> Run:
    half = {name: None if value is None else factor * value for name, value in values.items()}
    parts = [(run, values), (run.half_step, half)]
    new = [
        {
            "metrics": replace(one.metrics, **{name: v for name, v in some.items() if hasattr(one.metrics, name)}),
            "facts": replace(one.facts, **{name: v for name, v in some.items() if not hasattr(one.metrics, name)}),
        }
        for one, some in parts
    ]
    return replace(run, **new[0], half_step=replace(run.half_step, **new[1]))


def failed(comparison: Comparison, name: str) -> Comparison:
    runs = tuple(
        replace(run, status=Status("singular", 1.0, "why"), metrics=Metrics(), facts=None, half_step=None)
        if run.planned.name == name
        else run
        for run in comparison.runs
    )
    return replace(comparison, runs=runs)


def scaled(name: str, factor: float, base: float = 1.0) -> Callable[[Run], Mapping[str, float]]:
    """A metric or fact that is `base` under pole placement, and `factor` times as much under the other laws."""
    return lambda run: {name: base if run.planned.law == "linear" else factor * base}


def of(comparison: Comparison, part: str):
    return next(one for one in claims(comparison) if part in one.quote)


def sentences(comparison: Comparison) -> str:
    return "\n".join(verdict(comparison, claims(comparison)))
