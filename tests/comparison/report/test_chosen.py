"""What a study chooses for its report: metrics of the tables, figures."""

import csv
import json
from pathlib import Path

import pytest

from brunovsky.comparison import load_study, run_study, summary_markdown, write_report
from brunovsky.comparison.report.page import report_content
from brunovsky.comparison.report.scenario import scenario_section
from brunovsky.errors import StudyError


def with_lines(study: Path, lines: str) -> Path:
    study.write_text(f"{lines}\n{study.read_text(encoding='utf-8')}", encoding="utf-8")
    return study


def test_chosen_metrics_and_figures_alone_are_shown(small, tmp_path) -> None:
    everything = load_study(small)
    study = load_study(with_lines(small, 'metrics = ["iae", "settling_time"]\nfigures = ["errors"]'))
    assert study.plan() == everything.plan()  # the same simulations
    comparison = run_study(study)
    content = report_content(comparison)
    assert content.overall.columns[3:] == ("settling time to 1 cm, s", "IAE, integral of the position error, m s")
    section = content.groups[0].scenarios[0]
    assert [row[0] for row in section.table.rows] == [
        "status",
        "settling time to 1 cm",
        "IAE, integral of the position error",
    ]
    assert [one.caption.split(":")[0] for one in section.figures] == ["Errors"]
    assert content.linear.figures == () and content.linear.margins.rows
    assert "total variation" not in summary_markdown(comparison).partition("## All runs")[2]

    files = write_report(comparison, tmp_path / "out")
    kept = json.loads(files.metrics.read_text(encoding="utf-8"))["runs"][0]["metrics"]
    assert kept == comparison.runs[0].metrics.as_dict()
    header = next(csv.reader((tmp_path / "out/tables/metrics.csv").open(encoding="utf-8")))
    assert set(kept) < set(header)


def test_figures_are_drawn_in_their_fixed_order(small) -> None:
    study = load_study(with_lines(small, 'figures = ["phase", "path", "linear"]'))
    content = report_content(run_study(study))
    shown = [one.caption.split(":")[0] for one in content.groups[0].scenarios[0].figures]
    assert shown == ["Path", "Phase portraits"] and content.linear.figures


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ('metrics = ["settling_tim"]', "there is no metric 'settling_tim'; did you mean settling_time"),
        ('metrics = ["iae", "iae"]', "'iae' is named twice"),
        ('figures = ["bode"]', "'path', 'errors', 'inputs', 'sliding', 'phase' or 'linear'"),
        ('figures = "path"', "figures: is no list; write one"),
    ],
)
def test_what_cannot_be_shown_is_refused(small, line: str, told: str) -> None:
    with pytest.raises(StudyError) as error:
        load_study(with_lines(small, line))
    assert told in str(error.value) and "line 1" in str(error.value)


def test_many_laws_are_drawn_in_figures_of_a_few_each_with_pole_placement(small) -> None:
    laws = "".join(
        f'[[laws]]\nname = "layer{k}"\nkind = "saturation"\nparameters = {{ phi_m_per_s2 = {0.05 * k:g} }}\n'
        for k in range(1, 7)
    )
    text = small.read_text(encoding="utf-8").replace("duration_s = 3.0", "duration_s = 0.2")
    small.write_text(text.replace("[[scenarios]]", f"{laws}[[scenarios]]"), encoding="utf-8")
    comparison = run_study(load_study(with_lines(small, 'figures = ["path"]')))
    section = scenario_section(comparison, comparison.study.scenarios[0])
    assert [one.caption.partition(".")[0] for one in section.figures] == [
        "Path: Circle, 1 of 2, under “linear”, “relay”, “layer1”, “layer2” and “layer3”",
        "Path: Circle, 2 of 2, under “linear”, “layer4”, “layer5” and “layer6”",
    ]
    assert len(section.table.columns) == 2 + 8
