"""Numbers that depend on the step are found by a run at half of it, marked, and rank no law."""

import dataclasses
import json
import math

import pytest

from brunovsky.comparison import load_study, run_study, write_report
from brunovsky.comparison.claims import claims
from brunovsky.comparison.facts import wrapped
from brunovsky.comparison.findings import scenario_findings
from brunovsky.comparison.sensitivity import converged, sensitivity, told
from brunovsky.comparison.tables import footnote, metric_rows


def run_of(comparison, name):
    return next(run for run in comparison.runs if run.planned.name == name)


@pytest.mark.parametrize(
    ("name", "metric", "expected"),
    [
        ("fig6-inside/sign", "total_variation_u2", 0.90),
        ("outside-d2/sign", "rms_tail_error", -0.72),
        ("fig5/saturation", "rms_tail_error", 4.9),
    ],
)
def test_what_depends_on_the_step(paper_runs, name, metric, expected):
    run = run_of(paper_runs, name)
    assert not converged(run, metric)
    assert sensitivity(run, metric) == pytest.approx(expected, abs=0.06)
    assert told(run, metric).startswith("≈")


@pytest.mark.parametrize("metric", ["settling_time", "peak_speed", "peak_yaw_acceleration", "iae"])
def test_what_does_not(paper_runs, metric):
    run = run_of(paper_runs, "fig6-outside/sign")
    assert converged(run, metric) and not told(run, metric).startswith("≈")


def test_a_table_with_marks_has_a_footnote_and_one_without_has_none(paper_runs, paper):
    for scenario in paper.scenarios:
        runs = [run for _, run in paper_runs.laws_of(scenario)]
        marked = any(cell.startswith("≈") for _, _, cells in metric_rows(runs) for cell in cells)
        assert bool(footnote(runs)) == marked


def test_a_footnote_tells_which_input_and_both_numbers_where_a_share_of_the_base_says_nothing(paper_runs):
    run = run_of(paper_runs, "fig6-inside/sign")
    assert run.half_step is not None
    half = dataclasses.replace(
        run.half_step, metrics=dataclasses.replace(run.half_step.metrics, effort_u1=1e-9, effort_u2=3.0, min_speed=2.0)
    )
    changed = dataclasses.replace(run.metrics, effort_u1=1.0, effort_u2=2.0, min_speed=1e-9)
    text = footnote(
        [dataclasses.replace(run, metrics=changed, half_step=half)], ["effort_u1", "effort_u2", "min_speed"]
    )
    assert "effort (integral of u₁²) from 1.0 to 1.0×10⁻⁹\u00a0m²/s³ (sign)" in text
    assert "effort (integral of u₂²) by 50\u00a0% (sign)" in text
    assert "smallest |η₁| from 1.0×10⁻⁹ to 2.0\u00a0m/s (sign)" in text


def test_figure_5_is_not_ranked_by_its_tail_or_heading(paper_runs, paper):
    scenario = next(one for one in paper.scenarios if one.name == "fig5")
    text = " ".join(scenario_findings(paper_runs, scenario))
    assert "ranks no law" in text and "no finding rests on it" in text
    assert "apart" not in text and "times less" not in text


def test_a_residual_that_is_not_converged_gives_no_factor(paper_runs, paper):
    by_name = {one.name: one for one in paper.scenarios}
    matched = " ".join(scenario_findings(paper_runs, by_name["outside-d2"]))
    unmatched = " ".join(scenario_findings(paper_runs, by_name["outside-d1"]))
    assert "times less" not in matched and "within the bound" in matched
    assert "3.0 times less" in unmatched and "does not remove it" in unmatched


def test_convergence_is_told_for_three_thresholds(paper_runs):
    claim = next(one for one in claims(paper_runs) if "its rate" in one.quote)
    assert claim.verdict == "confirmed under conditions"
    for part in ("to 1 cm by", "to 1 mm by", "to 0.1 mm by −22\u00a0% to −14\u00a0%"):
        assert part in claim.shown, claim.shown


@pytest.mark.parametrize(("law", "settling"), [("linear", 1.598), ("saturation", 1.593), ("sign", 1.593)])
def test_a_wrong_inertia_slows_every_law(paper_runs, law, settling):
    assert run_of(paper_runs, f"outside-rho2/{law}").metrics.settling_time == pytest.approx(settling, abs=5e-4)


def test_a_wrong_mass_on_the_circle_is_no_test(paper_runs):
    claim = next(one for one in claims(paper_runs) if "robustness" in one.quote)
    assert claim.shown.index("mass a quarter above") > claim.shown.index("Not counted")


@pytest.mark.parametrize(
    ("angle", "expected"), [(0.5, 0.5), (math.pi, math.pi), (-math.pi, math.pi), (7.0, 7.0 - 2.0 * math.pi)]
)
def test_wrapped(angle, expected):
    assert wrapped(angle) == pytest.approx(expected)


def test_a_failed_run_has_no_sensitivity(small, tmp_path):
    text = small.read_text().replace("eta_min_m_per_s = 0.05", "eta_min_m_per_s = 0.0")
    small.write_text(text.replace("eta_start_1_m_per_s = 0.5", "eta_start_1_m_per_s = 0.0"))
    written = write_report(run_study(load_study(small)), tmp_path)
    run = json.loads(written.metrics.read_text())["runs"][0]
    assert run["status"] == "singular" and set(run["step_sensitivity"].values()) == {None}


def test_a_study_without_the_paper_speaks_of_no_paper_figure(small, tmp_path):
    text = small.read_text()
    begin, end = text.index('[[laws]]\nname = "relay"'), text.index("[[scenarios]]")
    small.write_text(text[:begin] + text[end:])
    report = write_report(run_study(load_study(small)), tmp_path).report.read_text(encoding="utf-8")
    assert "What the paper claims" not in report
    assert "Beyond the paper" not in report and ">Scenarios</h2>" in report
