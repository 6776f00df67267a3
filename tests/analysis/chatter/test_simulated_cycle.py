"""Simulated switching loops: margins of the linear part, every kind of outcome, delay, saturation, and the basin."""

import numpy as np
import pytest

from brunovsky.analysis import (
    SwitchingLoop,
    basin_edge,
    cycle_state,
    margins,
    predicted_cycles,
    relay_cycles,
    simulated_cycle,
    sliding_gain,
)
from brunovsky.analysis.chatter.switched_response import trajectory
from brunovsky.errors import ParameterError

C, Q, P = (500.0, 10.0, 1.0), 5.0, 2.5


@pytest.mark.parametrize("kind", ["lag", "two_lags", "delay"])
def test_the_linear_part_of_the_paper_loses_stability_at_its_margin(kind):
    margin = getattr(margins(sliding_gain(C, Q)), kind)
    assert margin == pytest.approx({"lag": 19.0e-3, "two_lags": 9.2e-3, "delay": 18.4e-3}[kind], abs=1e-4)
    for factor, outcome in ((0.98, "decays"), (1.02, "diverges")):
        late = factor * margin
        actuator = {"lag": {"lags": [late]}, "two_lags": {"lags": [late, late]}, "delay": {"delay": late}}[kind]
        assert simulated_cycle(SwitchingLoop(C, Q, 0.0, **actuator)).outcome == outcome


@pytest.mark.parametrize("delay", [0.002, 0.005, 0.01, 0.017])
@pytest.mark.parametrize("lags", [(), (0.002,)])
def test_with_a_delay_the_fundamental_is_predicted(delay, lags):
    loop = SwitchingLoop(C, Q, P, lags=lags, delay=delay)
    seen = simulated_cycle(loop).cycle
    (predicted,) = (one for one in predicted_cycles(loop) if one.stable)
    (exact,) = (one for one in relay_cycles(loop) if one.stable)
    assert predicted.frequency == pytest.approx(seen.frequency, rel=0.05)
    assert predicted.amplitude == pytest.approx(seen.fundamental, rel=0.05)
    assert exact.frequency == pytest.approx(seen.frequency, rel=1e-4)
    assert exact.amplitude == pytest.approx(seen.amplitude, rel=3e-3)
    assert exact.fundamental == pytest.approx(seen.fundamental, rel=1e-3)


@pytest.mark.parametrize("phi", [1e-3, 4e-3, 6e-3])
@pytest.mark.parametrize("delay", [0.0, 1e-3])
def test_a_boundary_layer_too_thin_for_the_lags_chatters(phi, delay):
    loop = SwitchingLoop(C, Q, P, boundary_layer=phi, lags=[0.005, 0.005], delay=delay)
    (predicted,) = predicted_cycles(loop)
    seen = simulated_cycle(loop).cycle
    assert predicted.frequency == pytest.approx(seen.frequency, rel=0.05)
    assert predicted.amplitude == pytest.approx(seen.amplitude, rel=0.1)


def test_a_boundary_layer_chatters_up_to_the_margin_of_its_own_gain():
    relay = SwitchingLoop(C, Q, P, lags=[0.005, 0.005])
    threshold = np.pi / 4 * predicted_cycles(relay)[0].amplitude
    for factor, outcome in ((0.97, "cycle"), (1.03, "decays")):
        loop = SwitchingLoop(C, Q, P, boundary_layer=factor * threshold, lags=[0.005, 0.005])
        assert simulated_cycle(loop).outcome == outcome


def test_hysteresis_with_lags():
    loop = SwitchingLoop(C, Q, P, lags=[0.005, 0.005], hysteresis=0.003)
    (exact,) = relay_cycles(loop)
    seen = simulated_cycle(loop).cycle
    assert exact.frequency == pytest.approx(seen.frequency, rel=1e-6)
    assert exact.amplitude == pytest.approx(seen.amplitude, rel=1e-3)


@pytest.mark.parametrize("actuator", [{}, {"lags": [0.01]}])
def test_a_relay_that_slides(actuator):
    assert simulated_cycle(SwitchingLoop(C, Q, P, **actuator)).outcome == "slides"


def test_beyond_the_fold_nothing_is_bounded():
    assert simulated_cycle(SwitchingLoop(C, Q, P, lags=[0.015, 0.015])).outcome == "diverges"


@pytest.mark.parametrize("milliseconds", [9.5, 12.0, 14.0])
def test_the_unstable_cycle_bounds_the_basin_of_the_stable_one(milliseconds):
    loop = SwitchingLoop(C, Q, P, lags=[milliseconds * 1e-3] * 2)
    small, large = relay_cycles(loop)
    assert (small.stable, large.stable) == (True, False)
    edge = cycle_state(loop, large.frequency)
    inside = simulated_cycle(loop, 0.97 * edge)
    assert inside.outcome == "cycle"
    assert inside.cycle.amplitude == pytest.approx(small.amplitude, rel=1e-3)
    assert simulated_cycle(loop, 1.03 * edge).outcome == "diverges"


def test_edge_of_the_basin_by_bisection():
    loop = SwitchingLoop(C, Q, P, lags=[0.012, 0.012])
    large = relay_cycles(loop)[-1]
    assert basin_edge(loop, 0.3 * cycle_state(loop, large.frequency), 0.02) == pytest.approx(1 / 0.3, rel=0.02)
    assert basin_edge(SwitchingLoop(C, Q, P, lags=[0.005, 0.005]), [0, 0, 2.0**-55], 0.5) == np.inf


def test_the_trajectory_of_a_linear_loop_is_its_exponential():
    loop = SwitchingLoop((2.0, 1.0), 3.0, 0.0, sampling=None)
    t, S = next(trajectory(loop, np.array([0.1, 0.5])))
    np.testing.assert_allclose(S, 0.7 * np.exp(-3.0 * t), rtol=1e-10)


def test_amplitude_is_independent_of_the_start():
    loop = SwitchingLoop(C, Q, P, lags=[0.005, 0.005])
    near, far = (simulated_cycle(loop, start).cycle for start in ([0, 0, 1e-4], [0.1, -0.3, 2.0, 1.0, 5.0]))
    assert near.amplitude == pytest.approx(far.amplitude, rel=1e-3)
    assert near.frequency == pytest.approx(far.frequency, rel=1e-4)


@pytest.mark.parametrize("start", [[1.0], [0, 0, 0], [1, 2, 3, 4], [np.nan, 0, 0], "x"])
def test_a_start_that_does_not_fit_is_refused(start):
    with pytest.raises(ParameterError, match="start"):
        simulated_cycle(SwitchingLoop(C, Q, P, lags=[0.005, 0.005]), start)


def test_other_bad_input_is_refused():
    loop = SwitchingLoop(C, Q, P, lags=[0.005, 0.005])
    with pytest.raises(ParameterError, match="tolerance"):
        basin_edge(loop, [0, 0, 1], 1.0)
    with pytest.raises(ParameterError, match="frequency > 0"):
        cycle_state(loop, 0)
    with pytest.raises(ParameterError, match="lags only"):
        cycle_state(SwitchingLoop(C, Q, P, delay=0.01), 1)
