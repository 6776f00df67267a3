"""The page of a report: all its parts, put into the template."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import Any, Literal

import jinja2
from markupsafe import Markup

from brunovsky.comparison import drawing, equations, figures
from brunovsky.comparison.agreement import differences_table, engine_text
from brunovsky.comparison.claim import Claim
from brunovsky.comparison.claims import claims, examined
from brunovsky.comparison.facts import given, joined, number
from brunovsky.comparison.other_laws import other_laws_table
from brunovsky.comparison.output import plain
from brunovsky.comparison.protocol_section import ProtocolSection, Table
from brunovsky.comparison.report.data import agreement_data, metrics_table
from brunovsky.comparison.report.definitions import metric_definitions
from brunovsky.comparison.report.layout import cell_text, table_layout, table_parts
from brunovsky.comparison.report.limits import limits
from brunovsky.comparison.report.linear import LinearSection, linear_section
from brunovsky.comparison.report.overall import overall_table
from brunovsky.comparison.report.pairs import pairs_note
from brunovsky.comparison.report.scenario import Picture, ScenarioSection, scenario_section
from brunovsky.comparison.report.verdict import verdict
from brunovsky.comparison.run import Comparison
from brunovsky.comparison.run_files import aside_text, coupling_text, files_table
from brunovsky.comparison.sensitivity import step_note
from brunovsky.comparison.step_words import instants_text, step_text
from brunovsky.comparison.study import Scenario

Medium = Literal["screen", "paper"]


@dataclass(frozen=True)
class Group:
    """Scenarios that stand for one figure of the paper, or for none."""

    title: str
    overview: Picture | None
    scenarios: tuple[ScenarioSection, ...]


@dataclass(frozen=True)
class Content:
    """What a report says, before it is laid out: drawn and worded once for page, PDF and tables."""

    comparison: Comparison
    verdict: tuple[str, ...]
    overall: Table
    other_laws: Table
    claims: tuple[Claim, ...]
    limits: tuple[str, ...]
    groups: tuple[Group, ...]
    linear: LinearSection
    protocols: tuple[ProtocolSection, ...]
    definitions: Table

    @property
    def tables(self) -> tuple[Table, ...]:
        """Tables that are kept as CSV beside the report."""
        columns = ("claim", "verdict", "what these runs show")
        rows = tuple((one.quote, one.verdict, one.shown) for one in self.claims)
        own = (metrics_table(self.comparison), self.overall, Table("claims", columns, rows))
        linear = (self.linear.loops, self.linear.margins)
        laws = (self.other_laws,) if self.other_laws.rows else ()
        return (*own, *laws, *linear, *(one.table for one in self.protocols if one.table is not None))


def report_content(comparison: Comparison, sections: Sequence[ProtocolSection] = ()) -> Content:
    """Draw and word a report."""
    found = claims(comparison)
    with drawing.settings():
        groups = tuple(_group(comparison, title, some, k) for k, (title, some) in enumerate(_grouped(comparison), 1))
        linear = linear_section(comparison.study)
    return Content(
        comparison=comparison,
        verdict=tuple(verdict(comparison, found, sections)),
        overall=overall_table(comparison),
        other_laws=other_laws_table(comparison),
        claims=tuple(found),
        limits=tuple(limits(comparison, found)),
        groups=groups,
        linear=linear,
        protocols=tuple(sections),
        definitions=metric_definitions(),
    )


def render_report(
    comparison: Comparison, sections: Sequence[ProtocolSection] = (), *, medium: Medium = "screen"
) -> str:
    """HTML of the report.

    Parameters
    ----------
    comparison : Comparison
        From :func:`run_study`.
    sections : sequence of ProtocolSection, optional
        Protocols of fairness, in the order in which they stand after the figures of the linear part.
    medium : {"screen", "paper"}
        For a browser, or for what makes the PDF: without scripts, equations drawn.
    """
    return render(report_content(comparison, sections), medium)


def render(content: Content, medium: Medium) -> str:
    """HTML of what a report says."""
    comparison = content.comparison
    study, provenance = comparison.study, plain(comparison.provenance)
    plan = study.plan()
    with drawing.settings():
        draw = equations.as_mathml if medium == "screen" else equations.as_svg
        model = {
            "plant": [Markup(draw(one)) for one in equations.plant_equations()],
            "inner_loop": [Markup(draw(one)) for one in equations.inner_loop_equations()],
            "determinant": Markup(draw(equations.determinant())),
        }
    return _environment().get_template("report.html.j2").render(
        content=content,
        comparison=comparison,
        study=study,
        model=model,
        medium=medium,
        pairs_note=pairs_note([*content.verdict, *(one.shown for one in content.claims)]),
        about_the_paper=bool(examined(list(content.claims))),
        guards=joined(sorted({given(run.guard) for run in plan if run.guard is not None}) or ["–"]),
        failed=[run for run in comparison.runs if not run.ok],
        agreement=agreement_data(comparison),
        engine_text=engine_text(
            comparison.engine, comparison.provenance, [one.agreement for one in comparison.runs if one.agreement]
        ),
        provenance=_told(provenance),
        files=files_table(provenance["files"]) if provenance.get("files") else None,
        coupling_text=coupling_text(provenance.get("files", ()), provenance, own=comparison.own_file),
        differences=differences_table([one.agreement for one in comparison.runs if one.agreement]),
        aside=aside_text(study, comparison.engine),
        resolved=study.resolved(),
        step_note=step_note(comparison.engine, own=comparison.own_file),
        step_text=step_text(comparison),
        instants_text=instants_text(comparison),
    )  # fmt: skip


def _told(provenance: dict[str, Any]) -> dict[str, Any]:
    """Provenance as the report lists it: numbers with their units, files in a table of their own."""
    units = provenance.get("units", {})
    hidden = ("units", "files", *(("ssp_sha256", "fmu_sha256") if provenance.get("files") else ()))
    return {
        name: f"{value} {units[name]}" if name in units else value
        for name, value in provenance.items()
        if name not in hidden
    }


def _grouped(comparison: Comparison) -> list[tuple[str, list[Scenario]]]:
    scenarios = comparison.study.scenarios
    groups = [(f"Figure {k} of the paper", [one for one in scenarios if one.figure == k]) for k in "456"]
    others = [one for one in scenarios if one.figure is None]
    groups.append(("Beyond the paper’s figures" if len(others) < len(scenarios) else "Scenarios", others))
    return [(title, some) for title, some in groups if some]


def _group(comparison: Comparison, title: str, scenarios: list[Scenario], index: int) -> Group:
    """A group, with the paths side by side of its scenarios that stand for a figure, if there are at least two."""
    shown = [one for one in scenarios if one.figure and any(run.ok for run in comparison.of(one).values())]
    overview = None
    if len(shown) > 1 and "path" in comparison.study.figures:
        caption = "Paths of the scenarios below, on equal scales. The lines of the laws are drawn over one another."
        svg = drawing.svg(figures.paths_figure(comparison, shown), f"paths-{index}", f"Paths: {title}")
        overview = Picture(svg, caption)
    return Group(title, overview, tuple(scenario_section(comparison, one) for one in scenarios))


def _environment() -> jinja2.Environment:
    folder = files(__package__)
    environment = jinja2.Environment(
        loader=jinja2.FunctionLoader(lambda name: folder.joinpath(name).read_text(encoding="utf-8")),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {"cell": cell_text, "layout": table_layout, "parts": table_parts, "described": _described}
    environment.globals |= {"given": given, "number": number}
    environment.globals["inlined"] = lambda name: Markup(folder.joinpath(name).read_text(encoding="utf-8"))
    return environment


def _described(svg: str, title: str) -> Markup:
    """SVG element that says what it shows."""
    return Markup(drawing.described(svg, title)) if svg else Markup("")
