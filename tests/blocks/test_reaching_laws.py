"""Sliding mode: reaching laws and switching functions against their closed forms, and what is refused."""

import math
from functools import cache

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from outer_loop_cases import SURFACE, B, chain_loop, chain_plant

import brunovsky as br
from brunovsky import analysis
from brunovsky.blocks import Chains, symbol, symbols
from brunovsky.blocks.library.outer_loops.surface import hurwitz
from brunovsky.errors import ModelError, ParameterError

S0 = -25.0  # of the chain's loop, which starts one metre off
REACHING = ("exponential", "constant rate", "power rate")


def rate_of(law: br.Block, values: dict[str, float], s: float) -> float:
    """S' that a law of chains (3,) gives at a point with this S, from its outputs alone."""
    numbers = {one.symbol: one.value for one in law.parameters}
    numbers |= {one.symbol: values.get(one.name, 0.0) for one in law.inputs}
    c = [law.parameter_values()[f"C[{k}]"] for k in (1, 2, 3)]
    numbers[symbol("Z1[3]")] = (s - c[0] * values["Z1[1]"] - c[1] * values["Z1[2]"]) / c[2]
    for relation in law.relations:
        numbers[relation.symbol] = bool(relation.expression.subs(numbers) > 0)
    v = float(law.outputs[0].expression.subs(numbers))
    return c[0] * values["Z1[2]"] + c[1] * float(numbers[symbol("Z1[3]")]) + c[2] * v


@pytest.mark.parametrize("switching", ["saturation", "sign", "tanh"])
@pytest.mark.parametrize("reaching", REACHING)
@pytest.mark.parametrize("s", [-3.0, -0.02, 0.0, 0.04, 0.7])
def test_each_law_gives_the_rate_that_it_states(reaching: str, switching: str, s: float) -> None:
    Q, P, phi, a = 2.0, 3.0, 0.05, 0.4
    options = {} if reaching == "constant rate" else {"Q": Q}
    options |= {} if switching == "sign" else {"phi": phi}
    options |= {"exponent": a} if reaching == "power rate" else {}
    law = B.sliding_mode(
        Chains((3,), ("m",)), [50.0, 20.0, 2.0], P=P, reaching=reaching, switching=switching, **options,
    )  # fmt: skip
    f = {"saturation": np.clip(s / phi, -1, 1), "sign": np.sign(s), "tanh": math.tanh(s / phi)}[switching]
    width = 0.0 if switching == "sign" else phi
    power = (s**2 + width**2) ** (a / 2) if reaching == "power rate" else 1.0
    expected = -P * power * f - (0.0 if reaching == "constant rate" else Q * s)
    assert rate_of(law, {"Z1[1]": 0.3, "Z1[2]": -0.1}, s) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("reaching", ["exponential", "power rate"])
@pytest.mark.parametrize("switching", ["saturation", "tanh"])
def test_without_switching_gain_it_is_pole_placement(reaching: str, switching: str) -> None:
    sliding = B.sliding_mode(chain_plant(), SURFACE, Q=3.0, P=0.0, reaching=reaching, switching=switching)
    linear = B.pole_placement(chain_plant(), analysis.sliding_gain(SURFACE, 3.0))
    one, other = (br.simulate(chain_loop(law), 3.0, parameters={"amplitude": 0.3}) for law in (sliding, linear))
    assert abs(one["z0"] - other["z0"]).max() < 1e-13


@pytest.mark.parametrize(
    ("reaching", "Q", "P", "a"),
    [("exponential", 5.0, 2.5, 0.0), ("constant rate", 0.0, 40.0, 0.0), ("power rate", 0.0, 20.0, 0.5),
     ("power rate", 4.0, 10.0, 0.3)],
)  # fmt: skip
def test_reaching_times_are_those_of_the_closed_form(reaching: str, Q: float, P: float, a: float) -> None:
    """With the sign function, frozen over steps of 1 ms: reached within a step or two of the prediction."""
    options = {} if reaching == "constant rate" else {"Q": Q}
    options |= {"exponent": a} if reaching == "power rate" else {}
    law = B.sliding_mode(chain_plant(), SURFACE, P=P, reaching=reaching, switching="sign", **options)
    data = br.simulate(chain_loop(law), 3.0, record=["S[1]"])
    s = data["S[1]"].values
    assert s[0] == pytest.approx(S0)
    reached = float(data["time"][np.argmax(s >= -1e-6 * abs(S0))])
    assert reached == pytest.approx(analysis.reaching_time(S0, Q, P, a), abs=2e-3)
    assert np.isfinite(s).all() and abs(s[-100:]).max() <= 2 * P * 1e-3


