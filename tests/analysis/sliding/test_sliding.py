"""Bounds of the sliding mode: the formulas against simulations of the switched chain."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

import brunovsky as br
from brunovsky import analysis
from brunovsky.errors import ParameterError

C, Q, P = (500.0, 10.0, 1.0), 5.0, 2.5
STEP = 2e-4


def simulate(d1=0.0, rate=0.0, jerk=0.0, surface=C, seconds=5.0, phase=0.0):
    """One axis under the printed law, z'' from the model, relay frozen over each step; returns t, position error, S.

    Heading error = phase + rate t; d1 enters as d1 cos below v and as -rate d1 sin at v, `jerk` at v.
    """
    c1, c2, c3 = surface
    steps = round(seconds / STEP)
    position = velocity = acceleration = 0.0
    positions, surfaces = np.empty(steps), np.empty(steps)
    for k in range(steps):
        angle = phase + rate * (k + 0.5) * STEP
        S = c1 * position + c2 * velocity + c3 * acceleration
        positions[k], surfaces[k] = position, S
        v = (-Q * S - P * np.sign(S) - c1 * velocity - c2 * acceleration) / c3
        third = v - rate * d1 * np.sin(angle) + jerk
        true_acceleration = acceleration + third * STEP / 2 + d1 * np.cos(angle)
        position += velocity * STEP + true_acceleration * STEP**2 / 2
        velocity += true_acceleration * STEP
        acceleration += third * STEP
    return np.arange(steps) * STEP, positions, surfaces


def test_numbers_of_the_paper():
    assert analysis.matched_disturbance_bound(C, P) == 2.5
    assert analysis.yaw_disturbance_bound(C, P, -2.0) == 1.25
    assert analysis.yaw_disturbance_bound(C, P, 0.0) == np.inf
    assert analysis.unmatched_residual(C, 0.2, 0.5) == pytest.approx(4e-4, rel=1e-3)
    assert analysis.unmatched_residual(C, -0.2) == pytest.approx(4e-4, rel=1e-12)
    assert analysis.forward_disturbance_bound(C, P, 0.5) == pytest.approx(2.5 / 10.5)
    assert analysis.forward_disturbance_bound(C, P, 0.5) > 0.2  # so sliding persists in the paper's circle, d1 = 0.2


@pytest.mark.parametrize("surface", [C, (-1000.0, -20.0, -2.0)])
def test_jerk_disturbance_is_rejected_up_to_its_bound(surface):
    bound = analysis.matched_disturbance_bound(surface, P)
    c3 = abs(surface[2])
    _, _, S = simulate(jerk=0.98 * bound, surface=surface, seconds=2)
    assert np.max(np.abs(S)) < 4 * P * STEP  # the relay's step, nothing more
    _, _, S = simulate(jerk=1.02 * bound, surface=surface, seconds=2)
    assert abs(S[-1]) == pytest.approx((c3 * 1.02 * bound - P) / Q, rel=1e-2)


def test_yaw_disturbance_bound_is_the_jerk_bound_in_the_worst_heading():
    speed = 1.7
    headings = np.linspace(0, 2 * np.pi, 721)
    d2 = analysis.yaw_disturbance_bound(C, P, speed)
    h_th = np.array([-np.cos(headings), -np.sin(headings)])
    assert np.max(np.abs(speed * d2 * h_th)) == pytest.approx(analysis.matched_disturbance_bound(C, P))


@pytest.mark.parametrize("rate", [0.0, 0.5, 10.0])
def test_unmatched_residual_is_what_the_relay_leaves(rate):
    d1 = 0.8 * analysis.forward_disturbance_bound(C, P, rate)
    t, position, S = simulate(d1=d1, rate=rate, seconds=15.0)
    tail = t > 2.0
    assert np.max(np.abs(S[tail])) < 20 * P * STEP
    assert np.max(np.abs(position[tail])) == pytest.approx(analysis.unmatched_residual(C, d1, rate), rel=2e-2)


@pytest.mark.parametrize("rate", [0.5, 10.0])
def test_forward_disturbance_bound_is_sufficient_and_the_quadrature_one_sharp(rate):
    sharp = P / np.hypot(C[1], C[2] * rate)
    assert analysis.forward_disturbance_bound(C, P, rate) < sharp
    for d1, persists in ((0.98 * sharp, True), (1.2 * sharp, False)):
        t, _, S = simulate(d1=d1, rate=rate, seconds=15.0)
        assert (np.max(np.abs(S[t > 2.0])) < 20 * P * STEP) == persists


def test_unmatched_residual_without_disturbance_and_at_a_resonance():
    assert analysis.unmatched_residual((4.0, 0.0, 1.0), 0.0, 2.0) == 0.0
    assert analysis.unmatched_residual((4.0, 0.0, 1.0), 0.1, 2.0) == np.inf
    assert analysis.forward_disturbance_bound((4.0, 0.0, 1.0), P, 0.0) == np.inf


@given(st.floats(1e-3, 1e3), st.floats(0.01, 50), st.floats(0.01, 50))
def test_reaching_time_brings_the_reaching_law_to_zero(start, rate, switching):
    t = analysis.reaching_time(-start, rate, switching)
    left = (start + switching / rate) * np.exp(-rate * t) - switching / rate  # solution of S' = -Q S - P
    assert abs(left) < 1e-9 * (start + switching / rate)


def test_reaching_time_against_an_integration_with_a_matched_disturbance():
    def crossing(t, S):
        return S[0]

    crossing.terminal = True

    def reach(net):
        run = solve_ivp(lambda t, S: -Q * S - net, (0, 10), [3.0], events=crossing, rtol=1e-10, atol=1e-12)
        return run.t_events[0][0]

    assert analysis.reaching_time(3.0, Q, P) == pytest.approx(reach(P), rel=1e-8)
    assert analysis.reaching_time(3.0, Q, P - 1.0) == pytest.approx(reach(P - 1.0), rel=1e-8)


def test_reaching_time_of_the_robot_in_native_simulation():
    """Both axes from outside the circle, sign function: S is within the relay's step from the predicted instant on."""
    step = 1e-4
    run = br.simulate(br.blocks.closed_loop(), 1.5, step_size=step, parameters={"phi": 0.0}, record=["S[1]", "S[2]"])
    for name in ("S[1]", "S[2]"):
        S = run[name].values
        reached = run["time"].values[np.argmax(np.abs(S) < 2 * P * step)]
        assert reached == pytest.approx(analysis.reaching_time(S[0], Q, P), abs=5 * step)
        after = run["time"].values > reached + 5 * step
        assert np.max(np.abs(S[after])) < 4 * P * step


