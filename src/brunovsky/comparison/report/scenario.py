"""The part of a report that belongs to one scenario: figures in their fixed order, findings, table of metrics."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

from matplotlib.figure import Figure

from brunovsky.comparison import drawing, figures
from brunovsky.comparison.facts import given, joined
from brunovsky.comparison.findings import scenario_findings
from brunovsky.comparison.protocol_section import Table
from brunovsky.comparison.run import Comparison
from brunovsky.comparison.study import FigureName, Law, Scenario
from brunovsky.comparison.tables import conditions, footnote, metric_rows


@dataclass(frozen=True)
class Picture:
    """A figure of a report: its SVG and what stands below it."""

    svg: str
    caption: str
    narrow: bool = False


@dataclass(frozen=True)
class ScenarioSection:
    """What a report shows of one scenario."""

    scenario: Scenario
    conditions: str
    figures: tuple[Picture, ...]
    findings: tuple[str, ...]
    table: Table
    footnote: str


MOST, BESIDE = 6, 4  # laws that one figure shows; of more, those in a figure beside pole placement
_SIGNALS = "Traces are thinned so that peaks remain."
# In the order in which every scenario shows them.
_FIGURES: tuple[tuple[FigureName, str, Callable[[Comparison, Scenario], Figure], str], ...] = (
    (
        "path",
        "Path",
        figures.path_figure,
        "On equal scales. The lines of the laws are drawn over one another: where they coincide, all show.",
    ),
    ("errors", "Errors", figures.errors_figure, f"{{window}} Position errors below 1 nm are drawn at 1 nm. {_SIGNALS}"),
    ("inputs", "Physical inputs", figures.inputs_figure, f"{{window}} The law divides by η₁. {_SIGNALS}"),
    ("sliding", "Sliding variables", figures.sliding_figure, f"{{window}} {_SIGNALS}"),
    (
        "phase",
        "Phase portraits",
        figures.phase_figure,
        "Above error and its rate (a projection: a chain has three states), below sliding variable and its mean "
        "rate over "
        "each step, to the end. Dotted: the reaching law S′ = −Q S − P σ(S) of the paper’s laws without disturbance, "
        "and the boundary layer. A "
        "stroke that only covers what earlier ones cover is left out.",
    ),
)


def scenario_section(comparison: Comparison, scenario: Scenario) -> ScenarioSection:
    """Everything a report shows of one scenario; without figures if no run of it made a step."""
    pairs = comparison.laws_of(scenario)
    runs = [run for _, run in pairs]
    rests = all(run.planned.target is not None and run.planned.guard is not None for run in runs)
    caption = f"Metrics of “{scenario.title}” ({scenario.name})"
    caption += ". The robot ends at rest, the law’s singularity, where the guard acts" if rests else ""
    columns = ("metric", "unit", *(law.name for law, _ in pairs))
    rows = tuple((label, unit, *cells) for label, unit, cells in metric_rows(runs, comparison.study.metrics))
    drawn = any(run.trajectory.sizes["time"] for run in runs)
    return ScenarioSection(
        scenario=scenario,
        conditions=conditions(runs[0]),
        figures=_pictures(comparison, scenario) if drawn else (),
        findings=tuple(scenario_findings(comparison, scenario)),
        table=Table(f"metrics-{scenario.name}", columns, rows, caption, heads=2),
        footnote=footnote(runs, comparison.study.metrics),
    )


def _pictures(comparison: Comparison, scenario: Scenario) -> tuple[Picture, ...]:
    groups = _groups(comparison, scenario)
    found = []
    for kind, name, draw, about in _FIGURES:
        if kind not in comparison.study.figures:
            continue
        for k, one in enumerate(groups, 1):
            runs = one.of(scenario).values()
            if not any(
                run.trajectory.sizes["time"] and (kind != "sliding" or "S[1]" in run.trajectory) for run in runs
            ):
                continue
            window = figures.transient_window(one, scenario)
            until = f"The first {given(window)} s." if window < scenario.duration_s else "To the end."
            title, key = f"{name}: {scenario.title}", f"{scenario.name}-{name.lower().replace(' ', '-')}"
            if len(groups) > 1:
                title += (
                    f", {k} of {len(groups)}, under {joined([f'“{law.name}”' for law, _ in one.laws_of(scenario)])}"
                )
                key += f"-{k}"
            figure = draw(one, scenario)
            said = about.format(window=until) if k == 1 else until * about.startswith("{window}")
            caption = " ".join(filter(None, (f"{title}.", said, figures.linear_parts(figure))))
            found.append(Picture(drawing.svg(figure, key, title), caption, narrow=kind == "path"))
    return tuple(found)


def _groups(comparison: Comparison, scenario: Scenario) -> list[Comparison]:
    """Comparisons of as few laws of a scenario as one figure can show: pole placement, or the first, is in each."""
    laws = [law for law, _ in comparison.laws_of(scenario)]
    if len(laws) <= MOST:
        return [comparison]
    base = next((law for law in laws if law.kind == "linear"), laws[0])
    others = [law for law in laws if law is not base]
    count = math.ceil(len(others) / BESIDE)
    ends = [round(len(others) * k / count) for k in range(count + 1)]
    return [_of_laws(comparison, scenario, [base, *others[first:last]]) for first, last in pairwise(ends)]


def _of_laws(comparison: Comparison, scenario: Scenario, laws: list[Law]) -> Comparison:
    names = {law.name for law in laws}
    runs = tuple(run for name, run in comparison.of(scenario).items() if name in names)
    return replace(comparison, study=comparison.study.model_copy(update={"laws": tuple(laws)}), runs=runs)
