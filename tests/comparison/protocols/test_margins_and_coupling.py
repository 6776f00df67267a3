"""Margins by bisection from a stand-in for simulation, coupling errors of known order, and what is said of them."""

import math

import pytest

from brunovsky.analysis import CouplingError
from brunovsky.comparison.coupling_runs import run_coupling
from brunovsky.comparison.protocols.coupling import Layer, coupling_of
from brunovsky.comparison.protocols.coupling_figure import coupling_figure
from brunovsky.comparison.protocols.margins import margins_of
from brunovsky.comparison.protocols.margins_figure import margins_figure
from brunovsky.comparison.study import Study

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
    assert "order 1.00" in right.findings()[0] and "falls with order 1.00" in right.headline()
    assert "in 1 of 1 couplings with steps tried on both sides" in right.findings()[-1]
    wrong = coupling_of({"a": errors(2, 0.005)}, limits, large=1.0, small=2e-3)
    assert "order 2.00" in wrong.findings()[0]
    assert "in 0 of 1 couplings" in wrong.findings()[-1] and "not so for “a”" in wrong.findings()[-1]
    cells = {row["step"]: row for row in right.summary_rows()}
    assert cells["50 ms"]["all at once, 0 derivatives, m"] == "fails"
    assert cells["predicted limit (P = 0)"]["all at once, 0 derivatives, m"] == "20.00 ms"


@pytest.mark.parametrize("limit", [1e-5, 0.2])
def test_a_limit_with_steps_on_one_side_alone_confirms_nothing(limit):
    found = coupling_of({"a": errors(1, limit)}, {("a", "jacobi", 0): limit}, large=1.0, small=2e-3).findings()[-1]
    assert "which examines nothing" in found and "of 1 couplings" not in found


def layered(bands, alone=0.01, limit=5e-3, width=0.05):
    runs = [
        CouplingError("jacobi", 0, h, h, band, alone) for h, band in zip((1e-3, 4e-3, 6e-3, 9e-3), bands, strict=True)
    ]
    layers = {"a": Layer(width, {("jacobi", 0): limit})}
    return coupling_of({"a": runs}, {("a", "jacobi", 0): 8e-3}, layers, large=1.0, small=5e-3)


def test_a_run_beyond_the_limit_within_the_layer_chatters_without_leaving_the_path():
    found = layered((0.01, 0.02, 0.3, 0.4))
    cells = {row["step"]: row["all at once, 0 derivatives, m"] for row in found.summary_rows()}
    assert "|S| > φ" in cells["6 ms"] and cells["4 ms"] == 4e-3
    assert cells["predicted limit within the layer"] == "5.00 ms"
    assert "In 1 of 1 couplings with steps tried on both sides |S| exceeds φ = 0.05" in found.findings()[-1]
    early = layered((0.01, 0.2, 0.3, 0.4)).findings()[-1]
    assert "In 0 of 1 couplings" in early and "all at once with inputs held, from 4 ms on" in early


def test_a_layer_that_is_not_reached_is_not_examined():
    found = layered((3.0, 3.0, 3.0, 3.0), alone=2.0)
    assert found.findings()[-1].endswith("this limit is not examined.")
    assert all("|S|" not in str(row["all at once, 0 derivatives, m"]) for row in found.summary_rows())


def test_each_law_has_the_limits_of_its_own_loops(monkeypatch):
    """Without the switching term, and with Q + P/phi in place of Q: values of an independent eigenvalue computation."""
    study = Study.model_validate(
        {
            "name": "c",
            "title": "c",
            "parameters": {"C_1_per_s2": 500.0, "C_2_per_s": 10.0, "C_3": 1.0, "Q_per_s": 5.0},
            "laws": [{"name": "s", "kind": "saturation", "parameters": {"P_m_per_s3": 2.5, "phi_m_per_s2": 0.05}}],
            "scenarios": [
                {
                    "name": "o",
                    "title": "o",
                    "duration_s": 0.02,
                    "parameters": {"x_start_m": 2.5, "eta_start_1_m_per_s": 0.5},
                }
            ],
            "protocols": [{"kind": "coupling", "scenario": "o", "communication_steps_s": [5e-3, 1e-2]}],
        },
        context={"kinds": ["saturation"]},
    )
    watched = []

    def stand_in(_diagram, _duration, steps, **options):
        watched.append(options["watched"])
        pairs = [(scheme, order) for scheme in options["schemes"] for order in options["orders"]]
        return tuple(CouplingError(*pair, h, h, 0.01, 0.01) for pair in pairs for h in steps)

    monkeypatch.setattr("brunovsky.comparison.coupling_runs.coupling_errors", stand_in)
    found = run_coupling(study, study.protocols[0], lambda _: None)
    layer = {key[1:]: 1e3 * found.layer_limit(key) for key in found.keys}
    assert layer["jacobi", 0] == pytest.approx(13.96, abs=0.01) and layer["jacobi", 1] == pytest.approx(6.20, abs=0.01)
    assert layer["gauss_seidel", 0] == pytest.approx(31.9, abs=0.1)
    assert layer["gauss_seidel", 1] == pytest.approx(11.4, abs=0.1)
    assert 1e3 * found.limits["s", "jacobi", 0] == pytest.approx(12.41, abs=0.01)
    assert watched == [("S[1]", "S[2]")]
    coupling_figure(found)
