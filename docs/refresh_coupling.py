"""Draw docs/_static/coupling.svg: coupling errors under pole placement; comparisons/coupling.toml has all numbers."""

from __future__ import annotations

from pathlib import Path

from matplotlib import pyplot

from brunovsky import analysis
from brunovsky.comparison import load_study
from brunovsky.comparison.study import Study

ROOT = Path(__file__).resolve().parents[1]
FIGURE = ROOT / "docs" / "_static" / "coupling.svg"


def main() -> None:
    """Measure, and draw."""
    study = load_study(ROOT / "comparisons" / "coupling.toml")
    table = study.protocols[0]
    assert table.kind == "coupling"
    planned = study.planned_case(table, study.law("linear"), {})
    errors = analysis.coupling_errors(
        planned.loop.block,
        planned.duration,
        table.communication_steps_s,
        schemes=table.schemes,
        orders=table.derivatives,
        step_size=planned.step_size,
        parameters=planned.parameters,
    )
    _draw(study, errors)


def _draw(study: Study, errors: tuple[analysis.CouplingError, ...]) -> None:
    p = study.plan()[0].parameters
    gain = analysis.sliding_gain([p[f"C[{k}]"] for k in (1, 2, 3)], p["Q"])
    limits = {
        "limit all at once, inputs held": analysis.largest_communication_step(gain, "jacobi"),
        "limit in sequence, inputs held": analysis.largest_communication_step(gain, "gauss_seidel"),
    }
    stable = [one for one in errors if one.error < 1.0]
    with pyplot.rc_context(
        {"svg.hashsalt": "brunovsky", "svg.fonttype": "path", "axes.grid": True, "grid.alpha": 0.35}
    ):
        drawn = analysis.coupling_error_plot(stable, limits=limits)
        drawn.figure.savefig(FIGURE, metadata={"Date": None})


if __name__ == "__main__":
    main()
