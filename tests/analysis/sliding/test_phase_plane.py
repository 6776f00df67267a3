"""Phase portraits: the fields behind them against closed forms and the whole chain, and what is drawn."""

import control
import matplotlib.pyplot as plt
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from brunovsky import analysis
from brunovsky.errors import ParameterError

C, Q, P = np.array([500.0, 10.0, 1.0]), 5.0, 2.5


def test_surface_motion_has_the_poles_of_the_surface():
    system = analysis.surface_motion(C)
    np.testing.assert_allclose(np.sort_complex(system.poles()), analysis.surface_poles(C), rtol=1e-12)
    assert system.state_labels == ["e[1]", "e[2]"]


def test_surface_motion_is_what_the_chain_does_on_the_surface():
    gain = analysis.sliding_gain(C, Q)
    start = [0.01, -0.1]
    chain = analysis.error_dynamics(gain)
    time = np.linspace(0, 1, 201)
    whole = control.initial_response(chain, time, [*start, -(C[0] * start[0] + C[1] * start[1]) / C[2]])
    reduced = control.initial_response(analysis.surface_motion(C), time, start)
    np.testing.assert_allclose(whole.states[:2], reduced.states, atol=1e-9)


def field(lag, phi=0.0):
    system = analysis.lagged_reaching(Q, P, lag, phi)
    return lambda t, x: system.dynamics(t, x, [])


def test_between_switchings_the_relay_is_linear():
    lag, end = 0.01, 0.01
    run = solve_ivp(field(lag), (0, end), [0.05, 1.0], rtol=1e-10, atol=1e-13)
    A, rest = np.array([[0, 1], [-Q / lag, -1 / lag]]), np.array([-P / Q, 0.0])  # S > 0 all the time
    np.testing.assert_allclose(run.y[:, -1], rest + expm(A * end) @ (np.array([0.05, 1.0]) - rest), rtol=1e-7)


def test_within_the_layer_it_is_linear():
    lag, phi = 0.01, 0.05
    A = np.array([[0, 1], [-(Q + P / phi) / lag, -1 / lag]])
    for x in ([0.01, 0.3], [-0.04, 1.0]):
        np.testing.assert_allclose(field(lag, phi)(0, np.array(x)), A @ x)
    np.testing.assert_allclose(field(lag, phi)(0, np.array([0.2, 1.0])), field(lag)(0, np.array([0.2, 1.0])))


def test_a_lag_on_all_of_v_differs_by_what_is_stated():
    """S of the whole chain with v behind a lag, from e'' alone: the difference shrinks with the lag."""
    phi, start = 0.05, 0.02

    def difference(lag):
        def whole(t, x):
            _, e2, e3, v = x
            S = C @ x[:3]
            wanted = (-Q * S - P * np.clip(S / phi, -1, 1) - C[0] * e2 - C[1] * e3) / C[2]
            return [e2, e3, v, (wanted - v) / lag]

        end = 5 * lag
        time = np.linspace(0, end, 101)
        options = {"t_eval": time, "rtol": 1e-9, "atol": 1e-12}
        rate = -(Q + P / phi) * start
        chain = solve_ivp(whole, (0, end), [0, 0, start / C[2], (rate - C[1] * start) / C[2]], **options)
        plane = solve_ivp(field(lag, phi), (0, end), [start, rate], **options)
        return np.max(np.abs(C @ chain.y[:3] - plane.y[0])) / start

    coarse, fine = difference(4e-3), difference(1e-3)
    assert fine < 0.3 * coarse
    assert fine < 1e-3 * C[1] / C[2]


def test_portraits_are_python_controls_with_units():
    plot = analysis.surface_phase_plane(C, gridspec=[12, 12])
    assert isinstance(plot, control.ControlPlot)
    axes = plot.axes[0, 0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("e (m)", "e' (m/s)")
    plt.figure()
    plot = analysis.reaching_phase_plane(Q, P, 0.01, gridspec=[12, 12])
    axes = plot.axes[0, 0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("S (m/s²)", "S' (m/s³)")
    assert [one.get_text() for one in axes.get_legend().get_texts()] == ["without lag"]
    assert axes.get_xlim() == pytest.approx((-0.05, 0.05))
    _, own = plt.subplots()
    assert analysis.reaching_phase_plane(Q, P, 0.01, 0.05, ax=own, gridspec=[8, 8]).axes[0, 0] is own
    plt.close("all")


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: analysis.surface_motion([1.0, 2.0]), "pass three"),
        (lambda: analysis.surface_phase_plane(C, limits=[1, -1, 0, 1]), "ascending"),
        (lambda: analysis.surface_phase_plane(C, limits=[0, 1]), "smallest x"),
        (lambda: analysis.lagged_reaching(Q, P, 0.0), "only a curve"),
        (lambda: analysis.lagged_reaching(Q, -P, 0.01), "P >= 0"),
        (lambda: analysis.lagged_reaching(np.nan, P, 0.01), "Q"),
        (lambda: analysis.reaching_phase_plane(Q, P, 0.01, -0.1), "phi >= 0"),
        (lambda: analysis.reaching_phase_plane(Q, P, 0.01, limits="all"), "limits"),
    ],
)
def test_bad_input_is_refused_with_a_remedy(call, message):
    with pytest.raises(ParameterError, match=message):
        call()
