"""Protocols that were run, as sections of a report: figure, table of estimates, findings; all trials as a table."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from matplotlib.figure import Figure

from brunovsky.comparison import drawing
from brunovsky.comparison.chatter_section import chatter_section
from brunovsky.comparison.facts import number
from brunovsky.comparison.figures import worst_paths_figure
from brunovsky.comparison.protocol_runs import Path, ProtocolRun, Result
from brunovsky.comparison.protocol_section import Cell, ProtocolSection, Table
from brunovsky.comparison.protocols import (
    Coupling,
    EqualEffort,
    Map,
    MeasuredLoopMargins,
    MonteCarlo,
    Pareto,
    Swept,
    coupling_figure,
    equal_effort_figure,
    map_figure,
    margins_figure,
    monte_carlo_figure,
    pareto_figure,
    swept_figure,
)
from brunovsky.comparison.protocols.explanation import SWEPT
from brunovsky.comparison.run import Comparison
from brunovsky.comparison.symbols import symbol

_FIGURES: Mapping[type, Callable[..., Figure]] = {
    Swept: swept_figure,
    EqualEffort: equal_effort_figure,
    Pareto: pareto_figure,
    MonteCarlo: monte_carlo_figure,
    Map: map_figure,
    MeasuredLoopMargins: margins_figure,
    Coupling: coupling_figure,
}


_SAME = "the two positions are bit for bit the same"


def protocol_sections(comparison: Comparison, *, drawn: bool = True) -> tuple[ProtocolSection, ...]:
    """Sections of a report for the protocols of a study, in its order.

    Parameters
    ----------
    comparison : Comparison
        From :func:`run_study`.
    drawn : bool
        Whether they have figures.
    """
    titles = {law.name: law.title or law.name for law in comparison.study.laws}
    found: list[ProtocolSection] = []
    for index, one in enumerate(comparison.protocols, 1):
        scenario = comparison.study.scenario(one.table.scenario)
        found.append(_section(one, index, scenario.title, titles, drawn))
        if one.worst and drawn:
            found.append(_worst_section(one, index, titles))
    chatter = chatter_section(comparison, drawn=drawn)
    return tuple(found) if chatter is None else (chatter, *found)


def trial_tables(comparison: Comparison) -> tuple[Table, ...]:
    """All trials of all protocols, a row for each run, for CSV."""
    return tuple(
        table_of(f"protocol-{index}-trials", _trial_rows(one)) for index, one in enumerate(comparison.protocols, 1)
    )


def protocol_data(comparison: Comparison) -> list[dict[str, Any]]:
    """Results of all protocols as plain data, for JSON."""
    return [
        {
            "kind": one.table.kind,
            "scenario": one.table.scenario,
            "result": one.result.as_dict(),
            "drawn": {key: list(values) for key, values in one.drawn.items()},
            "agreement_with_native": [found.as_dict() for found in one.agreement],
        }
        for one in comparison.protocols
    ]


def table_of(name: str, rows: Sequence[Mapping[str, Any]], caption: str = "") -> Table:
    """A table of rows that are mappings from heading to cell; a cell that a row lacks is undefined."""
    columns = tuple(dict.fromkeys(key for row in rows for key in row))
    return Table(name, columns, tuple(tuple(_cell(row.get(key)) for key in columns) for row in rows), caption)


def _cell(value: Any) -> Cell:
    return ("yes" if value else "no") if isinstance(value, bool) else value


def _trial_rows(one: ProtocolRun) -> list[dict[str, Any]]:
    drawn = one.drawn
    return [
        {**row, **{key: values[int(row.get("case", 0))] for key, values in drawn.items()}} for row in one.result.rows()
    ]


def _section(one: ProtocolRun, index: int, scenario: str, titles: Mapping[str, str], drawn: bool) -> ProtocolSection:
    result, explanation = one.result, one.result.explanation
    key = f"protocol-{index}"
    if drawn:
        with drawing.settings():
            picture = drawing.svg(_FIGURES[type(result)](result, titles), key)
    rows = result.summary_rows() if isinstance(result, MonteCarlo | Map | Coupling) else result.rows()
    findings = tuple(result.findings())
    scenario = f"{scenario}{_replaced(result)}"
    return ProtocolSection(
        title=f"{_title(result)}: {scenario}",
        explanation=f"{explanation.holds_equal} What it cannot say: {explanation.cannot_say}",
        figure_svg=picture if drawn else "",
        table=table_of(key, rows, f"{_title(result)}, “{scenario}”"),
        findings=(*findings, *_agreement(one)),
        caption=f"{_title(result)}, “{scenario}”. {_reading(result)}".rstrip(),
        headline=_headline(result, findings, scenario),
        leads=isinstance(result, Coupling),
    )


def _headline(result: Result, findings: Sequence[str], scenario: str) -> str:
    """What the verdict says of a protocol: of the metric that the study names first, or of the fronts."""
    if isinstance(result, MonteCarlo | Map | Coupling):
        return f"“{scenario}”: {result.headline()}"
    if isinstance(result, EqualEffort):
        findings = [result.headline()] if result.headline() else []
    if not findings:
        return ""
    if isinstance(result, Pareto):  # who dominates whom; the hypervolume that follows it ranks nothing
        return f"“{scenario}”: {findings[-2] if len(findings) > 1 else findings[-1]}"
    return f"“{scenario}”: {findings[-1 if isinstance(result, MeasuredLoopMargins) else 0]}"


def _title(result: Result) -> str:
    """Title of a protocol; that of a sweep or a map names what is swept."""
    title = result.explanation.title
    if isinstance(result, Map):
        return f"{title} over {result.keys}"
    return title.replace("one parameter", symbol(result.knob)) if isinstance(result, Swept) else title


def _reading(result: Result) -> str:
    """How the figure is read; that of a map over one key has lines."""
    if isinstance(result, Map) and result.up is None:
        return f"The swept parameter replaces that of the scenario. {SWEPT.reading} × is a run that failed."
    return result.explanation.reading


def _replaced(result: Result) -> str:
    """That a map sweeps what the scenario's title may name."""
    if not isinstance(result, Map):
        return ""
    keys = [one.key for one in (result.across, result.up) if one is not None]
    return f" ({'starts' if all('_start' in one for one in keys) else ' and '.join(map(symbol, keys))} swept)"


