"""Super-twisting: what it removes and what not, continuous and implicit."""

import warnings

import numpy as np
import pytest
import sympy as sp
from outer_loop_cases import B, chain_plant
from test_sampled_sliding_mode import C, chain_run, variation

import brunovsky as br
from brunovsky import analysis
from brunovsky.blocks import Chains
from brunovsky.blocks.library.outer_loops.super_twisting import _signed_root
from brunovsky.blocks.library.outer_loops.surface_map import mean_rates
from brunovsky.errors import ModelError, ParameterError

ONE = Chains((1,), ("m",))


def test_the_contract_of_the_variables():
    block = B.super_twisting()
    assert [(one.name, one.unit) for one in block.parameters] == [
        ("C[1]", "1/s2"), ("C[2]", "1/s"), ("C[3]", "1"), ("k[1]", "1"), ("k[2]", "1"), ("L", "m/s4"),
    ]  # fmt: skip
    assert [one.name for one in block.inputs] == [one.name for one in B.sliding_mode().inputs]
    assert [(one.name, one.unit) for one in block.outputs] == [
        ("v[1]", "m/s3"), ("v[2]", "m/s3"), ("S[1]", "m/s2"), ("S[2]", "m/s2"),
    ]  # fmt: skip


@pytest.mark.parametrize("slope", [1.0, 10.0, 100.0])
def test_a_disturbance_of_bounded_slope_is_removed(slope):
    """Below 1e-6 with steps of 0.1 ms, for L = 100 m/s4 too."""
    law = B.super_twisting(chain_plant(), C, L=slope)
    assert analysis.super_twisting_condition(1.0, slope)
    time, s, v = chain_run(law, 6.0, disturbance=np.sin, start=0.002, samples=False, step_size=1e-4)
    assert abs(s[time > 4]).max() < 1e-6
    tail = time > 4
    assert abs(v[tail] + np.sin(time[tail])).max() < 0.2 * np.sqrt(slope) * 1e-1


def test_a_ramp_that_is_steeper_than_the_integral_is_not():
    """k2 L = 1.1 m/s4: a ramp of 1 m/s4 is removed, one of 2 m/s4 outruns it and S grows."""
    law = B.super_twisting(chain_plant(), C, L=1.0)
    for slope, removed in ((1.0, True), (2.0, False)):
        assert analysis.super_twisting_condition(slope, 1.0) == removed
        time, s, _ = chain_run(
            law, 10.0, disturbance=lambda t, one=slope: one * t, start=0.0, samples=False, step_size=1e-4
        )
        tail = abs(s[time > 5])
        assert tail.max() < 1e-6 if removed else tail.min() > 1.0


def test_reaching_takes_the_time_of_the_square_root():
    """From rest to the first zero of S on one integrator; S'' = -k1 sqrt(L) S'/(2 sqrt(S)) - k2 L, by quadrature."""
    plant = integrator()
    law = B.super_twisting(plant, [1.0], L=4.0)
    loop = B.closed_loop(law, plant=plant)
    data = br.simulate(loop, 3.0, parameters={"z_start": 1.0}, step_size=1e-4)
    s = data["S[1]"].values
    first = data["time"].values[np.flatnonzero(s <= 0)[0]]
    # with x = sqrt(S): x' = -(k1 sqrt(L) - w/x)/2 and w = -k2 L t
    x, time = 1.0, 0.0
    while x > 1e-3:
        x -= 1e-5 * (3.0 + 4.4 * time / x) / 2
        time += 1e-5
    assert first == pytest.approx(time, abs=2e-3)


def test_the_square_root_is_smooth_at_zero():
    s = sp.Symbol("s", real=True)
    call = sp.lambdify(s, _signed_root(s))
    values = np.concatenate([[0.0], np.geomspace(1e-30, 1e3, 2000)])
    values = np.concatenate([-values, values])
    error = abs(call(values) - np.sqrt(abs(values)) * np.sign(values))
    assert np.isfinite(call(values)).all()
    assert error.max() < 2.6e-7
    assert error[abs(values) > 1e-8].max() < 1e-12


def integrator():
    z, u, d = (sp.Symbol(name, real=True) for name in "zud")
    system = br.AffineSystem((z,), (u,), [0], [1], (z,), disturbances={d: (1,)})
    return br.linearized_block(br.linearize(system), labels={z: B.Variable("z", "m")}, output_units=["m"])


def updates(compensated):
    """(S, w) to (v, w+) of one integrator, by NumPy."""
    block = B.super_twisting_sampled(ONE, [1.0], period=0.1, L=2.0, k=(1.7, 1.3), compensated=compensated)
    engine = br.blocks.NumpyEngine(block)
    names = [one.name for one in block.samples]

    def call(s, w):
        engine.reset()
        engine.inputs = np.array([s, 0.0, 0.0])
        engine.samples = np.array([w if name == "w[1]" else 0.0 for name in names])
        engine.event()
        found = dict(zip(names, engine.samples, strict=True))
        return found["v[1]"], found["w[1]"]

    return call


