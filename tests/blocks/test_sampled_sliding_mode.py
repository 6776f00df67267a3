"""Sampled sliding mode: what it makes of S, its chatter and the absence of it, its limits."""

import dataclasses
import warnings

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from outer_loop_cases import B, chain_loop, chain_plant

import brunovsky as br
from brunovsky import analysis
from brunovsky.blocks import TIME, Block, Chains, Input, Output, Parameter, State, symbol
from brunovsky.blocks.library.outer_loops.surface_map import mean_rates, sampled_stability
from brunovsky.errors import ModelError, ParameterError

C = [500.0, 10.0, 1.0]
P, Q, H = 2.5, 5.0, 0.01


def variation(values):
    return float(np.abs(np.diff(values)).sum())


def chain_run(law, t_end=10.0, *, disturbance=0.0, start=0.01, samples=True, step_size=1e-3, period=H, **options):
    """Time, S and v on the chain that is to rest at 0, at the samples or at every step."""
    block = B.closed_loop(law, plant=chain_plant(), reference=B.set_point(chain_plant()))
    values = {"z0_start": start}
    data = br.simulate(block, t_end, inputs={"d": disturbance}, parameters=values, step_size=step_size, **options)
    every = round(period / step_size) if samples else 1
    return tuple(data[name].values[::every] for name in ("time", "S[1]", "v[1]"))


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5])
def test_mean_rate_of_the_surface_is_that_of_the_integrated_chain(order):
    """(S+ - S)/h from the chain integrated over h with v held, and its limit for h -> 0."""
    h, t, v = sp.symbols("h t v", positive=True)
    c, e = sp.symbols(f"c1:{order + 1}"), sp.symbols(f"e1:{order + 1}")
    y = sum(one * t**k / sp.factorial(k) for k, one in enumerate(e)) + v * t**order / sp.factorial(order)
    s = sum(gain * sp.diff(y, t, k) for k, gain in enumerate(c))
    expected = sp.expand((s.subs(t, h) - s.subs(t, 0)) / h)
    exact, euler = (
        sp.expand(sum(rate * one for rate, one in zip(mean_rates(c, h, which), (*e, v), strict=True)))
        for which in ("exact", "euler")
    )
    assert sp.expand(exact - expected) == 0
    assert sp.expand(euler - expected.subs(h, 0)) == 0


@pytest.mark.parametrize("preview", [False, True])
@pytest.mark.parametrize("scheme", ["implicit", "explicit"])
def test_the_exact_law_moves_every_chain_as_it_says(scheme, preview):
    """Unlike chains, integrated by hand from random values over one period: S+ = (1 - h Q) S - h P s."""
    chains, surfaces = Chains((4, 2, 1), ("m", "rad", "V")), [[24.0, 26.0, 9.0, 1.0], [6.0, 2.0], [-3.0]]
    rates, gains, h = [1.0, 2.0, 3.0], [0.5, 1.0, 2.0], 0.02
    block = B.sliding_mode_sampled(
        chains, surfaces, Q=rates, P=gains, period=h, scheme=scheme, surface_map="exact", preview=preview
    )
    engine = br.blocks.NumpyEngine(block)
    random = np.random.default_rng(3)
    for size in (1e-3, 1.0, 10.0):
        names = [one.name for one in block.inputs]
        values = {name: size * random.normal() for name in names}
        for i, order in enumerate(chains.orders, 1):  # a reference whose last derivative is held
            row = np.array([values[f"Z{i}d[{k}]"] for k in range(1, order + 1)] + [values[f"zd{order}[{i}]"]])
            values |= {f"Z{i}d_next[{k + 1}]": taylor(row[k:], h) for k in range(order)}
        engine.reset()
        engine.inputs = np.array([values[name] for name in names])
        engine.initialize()
        found = dict(zip((one.name for one in block.outputs), engine.outputs(), strict=True))
        for i, (order, c, q, p) in enumerate(zip(chains.orders, surfaces, rates, gains, strict=True), 1):
            row = np.array([values[f"Z{i}[{k}]"] for k in range(1, order + 1)] + [found[f"v[{i}]"]])
            wanted = np.array([values[f"Z{i}d[{k}]"] for k in range(1, order + 1)] + [values[f"zd{order}[{i}]"]])
            before = float(np.dot(c, (row - wanted)[:-1]))
            after = sum(c[k] * taylor((row - wanted)[k:], h) for k in range(order))
            free = (1 - h * q) * before
            expected = free - h * p * np.sign(before)
            if scheme == "implicit":
                expected = np.sign(free) * max(abs(free) - h * p, 0.0)
            assert found[f"S[{i}]"] == pytest.approx(before, rel=1e-9)
            assert after == pytest.approx(expected, abs=1e-10 * max(1.0, abs(before)))


