"""Results of a comparison as plain data: metrics.json, and what the report says of two engines."""

from __future__ import annotations

from typing import Any

from brunovsky.comparison.agreement import POSITION_TOLERANCE, agreement_text
from brunovsky.comparison.output import plain
from brunovsky.comparison.protocol_section import Cell, Table
from brunovsky.comparison.report.files import trace_name
from brunovsky.comparison.run import Comparison
from brunovsky.comparison.sensitivity import step_sensitivity


def metrics_data(comparison: Comparison) -> dict[str, Any]:
    """What ``metrics.json`` holds: study, provenance, and for each run its metrics and how it ended."""
    study = comparison.study
    return {
        "study": study.name,
        "provenance": {
            **plain(comparison.provenance),
            "resolved_study": study.model_dump(mode="json"),
            "agreement_with_native": agreement_data(comparison),
        },
        "runs": [
            {
                "name": run.planned.name,
                "law": run.planned.law,
                "scenario": run.planned.scenario,
                "metrics": run.metrics.as_dict(),
                "step_sensitivity": step_sensitivity(run),
                "status": run.status.state,
                "status_time": run.status.time,
                "status_message": run.status.message,
                "duration": run.planned.duration,
                "parameters": dict(run.planned.parameters),
                "inputs": dict(run.planned.inputs),
                "trace": trace_name(run) if run.trajectory.sizes["time"] else None,
            }
            for run in comparison.runs
        ],
    }


def agreement_data(comparison: Comparison) -> dict[str, Any] | None:
    """Cross-check of all runs against the native simulation; None where that is the engine."""
    found = [run.agreement for run in comparison.runs if run.agreement is not None]
    if not found:
        return None
    positions = [one.position for one in found if one.position is not None]
    return {
        "max_position_difference": max(positions, default=None),
        "all_agree": all(one.agrees for one in found),
        "position_tolerance": POSITION_TOLERANCE if found[0].basis == "rounding" else None,
        "basis": found[0].basis,
        "text": agreement_text(found, comparison.provenance),
        "runs": [one.as_dict() for one in found],
    }


def metrics_table(comparison: Comparison) -> Table:
    """All metrics of all runs in full digits, and their relative change at half the step."""
    names = list(comparison.runs[0].metrics.as_dict())
    columns = ("scenario", "law", "status", "status_time", *names, *(f"{name}_change_at_half_step" for name in names))
    rows: list[tuple[Cell, ...]] = []
    for run in comparison.runs:
        metrics, changes = run.metrics.as_dict(), step_sensitivity(run)
        state = (run.planned.scenario, run.planned.law, run.status.state, run.status.time)
        rows.append((*state, *(metrics[name] for name in names), *(changes[name] for name in names)))
    return Table("metrics", columns, tuple(rows))