def test_regularised_power_rate_reaches_the_layer_no_later() -> None:
    """From S0 to phi the rate is right within (1 + (phi/S)^2)^(a/2): the time within that factor of the closed form."""
    P, a, phi = 20.0, 0.5, 0.05
    law = B.sliding_mode(chain_plant(), SURFACE, P=P, phi=phi, reaching="power rate", exponent=a)
    data = br.simulate(chain_loop(law), 2.0, record=["S[1]"])
    exact = analysis.reaching_time(S0, 0.0, P, a) - analysis.reaching_time(phi, 0.0, P, a)
    reached = float(data["time"][np.argmax(data["S[1]"].values >= -phi)])
    assert exact / 2 ** (a / 2) <= reached <= exact + 1e-3


def test_power_rate_leaves_what_its_rate_balances() -> None:
    """A matched disturbance D moves S to (D/P)^(1/a); the exponential law with P > D keeps S within its layer."""
    P, a, D = 20.0, 0.5, 8.0
    law = B.sliding_mode(chain_plant(), SURFACE, P=P, phi=1e-3, reaching="power rate", exponent=a)
    data = br.simulate(chain_loop(law), 3.0, inputs={"d": D}, step_size=1e-4)
    assert float(data["S[1]"][-1]) == pytest.approx((D / P) ** (1 / a), rel=1e-3)
    kept = br.simulate(chain_loop(B.sliding_mode(chain_plant(), SURFACE, P=P, phi=0.05)), 3.0, inputs={"d": D})
    assert float(kept["S[1]"][-1]) == pytest.approx(D / (5.0 + P / 0.05), rel=1e-6)


@cache
def condition(count: int) -> tuple[tuple[sp.Symbol, ...], sp.Basic]:
    names = sp.symbols(f"c1:{count + 1}", real=True)
    return names, hurwitz(names)


REAL_PART = st.floats(0.1, 5.0).flatmap(lambda x: st.sampled_from([-x, -x, -x, x]))


@settings(max_examples=60)
@given(
    st.lists(REAL_PART, max_size=2),
    st.lists(st.tuples(REAL_PART, st.floats(0.0, 5.0)), max_size=2),
    st.sampled_from([-2.0, 0.5, 1.0]),
)
def test_the_condition_of_hurwitz_agrees_with_the_roots(
    single: list[float], pairs: list[tuple[float, float]], leading: float
) -> None:
    roots = [*single, *(complex(x, y) for x, y in pairs), *(complex(x, -y) for x, y in pairs)]
    coefficients = leading * np.atleast_1d(np.real(np.poly(roots)))[::-1]
    names, stable = condition(len(coefficients))
    found = stable.subs(dict(zip(names, map(sp.Float, coefficients), strict=True)))
    assert bool(found) == all(np.real(one) < 0 for one in roots)


@pytest.mark.parametrize(
    ("surface", "poles"),
    [([-500, 10, 1], "-27.91, 17.91"), ([500, -10, 1], r"5-21\.79j, 5\+21\.79j"), ([0, 10, 1], "-10, 0")],
)
@pytest.mark.parametrize("law", [B.sliding_mode, B.sliding_mode_relay])
def test_an_unstable_surface_is_refused_with_its_poles(law: object, surface: list[float], poles: str) -> None:
    with pytest.raises(ParameterError, match=rf"has the poles {poles}, not all.*surface_from_poles"):
        law(surface=surface)  # type: ignore[operator]