def taylor(derivatives, h):
    return sum(one * h**k / np.prod(np.arange(1.0, k + 1)) for k, one in enumerate(derivatives))


@pytest.mark.parametrize("surface_map", ["euler", "exact"])
def test_the_implicit_scheme_does_not_chatter(surface_map):
    """Disturbance sin t at v, 10 ms: its total variation is that of the disturbance, the explicit one's is not."""
    found = {}
    for scheme in ("implicit", "explicit"):
        law = B.sliding_mode_sampled(chain_plant(), C, scheme=scheme, surface_map=surface_map)
        time, s, v = chain_run(law, disturbance=np.sin, samples=False)
        found[scheme] = variation(v[time > 2]), abs(s[time > 2]).max()
    own = variation(np.sin(time[time > 2]))
    assert found["implicit"][0] < found["explicit"][0] / 100
    assert found["implicit"][0] == pytest.approx(own, rel=0.02)
    b = mean_rates(C, H, "exact")[-1]
    assert found["implicit"][1] <= 1.001 * H * b
    assert found["explicit"][1] > H * P / (2 - H * Q)


@pytest.mark.parametrize("surface_map", ["euler", "exact"])
def test_at_a_set_point_the_implicit_scheme_leaves_rounding(surface_map):
    time, s, v = chain_run(B.sliding_mode_sampled(chain_plant(), C, surface_map=surface_map), samples=False)
    assert abs(s[time > 8]).max() < 1e-12
    assert variation(v[time > 8]) < 1e-10


@pytest.mark.parametrize(("rate", "gain", "period"), [(5.0, 2.5, 0.01), (20.0, 1.0, 0.02), (5.0, 10.0, 0.1)])
def test_the_explicit_scheme_chatters_in_its_band(rate, gain, period):
    law = B.sliding_mode_sampled(
        chain_plant(), C, Q=rate, P=gain, period=period, scheme="explicit", surface_map="exact"
    )
    time, s, _ = chain_run(law, 15.0, period=period, step_size=period / 5)
    band = period * gain / (2 - period * rate)
    settled = s[time > 10]
    assert abs(settled) == pytest.approx(band, rel=1e-3)
    assert (settled[1:] * settled[:-1] < 0).all()


