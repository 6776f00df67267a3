"""Disk margins: the textbook example, the definition, python-control's own routine, and two loops at once."""

import control
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from brunovsky import analysis
from brunovsky.analysis import SteadyMotion
from brunovsky.errors import ParameterError

TEXTBOOK = control.tf([25], [1, 10, 10, 10])
PAPER = analysis.loop_transfer([2500.0, 550.0, 15.0])
ROTATING = control.ss([[0, 10], [-10, 0]], np.eye(2), [[1, 10], [-10, 1]], 0)  # rotating body, u = -y


def factor(margin, angle, scale=1.0):
    """Complex factor on the edge of a disk, from the definition."""
    d = scale * margin.radius * np.exp(1j * angle)
    return (1 + (1 - margin.skew) * d / 2) / (1 - (1 + margin.skew) * d / 2)


def test_the_example_of_the_reference():
    m = analysis.disk_margin(TEXTBOOK)
    assert m.radius == pytest.approx(0.46, abs=5e-3)
    assert (m.gain_lower, m.gain_upper) == pytest.approx((0.63, 1.59), abs=5e-3)
    assert np.rad2deg(m.phase) == pytest.approx(25.8, abs=5e-2)
    assert m.frequency == pytest.approx(1.94, abs=2e-2)


@pytest.mark.parametrize("skew", [0.0, 1.0, -1.0, 0.4])
@pytest.mark.parametrize("loop", [TEXTBOOK, PAPER])
def test_python_control_finds_the_same_on_a_grid(loop, skew):
    m = analysis.disk_margin(loop, skew)
    radius, gain, phase = control.disk_margins(loop, m.frequency * np.logspace(-0.1, 0.1, 2001), skew=skew)
    assert m.radius == pytest.approx(radius, rel=1e-6)
    assert min(m.gain_upper, 1 / m.gain_lower) == pytest.approx(control.db2mag(gain), rel=1e-6)
    assert np.rad2deg(m.phase) == pytest.approx(phase, rel=1e-6)


@pytest.mark.parametrize("skew", [0.0, 1.0, -1.0, -0.3])
@pytest.mark.parametrize("loop", [TEXTBOOK, PAPER])
def test_definition_no_factor_in_the_disk_meets_the_nyquist_plot_and_the_edge_touches_it(loop, skew):
    m = analysis.disk_margin(loop, skew)
    w = np.concatenate([np.logspace(-2, 3, 4000), m.frequency * np.linspace(0.99, 1.01, 2001)])
    at = loop(1j * w)
    angles = np.linspace(0, 2 * np.pi, 721)
    nearest = {
        scale: min(np.min(np.abs(1 + factor(m, angle, scale) * at) / (1 + np.abs(at))) for angle in angles)
        for scale in (0.97, 1.0)
    }
    assert nearest[0.97] > 3e-3
    assert nearest[1.0] < 3e-3  # the grid of angles
    assert factor(m, 0.0).real == pytest.approx(m.gain_upper)
    assert factor(m, np.pi).real == pytest.approx(m.gain_lower)
    edge = factor(m, angles)
    on_circle = edge[np.argmin(np.abs(np.abs(edge) - 1.0) + 10 * (np.abs(np.angle(edge)) < 1e-3))]
    assert abs(np.angle(on_circle)) == pytest.approx(m.phase, abs=1e-2)


def test_skew_one_is_the_modulus_margin():
    m = analysis.disk_margin(PAPER, 1.0)
    classical = analysis.loop_margins(PAPER)
    assert m.radius == pytest.approx(classical.modulus, rel=1e-9)
    assert m.frequency == pytest.approx(classical.modulus_frequency, rel=1e-4)


@settings(max_examples=40)
@given(st.floats(-10.0, -0.3), st.floats(-10.0, -0.3), st.floats(0.1, 30.0), st.floats(-1.0, 1.0))
def test_the_disk_lies_within_the_classical_margins(real, sigma, omega, skew):
    loop = analysis.loop_transfer(analysis.place([real, complex(sigma, omega), complex(sigma, -omega)]))
    disk, classical = analysis.disk_margin(loop, skew), analysis.loop_margins(loop)
    assert classical.gain_lower <= disk.gain_lower * (1 + 1e-6) < 1.0 < disk.gain_upper <= classical.gain_upper
    assert disk.phase <= abs(classical.phase) * (1 + 1e-6)


