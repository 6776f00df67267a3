"""Integral sliding mode: on its surface from the first instant, and along the nominal motion."""

import control
import numpy as np
import pytest
from outer_loop_cases import B, chain_loop, chain_plant

import brunovsky as br
from brunovsky import analysis

GAIN = analysis.place([-4.0, -5.0, -6.0])
P, PHI, D = 5.0, 0.05, 4.0


def disturbance(t: float) -> float:
    return 2.5 + 1.5 * np.sin(9.0 * t)


@pytest.fixture(scope="module")
def nominal() -> br.Block:
    return br.simulate(chain_loop(B.pole_placement(chain_plant(), GAIN)), 5.0, parameters={"amplitude": 0.4})


@pytest.mark.parametrize("switching", ["saturation", "tanh", "sign"])
def test_it_keeps_the_nominal_motion_under_a_matched_disturbance(switching: str, nominal: br.Block) -> None:
    """S' = -P f(S) + d, and the error departs from the nominal one by S through s/(s^3 + k3 s^2 + k2 s + k1)."""
    width = None if switching == "sign" else PHI
    law = B.integral_sliding_mode(chain_plant(), GAIN, P=P, phi=width, switching=switching, disturbance=D)
    data = br.simulate(chain_loop(law), 5.0, parameters={"amplitude": 0.4}, inputs={"d": disturbance})
    layer = {"saturation": PHI * D / P, "tanh": PHI * np.arctanh(D / P), "sign": (P + D) * 1e-3}[switching]
    assert data["S[1]"][0] == 0.0
    assert abs(data["S[1]"]).max() <= layer * (1 + 1e-6)
    k1, k2, k3 = GAIN
    response = control.impulse_response(control.tf([1, 0], [1, k3, k2, k1]), np.linspace(0, 8, 8001))
    largest = np.trapezoid(abs(response.outputs), response.time) * layer
    departure = abs(data["e1[1]"] - nominal["e1[1]"]).max()
    assert departure <= 1.01 * largest
    plain = br.simulate(
        chain_loop(B.pole_placement(chain_plant(), GAIN)), 5.0, parameters={"amplitude": 0.4}, inputs={"d": disturbance}
    )
    assert departure < 0.2 * abs(plain["e1[1]"] - nominal["e1[1]"]).max()


def test_within_the_layer_it_is_the_disturbance_observer() -> None:
    sliding = B.integral_sliding_mode(chain_plant(), GAIN, P=P, phi=PHI)
    observer = B.disturbance_observer(chain_plant(), GAIN, bandwidth=P / PHI)
    one, other = (
        br.simulate(chain_loop(law), 3.0, inputs={"d": disturbance}, record=["e1[1]", "v[1]"])
        for law in (sliding, observer)
    )
    assert abs(one["e1[1]"] - other["e1[1]"]).max() < 1e-12
    assert abs(one["v[1]"] - other["v[1]"]).max() < 1e-9


def test_beyond_its_gain_it_leaves_the_surface() -> None:
    loop = chain_loop(B.integral_sliding_mode(chain_plant(), GAIN, P=P, phi=PHI))
    data = br.simulate(loop, 2.0, inputs={"d": 1.2 * P})
    assert float(data["S[1]"][-1]) == pytest.approx(0.2 * P * 2.0, rel=0.02)


def test_it_starts_where_the_robot_is() -> None:
    """Nothing disturbs the robot on its chains: S is zero, whatever the start, but for the method's error in them."""
    loop = B.closed_loop(B.integral_sliding_mode())
    start = {"u_start[1]": 0.7, "x_start": 3.0}
    largest = []
    for step in (4e-4, 2e-4):
        data = br.simulate(loop, 1.0, step_size=step, parameters=start, record=["S[1]", "S[2]"])
        assert data["S[1]"][0] == 0.0 and data["S[2]"][0] == 0.0
        largest.append(float(max(abs(data["S[1]"]).max(), abs(data["S[2]"]).max())))
    assert largest[0] < 1e-5 and largest[0] / largest[1] == pytest.approx(16.0, rel=0.3)