@pytest.mark.parametrize("period", [0.01, 0.025])
def test_with_the_reference_known_ahead_s_is_rounding_on_the_circle(period):
    law = B.sliding_mode_sampled(surface_map="exact", preview=True)
    loop = B.closed_loop(law, reference=B.preview(B.circle()))
    assert [one.name for one in loop.parameters if "period" in one.name] == ["sampling_period"]
    data = br.simulate(loop, 10.0, parameters={"sampling_period": period}, record=["S[1]", "S[2]"])
    at_samples = np.stack([data[name].values[:: round(period / 1e-3)] for name in data])
    tail = at_samples[:, at_samples.shape[1] // 2 :]
    assert abs(tail).max() < 1e-11
    held = B.closed_loop(B.sliding_mode_sampled(surface_map="exact"))
    data = br.simulate(held, 10.0, parameters={"sampling_period": period}, record=["S[1]", "S[2]"])
    assert abs(data["S[1]"].values[5000:]).max() > 1e-7


@pytest.mark.parametrize(("surface_map", "limit"), [("euler", 0.0571), ("exact", 0.1549)])
def test_the_limit_of_the_period_is_that_of_the_loop(surface_map, limit):
    """Just below it a small error decays, without chatter, just above it grows, once the check is taken away."""
    stated = analysis.largest_sampling_period(C, surface_map=surface_map)
    assert stated == pytest.approx(limit, abs=1e-4)
    ends = {}
    for factor in (0.98, 1.02):
        period = factor * stated
        law = B.sliding_mode_sampled(chain_plant(), C, surface_map=surface_map)
        parameters = tuple(
            dataclasses.replace(one, value=period) if one.name == "sampling_period" else one for one in law.parameters
        )
        unchecked = dataclasses.replace(law, checks=(), parameters=parameters)
        _, _, v = chain_run(unchecked, 200 * period, start=1e-7, step_size=period / 4, period=period)
        ends[factor] = abs(v[-20:]).max() / abs(v[:20]).max()
    assert ends[0.98] < 0.1
    assert ends[1.02] > 10


def test_euler_s_rule_is_warned_of_where_large_errors_grow():
    """Between 41 and 57 ms: a start within the reach of P decays, a larger one does not."""
    with pytest.warns(UserWarning, match=r"sampling_period is too long: off the surface.*surface_map='exact'"):
        law = B.sliding_mode_sampled(chain_plant(), C, period=0.05)
    ends = [chain_run(law, 10.0, start=one, step_size=0.0125, period=0.05)[1][-1] for one in (1e-5, 1.0)]
    assert abs(ends[0]) < 1e-9
    assert abs(ends[1]) > 1e3
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        B.sliding_mode_sampled(chain_plant(), C, period=0.04)
        exact = B.sliding_mode_sampled(chain_plant(), C, period=0.15, surface_map="exact")
    assert abs(chain_run(exact, 40.0, start=1.0, step_size=0.03, period=0.15)[1][-1]) < 1e-6


@pytest.mark.parametrize("scheme", ["implicit", "explicit"])
@pytest.mark.parametrize("surface_map", ["euler", "exact"])
def test_constant_rate_reaching_is_not_mistaken_for_instability(scheme, surface_map):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        law = B.sliding_mode_sampled(chain_plant(), C, Q=0.0, P=10.0, scheme=scheme, surface_map=surface_map)
    time, s, _ = chain_run(law)
    assert abs(s[time > 5]).max() <= (1e-12 if scheme == "implicit" else 0.11)


surfaces = st.integers(1, 4).flatmap(
    lambda r: st.tuples(st.lists(st.floats(-1.0, 20.0), min_size=r - 1, max_size=r - 1), st.sampled_from([1.0, -2.0]))
)


@settings(max_examples=60)
@given(surfaces, st.floats(1e-3, 2.0), st.one_of(st.none(), st.floats(0.1, 30.0)), st.sampled_from(["euler", "exact"]))
def test_the_check_of_the_period_is_that_of_the_poles(surface, period, rate, surface_map):
    roots, leading = surface
    coefficients = leading * np.atleast_1d(np.poly(-np.array(roots)))[::-1] if roots else np.array([leading])
    symbols = sp.symbols(f"c1:{len(coefficients) + 1}", real=True)
    q, h = sp.symbols("q h", real=True)
    condition = sampled_stability(symbols, q, h, surface_map)
    values = dict(zip(symbols, map(sp.Float, coefficients), strict=True))
    values |= {h: sp.Float(period), q: sp.Float(1 / period if rate is None else rate)}
    poles = analysis.sampled_sliding_poles(coefficients, period, reaching_rate=rate, surface_map=surface_map)
    radius = abs(poles).max()
    if abs(radius - 1) > 1e-6:
        assert bool(condition.xreplace(values)) == (radius < 1)


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"surface": [500.0, -10.0, 1.0]}, ParameterError, "the surface .* has the poles .*surface_from_poles"),
        ({"surface": [500.0, 10.0, 0.0]}, ParameterError, r"C\[3\] = 0 leaves v out of the surface"),
        ({"period": 0.0}, ParameterError, "the sampling period 0.0 s is not .* give the time between two samples"),
        ({"period": float("nan")}, ParameterError, "sampling period nan s"),
        ({"period": "fast"}, ParameterError, "sampling period 'fast' s"),
        ({"period": 0.058}, ParameterError, "sampling_period is too long: on the surface.*largest_sampling_period"),
        ({"period": 0.05, "scheme": "explicit"}, ParameterError, "too long: off the surface.*surface_map='exact'"),
        ({"period": 0.156, "surface_map": "exact"}, ParameterError, "too long: on the surface"),
        ({"disturbance": 3.0}, ParameterError, "P does not exceed b D.*raise P"),
        ({"scheme": "implict"}, ModelError, "there is no scheme = 'implict'; choose one of 'implicit', 'explicit'"),
        ({"surface_map": "zoh"}, ModelError, "there is no surface_map = 'zoh'"),
        ({"preview": True}, ModelError, "choose surface_map='exact' as well"),
        ({"Q": [1.0, 2.0, 3.0]}, ModelError, "Q: 3 value"),
    ],
)
def test_bad_input_is_refused_with_its_remedy(options, error, message):
    with pytest.raises(error, match=message):
        B.sliding_mode_sampled(**options)


