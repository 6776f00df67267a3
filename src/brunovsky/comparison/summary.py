"""The short summary of a comparison that is kept beside its study file, in Markdown."""

from __future__ import annotations

from collections.abc import Sequence

from brunovsky.comparison.claims import claims, examined
from brunovsky.comparison.facts import number
from brunovsky.comparison.findings import scenario_findings
from brunovsky.comparison.protocol_section import Cell, ProtocolSection, Table
from brunovsky.comparison.protocol_sections import protocol_sections
from brunovsky.comparison.report.verdict import verdict
from brunovsky.comparison.run import Comparison
from brunovsky.comparison.sensitivity import step_note
from brunovsky.comparison.step_words import step_text
from brunovsky.comparison.tables import conditions, footnote, metric_rows

LONGEST = 100  # rows of a table that is kept
_KEPT = (
    "settling_time",
    "settling_1mm",
    "settling_100um",
    "rms_tail_error",
    "peak_speed",
    "min_speed",
    "peak_yaw_acceleration",
    "total_variation_u1",
    "total_variation_u2",
    "min_speed_moving",
    "peak_forward_acceleration",
    "sliding_band",
)  # of the metrics, where a study names none


def summary_markdown(comparison: Comparison) -> str:
    """What a comparison found: verdict, claims, protocols, and for each scenario its paragraphs and main metrics.

    Without dates and versions, so that it changes only where the findings do.
    """
    study = comparison.study
    lines = [
        f"# {study.title}",
        "",
        f"{study.description}",
        "",
        f"Written from the runs of `{study.name}.toml` (engine {comparison.engine}, {step_text(comparison)}). "
        "The report of a run has the figures, the poles, all metrics and the limits of the study.",
        "",
        f"All numbers are those of this step. {step_note(comparison.engine)}",
    ]
    found, protocols = claims(comparison), protocol_sections(comparison, drawn=False)
    lines += ["", "## Verdict", "", *(f"- {one}" for one in verdict(comparison, found, protocols))]
    told = examined(found)
    if told:
        lines += ["", "## What the paper claims, and what these runs show", ""]
        lines += [f"- {claim.quote}: **{claim.verdict}**. {claim.shown}" for claim in told]
    lines += sections_markdown(protocols)
    for scenario in study.scenarios:
        pairs = comparison.laws_of(scenario)
        figure = f"Figure {scenario.figure}: " if scenario.figure else ""
        lines += ["", f"## {figure}{scenario.title}", "", conditions(pairs[0][1])]
        for paragraph in scenario_findings(comparison, scenario):
            lines += ["", paragraph]
        lines += ["", f"| metric | unit | {' | '.join(law.name for law, _ in pairs)} |"]
        lines += [f"| --- | --- |{' ---: |' * len(pairs)}"]
        runs, kept = [run for _, run in pairs], study.metrics or _KEPT
        for label, unit, cells in metric_rows(runs, kept)[all(run.ok for run in runs) :]:
            lines.append(f"| {label.replace('|', chr(92) + '|')} | {unit} | {' | '.join(cells)} |")
        note = footnote(runs, kept)
        lines += ["", note.replace("|", chr(92) + "|")] if note else []
    return "\n".join(lines) + "\n"


def sections_markdown(sections: Sequence[ProtocolSection]) -> list[str]:
    """Lines of the sections of a report: what they are, what was found, and tables that are not long."""
    lines: list[str] = []
    for section in sections:
        lines += ["", f"## {section.title}", "", section.explanation, "", *(f"- {one}" for one in section.findings)]
        if section.table is not None and len(section.table.rows) <= LONGEST:
            lines += ["", *_markdown(section.table)]
    return lines


def _markdown(table: Table) -> list[str]:
    rows = [[_cell(cell) for cell in row] for row in table.rows]
    return [f"| {' | '.join(row)} |" for row in (table.columns, ["---"] * len(table.columns), *rows)]


def _cell(cell: Cell) -> str:
    return (number(cell) if isinstance(cell, float) or cell is None else str(cell)).replace("|", chr(92) + "|")
