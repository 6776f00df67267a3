"""The short summary of a comparison that is kept beside its study file, in Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from itertools import groupby

from brunovsky.comparison.claims import claims, examined
from brunovsky.comparison.definitions import definition
from brunovsky.comparison.facts import number
from brunovsky.comparison.other_laws import other_laws
from brunovsky.comparison.protocol_section import Cell, ProtocolSection, Table
from brunovsky.comparison.protocol_sections import protocol_sections
from brunovsky.comparison.protocols.evaluation import with_unit
from brunovsky.comparison.report.overall import overall_table
from brunovsky.comparison.report.pairs import pairs_note
from brunovsky.comparison.report.verdict import verdict
from brunovsky.comparison.run import Comparison
from brunovsky.comparison.sensitivity import step_note
from brunovsky.comparison.step_words import step_text
from brunovsky.comparison.symbols import with_key_unit
from brunovsky.comparison.tables import conditions

LONGEST = 12  # rows of a protocol's table that is kept
_LINE = 300  # characters of an item, beyond which each of its sentences has a line of its own
_SENTENCES = re.compile(r"(?<=\.) (?=[A-Z“])")
_HEADER = re.compile(r"(\w+) \[.*\]")


def summary_markdown(comparison: Comparison) -> str:
    """What a comparison found: verdict, claims, findings of the protocols, and one table of all runs.

    Without dates and versions, so that it changes only where the findings do. Figures, explanations, paragraphs on each
    scenario and long tables are in the report alone.
    """
    study = comparison.study
    lines = [
        f"# {study.title}",
        "",
        f"{study.description}",
        "",
        f"Written from the runs of `{study.name}.toml` (engine {comparison.engine}, {step_text(comparison)}). The "
        "report of a run has the figures, what each protocol does and cannot say, the poles, all metrics, the tables "
        "that are not here and the limits of the study.",
        "",
        f"All numbers are those of this step. {step_note(comparison.engine, own=comparison.own_file)}",
    ]
    found, protocols = claims(comparison), protocol_sections(comparison, drawn=False)
    sentences, told = verdict(comparison, found, protocols), examined(found)
    note = pairs_note([*sentences, *(claim.shown for claim in told)])
    lines += ["", "## Verdict", "", *([note, ""] if note else []), *_items(sentences)]
    if told:
        lines += ["", "## What the paper claims, and what these runs show", ""]
        lines += _items(f"{claim.quote}: **{claim.verdict}**. {claim.shown}" for claim in told)
    others = other_laws(comparison)
    if others:
        lines += ["", "## Laws that are not of the paper’s form", ""]
        lines += [f"- “{one.name}”, {one.title}: {one.description}. {one.source}." for one in others]
    return "\n".join([*lines, *sections_markdown(protocols), *_runs(comparison)]) + "\n"


def sections_markdown(sections: Sequence[ProtocolSection]) -> list[str]:
    """Lines of the sections of a report: what was found, and tables that are short."""
    lines: list[str] = []
    for section in sections:
        lines += ["", f"## {section.title}", "", *_items(section.findings)]
        if section.table is not None and 0 < len(section.table.rows) <= LONGEST:
            lines += ["", *_markdown(_shortened(section.table))]
    return lines


def _runs(comparison: Comparison) -> list[str]:
    """What each scenario is, and the table of all runs, in which the name of a scenario stands once."""
    scenarios = [(one, comparison.laws_of(one)) for one in comparison.study.scenarios]
    lines = ["", "## All runs", ""]
    for scenario, pairs in scenarios:
        figure = f"Figure {scenario.figure}: " if scenario.figure else ""
        lines.append(f"- **{figure}{scenario.title}**: {conditions(pairs[0][1])}")
    table = overall_table(comparison)
    rows = [
        ("" if k else row[0], *row[1:])
        for _, some in groupby(table.rows, key=lambda row: row[0])
        for k, row in enumerate(some)
    ]
    ended = () if all(run.ok for run in comparison.runs) else ("ended",)
    kept = [k for k, name in enumerate(table.columns) if name != "ended" or ended]
    return [*lines, "", *_markdown(_columns(Table(table.name, table.columns, tuple(rows)), kept))]


def _items(texts: Iterable[str]) -> list[str]:
    """Items of a list; the sentences of a long one below its first."""
    lines: list[str] = []
    for text in texts:
        first, *others = _SENTENCES.split(text) if len(text) > _LINE else [text]
        lines += [f"- {first}", *(f"  - {one}" for one in others)]
    return lines


def _shortened(table: Table) -> Table:
    """Without columns that are empty, and without the number of the case where there is one case."""
    cells = list(zip(*table.rows, strict=True))
    kept = [
        k
        for k, name in enumerate(table.columns)
        if any(cell not in (None, "") for cell in cells[k]) and not (name == "case" and len(set(cells[k])) == 1)
    ]
    return _columns(table, kept)


def _columns(table: Table, kept: Sequence[int]) -> Table:
    rows = tuple(tuple(row[k] for k in kept) for row in table.rows)
    return Table(table.name, tuple(table.columns[k] for k in kept), rows)


def _markdown(table: Table) -> list[str]:
    rows = [[_cell(cell) for cell in row] for row in table.rows]
    columns = [_escaped(_title(with_key_unit(name))) for name in table.columns]
    return [f"| {' | '.join(row)} |" for row in (columns, ["---"] * len(columns), *rows)]


def _title(text: str) -> str:
    """A metric by its title and unit, where a column or cell names it by its key."""
    name = header[1] if (header := _HEADER.fullmatch(text)) else text
    return with_unit(name) if definition(name) else text


def _cell(cell: Cell) -> str:
    return _escaped(number(cell) if isinstance(cell, float) or cell is None else _title(str(cell)))


def _escaped(text: str) -> str:
    return text.replace("|", chr(92) + "|")