def _agreement(one: ProtocolRun) -> list[str]:
    """What the native simulation says of the trials that it repeated."""
    known = [found.position for found in one.agreement if found.position is not None]
    if not known:
        return []
    differing = [found.run for found in one.agreement if not found.agrees]
    apart = "" if not differing else f"; {len(differing)} of them beyond what counts as agreement"
    far = f"the two positions are at most {number(max(known), 2)} m apart" if max(known) else _SAME
    return [f"The native simulation repeated {len(one.agreement)} of the trials; {far}{apart}."]


def _worst_section(one: ProtocolRun, index: int, titles: Mapping[str, str]) -> ProtocolSection:
    assert one.table.kind == "monte_carlo"
    key, metric = f"protocol-{index}-worst", one.table.worst or ""
    by_law: dict[str, list[Path]] = {}
    for path in one.worst:
        by_law.setdefault(path.law, []).append(path)
    rows = [{"law": path.law, "case": path.case, metric: path.value} for path in one.worst]
    most = max(map(len, by_law.values()))
    with drawing.settings():
        picture = drawing.svg(worst_paths_figure(by_law, titles), key)
    return ProtocolSection(
        title=f"The worst {most} cases of each law",
        explanation=(
            f"Cases in which {metric.replace('_', ' ')} is largest or undefined, as paths; failed runs come first. "
            "They show what goes wrong, not how often."
        ),
        figure_svg=picture,
        table=table_of(key, rows, "The cases drawn"),
        caption=f"Paths of the worst cases by {metric.replace('_', ' ')}; a circle is the start, a cross the end.",
    )
