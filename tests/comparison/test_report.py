"""The report and metrics.json: complete, self-contained, deterministic, and worded by its numbers."""

import dataclasses
import json
import os
import re
from html.parser import HTMLParser

import pytest

from brunovsky._frozen import FrozenMapping
from brunovsky._resources import resource
from brunovsky.comparison import compare_study, load_study, readme_figure, run_study, summary_markdown, write_report
from brunovsky.comparison.claims import claims
from brunovsky.comparison.report import render_report
from brunovsky.comparison.report.manifest import ReportFolder

VOID = {"meta", "br", "hr", "img", "link", "input"}
METRICS = {
    "iae", "ise", "itae", "settling_time", "final_error", "rms_tail_error", "peak_speed", "min_speed",
    "peak_yaw_acceleration", "effort_u1", "effort_u2", "total_variation_u1", "total_variation_u2",
}  # fmt: skip


class Page(HTMLParser):
    """Checks that tags nest, and collects what a page refers to."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: list[str] = []
        self.references: list[str] = []
        self.loaded: list[str] = []
        self.texts: list[str] = []
        self.count: dict[str, int] = {}
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.count[tag] = self.count.get(tag, 0) + 1
        if tag not in VOID:
            self.open.append(tag)
        for name, value in attrs:
            if name == "id":
                self.ids.append(value)
            if name in ("href", "xlink:href"):
                self.references.append(value)
            if name in ("src", "srcset", "data", "action"):
                self.loaded.append(value)
            self.references += re.findall(r"url\(([^)]*)\)", value or "")

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, (tag, self.getpos())

    def handle_data(self, data):
        self.texts.append(data)


@pytest.fixture(scope="module")
def page(written):
    return Page(written.report.read_text(encoding="utf-8"))


def test_the_page_is_well_formed_and_refers_to_nothing_outside(page, written):
    assert page.open == []
    assert len(set(page.ids)) == len(page.ids)
    assert page.loaded == []
    assert len(page.references) > 100
    assert all(one.startswith("#") and one[1:] in page.ids for one in page.references)
    text = written.report.read_text(encoding="utf-8")
    addresses = set(re.findall(r"https?://[^\"'\s<]+", text))
    assert addresses <= {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"}
    assert "@import" not in text and page.count["script"] == 1
    assert written.report.stat().st_size < 4_500_000


def test_the_page_has_every_figure_table_and_section(page, paper):
    linear = 3  # poles, Bode and Nyquist, describing function
    assert page.count["svg"] == page.count["figure"] == 5 * len(paper.scenarios) + 1 + linear  # 1: paths of figure 6
    assert page.count["h3"] == len(paper.scenarios)
    assert page.count["table"] == len(paper.scenarios) + 6
    assert {one.name for one in paper.scenarios} <= set(page.ids)
    text = " ".join(" ".join(page.texts).split())
    for part in (
        "Figure 4 of the paper", "Figure 5 of the paper", "Figure 6 of the paper", "Circle, from inside",
        "What the paper claims, and what these runs show", "What this study does not show", "Provenance",
        "the regulation is chaotic", "heading is left uncontrolled", "the law’s singularity, where the guard acts",
        "−5 ± 21.79j", "for these gains the rates coincide", "P does not help against it", "One target was tested",
        "are misprinted and corrected here", "total variation of u₂", "Within its boundary layer",
    ):  # fmt: skip
        assert part in text, part


def test_the_numbers_that_contradict_the_paper_are_told(page):
    text = " ".join(page.texts)
    assert "30.7 m/s" in text
    assert "1.43×10⁴ rad/s²" in text
    assert "hardly changes convergence" in text
    assert "predicted 4.00×10⁻⁴ m" in text


def test_metrics_json_keeps_its_contract(written, paper):
    def refuse(constant):
        raise AssertionError(constant)

    data = json.loads(written.metrics.read_text(encoding="utf-8"), parse_constant=refuse)
    assert set(data) == {"study", "provenance", "runs"}
    assert data["study"] == "paper"
    assert [one["name"] for one in data["runs"]] == [one.name for one in paper.plan()]
    for run in data["runs"]:
        assert {"name", "law", "scenario", "metrics", "status", "status_time"} <= set(run)
        assert METRICS <= set(run["step_sensitivity"]) == set(run["metrics"])
        assert run["name"] == f"{run['scenario']}/{run['law']}"
        assert run["status"] == "ok" and run["status_time"] is None
        assert all(isinstance(run["metrics"][name], float) for name in METRICS)
    provenance = data["provenance"]
    assert provenance["engine"] == "native" and provenance["step_size"] == 1e-3
    assert provenance["study_sha256"] == paper.run_by("native").digest() != paper.digest()
    assert provenance["resolved_study"]["scenarios"][0]["name"] == "fig4"
    assert provenance["agreement_with_native"] is None


def test_the_same_runs_give_the_same_bytes(small):
    reports = []
    for date in ("2001-01-01", "2002-02-02"):
        comparison = run_study(load_study(small))
        dated = dataclasses.replace(comparison, provenance=FrozenMapping({**comparison.provenance, "made": date}))
        reports.append(render_report(dated))
    assert reports[0] != reports[1]
    assert reports[0].replace("2001-01-01", "2002-02-02") == reports[1]


def test_one_call_does_it_all_shows_its_progress_and_replaces_the_report_before(small, tmp_path):
    seen = []
    before = ReportFolder(tmp_path / "out")
    before.write(tmp_path / "out" / "traces" / "renamed--linear.nc", b"of an earlier report")
    before.finish()
    (tmp_path / "out" / "traces" / "mine.nc").write_bytes(b"my own")
    written = compare_study(small, tmp_path / "out", progress=lambda *what: seen.append(what))
    files = {path.name for path in (tmp_path / "out" / "traces").iterdir()}
    assert files == {"mine.nc", *(path.name for path in written.traces)}
    listed = json.loads((tmp_path / "out" / "manifest.json").read_text())["sha256"]
    all_written = (written.report, written.metrics, *written.traces, *written.tables)
    assert set(listed) == {path.relative_to(tmp_path / "out").as_posix() for path in all_written}
    assert (written.report.name, written.metrics.name, written.pdf) == ("report.html", "metrics.json", None)
    names = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert names == ["manifest.json", "metrics.json", "report.html", "tables", "traces"]
    assert seen[0] == (0, 2, "circle/linear") and seen[1] == (1, 2, "circle/relay") and seen[-1][:2] == (2, 2)


def test_a_report_is_written_whole_or_not_at_all(small, tmp_path, monkeypatch):
    comparison = run_study(load_study(small))
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "report.html").write_text("before")

    def full(*_):
        raise OSError("disk full")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(OSError, match="disk full"):
        write_report(comparison, tmp_path / "out")
    assert [path for path in (tmp_path / "out").rglob("*") if path.is_file()] == [tmp_path / "out" / "report.html"]
    assert (tmp_path / "out" / "report.html").read_text() == "before"


def test_verdicts_follow_the_numbers(paper_runs, small):
    verdicts = {claim.quote[:30]: claim.verdict for claim in claims(paper_runs)}
    assert list(verdicts.values()) == [
        "confirmed under conditions", "confirmed", "confirmed under conditions", "confirmed under conditions",
        "confirmed under conditions", "not examined", "confirmed", "confirmed under conditions", "confirmed",
        "confirmed under conditions",
    ]  # fmt: skip
    gentle = small.read_text().replace('title = "Circle"', 'title = "Circle"\nfigure = "6"')
    gentle = gentle.replace(
        "eta_min_m_per_s = 0.05", "eta_min_m_per_s = 0.05\nC_1_per_s2 = 4.0\nC_2_per_s = 4.0\nQ_per_s = 1.0"
    )
    gentle = gentle.replace("eta_start_1_m_per_s = 0.5", "eta_start_1_m_per_s = 0.7071\neta_start_2_rad_per_s = 0.5")
    small.write_text(
        gentle.replace("x_start_m = 1.0", "x_start_m = 1.41").replace("duration_s = 3.0", "duration_s = 20.0")
    )
    smooth = {claim.quote: claim for claim in claims(run_study(load_study(small)))}
    smoothness = next(claim for quote, claim in smooth.items() if "control smoothness" in quote)
    assert smoothness.verdict == "confirmed"
    assert "far beyond" not in smoothness.shown


def test_what_is_committed_tells_what_the_runs_tell(paper_runs):
    """Verdicts, headings and settling times of the summary that is kept; its other numbers may differ by rounding."""
    committed = resource("comparisons", "paper.md").read_text(encoding="utf-8")

    def outline(text):
        settling = r"^\| [^|]*\| [^|]*\| (?:≈ )?[\d.]+ \|"  # scenario, law, settling time: the table of all runs
        return re.findall(rf"^#.*$|\*\*[a-z ]+\*\*|{settling}", text, flags=re.MULTILINE)

    told = outline(summary_markdown(paper_runs))
    assert outline(committed) == told
    assert sum(one.startswith("|") for one in told) == len(paper_runs.runs)
    assert len(committed.encode()) < 15_000


def test_the_picture_of_the_readme_is_a_small_svg(paper_runs):
    text = readme_figure(paper_runs)
    assert text.startswith("<?xml") and text.rstrip().endswith("</svg>")
    assert len(text.encode()) < 200_000
