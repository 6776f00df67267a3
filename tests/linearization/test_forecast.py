"""The forecast agrees with simulating the plant under its law."""

import numpy as np
import pytest
import sympy as sp
from gallery_plants import linearized
from hypothesis import given, settings
from hypothesis import strategies as st
from linearization_plants import U2, chain
from scipy.integrate import solve_ivp

from brunovsky.errors import LinearizationError, ModelError, ParameterError
from brunovsky.linearization import chain_values, forecast, linearize

GAINS = [np.array([2500.0, 550.0, 15.0])] * 2  # C = [500 10 1], Q = 5 and no switching term
RADIUS, RATE = np.sqrt(2.0), 0.5


def circle(time: float) -> tuple[list[float], list[float]]:
    phases = [RATE * time + k * np.pi / 2 for k in range(4)]
    return tuple([RADIUS * RATE**k * f for k, f in enumerate(map(shape, phases))] for shape in (np.cos, np.sin))


def start(theta: float, speed: float = 0.5) -> dict[str, float]:
    return {"x": 2.5, "y": 0, "theta": theta, "eta1": speed, "eta2": 0, "u1": 0}


@pytest.mark.parametrize(("theta", "distance", "peak"), [(0.0, 0.5, 5439.5), (-np.pi / 2, 0.06604, 3.5288e5)])
def test_robot_outside_the_circle(theta: float, distance: float, peak: float) -> None:
    result = linearized("nominal_robot")
    found = forecast(result, GAINS, chain_values(result, start(theta)), circle, 2.0, samples=20001)
    assert found.closest_distance == pytest.approx(distance, rel=1e-3)
    assert found.peaks[U2] == pytest.approx(peak, rel=0.02)  # a spike, seen at the instants
    assert found.chains.shape == (20001, 6) and found.distances.shape == found.times.shape


@settings(max_examples=5)
@given(theta=st.floats(-3.0, 3.0), speed=st.sampled_from([-1.0, 0.5, 2.0]))
def test_robot_simulated_comes_as_near(theta: float, speed: float) -> None:
    result = linearized("nominal_robot")
    system = result.extended_system
    gains, poles = [np.array([6.0, 11.0, 6.0])] * 2, 1.0
    place = start(theta, speed)
    found = forecast(result, gains, chain_values(result, place), circle, poles)
    if found.closest_distance < 0.05:
        return
    chains = sp.lambdify(system.states, [part for parts in result.chains for part in parts])
    law = sp.lambdify((*system.states, *result.outer_inputs), list(result.law.values()))
    field = sp.lambdify(
        (*system.states, *system.inputs), list(system.dynamics.subs(dict.fromkeys(system.disturbances, 0)))
    )

    def slope(time: float, state: np.ndarray) -> list[float]:
        errors = np.array(chains(*state)).reshape(2, 3) - np.array(circle(time))[:, :3]
        v = np.array(circle(time))[:, 3] - errors @ gains[0]
        return field(*state, *law(*state, *v))

    first = [float(place[symbol.name]) for symbol in system.states]
    simulated = solve_ivp(slope, (0, poles), first, rtol=1e-10, atol=1e-10, t_eval=found.times)
    np.testing.assert_allclose(np.abs(simulated.y[3]), found.distances, rtol=1e-6, atol=1e-7)
    assert np.min(np.abs(simulated.y[3])) == pytest.approx(found.closest_distance, abs=1e-5)


def test_the_minimum_is_refined_between_the_instants() -> None:
    result = linearized("unicycle")

    # y1 = 1 - 2 t + t^2 passes speed zero in the y1 direction, speed 0.3 across it stays
    def reference(time: float) -> tuple[list[float], list[float]]:
        return [(time - 1) ** 2, 2 * (time - 1), 2.0], [0.3 * time, 0.3, 0.0]

    found = forecast(result, [[1, 2]] * 2, [[1, -2], [0, 0.3]], reference, 2.3, samples=6)
    assert found.closest_time == pytest.approx(1.0, abs=1e-6)
    assert found.closest_distance == pytest.approx(0.3, rel=1e-9)
    assert np.min(found.distances) > 0.31


def test_vtol_needs_values_of_its_parameters() -> None:
    result = linearized("vtol")

    def hover(time: float) -> tuple[list[float], list[float]]:
        return [0.0] * 5, [0.0] * 5

    gains, first = [[24, 50, 35, 10]] * 2, [[1, 0, 0, 0], [2, 0, 0, 0]]
    found = forecast(result, gains, first, hover, 3.0, parameters={"m": 2, "J": 0.1})
    assert 0 < found.closest_distance < 2 * 9.81
    with pytest.raises(ParameterError, match=r"no value for m, J; give one"):
        forecast(result, gains, first, hover, 3.0)


def test_what_cannot_be_forecast_is_refused() -> None:
    def rest(time: float) -> tuple[list[float], ...]:
        return ([0.0] * 4,)

    beam = linearized("ball_and_beam")
    with pytest.raises(LinearizationError, match=r"depend on the internal dynamics \(eta1\)"):
        forecast(beam, [[1, 3, 3]], [[1, 0, 0]], rest, 1.0, parameters={"b": 1})
    with pytest.raises(LinearizationError, match="there is no singularity"):
        forecast(linearize(chain(3)), [[1, 3, 3]], [[1, 0, 0]], rest, 1.0)
    robot = linearized("nominal_robot")
    with pytest.raises(ModelError, match=r"gains: shapes \[\(2,\)\] where \[\(3,\), \(3,\)\]"):
        forecast(robot, [[1, 2]], [[0] * 3] * 2, circle, 1.0)
    with pytest.raises(ParameterError, match="t_end > 0"):
        forecast(robot, GAINS, [[0] * 3] * 2, circle, 0.0)
