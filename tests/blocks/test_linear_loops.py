"""Linear outer loops: integral action, LQR, and the disturbance observer, which is integral action of another start."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from outer_loop_cases import B, chain_loop, chain_plant

import brunovsky as br
from brunovsky import analysis
from brunovsky.blocks import Chains, symbol, symbols
from brunovsky.errors import ModelError, ParameterError

POLES = [-4.0, -5.0, -6.0]
GAIN = analysis.place(POLES)
LEFT = st.floats(-8.0, -0.5)


def poles_of_loop(law: br.Block, chains: Chains) -> list[complex]:
    """Eigenvalues of the Jacobian of chains and law, the reference at rest."""
    outputs = {one.name: one.expression for one in law.outputs}
    values = {one.symbol: one.value for one in law.parameters}
    states, slopes = [], []
    for i, order in enumerate(chains.orders, 1):
        states += [symbol(f"Z{i}[{k}]") for k in range(1, order + 1)]
        slopes += [*(symbol(f"Z{i}[{k}]") for k in range(2, order + 1)), outputs[f"v[{i}]"]]
    states += [one.symbol for one in law.states]
    slopes += [one.derivative for one in law.states]
    jacobian = sp.Matrix(slopes).subs(values).jacobian(states)
    return sorted(np.linalg.eigvals(np.array(jacobian, dtype=float)), key=lambda one: (one.real, one.imag))


@settings(max_examples=15)
@given(st.lists(LEFT, min_size=3, max_size=3, unique_by=lambda x: round(x)))
def test_integral_action_places_one_pole_more_per_chain(poles: list[float]) -> None:
    chains = Chains((2, 1), ("m", "V"))
    law = B.pole_placement(chains, [analysis.place(poles), analysis.place(poles[:2])], integral=True)
    assert [one.name for one in law.parameters] == ["K1[1]", "K1[2]", "K2[1]", "K_I[1]", "K_I[2]"]
    assert [(one.name, one.unit) for one in law.states] == [("integral[1]", "m.s"), ("integral[2]", "V.s")]
    found = poles_of_loop(law, chains)
    assert np.real(found) == pytest.approx(sorted([*poles, *poles[:2]]), abs=1e-4)


def test_integral_gain_has_its_unit() -> None:
    law = B.pole_placement(gains=analysis.place([*POLES, -7.0]), integral=True)
    assert {one.name: one.unit for one in law.parameters} == {
        "K[1]": "1/s3", "K[2]": "1/s2", "K[3]": "1/s", "K_I": "1/s4",
    }  # fmt: skip
    assert law.parameter_values()["K_I"] == pytest.approx(4 * 5 * 6 * 7)


@pytest.mark.parametrize(
    "law",
    [
        B.pole_placement(chain_plant(), analysis.place([*POLES, -7.0]), integral=True),
        B.pole_placement(chain_plant(), analysis.lqr_gain(3, [1e6, 1e5, 1e3, 1.0], integral=True), integral=True),
        B.disturbance_observer(chain_plant(), GAIN, bandwidth=10.0),
    ],
    ids=["poles", "LQR", "observer"],
)
def test_a_constant_disturbance_leaves_no_error(law: br.Block) -> None:
    data = br.simulate(chain_loop(law), 12.0, inputs={"d": 3.0})
    assert abs(data["e1[1]"][-500:]).max() < 1e-9
    plain = br.simulate(chain_loop(B.pole_placement(chain_plant(), GAIN)), 12.0, inputs={"d": 3.0})
    assert float(plain["e1[1]"][-1]) == pytest.approx(3.0 / 120.0, rel=1e-6)


@settings(max_examples=10)
@given(st.lists(LEFT, min_size=3, max_size=3), st.floats(1.0, 30.0))
def test_the_observer_is_integral_action_with_the_poles_of_gain_and_bandwidth(poles: list[float], L: float) -> None:
    """With p' = nominal law and d_hat = L (Z_3 - p), v is that of integral action once p is written as an integral."""
    observer = B.disturbance_observer(chain_plant(), analysis.place(poles), bandwidth=L)
    integral = B.pole_placement(chain_plant(), analysis.place([*poles, -L]), integral=True)
    values = {one.symbol: one.value for block in (observer, integral) for one in block.parameters}
    k = analysis.place(poles)
    errors = [symbol(f"Z1[{j}]") - symbol(f"Z1d[{j}]") for j in (1, 2, 3)]
    total, nominal = symbols("integral[1]", "nominal[1]")
    # p' = -k1 e1 - k2 e1' - k3 e1'' + z_d''', integrated
    written = -k[0] * total - k[1] * errors[0] - k[2] * errors[1] + symbol("Z1d[3]")
    one, other = (block.outputs[0].expression for block in (observer, integral))
    own = {p.symbol: p.value for p in observer.parameters}
    difference = one.subs(own).subs(nominal, written) - other.subs({p.symbol: p.value for p in integral.parameters})
    largest = max(abs(float(c)) for c in sp.expand(difference).as_coefficients_dict().values())
    assert largest < 1e-9 * max(abs(float(v)) for v in values.values())


