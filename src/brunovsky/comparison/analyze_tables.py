"""Tables of an analysis for a terminal."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from rich.markup import escape
from rich.table import Table

from brunovsky.analysis import ChatterRow, DiskMargin, Margins
from brunovsky.comparison.analyze import Analysis
from brunovsky.comparison.analyzed_loops import AnalyzedLoop, laws_outside, loops_by_name
from brunovsky.comparison.analyzed_runs import ActuatorMargins, AnalyzedRun
from brunovsky.comparison.facts import given, number
from brunovsky.comparison.study.chatter_grid import ChatterGrid
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
    loops = loops_by_name(analysis.laws)
    tables = [_laws(analysis), *([_loops(loops)] if loops else []), _outside(analysis)]
    tables += [_actuators(analysis.runs), _reaching(analysis.runs), _singularity(analysis.runs), _bounds(analysis.runs)]
    tables += [_chatter(grid, rows) for grid, rows in analysis.grids]
    return tuple(table for table in tables if table.row_count)


def _table(title: str, *columns: str) -> Table:
    table = Table(title=escape(title), title_justify="left", title_style="bold", box=None, pad_edge=False)
    for index, column in enumerate(columns):
        table.add_column(column, justify="right" if index else "left", no_wrap=index == 0, overflow="fold")
    return table


def _footnote(table: Table, text: str) -> None:
    table.caption, table.caption_justify = text, "left"


def _laws(analysis: Analysis) -> Table:
    title = "Laws (Q in 1/s, P in m/s³, φ in m/s², poles in 1/s, |d| at the level of v in m/s³)"
    table = _table(title, "law", "kind", "C", "Q", "P", "φ", "poles on S = 0", "rejects |d| <")
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


def _outside(analysis: Analysis) -> Table:
    table = _table("Not analysed, as they are of another kind than the paper's law", "laws")
    outside = laws_outside(analysis.study)
    if outside:
        table.add_row(escape(", ".join(outside)))
    return table


def _loops(loops: dict[str, AnalyzedLoop]) -> Table:
    table = _table("Linear loops, cut at v", "", *loops)
    rows = list(loops.values())
    table.add_row("gain K, 1/s³; 1/s²; 1/s", *(_listed(one.gain) for one in rows))
    table.add_row("poles, 1/s", *(poles_text(one.poles) for one in rows))
    for name, label, scale in MARGIN_ROWS:
        if name in ("max_sensitivity", "disk_margin"):
            continue  # told below
        table.add_row(label, *(_of(one.margins, name, scale) for one in rows))
    table.add_row("peak sensitivity Ms", *(_of(one.margins, "max_sensitivity") for one in rows))
    table.add_row("disk margin", *(_of(one.disk_margin, "radius") for one in rows))
    table.add_row("bandwidth, rad/s", *(number(one.bandwidth) for one in rows))
    for key, label in _STEP_ROWS:
        table.add_row(f"set point: {label}", *(number(one.step[key]) if one.step else "–" for one in rows))
    return table


def _actuators(runs: Sequence[AnalyzedRun]) -> Table:
    found: dict[tuple[str, str, ActuatorMargins], None] = {}
    for run in runs:
        motion = f"{given(run.speed)} m/s and {given(run.yaw_rate)} rad/s"
        found |= {(motion, part.replace("_", " "), one): None for part, one in (run.actuators or {}).items()}
    motions = {motion for motion, _, _ in found}
    title = "Margins at the actuators of the nominal robot, " + (
        f"at {motions.pop()}" if len(motions) == 1 else "moving"
    )
    columns = ("gain ×", "phase, °", "delay, ms", "lag, ms", "Ms", "disk", "both")
    table = _table(f"{title} (disk margin of one, of both at once)", "loop cut at", *columns)
    for motion, part, one in found:
        where = part if not motions else f"{motion}, {part}"
        for cut, margins, disk in (("u₁", one.u1, one.disk_u1), ("u₂", one.u2, one.disk_u2)):
            table.add_row(
                f"{cut}, {where}",
                f"{number(margins.gain_lower)} to {number(margins.gain_upper)}",
                _of(margins, "phase", 180.0 / math.pi, 3),
                _of(margins, "delay", 1e3, 3),
                _of(margins, "lag", 1e3, 3),
                _of(margins, "max_sensitivity", 1.0, 3),
                number(disk.radius),
                number(one.disk_both.radius),
            )
    return table


def _reaching(runs: Sequence[AnalyzedRun]) -> Table:
    table = _table("Runs: reaching (S in m/s², times in s)", "run", "S₁(0)", "S₂(0)", "S₁ after", "S₂ after")
    for run in runs:
        times = ("never" if math.isinf(one) else number(one) for one in run.reaching_time)
        table.add_row(run.name, *(number(one) for one in run.sliding_start), *times)
    _footnote(table, "Nominal robot, while abs(eta1) stays above eta_min; to phi in a boundary layer.")
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
    title = "Runs: disturbances that P rejects on the reference, and the error that the run's own leave"
    table = _table(title, "run", "|d₁| <, m/s²", "|d₂| <, rad/s²", "error, m")
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