def test_after_reaching_the_robot_moves_with_the_poles_of_the_surface():
    """Native simulation, sign function: from an instant on S = 0 the error is the free motion of the reduced order."""
    names = ["e1[1]", "e1[2]", "S[1]"]
    run = br.simulate(br.blocks.closed_loop(), 1.8, step_size=1e-4, parameters={"phi": 0.0}, record=names)
    sliding = run.isel(time=slice(14500, None))  # t_r of both axes lies before 1.45 s
    assert float(run["time"][14500]) > analysis.reaching_time(float(run["S[1]"][0]), Q, P)
    start = [float(sliding[name][0]) for name in names[:2]]
    time = sliding["time"].values - float(sliding["time"][0])
    slow, fast = analysis.surface_poles(C)
    amplitudes = np.linalg.solve([[1, 1], [slow, fast]], start)
    free = (amplitudes[0] * np.exp(slow * time) + amplitudes[1] * np.exp(fast * time)).real
    assert np.max(np.abs(free)) > 1e-4
    np.testing.assert_allclose(sliding["e1[1]"].values, free, atol=2e-6)


def test_limits_of_the_reaching_time():
    assert analysis.reaching_time(0.0, Q, 0.0) == 0.0
    assert analysis.reaching_time(1.0, Q, 0.0) == np.inf
    assert analysis.reaching_time(5.0, 0.0, P) == 2.0
    assert analysis.reaching_time(5.0, 1e-12, P) == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: analysis.matched_disturbance_bound([1, 2, 0], P), "c_n != 0"),
        (lambda: analysis.matched_disturbance_bound(C, -1), "P >= 0"),
        (lambda: analysis.yaw_disturbance_bound(C, P, np.inf), "speed"),
        (lambda: analysis.forward_disturbance_bound([1.0], P, 0.5), "at least 2"),
        (lambda: analysis.forward_disturbance_bound(C, P, "fast"), "yaw_rate"),
        (lambda: analysis.unmatched_residual(C, np.nan), "disturbance"),
        (lambda: analysis.unmatched_residual(C, 0.1, np.nan), "rate"),
        (lambda: analysis.reaching_time(1, -1, P), "Q >= 0"),
        (lambda: analysis.reaching_time(1, Q, -1), "P >= 0"),
    ],
)
def test_bad_input_is_refused_with_a_remedy(call, message):
    with pytest.raises(ParameterError, match=message):
        call()
