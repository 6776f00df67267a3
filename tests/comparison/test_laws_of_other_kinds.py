"""Studies with laws that are not of the paper's family: reported, and named where they are not analysed."""

import json
from io import StringIO

import pytest
from rich.console import Console

from brunovsky.comparison import (
    analysis_tables,
    analyze_study,
    load_study,
    protocol_sections,
    run_study,
    write_analysis,
    write_report,
)

STUDY = """
name = "kinds"
title = "Kinds"
engine = "native"
step_size_s = 5e-3
[[laws]]
name = "goal"
kind = "goal_frame"
[[laws]]
name = "steps"
kind = "backstepping"
[[laws]]
name = "poles"
kind = "pole_placement"
{family}
[[scenarios]]
name = "point"
title = "Set point"
duration_s = 0.5
[scenarios.parameters]
x_start_m = 1.0
goal_1_m = 0.0
goal_2_m = 0.0
goal_heading_rad = 0.5
radius_m = 0.0
[[protocols]]
kind = "map"
scenario = "point"
laws = ["goal", "poles"]
metrics = ["final_heading_error", "iae", "arrival_time"]
across = {{ knob = "theta_start_rad", low = -1.0, high = 1.0, points = 3 }}
"""
FAMILY = '[[laws]]\nname = "plain"\nkind = "linear"'


@pytest.mark.parametrize("family", ["", pytest.param(FAMILY, marks=pytest.mark.slow)])
def test_reported_and_analysed_with_and_without_a_law_of_the_family(family, tmp_path):
    path = tmp_path / "kinds.toml"
    path.write_text(STUDY.format(family=family), encoding="utf-8")
    study = load_study(path)
    comparison = run_study(study)
    files = write_report(comparison, tmp_path / "report", sections=protocol_sections(comparison))
    page = files.report.read_text(encoding="utf-8")
    assert "to rest at (0 m, 0 m) with heading 0.5 rad" in page
    assert ('id="linear"' in page) is bool(family)
    assert "In the end the heading is off the goal’s by" in page
    analysis = analyze_study(study)
    written = json.loads(write_analysis(analysis, tmp_path / "analysis").analysis.read_text(encoding="utf-8"))
    assert written["laws_not_analyzed"] == ["goal", "steps", "poles"]
    assert [one["law"] for one in written["runs"]] == (["plain"] if family else [])
    terminal = Console(file=StringIO(), width=200)
    terminal.print(*analysis_tables(analysis))
    assert "goal, steps, poles" in terminal.file.getvalue()
