"""Every study that ships: it loads, and a short form of it runs natively to a report without holes."""

import csv
import json
import math
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest

from brunovsky._resources import resource
from brunovsky.comparison import (
    Comparison,
    Study,
    analyze_study,
    chatter_markdown,
    load_study,
    protocol_sections,
    run_study,
    summary_markdown,
    write_report,
)
from brunovsky.comparison.protocol_sections import protocol_data, trial_tables
from brunovsky.comparison.report.files import csv_text
from brunovsky.errors import StudyError

STUDIES = sorted(resource("comparisons").glob("*.toml"))
HOLES = {"nan", "NaN", "None", "null", "inf", "-inf"}


class _Cells(HTMLParser):
    """Texts of the cells of all tables."""

    def __init__(self) -> None:
        super().__init__()
        self.depth, self.found = 0, [""]

    def handle_starttag(self, tag, attrs):
        if tag in ("td", "th"):
            self.depth += 1
            self.found.append("")

    def handle_endtag(self, tag):
        self.depth -= tag in ("td", "th")

    def handle_data(self, data):
        if self.depth:
            self.found[-1] += data


def cells(page: str) -> list[str]:
    parser = _Cells()
    parser.feed(page)
    return [one.strip() for one in parser.found]


def part(comparison: Comparison) -> Comparison:
    """The same with its first scenario alone, and of many laws one kind of figure."""
    study = comparison.study
    first = study.scenarios[0]
    runs = tuple(run for run in comparison.runs if run.planned.scenario == first.name)
    shown = study.figures if len(runs) <= 6 else ("phase",)
    protocols = tuple(one for one in comparison.protocols if one.table.scenario == first.name)
    study = study.model_copy(update={"scenarios": (first,), "figures": shown})
    return replace(comparison, study=study, runs=runs, protocols=protocols)


def named(path: Path) -> str:
    return path.stem


@pytest.mark.parametrize("path", STUDIES, ids=named)
def test_a_study_is_called_as_its_file_and_its_short_form_has_no_holes(path, tmp_path):
    study = load_study(path)
    assert study.name == path.stem
    short = study.shortened()
    assert all(run.duration <= 1.0 for run in short.plan())
    assert [run.name for run in short.plan()] == [run.name for run in study.plan()]
    comparison = run_study(short, engine="native")
    assert len(comparison.protocols) == len(study.protocols)
    summary = summary_markdown(comparison)
    assert not HOLES & {one.strip() for line in summary.splitlines() for one in line.split("|")}
    # Figures take the time, so that the report is drawn of the first scenario, with all protocols.
    files = write_report(part(comparison), tmp_path, sections=protocol_sections(comparison))
    assert not HOLES & set(cells(files.report.read_text(encoding="utf-8")))
    json.dumps(protocol_data(comparison), allow_nan=False)
    trials = [csv_text(one) for one in trial_tables(comparison)]
    for text in (*trials, *(one.read_text(encoding="utf-8") for one in files.tables)):
        rows = csv.reader(text.splitlines())
        assert not HOLES & {one.strip() for row in rows for one in row}, text


@pytest.mark.parametrize("path", [one for one in STUDIES if load_study(one).chatter], ids=named)
def test_chatter_of_a_short_form(path):
    assert chatter_markdown(analyze_study(load_study(path).shortened())).startswith("# ")


def test_signals_stay_where_they_were_in_a_shorter_run(small):
    text = small.read_text(encoding="utf-8")
    small.write_text(
        f"""{text}
[[scenarios.signals]]
kind = "sine"
start_s = 1.5
stop_s = 2.4
angular_frequency_rad_per_s = 5.0
amplitude = {{ d_1_m_per_s2 = 0.1 }}
[[scenarios.signals]]
kind = "impulse"
start_s = 2.7
width_s = 0.03
amplitude = {{ d_2_rad_per_s2 = 1.0 }}
[[protocols]]
kind = "monte_carlo"
scenario = "circle"
cases = 100
duration_s = 2.0
metrics = ["iae"]
distributions.x_start_m = {{ uniform = [0.5, 1.0] }}
""",
        encoding="utf-8",
    )
    study = load_study(small)
    short = study.shortened()
    sine, impulse = short.scenarios[0].signals
    assert (sine.start_s, sine.stop_s) == pytest.approx((0.5, 0.8))
    assert sine.angular_frequency_rad_per_s == 5.0
    assert impulse.width_s == pytest.approx(0.01)
    assert (short.protocols[0].cases, short.protocols[0].duration_s) == (3, 1.0)
    assert study.scenarios[0].duration_s == 3.0
    assert study.shortened(math.inf).scenarios == study.scenarios
    assert isinstance(short, Study)


@pytest.mark.parametrize("duration", [0.0, -1.0, math.nan])
def test_a_study_is_not_shortened_to_nothing(small, duration):
    with pytest.raises(StudyError, match="above 0"):
        load_study(small).shortened(duration)