@pytest.mark.parametrize("compensated", [False, True])
def test_the_closed_form_solves_the_implicit_step(compensated):
    """The inclusion of the source: w+ = w - h k2 L s, v = w+ - k1 sqrt(L abs(S+)) sign(S+), s in sign(S+)."""
    call, h, k1, k2, slope = updates(compensated), 0.1, 1.7, 1.3, 2.0
    random = np.random.default_rng(5)
    for _ in range(300):
        s, w = 10.0 ** random.uniform(-4, 2, size=2) * random.choice([-1.0, 1.0], size=2)
        v, following = call(s, w)
        assumed = (following - w) if compensated else 0.0
        after = s + h * (v - following) if compensated else s + h * v
        sign = (w - following) / (h * k2 * slope)
        assert abs(sign) <= 1 + 1e-9
        if abs(after) > 1e-9 * (abs(s) + abs(w)):
            assert sign == pytest.approx(np.sign(after), abs=1e-9 * (1 + abs(w)))
        root = k1 * np.sqrt(slope * abs(after)) * np.sign(after)
        assert v == pytest.approx(following + assumed - root, abs=1e-5 * (1 + abs(v)))


@pytest.mark.parametrize("compensated", [False, True])
@pytest.mark.parametrize("period", [1e-3, 1e-2])
def test_the_implicit_scheme_leaves_what_a_sample_cannot_know(compensated, period):
    """h^2 b L where w stands for the disturbance, h b d where it does not; v varies as the disturbance does."""
    law = B.super_twisting_sampled(chain_plant(), C, L=1.0, period=period, compensated=compensated)
    time, s, v = chain_run(law, 8.0, disturbance=np.sin, start=0.002, period=period, step_size=period / 10)
    b = mean_rates(C, period, "exact")[-1]
    left = abs(s[time > 5]).max()
    assert left == pytest.approx((period**2 if compensated else period) * b, rel=0.01)
    assert variation(v[time > 5]) == pytest.approx(variation(np.sin(time[time > 5])), rel=0.01)


def test_the_implicit_scheme_is_below_a_millionth_with_a_step_of_a_tenth_of_a_millisecond():
    law = B.super_twisting_sampled(chain_plant(), C, L=1.0, period=1e-4)
    time, s, _ = chain_run(law, 6.0, disturbance=np.sin, start=0.002, period=1e-4, step_size=1e-4)
    assert abs(s[time > 4]).max() < 1e-6


@pytest.mark.parametrize("seed", range(12))
def test_every_slope_within_the_bound_leaves_its_least(seed):
    """Random gains that satisfy the condition, random starts, periods and disturbances: abs(S) <= L h^2 in the end."""
    random = np.random.default_rng(seed)
    period, slope, k2 = 10 ** random.uniform(-2, 0), 10 ** random.uniform(-1, 1), random.uniform(1.02, 3.0)
    k1 = np.sqrt(k2 + 1) * random.uniform(1.02, 2.0)
    start = random.choice([-1.0, 1.0]) * slope * period * 10 ** random.uniform(0, 1)
    plant = integrator()
    loop = B.closed_loop(B.super_twisting_sampled(plant, [1.0], period=0.01), plant=plant)
    turns = np.cumsum(random.uniform(1.0, 100.0, size=400))
    k = np.arange(4001)
    direction = np.where(np.searchsorted(turns, k) % 2, 1.0, -1.0)
    d = random.normal() + slope * period * np.concatenate([[0.0], np.cumsum(direction[:-1])])
    values = {"sampling_period": period, "L": slope, "k[1]": k1, "k[2]": k2, "z_start": start}
    data = br.simulate(loop, 4000 * period, step_size=period, parameters=values, inputs={"d": d})
    assert abs(data["S[1]"].values[3000:]).max() <= slope * period**2 * (1 + 1e-6) + 1e-12


def test_on_the_circle_with_the_reference_known_ahead_s_is_rounding():
    loop = B.closed_loop(B.super_twisting_sampled(preview=True), reference=B.preview(B.circle()))
    data = br.simulate(loop, 10.0, record=["S[1]", "S[2]"])
    assert max(abs(data[name].values[8000::10]).max() for name in data) < 1e-11


@pytest.mark.parametrize("make", [B.super_twisting, B.super_twisting_sampled])
@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"k": (1.5, 1.0)}, ParameterError, r"k\[2\] is not above 1: .* 1.1 say"),
        ({"k": (1.5,)}, ModelError, r"k has the shape \(1,\); give k1 and k2"),
        ({"L": 0.0}, ParameterError, "L = 0 leaves the law without feedback"),
        ({"L": -1.0}, ParameterError, "L = -1 m/s4 is not"),
        ({"surface": [500.0, -10.0, 1.0]}, ParameterError, "has the poles"),
        ({"surface": [500.0, 10.0, 0.0]}, ParameterError, "leaves v out of the surface"),
    ],
)
def test_bad_input_is_refused_with_its_remedy(make, options, error, message):
    with pytest.raises(error, match=message):
        make(**options)


def test_gains_without_a_guarantee_are_warned_of():
    with pytest.warns(UserWarning, match=r"k\[1\] is not above sqrt\(k\[2\] \+ 1\)"):
        B.super_twisting(k=(1.2, 1.1))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        B.super_twisting()
        B.super_twisting_sampled()
    with pytest.raises(ParameterError, match="too long: on the surface"):
        B.super_twisting_sampled(period=0.16)
