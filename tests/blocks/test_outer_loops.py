"""Outer loops and references for chains of any length and number."""

import pytest
import sympy as sp

import brunovsky as br
from brunovsky.blocks import Chains, Parameter, symbol
from brunovsky.blocks.units import derivative_unit, unit_exponents
from brunovsky.errors import ModelError
from brunovsky.linearization import gallery

ANALYSIS = br.analysis
MIXED = Chains((4, 2, 1), ("m", "rad", "V"))


def quadrotor() -> br.Block:
    linearization = br.linearize(gallery.quadrotor())
    starts = {"T": 9.81}
    return br.linearized_block(linearization, parameters=dict.fromkeys(("m", "J_x", "J_y", "J_z"), 1.0), starts=starts)


def test_inputs_have_the_names_and_units_of_the_chains() -> None:
    names = {one.name: one.unit for one in MIXED.inputs}
    assert list(names)[:7] == ["Z1[1]", "Z1[2]", "Z1[3]", "Z1[4]", "Z2[1]", "Z2[2]", "Z3[1]"]
    assert (names["Z1[4]"], names["Z1d[2]"], names["Z2d[2]"], names["Z3d[1]"]) == ("m/s3", "m/s", "rad/s", "V")
    assert [one for one in names if one.startswith("zd")] == ["zd4[1]", "zd2[2]", "zd1[3]"]
    assert (names["zd4[1]"], names["zd2[2]"]) == ("m/s4", "rad/s2")
    assert unit_exponents(names["zd1[3]"]) == unit_exponents("V/s")


@pytest.mark.parametrize("loop", ["pole_placement", "sliding_mode"])
def test_error_of_unlike_chains_obeys_its_polynomial(loop: str) -> None:
    """With y^(r) = v the closed loop of chain i is the polynomial of its own gains."""
    vectors = [[24.0, 50.0, 35.0, 10.0], [6.0, 5.0], [3.0]]
    if loop == "pole_placement":
        block = br.blocks.pole_placement(MIXED, vectors)
    else:
        block = br.blocks.sliding_mode(MIXED, vectors, Q=[1.0, 2.0, 3.0], P=0.0)
        vectors = [ANALYSIS.sliding_gain(c, q).tolist() for c, q in zip(vectors, (1.0, 2.0, 3.0), strict=True)]
    values = {one.symbol: one.value for one in block.parameters}
    for i, (gains, order) in enumerate(zip(vectors, MIXED.orders, strict=True), 1):
        v = next(one.expression for one in block.outputs if one.name == f"v[{i}]").subs(values)
        feed = sum(g * (symbol(f"Z{i}d[{k}]") - symbol(f"Z{i}[{k}]")) for k, g in enumerate(gains, 1))
        difference = sp.expand(v - feed - symbol(f"zd{order}[{i}]"))
        assert max((abs(one) for one in difference.as_coefficients_dict().values()), default=0) < 1e-12


def test_chains_that_are_alike_share_their_parameters() -> None:
    names = [one.name for one in br.blocks.sliding_mode().parameters]
    assert names == ["C[1]", "C[2]", "C[3]", "Q", "P", "phi"]
    own = br.blocks.sliding_mode(surface=[[500, 10, 1], [100, 20, 1]], P=[1.0, 2.0])
    assert [one.name for one in own.parameters] == [
        *(f"C{i}[{k}]" for i in (1, 2) for k in (1, 2, 3)), "Q", "P[1]", "P[2]", "phi",
    ]  # fmt: skip


def test_quadrotor_goes_to_its_set_point() -> None:
    """From hover, four unlike chains, with both laws; the inputs of the plant need no hand-written equation."""
    plant = quadrotor()
    gains = [ANALYSIS.place([-3] * 4)] * 3 + [ANALYSIS.place([-3] * 2)]
    surfaces = [ANALYSIS.surface_from_poles([-3] * 3)] * 3 + [ANALYSIS.surface_from_poles([-3])]
    target = {"target[1]": 1.0, "target[2]": -0.5, "target[3]": 2.0, "target[4]": 0.3}
    for law in (br.blocks.pole_placement(plant, gains), br.blocks.sliding_mode(plant, surfaces, phi=0.2)):
        data = br.simulate(br.blocks.closed_loop(law, plant=plant), 8.0, step_size=2e-3, parameters=target)
        for name, wanted in zip(("x", "y", "z", "psi"), target.values(), strict=True):
            assert float(data[name][-1]) == pytest.approx(wanted, abs=1e-3)
        assert float(data["T"][-1]) == pytest.approx(9.81, abs=1e-3)