def test_bad_values_are_refused_when_they_are_set():
    loop = chain_loop(B.sliding_mode_sampled(chain_plant(), C, disturbance=2.0))
    for values, message in (
        ({"P": 2.0}, "P does not exceed b D"),
        ({"C[2]": -10.0}, "the error does not decay"),
        ({"C[3]": 0.0}, "leaves v out of the surface"),
        ({"sampling_period": 0.06}, "sampling_period is too long"),
        ({"sampling_period": 0.0}, "sampling_period = 0 s is not"),
    ):
        with pytest.raises(ParameterError, match=message):
            br.simulate(loop, 0.1, parameters=values)


def test_a_disturbance_within_its_stated_bound_keeps_s():
    """The stated bound is the one that holds: P above b D keeps S within h b D, P below D loses it."""
    bound = 2.3
    law = B.sliding_mode_sampled(chain_plant(), C, disturbance=bound, surface_map="exact")
    b = mean_rates(C, H, "exact")[-1]
    time, s, _ = chain_run(law, disturbance=lambda t: bound * np.sign(np.sin(7 * t)))
    assert abs(s[time > 2]).max() < 1.001 * H * b * bound
    time, s, _ = chain_run(B.sliding_mode_sampled(chain_plant(), C, Q=0.1), disturbance=3.0)
    assert abs(s[-1]) > 0.1


def test_a_preview_is_the_reference_one_period_later():
    a, k = symbol("a"), Parameter("a", "m", "height", 2.0)
    wave = sp.Piecewise((a, sp.sin(3 * TIME) > 0), (TIME**2, True))
    reference = Block("wave", parameters=(k,), outputs=Chains((2,), ("m",)).reference([wave]))
    ahead = B.preview(reference, 0.1)
    data = br.simulate(ahead, 5.0, step_size=0.1)
    for name in ("Z1d", "zd2"):
        assert (name != "Z1d") or data["Z1d_next[1]"].values[:-1] == pytest.approx(data["Z1d[1]"].values[1:])
    assert data["Z1d_next[2]"].values[:-1] == pytest.approx(data["Z1d[2]"].values[1:])
    assert ahead.parameters[-1].name == "sampling_period"


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: B.preview(3), "takes a Block"),
        (lambda: B.preview(B.sliding_mode()), "has inputs, so that its values to come are not known"),
        (lambda: B.preview(Block("lag", states=(State("x", derivative=-symbol("x")),))), "has states"),
        (lambda: B.preview(Block("one", outputs=(Output("y"),))), "no outputs Z1d"),
        (
            lambda: B.closed_loop(
                B.sliding_mode_sampled(surface_map="exact", preview=True), reference=B.preview(B.circle(), 0.02)
            ),
            "share 'sampling_period' with different defaults",
        ),
    ],
)
def test_what_cannot_be_known_ahead_is_refused(make, message):
    with pytest.raises(ModelError, match=message):
        make()


def test_inputs_ahead_have_the_units_of_the_reference():
    block = B.sliding_mode_sampled(surface_map="exact", preview=True)
    ahead = {one.name: one.unit for one in block.inputs if "next" in one.name}
    assert ahead == {f"Z{i}d_next[{k}]": unit for i in (1, 2) for k, unit in enumerate(("m", "m/s", "m/s2"), 1)}
    assert all(isinstance(one, Input) for one in block.inputs)
