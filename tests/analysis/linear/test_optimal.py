"""Designs by quadratic cost: textbook answers, guaranteed margins, and that no other design costs less."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import solve_continuous_lyapunov

from brunovsky import analysis
from brunovsky.errors import ParameterError

WEIGHT = st.floats(0.01, 100.0)


def cost(slope: np.ndarray, weights: np.ndarray, start: np.ndarray) -> float:
    """Integral of x' W x along x' = slope x."""
    return float(start @ solve_continuous_lyapunov(slope.T, -weights) @ start)


def test_textbook_answers() -> None:
    """One integrator: sqrt(w/r); two with weight on the position alone: damping 1/sqrt 2."""
    assert analysis.lqr_gain(1, [9.0], 4.0) == pytest.approx([1.5])
    assert analysis.lqr_gain(2, [16.0, 0.0]) == pytest.approx([4.0, np.sqrt(8.0)])
    assert analysis.lqr_gain(3, [1.0, 0.0, 0.0]) == pytest.approx([1.0, 2.0, 2.0])  # Butterworth
    assert analysis.surface_from_cost([16.0, 9.0]) == pytest.approx([4 / 3, 1.0])
    assert analysis.surface_from_cost([1.0, 0.0, 1.0], leading=2.0) == pytest.approx([2.0, 2 * np.sqrt(2.0), 2.0])


@settings(max_examples=40)
@given(st.lists(WEIGHT, min_size=1, max_size=5), WEIGHT)
def test_guaranteed_margins(weights: list[float], input_weight: float) -> None:
    """Distance of 1 from -1: any gain above 1/2, 60 degrees of phase."""
    margins = analysis.margins(analysis.lqr_gain(len(weights), weights, input_weight))
    assert margins.gain_lower <= 0.5 + 1e-6
    assert margins.gain_upper == np.inf
    assert abs(margins.phase) >= np.deg2rad(60.0) - 1e-6
    assert margins.modulus >= 1.0 - 1e-6


@settings(max_examples=25)
@given(st.lists(WEIGHT, min_size=3, max_size=3), st.lists(st.floats(-0.3, 0.3), min_size=3, max_size=3))
def test_no_gain_costs_less(weights: list[float], change: list[float]) -> None:
    A, b = np.eye(3, k=1), np.eye(3)[:, -1]
    start = np.array([1.0, -0.5, 0.3])

    def total(K: np.ndarray) -> float:
        return cost(A - np.outer(b, K), np.diag(weights) + np.outer(K, K), start)

    best = analysis.lqr_gain(3, weights)
    other = best * (1 + np.array(change))
    if analysis.closed_loop_poles(other).real.max() < 0:
        assert total(other) >= total(best) * (1 - 1e-9)


def test_integral_is_one_integrator_more() -> None:
    weights = [7.0, 5.0, 3.0, 2.0]
    assert analysis.lqr_gain(3, weights, integral=True) == pytest.approx(analysis.lqr_gain(4, weights))


@settings(max_examples=25)
@given(st.lists(WEIGHT, min_size=3, max_size=3), st.lists(st.floats(-0.5, 0.5), min_size=2, max_size=2))
def test_no_surface_costs_less(weights: list[float], change: list[float]) -> None:
    """On S = 0 the last error is -(c1 e1 + c2 e2)/c3: its cost along the surface, against that of other surfaces."""
    start = np.array([1.0, -0.4])

    def total(C: np.ndarray) -> float:
        last = -C[:-1] / C[-1]
        slope = np.array([[0.0, 1.0], last])
        return cost(slope, np.diag(weights[:2]) + weights[2] * np.outer(last, last), start)

    best = analysis.surface_from_cost(weights)
    assert analysis.surface_poles(best).real.max() < 0
    assert total(best * [1 + change[0], 1 + change[1], 1.0]) >= total(best) * (1 - 1e-9)


def test_cross_terms_count() -> None:
    """e1^2 + e2^2 + 2 q e1 e2 on a chain of two: e1' = -c e1 costs (1 + c^2 - 2 q c)/(2 c), least for c = 1."""
    assert analysis.surface_from_cost([[1.0, 0.5], [0.5, 1.0]]) == pytest.approx([1.0, 1.0])
    matrix = np.array([[2.0, 0.3, 0.2], [0.3, 1.0, 0.1], [0.2, 0.1, 0.5]])
    best = analysis.surface_from_cost(matrix)

    def total(C: np.ndarray) -> float:
        last = -C[:-1] / C[-1]
        full = np.vstack([np.eye(2), last])
        return cost(np.array([[0.0, 1.0], last]), full.T @ matrix @ full, np.array([1.0, 0.7]))

    for k in (0, 1):
        for factor in (0.99, 1.01):
            other = best.copy()
            other[k] *= factor
            assert total(other) > total(best)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: analysis.lqr_gain(0, []), "order"),
        (lambda: analysis.lqr_gain(3, [1, 1]), r"shape \(2,\); pass \(3,\) or \(3, 3\)"),
        (lambda: analysis.lqr_gain(3, [1, 1, 1], integral=True), r"pass \(4,\)"),
        (lambda: analysis.lqr_gain(2, [0, 1]), "first weight is 0"),
        (lambda: analysis.lqr_gain(2, [1, -1]), "not positive semidefinite"),
        (lambda: analysis.lqr_gain(2, [1, np.nan]), "not finite"),
        (lambda: analysis.lqr_gain(2, [[1, 2], [0, 5]]), "not symmetric"),
        (lambda: analysis.lqr_gain(2, "ab"), "no numbers"),
        (lambda: analysis.lqr_gain(2, [1, 1], 0.0), "input_weight > 0"),
        (lambda: analysis.surface_from_cost([1.0]), "n >= 2"),
        (lambda: analysis.surface_from_cost(1.0), "n >= 2"),
        (lambda: analysis.surface_from_cost([1, 0]), "last weight is 0"),
        (lambda: analysis.surface_from_cost([0, 1]), "first weight is 0"),
        (lambda: analysis.surface_from_cost([1, 1], leading=0.0), "last coefficient"),
        (lambda: analysis.surface_from_cost([[1, 0, 1], [0, 0, 0], [1, 0, 1]]), "does not decay"),
    ],
)
def test_bad_input_is_refused(call: object, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        call()  # type: ignore[operator]
