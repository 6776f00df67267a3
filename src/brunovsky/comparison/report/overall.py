"""The table of all runs that stands behind the verdict, failures included."""

from __future__ import annotations

from brunovsky.comparison.facts import number, seconds
from brunovsky.comparison.protocol_section import Table
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.sensitivity import both, told

_COLUMNS = (
    ("rms_tail_error", "RMS error, last quarter, m"),
    ("peak_speed", "largest |η₁|, m/s"),
    ("peak_yaw_acceleration", "largest |u₂|, rad/s²"),
    ("total_variation_u1", "total variation of u₁, m/s²"),
    ("total_variation_u2", "total variation of u₂, rad/s²"),
)


def overall_table(comparison: Comparison) -> Table:
    """One row for each run: how it ended, and its main metrics."""
    titles = {one.name: one.title for one in comparison.study.scenarios}
    columns = ("scenario", "law", "ended", "settling time to 1 cm, s", *(label for _, label in _COLUMNS))
    rows = tuple(
        (
            titles[run.planned.scenario],
            run.planned.law,
            ended(run),
            _settling(run),
            *(told(run, name) for name, _ in _COLUMNS),
        )
        for run in comparison.runs
    )
    return Table("overall", columns, rows)


def ended(run: Run) -> str:
    """How a run ended, in a few words."""
    if run.ok:
        return "ok"
    when = f"at {number(run.status.time)} s" if run.status.time is not None else "before its first step"
    return f"failed: {run.status.state} {when}"


def _settling(run: Run) -> str:
    value = both(run, "settling_time")[0]
    if value is None:
        return "never" if run.ok else "–"
    return seconds(value).removesuffix("\u00a0s")
