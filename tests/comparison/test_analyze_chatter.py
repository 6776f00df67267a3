"""Chatter tables of a study: grids, rows against the gates, and the summary that is kept beside the study."""

import json
import re

import pytest

from brunovsky._resources import resource
from brunovsky.comparison import analysis_data, analyze_study, chatter_markdown, load_study
from brunovsky.comparison.chatter_summary import largest_error
from brunovsky.errors import StudyError

C, Q, P = (500.0, 10.0, 1.0), 5.0, 2.5
KEYS = {
    *("lag_s", "C", "Q", "P", "phi"),
    *(f"{one}_{what}" for one in ("predicted", "locus", "simulated") for what in ("amplitude", "frequency_rad_s")),
}


def test_a_chatter_table_is_a_grid(mine):
    first, second = load_study(mine).chatter_grids()
    assert [loop.lags for loop in first.loops] == [(0.005, 0.005), (0.009, 0.009), (0.02, 0.02)]
    assert {(loop.surface, loop.reaching_rate, loop.switching_gain, loop.boundary_layer) for loop in first.loops} == {
        (C, Q, P, 0.0)
    }
    assert len(second.loops) == 3 * 2 * 2
    assert {loop.reaching_rate for loop in second.loops} == {2.0, 5.0}
    assert {loop.delay for loop in second.loops} == {0.0, 0.002}
    assert {loop.boundary_layer for loop in second.loops} == {0.0}


def check_gates(data):
    """The gates of prediction against simulation, for relays whose linear part is stable; rows that oscillate."""
    for row in data["chatter"]:
        assert set(row) >= KEYS and isinstance(row["lag_s"], list)
        for source in ("predicted", "locus", "simulated"):
            pair = (row[f"{source}_amplitude"], row[f"{source}_frequency_rad_s"])
            assert (pair[0] is None) == (pair[1] is None)
    rows = [row for row in data["chatter"] if row["linear_part_stable"] and not row["phi"]]
    rows = [row for row in rows if row["simulated_amplitude"] is not None]
    for row in rows:
        assert row["predicted_frequency_rad_s"] == pytest.approx(row["simulated_frequency_rad_s"], rel=0.05)
        assert row["predicted_amplitude"] == pytest.approx(row["simulated_amplitude"], rel=0.10)
        assert row["locus_frequency_rad_s"] == pytest.approx(row["simulated_frequency_rad_s"], rel=0.01)
        assert row["locus_amplitude"] == pytest.approx(row["simulated_amplitude"], rel=0.01)
    return rows


def test_chatter_rows(chatter_analysis):
    data = json.loads(json.dumps(analysis_data(chatter_analysis), allow_nan=False))
    two_lags = [row for row in data["chatter"] if row["grid"] == "two lags"]
    assert len(check_gates({"chatter": two_lags})) == 2
    assert (two_lags[0]["lag_s"], two_lags[0]["C"], two_lags[0]["Q"]) == ([0.005, 0.005], list(C), Q)
    beyond = two_lags[2]
    assert beyond["linear_part_stable"] is False and beyond["outcome"] == "diverges"
    assert all(beyond[key] is None for key in KEYS - {"lag_s", "C", "Q", "P", "phi"})
    others = [row for row in data["chatter"] if row["grid"] == "others"]
    assert len(others) == 12
    quiet = [row for row in others if row["delay_s"] == 0.0 and len(row["lag_s"]) < 2]
    assert len(quiet) == 4 and all(row["simulated_amplitude"] is None for row in quiet)


def test_the_summary_needs_chatter(small):
    with pytest.raises(StudyError, match="no chatter tables"):
        chatter_markdown(analyze_study(small))


def outline(text):
    return re.findall(r"^#.*$|^- .*$|^\| \d.*$", re.sub(r"[\d.]+(?= %)", "", text), flags=re.MULTILINE)


def test_the_shipped_study_is_what_its_summary_was_written_from():
    study = load_study(resource("comparisons", "chatter.toml"))
    points = sum(len(grid.loops) for grid in study.chatter_grids())
    committed = resource("comparisons", "chatter.md").read_text(encoding="utf-8")
    assert 40 <= points <= 80 and f"from the {points} points" in committed
    assert re.findall(r"^## (.*)$", committed, flags=re.MULTILINE)[1:] == [
        *(one.title for one in study.chatter),
        "Chatter, predicted and measured",
    ]


@pytest.mark.slow
def test_the_shipped_study():
    found = analyze_study(resource("comparisons", "chatter.toml"))
    rows = check_gates(analysis_data(found))
    assert len(rows) > 40
    every = [row for _, part in found.grids for row in part]
    assert len([row for row in every if not row.linear_part_stable]) > 5
    assert largest_error(every, "locus", "amplitude") < 1e-3
    committed = resource("comparisons", "chatter.md").read_text(encoding="utf-8")
    assert outline(chatter_markdown(found)) == outline(committed.split("## Chatter, predicted and measured")[0])
