"""Margins by bisection from a stand-in for simulation, coupling errors of known order, and what is said of them."""

import math

import pytest

from brunovsky.analysis import CouplingError
from brunovsky.comparison.protocols.coupling import coupling_of
from brunovsky.comparison.protocols.margins import margins_of
from brunovsky.comparison.protocols.margins_figure import margins_figure

LIMITS = {"delay": (0.0, 0.0183), "gain": (0.3, math.inf), "sampling": (0.0, 0.02)}


def stable(_law, _cut, change, size):
    low, high = LIMITS[change]
    return low < size < high


def measured(predicted, changes=("gain", "delay"), stand_in=stable, **more):
    predictions = {("a", "both", name): (value, None) for name, value in predicted.items()}
    options = {"gains": (0.01, 100.0), "times": (1e-3, 0.1), "bound": 0.01, "tolerance": 0.01} | more
    return margins_of(stand_in, ["a"], ["both"], changes, predictions, **options)


def test_margins_are_found_within_the_tolerance():
    rows = {one.quantity.name: one for one in measured({}).found}
    assert rows["delay"].measured.value == pytest.approx(0.0183, rel=0.01)
    assert rows["delay"].measured.value < 0.0183 <= rows["delay"].measured.unstable_from
    assert rows["gain_lower"].measured.value == pytest.approx(0.3, rel=0.01)
    assert rows["gain_upper"].measured.value is None and rows["gain_upper"].measured.reason == "none to 100"
    assert not rows["gain_upper"].limited


def test_the_first_loss_is_found_where_a_loop_is_stable_again_beyond():
    def regained(_law, _cut, change, size):
        return change == "gain" or not 0.01 < size < 0.05

    found = margins_of(
        regained, ["a"], ["u1"], ["lag"], {}, gains=(0.1, 10.0), times=(1e-3, 0.1), bound=0.01, tolerance=0.01
    )
    assert found.found[0].measured.value == pytest.approx(0.01, rel=0.01)


@pytest.mark.parametrize("hole", [(2e-3, 2.3e-3), (6.5e-3, 7.5e-3)])
def test_a_hole_below_the_place_found_is_the_first_loss_and_no_margin(hole):
    def holed(_law, _cut, change, size):
        return change == "gain" or (size < 0.0115 and not hole[0] < size < hole[1])

    result = measured({"delay": 0.0115}, changes=["delay"], stand_in=holed)
    found = result.found[0]
    assert found.measured.value == pytest.approx(hole[0], rel=0.01)
    assert found.measured.stands_again_to == pytest.approx(0.0115, rel=0.01)
    assert found.difference is None and found.as_row()["measured"].startswith("none: lost above")
    words = " ".join(result.findings())
    assert "already lost at" in words and "stands again up to 11." in words and "1 of 1" not in words
    assert [line.get_fillstyle() for axes in margins_figure(result).axes for line in axes.get_lines()].count(
        "none"
    ) == 1


def test_what_is_said_follows_the_numbers():
    close = measured({"delay": 0.0183, "gain_lower": 0.3}).findings()[-1]
    assert "Of 2 margins" in close and "2 agree" in close and "falls shortest" not in close
    short = measured({"delay": 0.04, "gain_lower": 0.2}).findings()
    assert "0 agree" in short[-1] and "2 are smaller" in short[-1] and "delay at both" in short[-1]
    assert "stands less" in " ".join(short)
    more = measured({"delay": 0.01, "gain_lower": 0.5}).findings()
    assert "stands more" in " ".join(more) and "2 larger" in more[-1]


def test_a_law_that_fails_as_it_is_has_no_margins():
    found = margins_of(
        lambda *_: False, ["a"], ["u1"], ["delay"], {}, gains=(0.1, 10.0), times=(1e-3, 0.1), bound=1.0, tolerance=0.1
    )
    assert found.findings()[0].startswith("“a” does not do this scenario")
    assert found.found[0].measured.value is None


@pytest.mark.parametrize(
    ("factor", "told", "cell"),
    [
        (43.0, "as found", pytest.approx(43.0, rel=0.01)),
        (44.9, "as found", pytest.approx(43.0, rel=0.01)),
        (41.2, "as found", pytest.approx(43.0, rel=0.01)),
        (46.0, "lost later", "at least 42."),
        (math.inf, "lost later", "at least 42."),
        (40.0, "lost earlier", "less than 42."),
    ],
)
def test_a_margin_that_moves_at_half_of_the_step_is_that_of_the_step(factor, told, cell):
    def up_to(factor):
        return lambda _law, _cut, change, size: 0.3 < size < factor if change == "gain" else size < 0.0183

    found = measured({"gain_upper": 43.0}, stand_in=up_to(43.0), finer=up_to(factor))
    rows = {one.quantity.name: one for one in found.found}
    upper = rows["gain_upper"]
    assert upper.measured.at_half_step == told
    assert rows["delay"].measured.at_half_step == rows["gain_lower"].measured.at_half_step == "as found"
    words, row = " ".join(found.findings()), upper.as_row()
    assert row["measured"].startswith(cell) if isinstance(cell, str) else row["measured"] == cell
    marks = [line.get_fillstyle() for axes in margins_figure(found).axes for line in axes.get_lines()]
    if told == "as found":
        assert "integration" not in words and "none" not in marks
        assert upper.difference == pytest.approx(0.0, abs=0.01)
    else:
        assert f"upper gain margin (factor) at both, {cell}" in words and "Under “a” 1 of 1" not in words
        assert upper.difference is None and marks.count("none") == 1


def test_a_lower_gain_margin_of_the_step_is_told_the_other_way_round():
    found = measured({}, finer=lambda _law, _cut, change, size: change != "gain" or size > 0.1)
    assert "lower gain margin (factor) at both, at most 0.30" in " ".join(found.findings())


def errors(order, limit):
    steps = (1e-4, 1e-3, 1e-2, 5e-2)
    return [CouplingError("jacobi", 0, h, h**order if h < limit else math.inf) for h in steps]


def test_order_and_limit_of_a_coupling():
    limits = {("a", "jacobi", 0): 0.02}
    right = coupling_of({"a": errors(1, 0.02)}, limits, large=1.0, small=2e-3)
    assert "order 1.00" in right.findings()[0]
    assert right.findings()[-1].startswith("For 1 of 1 couplings")
    wrong = coupling_of({"a": errors(2, 0.005)}, limits, large=1.0, small=2e-3)
    assert "order 2.00" in wrong.findings()[0]
    assert wrong.findings()[-1].startswith("For 0 of 1 couplings") and "not so for “a”" in wrong.findings()[-1]
    cells = {row["step"]: row for row in right.summary_rows()}
    assert cells["50 ms"]["all at once, 0 derivatives, m"] == "fails"
    assert cells["predicted limit"]["all at once, 0 derivatives, m"] == "20.00 ms"
