"""The report of a comparison: one HTML file that opens offline, and its metrics as JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any, NamedTuple

import jinja2

from brunovsky.comparison import drawing, figures
from brunovsky.comparison.agreement import POSITION_TOLERANCE, agreement_text, engine_text
from brunovsky.comparison.claims import claims
from brunovsky.comparison.equations import determinant, inner_loop_equations, plant_equations
from brunovsky.comparison.facts import given, joined, number
from brunovsky.comparison.findings import scenario_findings
from brunovsky.comparison.linear_part import linear_loops, motion_on_surface, shares_one_linear_part
from brunovsky.comparison.output import write_text
from brunovsky.comparison.run import Comparison, Progress, run_study
from brunovsky.comparison.sensitivity import CONVERGED, MARK, step_sensitivity
from brunovsky.comparison.study import EngineName, Scenario, Study, load_study
from brunovsky.comparison.tables import conditions, footnote, loop_row, margin_rows, metric_rows, poles_text


class ReportFiles(NamedTuple):
    """What a comparison leaves behind."""

    report: Path
    metrics: Path


def compare_study(
    study: Study | str | Path, folder: str | Path, *, engine: EngineName | None = None, progress: Progress | None = None
) -> ReportFiles:
    """Run a study and write its report and metrics.

    Parameters
    ----------
    study : Study or path
        A study, or its file (TOML).
    folder : path
        Where ``report.html``, ``metrics.json`` and ``fmus/`` or ``ssps/`` go; made if missing.
    engine : {"fmpy", "native", "ssp"}, optional
        In place of the study's own choice.
    progress : function of (done, total, what), optional
        See :func:`run_study`.

    Raises
    ------
    StudyError
        If the study file cannot be used.
    """
    loaded = study if isinstance(study, Study) else load_study(study)
    comparison = run_study(loaded, engine=engine, folder=folder, progress=progress)
    if progress is not None:
        progress(len(comparison.runs), len(comparison.runs), "drawing the report")
    return write_report(comparison, folder)


def write_report(comparison: Comparison, folder: str | Path) -> ReportFiles:
    """Write ``report.html`` and ``metrics.json``, each complete or not at all.

    Parameters
    ----------
    comparison : Comparison
        From :func:`run_study`.
    folder : path
        Made if missing.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    written = ReportFiles(folder / "report.html", folder / "metrics.json")
    report, metrics = render_report(comparison), json.dumps(metrics_data(comparison), indent=1, allow_nan=False) + "\n"
    write_text(written.report, report)
    write_text(written.metrics, metrics)
    return written


def metrics_data(comparison: Comparison) -> dict[str, Any]:
    """What ``metrics.json`` holds: study, provenance, and for each run its metrics and how it ended."""
    study = comparison.study
    return {
        "study": study.name,
        "provenance": {
            **_plain(comparison.provenance),
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


def render_report(comparison: Comparison) -> str:
    """HTML of the report."""
    study = comparison.study
    groups = [(f"Figure {k} of the paper", [one for one in study.scenarios if one.figure == k]) for k in "456"]
    others = [one for one in study.scenarios if one.figure is None]
    groups.append(("Beyond the paper’s figures" if len(others) < len(study.scenarios) else "Scenarios", others))
    loops = linear_loops(study)
    with drawing.settings():
        sections = [
            {
                "title": title,
                "overview": _overview(comparison, scenarios, f"paths{index}"),
                "scenarios": [_scenario(comparison, one) for one in scenarios],
            }
            for index, (title, scenarios) in enumerate(groups)
            if scenarios
        ]
        named = [(one.title, one.poles) for one in loops] + [("motion on S = 0", motion_on_surface(study))]
        poles = drawing.svg(figures.poles_figure(named), "poles")
    return _template().render(
        comparison=comparison,
        study=study,
        sections=sections,
        claims=claims(comparison),
        loops=[loop_row(one) for one in loops],
        margins=margin_rows(list(loops)),
        surface_poles=poles_text(motion_on_surface(study)),
        one_linear_part=shares_one_linear_part(study),
        poles_figure=poles,
        guards=joined(sorted({given(run.planned.parameters["eta_min"]) for run in comparison.runs})),
        failed=[run for run in comparison.runs if not run.ok],
        agreement=agreement_data(comparison),
        engine_text=engine_text(
            comparison.engine, comparison.provenance, [one.agreement for one in comparison.runs if one.agreement]
        ),
        provenance=_plain(comparison.provenance),
        resolved=json.dumps(study.model_dump(mode="json"), indent=1, ensure_ascii=False),
        number=number,
        mark=MARK.strip(),
        converged=f"{100 * CONVERGED:g} %",
        given=given,
        plant_equations=plant_equations(),
        inner_loop_equations=inner_loop_equations(),
        determinant=determinant(),
    )


def _overview(comparison: Comparison, scenarios: Sequence[Scenario], key: str) -> str:
    """Paths side by side, of the scenarios of a figure with a run that reached its end; nothing for fewer than two."""
    shown = [one for one in scenarios if one.figure and any(run.ok for run in comparison.of(one).values())]
    return drawing.svg(figures.paths_figure(comparison, shown), key) if len(shown) > 1 else ""


def _scenario(comparison: Comparison, scenario: Scenario) -> dict[str, Any]:
    pairs = comparison.laws_of(scenario)
    window = figures.transient_window(comparison, scenario)
    drawn = any(run.trajectory.sizes["time"] for _, run in pairs)
    return {
        "scenario": scenario,
        "figure": drawing.svg(figures.scenario_figure(comparison, scenario), scenario.name) if drawn else "",
        "window": given(window) if window < scenario.duration_s else "",
        "regulation": all(run.planned.parameters["radius"] == 0.0 for _, run in pairs),
        "findings": scenario_findings(comparison, scenario),
        "laws": [law for law, _ in pairs],
        "footnote": footnote([run for _, run in pairs]),
        "rows": metric_rows([run for _, run in pairs]),
        "conditions": conditions(pairs[0][1]),
    }


def _template() -> jinja2.Template:
    environment = jinja2.Environment(
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    return environment.from_string(files(__package__).joinpath("report.html.j2").read_text(encoding="utf-8"))


def _plain(data: Mapping[str, Any]) -> dict[str, Any]:
    return {name: dict(value) if isinstance(value, Mapping) else value for name, value in data.items()}