def test_set_point_is_constant() -> None:
    block = br.blocks.set_point(MIXED, [1.0, 2.0, 3.0])
    values = {one.name: one.expression for one in block.outputs}
    assert values["Z2d[1]"] == symbol("target[2]")
    assert all(value == 0 for name, value in values.items() if not name.endswith("d[1]"))
    assert [one.value for one in block.parameters] == [1.0, 2.0, 3.0]


def test_a_name_of_the_plant_wins_over_the_controller_s() -> None:
    a, b, u, q = sp.symbols("a b u Q", real=True)
    linearization = br.linearize(br.AffineSystem((a, b), (u,), [b, -q * a], [0, 1], (a,), (q,)))
    plant = br.linearized_block(linearization, parameters={"Q": 4.0})
    loop = br.blocks.closed_loop(br.blocks.sliding_mode(plant, [2.0, 1.0], Q=7.0), plant=plant)
    assert {one.name: one.value for one in loop.parameters if "Q" in one.name} == {"Q": 4.0, "controller.Q": 7.0}
    data = br.simulate(loop, 6.0, parameters={"target[1]": 1.0})
    assert float(data["a"][-1]) == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Chains((3, 0), ("m", "m")), "positive whole number"),
        (lambda: Chains((3,), ("m", "m")), "2 unit\\(s\\) for 1 chain"),
        (lambda: Chains.of(br.blocks.robot()), "no outputs Z1"),
        (lambda: Chains.of(3), "no chains"),  # type: ignore[arg-type]
        (lambda: br.blocks.pole_placement(MIXED), "gains are missing"),
        (lambda: br.blocks.sliding_mode(MIXED), "surface is missing"),
        (lambda: br.blocks.pole_placement(MIXED, [1, 2, 3, 4]), "not alike"),
        (lambda: br.blocks.pole_placement(gains=[1, 2]), "lengths 2, 2 for chains of the lengths 3, 3"),
        (lambda: br.blocks.sliding_mode(P=[1, 2, 3]), "P: 3 value"),
    ],
)
def test_what_does_not_fit_is_refused(make: object, message: str) -> None:
    with pytest.raises(ModelError, match=message):
        make()  # type: ignore[operator]


def test_parameters_and_starts_are_checked_by_name() -> None:
    linearization = br.linearize(gallery.car())
    with pytest.raises(ModelError, match="parameters without a value: L"):
        br.linearized_block(linearization)
    with pytest.raises(ModelError, match="no parameter 'l'; did you mean 'L'"):
        br.linearized_block(linearization, parameters={"l": 1.0, "L": 1.0})
    with pytest.raises(ModelError, match="starts: there is no state 'speed'"):
        br.linearized_block(linearization, parameters={"L": 1.0}, starts={"speed": 1.0})
    block = br.linearized_block(linearization, parameters=[Parameter("L", "m", "wheel base", 2.0)], starts={"v": 1.0})
    assert {one.name: one.value for one in block.parameters if one.name in ("L", "v_start")} == {"v_start": 1, "L": 2}


@pytest.mark.parametrize(
    ("unit", "order", "expected"),
    [
        ("m", 3, "m/s3"), ("V", 1, "V/s"), ("V", 0, "V"), ("rad/s", 1, "rad/s2"), ("m.s2", 2, "m"), ("s", 1, "1"),
        ("1/s", 2, "1/s3"), ("s2", 1, "s"), ("kg.m2/s3/A", 1, "kg.m2/A/s4"), ("N.s", 2, "N/s"), ("/s", 1, None),
    ],
)  # fmt: skip
def test_derivative_units(unit: str, order: int, expected: str | None) -> None:
    if expected is None:
        with pytest.raises(ModelError):
            derivative_unit(unit, order)
        return
    assert derivative_unit(unit, order) == expected
    before, after = unit_exponents(unit), unit_exponents(expected)
    assert [a - b for a, b in zip(after, before, strict=True)] == [0, 0, -order, 0, 0, 0, 0, 0]