def test_the_estimate_follows_a_constant_and_lags_a_ramp() -> None:
    """d_hat' = L (d - d_hat): exact in the end for a constant, behind by R/L for a ramp of R per second."""
    L, R = 10.0, 2.0
    loop = chain_loop(B.disturbance_observer(chain_plant(), GAIN, bandwidth=L))
    data = br.simulate(loop, 4.0, inputs={"d": 3.0}, record=["d_hat[1]"])
    assert data["d_hat[1]"][0] == 0.0
    assert data["d_hat[1]"].values == pytest.approx(3.0 * (1 - np.exp(-L * data["time"].values)), abs=1e-6)
    ramp = br.simulate(loop, 4.0, inputs={"d": lambda t: R * t}, record=["d_hat[1]"])
    # inputs are held over the step of 1 ms: half a step behind on average
    assert R * 4.0 - float(ramp["d_hat[1]"][-1]) == pytest.approx(R / L + R * 0.5e-3, abs=1e-3 * R)


def test_the_observer_keeps_the_nominal_motion_when_nothing_disturbs_it() -> None:
    plain, observed = (
        br.simulate(chain_loop(law), 3.0)
        for law in (B.pole_placement(chain_plant(), GAIN), B.disturbance_observer(chain_plant(), GAIN))
    )
    assert abs(observed["d_hat[1]"]).max() < 1e-10
    assert abs(observed["e1[1]"] - plain["e1[1]"]).max() < 1e-12


def test_on_the_robot_the_observer_sees_the_yaw_disturbance() -> None:
    """d2 enters as eta1 d2 h_th: matched; what is left of its estimate is its rotation at w: w/sqrt(L^2 + w^2)."""
    L, w, d2 = 50.0, 0.5, 0.2
    loop = B.closed_loop(B.disturbance_observer(bandwidth=L))
    data = br.simulate(loop, 20.0, inputs={"d[2]": d2})
    last = data.isel(time=slice(-5000, None))
    speed = np.sqrt(2.0) * w
    estimated = np.hypot(last["d_hat[1]"], last["d_hat[2]"])
    assert estimated.mean() == pytest.approx(speed * d2 * L / np.hypot(L, w), rel=1e-3)
    k1, k2, k3 = 2500.0, 550.0, 15.0
    loop_gain = abs(-1j * w**3 - k3 * w**2 + 1j * k2 * w + k1)
    residual = speed * d2 * w / np.hypot(L, w) / loop_gain
    assert float(np.hypot(last["e1[1]"], last["e2[1]"]).mean()) == pytest.approx(residual, rel=5e-3)


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: B.pole_placement(integral=True), ModelError, "one pole more"),
        (lambda: B.pole_placement(gains=[1, 2, 3], integral=True), ModelError, "K_I first"),
        (lambda: B.pole_placement(gains=[[1, 2, 3, 4], 2], integral=True), ModelError, "no vector"),
        (lambda: B.pole_placement(gains=[], integral=True), ModelError, "no vector"),
        (lambda: B.disturbance_observer(bandwidth=0.0), ParameterError, "observes nothing; set it > 0"),
        (lambda: B.disturbance_observer(bandwidth=-1.0), ParameterError, "bandwidth = -1"),
        (lambda: B.disturbance_observer(chain_plant()), ModelError, "disturbance_observer: gains are missing"),
    ],
)
def test_what_cannot_work_is_refused(make: object, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        make()  # type: ignore[operator]


def test_an_unstable_linear_loop_is_warned_of_and_no_other_law_stands_on_it():
    with pytest.warns(UserWarning, match="poles .* not all in the open left half plane"):
        B.pole_placement(gains=[2500, -550, 15])
    with pytest.warns(UserWarning, match="poles"):
        B.pole_placement(gains=[-1.0, 24.0, 26.0, 9.0], integral=True)
    for law in (B.disturbance_observer, B.integral_sliding_mode):
        with pytest.raises(ParameterError, match="poles"):
            law(gains=[-1, 0, 0])


@pytest.mark.parametrize(
    "make",
    [
        lambda: B.pole_placement(gains=5),
        lambda: B.pole_placement(gains=["a", "b", "c"]),
        lambda: B.sliding_mode(surface=[500, [10], 1]),
        lambda: B.sliding_mode(surface=[500, 10, 1j]),
        lambda: B.sliding_mode(Q="a"),
        lambda: B.sliding_mode(P=None),
        lambda: B.sliding_mode(P=[1.0, [2.0]]),
        lambda: B.pole_placement(gains=[1.0, [2.0, [3.0]], 4.0]),
        lambda: B.pole_placement(gains="abc"),
        lambda: B.set_point(B.Chains(), [1.0]),
        lambda: B.set_point(B.Chains(), [1.0, 2.0, 3.0]),
        lambda: B.Chains((True,), ("m",)),
    ],
)
def test_what_are_no_numbers_for_the_chains_is_refused(make):
    with pytest.raises(ModelError):
        make()


def test_numpy_numbers_are_numbers():
    assert B.Chains((np.int64(3),), ("m",)).orders == (3,)
    assert [one.value for one in B.set_point(B.Chains(), np.array([1.0, 2.0])).parameters] == [1.0, 2.0]
    sampled = B.sliding_mode_sampled(period=np.float32(0.01))
    assert next(one.value for one in sampled.parameters if one.name == "sampling_period") == pytest.approx(0.01)


def test_a_negative_rate_is_warned_of_and_a_relay_that_would_rest_too():
    with pytest.warns(UserWarning, match="Q = -5 drives S away"):
        B.sliding_mode(Q=-5)
    with pytest.raises(ParameterError, match="comes to rest within the hysteresis"):
        B.sliding_mode_relay(hysteresis=1.0)
