"""The plane (S, S') of super-twisting: against the law, its simulation, and convergence in finite time."""

import control
import matplotlib.pyplot as plt
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

import brunovsky as br
from brunovsky import analysis
from brunovsky.errors import ParameterError

K1, K2 = 1.5, 1.1


def integrator():
    import sympy as sp

    z, u, d = sp.symbols("z u d", real=True)
    system = br.AffineSystem((z,), (u,), [0], [1], (z,), disturbances={d: (1,)})
    return br.linearized_block(br.linearize(system), "integrator")


def loop(L):
    plant = integrator()
    law = br.blocks.super_twisting(plant, [1.0], L=L)
    return br.blocks.closed_loop(law, plant=plant, reference=br.blocks.set_point(plant))


@given(st.floats(1e-4, 10), st.booleans(), st.floats(-10, 10), st.floats(0.1, 100), st.floats(-1, 1))
def test_the_field_is_the_textbook_s(size, negative, velocity, L, drift):
    S = -size if negative else size
    field = analysis.super_twisting_motion((K1, K2), L, drift).dynamics(0, np.array([S, velocity]), [])
    expected = -K1 * np.sqrt(L) * velocity / (2 * np.sqrt(size)) - K2 * L * np.sign(S) + drift
    np.testing.assert_allclose(field, [velocity, expected], rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("drift", [0.0, 2.0])
def test_a_simulation_of_the_block_moves_along_it(drift):
    """S' of the simulated loop, v + d, changes as the field says wherever S is away from zero."""
    L = 4.0
    data = br.simulate(loop(L), 0.6, step_size=1e-4, parameters={"z_start": 0.5}, inputs={"d": lambda t: drift * t})
    time, S = data["time"].values, data["S[1]"].values
    velocity = data["v[1]"].values + drift * time
    field = analysis.super_twisting_motion((K1, K2), L, drift)
    away = np.flatnonzero(abs(S[1:-1]) > 0.02) + 1
    assert away.size > 1000
    measured = (velocity[away + 1] - velocity[away - 1]) / 2e-4
    expected = np.array([field.dynamics(0, np.array([S[i], velocity[i]]), [])[1] for i in away])
    np.testing.assert_allclose(measured, expected, rtol=2e-3, atol=2e-3)
    assert S.min() < 0 or S[-1] < 0.02


def crossings(drift, count=4, L=1.0, first=1e3):
    """Size of S' at successive crossings of S = 0 and their instants, along the field, by an adaptive solver."""
    system = analysis.super_twisting_motion((K1, K2), L, drift)
    state, now, sizes, times = np.array([0.0, first]), 0.0, [first], [0.0]
    for _ in range(count):

        def zero(t, x):
            return x[0]

        zero.terminal, zero.direction = True, -np.sign(state[1])
        start = [np.sign(state[1]) * 1e-7 * state[1] ** 2, state[1]]
        run = solve_ivp(lambda t, x: system.dynamics(t, x, []), (0, 1e5), start, events=zero, rtol=1e-9, atol=1e-12)
        now += float(run.t[-1])
        state = run.y[:, -1]
        sizes.append(abs(float(state[1])))
        times.append(now)
    return np.array(sizes), np.array(times)


@pytest.mark.parametrize("drift", [0.0, 0.5])
def test_it_converges_in_finite_time(drift):
    """Each turn shrinks S' and takes less time by the same factor: a geometric series of times, with a finite sum."""
    sizes, times = crossings(drift)
    ratios, durations = sizes[2:] / sizes[:-2], np.diff(times)  # over a whole turn: the halves differ with d'
    assert np.all(ratios < 0.1)
    np.testing.assert_allclose(ratios, ratios[0], rtol=1e-2)
    np.testing.assert_allclose(durations[2:] / durations[:-2], ratios[0], rtol=1e-2)


def test_a_simulation_of_the_block_turns_as_fast_and_is_there_after_the_sum():
    """Steps of 0.1 ms; from the first crossing of S = 0 on, S' falls by the field's ratio and the times add up."""
    data = br.simulate(loop(1.0), 6.0, step_size=1e-4, parameters={"z_start": 0.5})
    time, S, velocity = (data[name].values for name in ("time", "S[1]", "v[1]"))
    first, second = np.flatnonzero(np.signbit(S[1:]) != np.signbit(S[:-1]))[:2]
    sizes, times = crossings(0.0)
    ratio = sizes[1] / sizes[0]
    assert abs(velocity[second] / velocity[first]) == pytest.approx(ratio, rel=0.02)
    # a turn that begins with S' lasts as long as S' is large
    duration = (times[1] - times[0]) / sizes[0] * abs(velocity[first])
    assert time[second] - time[first] == pytest.approx(duration, rel=0.02)
    end = time[first] + duration / (1 - ratio)
    assert abs(S[time > 1.02 * end]).max() < 1e-7
    assert abs(S[time < 0.9 * end]).max() > 1e-3


def test_a_slope_beyond_the_integral_does_not():
    system = analysis.super_twisting_motion((K1, K2), 1.0, 2.0)
    run = solve_ivp(lambda t, x: system.dynamics(t, x, []), (0, 20), [0.1, 1.0], rtol=1e-8)
    assert run.y[0, -1] > 1.0


def test_the_portrait_is_python_controls_with_units():
    plot = analysis.super_twisting_phase_plane(slope=2.0, gridspec=[12, 12])
    assert isinstance(plot, control.ControlPlot)
    axes = plot.axes[0, 0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("S (m/s²)", "S' (m/s³)")
    assert axes.get_xlim() == pytest.approx((-2, 2))
    S, curve = axes.lines[-1].get_data()
    np.testing.assert_allclose(curve, -K1 * np.sqrt(2.0 * abs(S)) * np.sign(S))
    plt.close("all")


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: analysis.super_twisting_motion([1.5]), "positive gains|k has shape"),
        (lambda: analysis.super_twisting_motion([1.5, -1.0]), "two positive gains"),
        (lambda: analysis.super_twisting_motion(slope=0.0), "slope > 0"),
        (lambda: analysis.super_twisting_motion(disturbance_slope=np.inf), "disturbance_slope"),
        (lambda: analysis.super_twisting_phase_plane(limits=[1, 0, 0, 1]), "ascending"),
    ],
)
def test_bad_input_is_refused_with_a_remedy(call, message):
    with pytest.raises(ParameterError, match=message):
        call()
