"""Tables of an analysis for a terminal."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from rich.table import Table

from brunovsky.analysis import ChatterRow, DiskMargin, Margins
from brunovsky.comparison.analyze import Analysis
from brunovsky.comparison.analyze_figures import named_loops
from brunovsky.comparison.analyzed_loops import AnalyzedLoop
from brunovsky.comparison.analyzed_runs import ActuatorMargins, AnalyzedRun
from brunovsky.comparison.chatter_grid import ChatterGrid
from brunovsky.comparison.facts import given, number
from brunovsky.comparison.tables import MARGIN_ROWS, poles_text

_STEP_ROWS = (("RiseTime", "rise time, s"), ("Overshoot", "overshoot, %"), ("SettlingTime", "settling time (2 %), s"))


def analysis_tables(analysis: Analysis) -> tuple[Table, ...]:
    """Tables of an analysis, for a `rich.console.Console`.

    Parameters
    ----------
    analysis : Analysis
        From :func:`analyze_study`.

    Returns
    -------
    tuple of rich.table.Table
        Laws, linear loops, margins at the actuators, runs, and one for each chatter grid.
    """
    tables = [_laws(analysis), _loops(named_loops(analysis))]
    tables += [_actuators(analysis.runs), _reaching(analysis.runs), _singularity(analysis.runs), _bounds(analysis.runs)]
    tables += [_chatter(grid, rows) for grid, rows in analysis.grids]
    return tuple(table for table in tables if table.row_count)


def _table(title: str, *columns: str) -> Table:
    table = Table(title=title, title_justify="left", title_style="bold", box=None, pad_edge=False)
    for index, column in enumerate(columns):
        table.add_column(column, justify="left" if index == 0 else "right", overflow="fold")
    return table


def _footnote(table: Table, text: str) -> None:
    table.caption, table.caption_justify = text, "left"


def _laws(analysis: Analysis) -> Table:
    table = _table(
        "Laws",
        "law",
        "kind",
        "C, 1/s²; 1/s; 1",
        "Q, 1/s",
        "P, m/s³",
        "φ, m/s²",
        "poles on S = 0, 1/s",
        "rejects |d| <, m/s³",
    )
    for law in analysis.laws:
        table.add_row(
            law.law,
            law.kind,
            _listed(law.C),
            given(law.Q),
            given(law.P),
            given(law.phi) if law.kind == "saturation" else "–",
            poles_text(law.surface_poles),
            given(law.matched_disturbance_bound),
        )
    return table


def _loops(loops: dict[str, AnalyzedLoop]) -> Table:
    table = _table("Linear loops, cut at v", "", *loops)
    rows = list(loops.values())
    table.add_row("gain K, 1/s³; 1/s²; 1/s", *(_listed(one.gain) for one in rows))
    table.add_row("poles, 1/s", *(poles_text(one.poles) for one in rows))
    for name, label, scale in MARGIN_ROWS:
        table.add_row(label, *(_of(one.margins, name, scale) for one in rows))
    table.add_row("peak sensitivity Ms", *(_of(one.margins, "max_sensitivity") for one in rows))
    table.add_row("disk margin", *(_of(one.disk_margin, "radius") for one in rows))
    table.add_row("bandwidth, rad/s", *(number(one.bandwidth) for one in rows))
    for key, label in _STEP_ROWS:
        table.add_row(f"set point: {label}", *(number(one.step[key]) if one.step else "–" for one in rows))
    return table


def _actuators(runs: Sequence[AnalyzedRun]) -> Table:
    columns = ("gain ×", "phase, °", "delay, ms", "lag, ms", "Ms", "disk", "both: disk")
    table = _table("Margins at the actuators, nominal robot on its reference", "motion, loop, actuator", *columns)
    seen: set[tuple[float, float, ActuatorMargins]] = set()
    for run in runs:
        for part, found in (run.actuators or {}).items():
            key = (run.speed, run.yaw_rate, found)
            if key in seen:
                continue
            seen.add(key)
            where = f"{given(run.speed)} m/s, {given(run.yaw_rate)} rad/s, {part.replace('_', ' ')}"
            for cut, margins, disk in (("u₁", found.u1, found.disk_u1), ("u₂", found.u2, found.disk_u2)):
                table.add_row(
                    f"{where}, {cut}",
                    f"{number(margins.gain_lower)} to {number(margins.gain_upper)}",
                    _of(margins, "phase", 180.0 / math.pi, 3),
                    _of(margins, "delay", 1e3, 3),
                    _of(margins, "lag", 1e3, 3),
                    _of(margins, "max_sensitivity", 1.0, 3),
                    number(disk.radius),
                    number(found.disk_both.radius),
                )
    return table


def _reaching(runs: Sequence[AnalyzedRun]) -> Table:
    table = _table("Runs: reaching", "run", "S₁(0), m/s²", "S₂(0), m/s²", "S₁ reached after, s", "S₂ reached after, s")
    for run in runs:
        times = ("never" if math.isinf(one) else number(one) for one in run.reaching_time)
        table.add_row(run.name, *(number(one) for one in run.sliding_start), *times)
    return table


def _singularity(runs: Sequence[AnalyzedRun]) -> Table:
    table = _table("Runs: forecast of linear laws", "run", "smallest |η₁|, m/s", "at, s", "largest |u₂|, rad/s²")
    for run in runs:
        if run.forecast is not None:
            speed = number(run.forecast.closest_speed) + (" *" if run.forecast.guarded else "")
            table.add_row(
                run.name, speed, number(run.forecast.closest_time), number(run.forecast.peak_yaw_acceleration)
            )
    if any(run.forecast and run.forecast.guarded for run in runs):
        _footnote(table, "* not above eta_min, where the law that runs is the guarded one")
    return table


def _bounds(runs: Sequence[AnalyzedRun]) -> Table:
    table = _table(
        "Runs: disturbances", "run", "rejects |d₁| <, m/s²", "rejects |d₂| <, rad/s²", "error that its own leave, m"
    )
    for run in runs:
        table.add_row(
            run.name,
            number(run.forward_disturbance_bound),
            number(run.yaw_disturbance_bound),
            number(run.predicted_residual),
        )
    return table


def _chatter(grid: ChatterGrid, rows: Sequence[ChatterRow]) -> Table:
    """Columns for what varies within the grid; what doesn't stands in the title."""
    axes = {
        "lags, ms": [" ".join(f"{1e3 * one:.4g}" for one in row.lag_s) or "none" for row in rows],
        "delay, ms": [given(1e3 * row.delay_s) for row in rows],
        "C": [_listed(row.C) for row in rows],
        "Q": [given(row.Q) for row in rows],
        "P": [given(row.P) for row in rows],
        "φ": [given(row.phi) for row in rows],
    }
    varying = {name: cells for name, cells in axes.items() if len(set(cells)) > 1 or name == "lags, ms"}
    fixed = [f"{name} = {cells[0]}" for name, cells in axes.items() if name not in varying and cells[0] != "0"]
    if rows[0].sampling_s is not None:
        fixed.append(f"sampling = {given(1e3 * rows[0].sampling_s)} ms")
    columns = ("A by DF", "A by locus", "A simulated", "ω by DF", "ω by locus", "ω simulated", "outcome")
    table = _table(f"Chatter: {grid.title} ({', '.join(fixed)}); A in m/s², ω in rad/s", *varying, *columns)
    for index, row in enumerate(rows):
        numbers = (
            getattr(row, f"{one}_{what}")
            for what in ("amplitude", "frequency_rad_s")
            for one in ("predicted", "locus", "simulated")
        )
        outcome = row.outcome if row.linear_part_stable else f"{row.outcome} *"
        table.add_row(*(cells[index] for cells in varying.values()), *(number(one) for one in numbers), outcome)
    if not all(row.linear_part_stable for row in rows):
        _footnote(table, "* the linear part is unstable there")
    return table


def _of(found: Margins | DiskMargin | None, name: str, scale: float = 1.0, digits: int = 4) -> str:
    return "unstable" if found is None else number(scale * getattr(found, name), digits)


def _listed(values: Any) -> str:
    return ", ".join(given(float(one)) for one in values)