def test_a_peak_that_is_only_approached():
    m = analysis.disk_margin(analysis.loop_transfer([2.0]))  # S = s/(s + 2): abs(S - T)/2 = 1/2 at every frequency
    assert m.radius == pytest.approx(2.0)
    assert (m.gain_lower, m.gain_upper) == pytest.approx((0.0, np.inf), abs=1e-9)
    assert m.phase == pytest.approx(np.pi / 2)
    assert analysis.disk_margin(analysis.loop_transfer([2.0]), 1.0).frequency == np.inf


def test_a_narrow_peak_is_not_missed():
    """Closed-loop poles at -1e-5 +- 1j beside fast ones: S has a peak a hundred-thousandth of its frequency wide."""
    loop = analysis.loop_transfer(analysis.place([-1e-5 + 1j, -1e-5 - 1j, -50.0]))
    m = analysis.disk_margin(loop)
    closed = 1 / (1 + loop(1j * np.linspace(1 - 1e-4, 1 + 1e-4, 200001)))
    assert 1 / m.radius == pytest.approx(np.max(np.abs(closed - 0.5)), rel=1e-6)
    assert m.radius < 1e-3


# ---- two loops


def test_rotating_body_is_robust_one_loop_at_a_time_and_fragile_in_both():
    m = analysis.disk_margin(ROTATING)
    at = ROTATING(3j)
    alone = at[0, 0] - at[0, 1] * at[1, 0] / (1 + at[1, 1])  # one loop with the other one closed
    assert alone == pytest.approx(1 / 3j)
    assert analysis.disk_margin(control.tf([1], [1, 0])).radius == pytest.approx(2.0)
    edge = control.ss([], [], [], np.diag([1.1, 0.9]))
    assert np.max(control.feedback(ROTATING * edge, np.eye(2)).poles().real) > -0.01  # -1 without the factors
    assert m.radius == pytest.approx(0.0998, abs=1e-4)


@pytest.mark.parametrize("motion", [SteadyMotion(0.5), SteadyMotion(1.0, 5.0)], ids=["line", "circle"])
def test_two_loops_against_a_search_for_the_scaling_and_for_a_destabilising_pair(motion):
    loop = analysis.actuator_loop([2500.0, 550.0, 15.0], motion)
    m = analysis.disk_margin(loop)
    at = loop(1j * m.frequency)
    matrix = np.linalg.inv(np.eye(2) + at) - np.eye(2) / 2
    scaled = [
        np.linalg.norm(np.diag([d, 1]) @ matrix @ np.diag([1 / d, 1]), 2) for d in np.logspace(-6, 6, 20001)
    ]  # upper bound of mu
    assert 1 / m.radius == pytest.approx(min(scaled), rel=1e-5)
    angles = np.exp(2j * np.pi * np.arange(720) / 720)
    radii = [np.max(np.abs(np.linalg.eigvals(matrix @ np.diag([1.0, one])))) for one in angles]  # lower bound
    assert 1 / m.radius == pytest.approx(max(radii), rel=1e-4)


def test_two_loops_without_coupling_have_the_smaller_margin():
    loop = control.append(control.ss(TEXTBOOK), control.ss(PAPER))
    radii = [analysis.disk_margin(one).radius for one in (TEXTBOOK, PAPER)]
    assert analysis.disk_margin(loop).radius == pytest.approx(min(radii), rel=1e-6)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: analysis.disk_margin(control.tf([1], [1, -1, 1])), "not stable"),
        (lambda: analysis.disk_margin(PAPER, 1.5), "skew"),
        (lambda: analysis.disk_margin(PAPER, np.nan), "skew"),
        (lambda: analysis.disk_margin([1, 2]), "not a loop transfer function"),
        (lambda: analysis.disk_margin(control.append(*[control.ss(PAPER)] * 3)), "at most 2"),
        (lambda: analysis.disk_margin(control.tf([1], [1, 0], 0.1)), "continuous time"),
        (lambda: analysis.disk_margin(control.tf([1, 0, 0], [1, 1])), "proper"),
        (lambda: analysis.loop_margins(ROTATING), "one input and one output"),
        (lambda: analysis.loop_margins(control.tf([1], [1, 0, 0])), "not stable"),
    ],
)
def test_bad_input_is_refused_with_a_remedy(call, message):
    with pytest.raises(ParameterError, match=message):
        call()


def test_margins_of_a_loop_without_crossover():
    m = analysis.loop_margins(control.tf([0.5], [1, 1]))
    assert (m.phase, m.delay, m.lag, m.two_lags) == (np.inf, np.inf, np.inf, np.inf)
    assert np.isnan(m.gain_crossover)
    assert (m.gain_lower, m.gain_upper) == (0.0, np.inf)
