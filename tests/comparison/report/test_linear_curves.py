"""The figures of the linear part show the loop that the scenarios have, lags, delay and sampling included."""

import control
import numpy as np
import pytest

from brunovsky.analysis import SwitchingLoop, loop_margins, loop_transfer, predicted_cycles, sliding_gain
from brunovsky.comparison import load_study
from brunovsky.comparison.chain_hardware import uncovered
from brunovsky.comparison.figures import bode_figures, describing_function_figure, describing_functions
from brunovsky.comparison.loop_curves import LoopCurve, loop_curves
from brunovsky.comparison.report.linear import linear_section

C, Q, P = (500.0, 10.0, 1.0), 5.0, 2.5
SCENARIO = """
[[scenarios]]
name = "{name}"
title = "Line"
duration_s = 1.0
[scenarios.parameters]
rate_rad_per_s = 5e-4
eta_start_1_m_per_s = 0.5
[scenarios.hardware]
{hardware}
"""


@pytest.fixture
def study(small):
    def made(**hardware: str):
        scenarios = "".join(SCENARIO.format(name=name, hardware=text) for name, text in hardware.items())
        small.write_text(small.read_text() + scenarios)
        return load_study(small)

    return made


def test_the_crossings_that_are_drawn_are_the_predicted_limit_cycles(study):
    found = describing_functions(study(slow="lag_s = 0.007\nlags = 2", late="delay_s = 0.004"))
    assert [one.hardware for one in found] == ["ideal actuators", "2 lags of 7 ms", "a delay of 4 ms"]
    assert [one.scenarios for one in found] == [("circle",), ("slow",), ("late",)]
    lines = {line.get_label(): line for line in describing_function_figure(found).axes[1].get_lines()}
    for hardware, loop in (
        ("2 lags of 7 ms", SwitchingLoop(C, Q, P, lags=(0.007, 0.007))),
        ("a delay of 4 ms", SwitchingLoop(C, Q, P, delay=0.004)),
    ):
        x, y = lines[f"W(jω), {hardware}"].get_data()
        at = np.flatnonzero(np.signbit(y[:-1]) != np.signbit(y[1:]))
        crossings = x[at] - y[at] * (x[at + 1] - x[at]) / (y[at + 1] - y[at])
        stable = next(one for one in predicted_cycles(loop) if one.stable)
        drawn = 4.0 / np.pi * -crossings  # -1/N(A) = -pi A/4
        assert np.min(np.abs(drawn / stable.amplitude - 1.0)) < 1e-3
    assert not found[0].cycles


def test_margins_with_lags_and_delay_are_those_of_the_loop():
    plain = loop_transfer(sliding_gain(C, Q))
    lagging = loop_margins(plain * control.tf([1.0], np.polymul([0.005, 1.0], [0.005, 1.0])))
    drawn = LoopCurve(SwitchingLoop(C, Q, P, lags=(0.005, 0.005))).margins
    for name in ("gain_lower", "gain_upper", "phase", "gain_crossover", "modulus"):
        assert getattr(drawn, name) == pytest.approx(getattr(lagging, name), rel=1e-5)
    ideal, late = loop_margins(plain), LoopCurve(SwitchingLoop(C, Q, P, delay=0.004)).margins
    assert late.phase == pytest.approx(ideal.phase - 0.004 * ideal.gain_crossover, rel=1e-6)
    assert LoopCurve(SwitchingLoop(C, Q, P, delay=1.01 * ideal.delay)).margins is None
    assert LoopCurve(SwitchingLoop(C, Q, P, delay=0.99 * ideal.delay)).margins is not None
    layer = LoopCurve(SwitchingLoop(C, Q, P), switching=1.0 / 0.05).margins
    assert layer.phase == pytest.approx(loop_margins(loop_transfer(sliding_gain(C, Q + P / 0.05))).phase, rel=1e-6)


def test_each_hardware_is_a_curve_with_its_margins(study):
    made = study(slow="lag_s = 0.01\nlags = 2", sampled="sampling_period_s = 0.005", apart="lag_s = [0.001, 0.002]")
    assert list(loop_curves(made)["P = 0"]) == ["ideal actuators", "2 lags of 10 ms", "sampling every 5 ms"]
    (figure,) = bode_figures(made)
    texts = [text.get_text() for text in figure.legends[0].get_texts()]
    assert len(texts) == 3 and texts[1] == "P = 0, 2 lags of 10 ms: unstable"
    assert texts[0].startswith("P = 0, ideal actuators: phase margin 26.2° at 24.8 rad/s, gain times 0.303 and more")
    line = next(one for one in figure.axes[0].get_lines() if "sampling" in str(one.get_label()))
    w, gain = line.get_data()
    assert np.all(np.isnan(gain[w > 1.001 * np.pi / 0.005]))


def test_what_the_theory_leaves_out_is_told_in_a_sentence(study):
    made = study(
        slow="lag_s = 0.007",
        apart="delay_s = [0.001, 0.002]",
        sampled="sampling_period_s = 0.01\nu1_max_m_per_s2 = 9.0",
    )
    (text,) = uncovered(made)
    assert text.count(".") == 1 and "across the heading" in text and "heading turns" not in text
    assert "different lags or delays of apart" in text and "the limits of the inputs in sampled" in text


def test_where_the_heading_turns_it_is_told(small):
    assert uncovered(load_study(small)) == ()
    small.write_text(small.read_text() + "[scenarios.hardware]\nlag_s = 0.007\n")
    (text,) = uncovered(load_study(small))
    assert "where the heading turns (circle) the two mix" in text


def test_the_sign_function_has_a_bound_for_its_lower_gain_margin(paper):
    found = linear_section(paper).margins
    assert found.columns[-1] == "“sign”, at any amplitude"
    assert [row[-1] for row in found.rows] == ["≤ 0.4775", *["–"] * (len(found.rows) - 1)]