@pytest.mark.parametrize("engine", ["native", "numpy"])
def test_a_surface_that_becomes_unstable_is_refused(engine: str) -> None:
    loop = chain_loop(B.sliding_mode(chain_plant(), SURFACE))
    for values in ({"C[1]": -1.0}, {"C[2]": 0.0}, {"C[3]": -1.0}):
        with pytest.raises(ParameterError, match=r"on the surface C\[1\], C\[2\], C\[3\] the error does not decay"):
            br.simulate(loop, 0.1, parameters=values, engine=engine)  # type: ignore[arg-type]
    opposite = dict(zip(("C[1]", "C[2]", "C[3]"), -SURFACE, strict=True))
    assert abs(br.simulate(loop, 8.0, parameters=opposite)["e1[1]"][-1]) < 1e-6


def test_chains_of_one_integrator_have_no_poles_to_refuse() -> None:
    law = B.sliding_mode(Chains((1,), ("V",)), [2.0])
    assert not law.failed_checks(law.parameter_values(), "start")


def test_a_stated_bound_is_checked_against_the_gain() -> None:
    B.sliding_mode(surface=[1000, 20, 2], P=2.5, disturbance=1.2)
    with pytest.raises(ParameterError, match=r"P does not exceed abs\(C\[3\]\) D.*raise P above"):
        B.sliding_mode(surface=[1000, 20, 2], P=2.5, disturbance=1.25)
    loop = chain_loop(B.sliding_mode(chain_plant(), SURFACE, disturbance=2.0))
    with pytest.raises(ParameterError, match=r"P does not exceed"):
        br.simulate(loop, 0.1, parameters={"P": 1.9})
    with pytest.raises(ParameterError, match=r"P does not exceed D"):
        B.integral_sliding_mode(P=1.0, disturbance=1.0)
    with pytest.raises(ParameterError, match=r"P\[2\] does not exceed abs\(C\[3\]\) D"):
        B.sliding_mode_relay(P=[3.0, 1.0], disturbance=1.0)


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"switching": "relay"}, ModelError, "no switching = 'relay'; choose one of 'saturation', 'sign', 'tanh'"),
        ({"reaching": "fast"}, ModelError, "choose one of 'exponential', 'constant rate', 'power rate'"),
        ({"reaching": "constant rate", "Q": 1.0}, ModelError, "has no Q"),
        ({"reaching": "power rate", "disturbance": 1.0}, ModelError, "no P makes the power rate reject"),
        ({"reaching": "power rate", "exponent": 1.0}, ParameterError, "between 0 and 1, both excluded"),
        ({"reaching": "power rate", "exponent": 0.0}, ParameterError, "between 0 and 1, both excluded"),
        ({"switching": "sign", "phi": 0.1}, ModelError, "has no phi"),
        ({"exponent": 0.5}, ModelError, "has no exponent"),
        ({"switching": "tanh", "phi": 0.0}, ParameterError, "phi = 0 leaves tanh"),
        ({"surface": [500, 10, 0]}, ParameterError, r"C\[3\] = 0 leaves v out of the surface"),
        ({"surface": [500, math.nan, 1]}, ModelError, "C: .*nan.* is no flat list of finite real numbers"),
        ({"P": -1.0}, ParameterError, "P = -1"),
    ],
)
def test_what_cannot_work_is_refused(options: dict[str, object], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        B.sliding_mode(**options)  # type: ignore[arg-type]


def test_the_sign_function_is_for_co_simulation_alone() -> None:
    law = B.sliding_mode(switching="sign")
    assert [one.name for one in law.parameters] == ["C[1]", "C[2]", "C[3]", "Q", "P"]
    (check,) = law.failed_checks(law.parameter_values(), "model exchange")
    assert "sliding_mode_relay" in check.message
    assert not law.failed_checks(law.parameter_values({"P": 0.0}), "model exchange", "start")
    smooth = B.sliding_mode(switching="tanh")
    assert not smooth.relations and not smooth.failed_checks(smooth.parameter_values(), "model exchange")
    assert symbols("phi")[0] in smooth.outputs[0].expression.free_symbols
