"""What is predicted of disturbances and noise on the circle, against what runs leave; bounds; words."""

import math

import numpy as np
import pytest

from brunovsky.analysis import unmatched_residual
from brunovsky.comparison import load_study, run_study
from brunovsky.comparison.claim import is_nominal
from brunovsky.comparison.condition_words import what_acts
from brunovsky.comparison.residuals import disturbed, predicted_noise, predicted_residual, tail_peaks, within_bounds

STUDY = """
name = "circle"
title = "Circle"
engine = "native"
step_size_s = 2e-3

[parameters]
x_start_m = 1.4142135623730951
eta_start_1_m_per_s = 2.221441469079183
eta_start_2_rad_per_s = 1.5707963267948966
rate_rad_per_s = 1.5707963267948966
C_1_per_s2 = 500.0
C_2_per_s = 10.0
C_3 = 1.0
Q_per_s = 5.0
eta_min_m_per_s = 0.05

[[laws]]
name = "linear"
kind = "linear"

[[laws]]
name = "layer"
kind = "saturation"
parameters = {{ P_m_per_s3 = 2.5, phi_m_per_s2 = 0.05 }}

[[laws]]
name = "relay"
kind = "sign"
parameters = {{ P_m_per_s3 = 2.5 }}

[[scenarios]]
name = "circle"
title = "Circle"
duration_s = {duration}
{acting}
"""
SINE = """[[scenarios.signals]]
kind = "sine"
angular_frequency_rad_per_s = {w}
phase_rad = 0.4
amplitude = {{ {what} }}
"""
IMPULSE = """[[scenarios.signals]]
kind = "impulse"
start_s = 2.0
width_s = 0.02
amplitude = { d_2_rad_per_s2 = 50.0 }
"""
CONSTANT = "[scenarios.disturbances]\n{what}\n"
W = math.pi  # the last quarter of 16 s holds whole periods, and one turn of the reference


@pytest.fixture
def study(tmp_path):
    def load(acting, duration=16.0):
        path = tmp_path / "circle.toml"
        path.write_text(STUDY.format(acting=acting, duration=duration), encoding="utf-8")
        return load_study(path)

    return load


@pytest.mark.parametrize(
    "acting",
    [
        CONSTANT.format(what="d_1_m_per_s2 = 0.1\nd_2_rad_per_s2 = 0.5"),
        CONSTANT.format(what="dv_1_m_per_s3 = 1.0\ndv_2_m_per_s3 = -0.4"),
        SINE.format(w=W, what="d_1_m_per_s2 = 0.15"),
        SINE.format(w=8 * W, what="d_2_rad_per_s2 = 1.0"),
        SINE.format(w=2 * W, what="dv_2_m_per_s3 = 1.5"),
        CONSTANT.format(what="d_1_m_per_s2 = 0.05") + SINE.format(w=W, what="dv_1_m_per_s3 = 1.0"),
    ],
    ids=["both", "dv", "d1-sine", "d2-fast-sine", "dv-sine", "d1-and-dv-sine"],
)
def test_linear_laws_leave_what_is_predicted(study, acting):
    found = study(acting)
    comparison = run_study(found, engine="native")
    for law, run in comparison.laws_of(found.scenarios[0]):
        predicted = predicted_residual(run.planned, law)
        assert within_bounds(run) == (law.kind != "linear")
        if law.kind == "sign":
            # the relay is held over a step, which adds what shrinks with it
            assert run.half_step.metrics.rms_tail_error == pytest.approx(predicted, rel=0.05, abs=1e-5)
        else:
            assert run.metrics.rms_tail_error == pytest.approx(predicted, rel=0.01)


def test_what_the_relay_leaves_of_a_constant_force_is_the_analysis_of_sliding(study):
    found = study(CONSTANT.format(what="d_1_m_per_s2 = 0.2\ndv_1_m_per_s3 = 0.3"))
    run = next(one for one in found.plan() if one.law == "relay")
    assert predicted_residual(run, found.law("relay")) == pytest.approx(
        unmatched_residual([500, 10, 1], 0.2, math.pi / 2)
    )


def test_what_has_passed_leaves_nothing_and_is_no_nominal_run(study):
    found = study(IMPULSE)
    comparison = run_study(found.shortened(8.0), engine="native")
    for run in comparison.runs:
        assert disturbed(run.planned)
        assert not is_nominal(run)
        assert not any(tail_peaks(run.planned).values())
        assert within_bounds(run)
    assert what_acts(found.plan()[0]) == ["an impulse of 50 rad/s² in d₂ over 20 ms at 2 s"]


def test_a_signal_that_begins_in_the_last_quarter_has_no_prediction(study):
    step = '[[scenarios.signals]]\nkind = "step"\nstart_s = 13.0\namplitude = { d_2_rad_per_s2 = 1.0 }\n'
    found = study(step)
    assert [predicted_residual(run, found.law(run.law)) for run in found.plan()] == [None] * 3
    assert tail_peaks(found.plan()[0])["d[2]"] == 1.0


def test_the_bounds_are_those_of_the_largest_disturbance(study):
    for amplitude, inside in ((2.4, True), (2.6, False)):
        found = study(CONSTANT.format(what=f"dv_1_m_per_s3 = {amplitude}"), 4.0)
        runs = run_study(found, engine="native").of(found.scenarios[0])
        assert within_bounds(runs["relay"]) is inside
        assert within_bounds(runs["linear"]) is False


def test_noise_of_the_position_is_predicted_as_its_covariance(study):
    noise = "[scenarios.noise]\nx_m = 0.001\ny_m = 0.0005\nperiod_s = 0.01\n"
    found = study(noise, 200.0)
    short = found.model_copy(update={"laws": found.laws[:1]})
    run = run_study(short, engine="native").runs[0]
    predicted = predicted_noise(run.planned, found.laws[0])
    assert run.metrics.rms_tail_error == pytest.approx(predicted, rel=0.1)
    assert predicted_noise(run.planned, found.law("relay")) is None
    assert not is_nominal(run)
    assert "white noise" in what_acts(run.planned)[0]


def test_a_disturbance_on_a_law_without_the_papers_parameters_has_no_prediction(tmp_path):
    text = STUDY.format(acting=CONSTANT.format(what="d_2_rad_per_s2 = 1.0"), duration=1.0)
    twist = '[[laws]]\nname = "twist"\nkind = "super_twisting"\n\n[[scenarios]]'
    path = tmp_path / "circle.toml"
    path.write_text(text.replace("[[scenarios]]", twist), encoding="utf-8")
    found = load_study(path)
    run = next(one for one in found.plan() if one.law == "twist")
    assert predicted_residual(run, found.law("twist")) is None
    assert np.isfinite(list(tail_peaks(run).values())).all()
