"""What is kept beside a report: trajectories as netCDF, tables as CSV."""

from __future__ import annotations

import csv
import io
import json

from brunovsky.comparison.protocol_section import Cell, Table
from brunovsky.comparison.run import Comparison, Run


def trace_name(run: Run) -> str:
    """Name of the file with the trajectory of a run."""
    return f"traces/{run.planned.scenario}--{run.planned.law}.nc"


def trace_bytes(comparison: Comparison, run: Run) -> bytes:
    """Trajectory of a run as netCDF (classic format with 64-bit offsets), with what it was run with as attributes."""
    planned = run.planned
    about = {
        "study": comparison.study.name,
        "study_sha256": comparison.provenance["study_sha256"],
        "scenario": planned.scenario,
        "law": planned.law,
        "engine": comparison.engine,
        "step_size_s": planned.step_size,
        "status": run.status.state,
        "status_message": run.status.message,
        "parameters": json.dumps(dict(planned.parameters)),
        "inputs": json.dumps(dict(planned.inputs)),
    }
    written = run.trajectory.assign_attrs(about).to_netcdf(engine="scipy", format="NETCDF3_64BIT")
    return bytes(written)


def csv_text(table: Table) -> str:
    """Table as CSV, UTF-8: all digits of its numbers, empty where undefined."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(table.columns)
    writer.writerows([[_written(cell) for cell in row] for row in table.rows])
    return text.getvalue()


def _written(cell: Cell) -> str:
    if cell is None:
        return ""
    return repr(cell) if isinstance(cell, float) else str(cell)
