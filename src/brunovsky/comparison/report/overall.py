"""The table of all runs that stands behind the verdict, failures included."""

from __future__ import annotations

from brunovsky.comparison.facts import number
from brunovsky.comparison.protocol_section import Table
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.tables import metric_cell, told_metrics

_MAIN = (
    "settling_time",
    "rms_tail_error",
    "peak_speed",
    "peak_yaw_acceleration",
    "total_variation_u1",
    "total_variation_u2",
)


def overall_table(comparison: Comparison) -> Table:
    """One row for each run: how it ended, and the metrics that the study names, or its main ones."""
    shown = told_metrics(comparison.study.metrics or _MAIN)
    titles = {one.name: one.title for one in comparison.study.scenarios}
    columns = (
        "scenario",
        "law",
        "ended",
        *(one.title if one.unit == "1" else f"{one.title}, {one.unit}" for one in shown),
    )
    rows = tuple(
        (
            titles[run.planned.scenario],
            run.planned.law,
            ended(run),
            *(metric_cell(run, one.name, 3) for one in shown),
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
