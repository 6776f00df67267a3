"""What a block accepts, what it refuses and how it says so."""

import math

import pytest
import sympy as sp

import brunovsky as br
from brunovsky.blocks import (
    TIME,
    Block,
    Check,
    Input,
    Mode,
    Output,
    Parameter,
    Relation,
    Sample,
    State,
    Transition,
    symbol,
    symbols,
)
from brunovsky.blocks.units import derivative_unit, unit_exponents
from brunovsky.errors import ModelError, ParameterError

x, u, p, mode = symbols("x", "u", "p", "mode")


def test_symbol_of_a_structured_name() -> None:
    assert str(symbol("eta[1]")) == "eta_1"
    assert str(symbol("plant.Z1[2]")) == "plant.Z1_2"
    assert symbol("x") == sp.Symbol("x", real=True)


@pytest.mark.parametrize(
    ("unit", "expected"),
    [
        ("m/s2", {"m": 1, "s": -2}),
        ("1", {}),
        ("1/s", {"s": -1}),
        ("rad/s", {"rad": 1, "s": -1}),
        ("kg.m2/s2/A", {"kg": 1, "m": 2, "s": -2, "A": -1}),
        ("N.m", {"kg": 1, "m": 2, "s": -2}),
        ("Wb2", {"kg": 2, "m": 4, "s": -4, "A": -2}),
    ],
)
def test_units_are_exponents_of_base_units(unit: str, expected: dict[str, int]) -> None:
    found = dict(zip(("kg", "m", "s", "A", "K", "mol", "cd", "rad"), unit_exponents(unit), strict=True))
    assert {key: value for key, value in found.items() if value} == expected


@pytest.mark.parametrize("unit", ["", "furlong", "m//s", "m/s^2", "m s", "/s", "m2s"])
def test_unreadable_units_are_refused(unit: str) -> None:
    with pytest.raises(ModelError, match="unit"):
        unit_exponents(unit)


@pytest.mark.parametrize(
    ("unit", "order", "expected"),
    [("m", 0, "m"), ("m", 1, "m/s"), ("rad/s", 2, "rad/s3"), ("m.s2", 2, "m"), ("1", 2, "1/s2")],
)
def test_derivative_units(unit: str, order: int, expected: str) -> None:
    assert unit_exponents(derivative_unit(unit, order)) == unit_exponents(expected)


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"outputs": [Output("y", expression=x)]}, r"output 'y' uses x; it may use only variables"),
        ({"states": [State("x", derivative=u)]}, r"derivative of 'x' uses u"),
        ({"inputs": [Input("u")], "states": [State("x", start=u)]}, r"start of 'x' uses u; it may use only parameters"),
        ({"inputs": [Input("u"), Input("u")]}, r"'u' and 'u' share"),
        ({"inputs": [Input("a[1]"), Input("a_1")]}, r"'a_1' and 'a\[1\]' share a name or symbol"),
        ({"inputs": [Input("time")]}, r"'time' is not a legal variable name"),
        ({"inputs": [Input("a b")]}, r"'a b' is not a legal variable name"),
        ({"inputs": [Input("a[0]")]}, r"'a\[0\]' is not a legal"),
        ({"inputs": [Input("u", "parsec")]}, r"'parsec' is unknown"),
        ({"outputs": [Output("y", expression=sp.floor(TIME))]}, r"expression of 'y': floor\(t\) cannot be used"),
        ({"outputs": [Output("y", expression=sp.Heaviside(TIME))]}, r"Heaviside"),
        ({"outputs": [Output("y", expression=sp.Piecewise((1, TIME > 0)))]}, r"undefined where no condition holds"),
        ({"outputs": [Output("y", expression=sp.Eq(TIME, 1))]}, r"compares real values for equality"),
        ({"outputs": [Output("y", expression=sp.nan)]}, r"nan"),
        ({"transitions": [Transition("go", sp.true, {u: sp.Integer(1)})]}, r"'go' assigns u, not a state"),
        ({"checks": [Check("late", x > 0, "")], "states": [State("x")]}, r"check 'late' uses x"),
        (
            {"samples": [Sample("s", period=x)], "states": [State("x")]},
            r"period of 's' uses x; it may use only parameters",
        ),
    ],
)
def test_malformed_blocks_are_refused(parts: dict[str, list[object]], message: str) -> None:
    with pytest.raises(ModelError, match=message):
        Block("bad", **parts)  # type: ignore[arg-type]


def test_block_names_are_identifiers() -> None:
    for name in ("", "two words", "a.b", "a[1]", "time", "1st"):
        with pytest.raises(ModelError):
            Block(name)


def test_switching_functions_become_relations() -> None:
    block = Block(
        "switch",
        inputs=[Input("u")],
        outputs=[
            Output("y", expression=sp.sign(u) + sp.Abs(u)),
            Output("b", expression=sp.And(u > 1, u >= -1)),
        ],
    )
    assert {one.expression for one in block.relations} == {u, -u, u - 1, -u - 1}
    for output in block.outputs:
        assert not output.expression.atoms(sp.sign, sp.Abs, sp.core.relational.Relational)
    assert set(block.indicators) == {u, u - 1, -u - 1}
    assert block.outputs[1].is_boolean and not block.outputs[0].is_boolean


def test_derivative_of_the_frozen_branch() -> None:
    block = Block("abs", inputs=[Input("u")], outputs=[Output("y", expression=sp.Abs(u) * u)])
    slope = sp.diff(block.outputs[0].expression, u)
    relation = block.relations[0].symbol
    assert slope.subs(relation, True) == 2 * u and slope.subs(relation, False) == -2 * u
    assert not slope.atoms(sp.DiracDelta)


def test_declared_relations_keep_name_and_indicator() -> None:
    block = Block(
        "named",
        inputs=[Input("u")],
        parameters=[Parameter("p", value=1.0)],
        outputs=[Output("y", expression=sp.Piecewise((1, u > p), (0, True)))],
        relations=[Relation("high", u - p, indicator=p - u)],
    )
    assert [one.name for one in block.relations] == ["high"]
    assert block.indicators == (p - u,)


def test_feedthrough_sees_through_relations() -> None:
    block = Block(
        "through",
        inputs=[Input("u"), Input("w")],
        states=[State("x", derivative=symbol("w"))],
        outputs=[Output("switched", expression=sp.sign(u)), Output("state", expression=x)],
    )
    assert block.feedthrough == {"switched": frozenset({"u"}), "state": frozenset()}


def test_modes_may_be_compared_for_equality() -> None:
    block = Block(
        "moded",
        modes=[Mode("mode", start=2)],
        outputs=[Output("y", expression=sp.Piecewise((1, sp.Eq(mode, 2)), (0, True)))],
    )
    assert block.relations == ()
    assert br.simulate(block, 0.1, step_size=0.1)["y"].values[0] == 1


@pytest.mark.parametrize("value", [math.nan, math.inf, -1.0, 2.5])
def test_parameters_out_of_range_are_refused(value: float) -> None:
    block = Block("ranged", parameters=[Parameter("p", "m", "", 1.0, 0.0, 2.0)])
    with pytest.raises(ParameterError, match=r"ranged: p = .* m is not a finite number from 0 to 2"):
        block.parameter_values({"p": value})


def test_unknown_parameter_is_named_with_the_nearest_or_all() -> None:
    with pytest.raises(ParameterError, match=r"circle has no parameter 'radios'; did you mean 'radius'\?"):
        br.simulate(br.blocks.circle(), 1.0, parameters={"radios": 1.0})
    with pytest.raises(ParameterError, match=r"circle has no parameter 'zzz'; there is center\[1\], center\[2\], rad"):
        br.simulate(br.blocks.circle(), 1.0, parameters={"zzz": 1.0})


def test_checks_of_parameters() -> None:
    law = br.blocks.sliding_mode()
    values = law.parameter_values({"phi": 0.0, "C[3]": 0.0})
    assert [one.name for one in law.failed_checks(values, "start")] == ["surface gain"]
    assert [one.name for one in law.failed_checks(values, "model exchange")] == ["sign function"]
    for engine in ("native", "numpy"):
        with pytest.raises(ParameterError, match=r"C\[3\] = 0 leaves v out"):
            br.simulate(br.blocks.closed_loop(), 0.1, parameters={"C[3]": 0.0}, engine=engine)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"t_end": 0.0}, "t_end = 0.0 s"),
        ({"t_end": math.inf}, "t_end = inf"),
        ({"step_size": -1.0}, "step_size = -1.0 s"),
        (
            {"inputs": {"v[9]": 1.0}},
            r"no input 'v\[9\]'; did you mean 'v\[2\]'|no input 'v\[9\]'; did you mean 'v\[1\]'",
        ),
        ({"t_end": "1"}, "t_end = '1' and step_size = 0.001 must be numbers"),
        ({"parameters": {"eta_min": "a"}}, "eta_min = 'a' is not a number"),
        ({"inputs": {"v[1]": math.nan}}, r"input 'v\[1\]' is not finite"),
        ({"inputs": {"v[1]": [1.0, 2.0]}}, r"shape \(2,\); give one value or 11"),
        ({"record": ["speed"]}, r"no variable to record 'speed'"),
    ],
)
def test_simulate_refuses_bad_input(options: dict[str, object], message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        br.simulate(br.blocks.linearized_robot(), **({"t_end": 0.01} | options))  # type: ignore[arg-type]


def test_simulation_is_labelled() -> None:
    result = br.simulate(br.blocks.linearized_robot(), 0.01, inputs={"v[1]": 0.1}, record=["x", "singular", "u[2]"])
    assert list(result) == ["x", "singular", "u[2]"]
    assert result.sizes["time"] == 11 and result["time"].attrs["units"] == "s"
    assert result["u[2]"].attrs["units"] == "rad/s2" and result["singular"].dtype == bool


def test_defaults_out_of_range_are_refused() -> None:
    with pytest.raises(ParameterError, match=r"bad: p = 3 1 is not a finite number from 0 to 2"):
        Block("bad", parameters=[Parameter("p", "1", "", 3.0, 0.0, 2.0)])


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"inputs": Input("u")}, r"inputs must be a sequence; write inputs=\[Input\(…\)\]"),
        ({"inputs": ["u"]}, r"inputs must be made of Input\(…\), not 'u'"),
        ({"outputs": [Output("y", TIME)]}, r"'y' has the unit t, which is not a text like 'm/s2'"),
        ({"outputs": [Output("y", expression=sp.Function("f")(TIME))]}, r"f\(t\) cannot be used in a block"),
        (
            {"inputs": [Input("u")], "outputs": [Output("y", expression=sp.Symbol("u"))]},
            r"uses a symbol u that is not the variable's, which is real; take it from brunovsky\.blocks\.symbol",
        ),
        (
            {"samples": [Sample("s", period=p)], "parameters": [Parameter("p", "s", "", 1.0, tunable=True)]},
            r"the period of 's' is tunable; a period must be fixed",
        ),
        (
            {"modes": [Mode("mode")], "transitions": [Transition("go", sp.true, {mode: sp.Rational(3, 2)})]},
            r"assigns mode = 3/2; a mode is an integer",
        ),
        (
            {
                "relations": [
                    Relation("a", sp.Piecewise((1, sp.Symbol("b")), (0, True))),
                    Relation("b", sp.Piecewise((1, sp.Symbol("a")), (0, True))),
                ]
            },
            r"relations depend on each other: .*a.*b|relations depend on each other: .*b.*a",
        ),
    ],
)
def test_a_newcomers_mistakes_are_named(parts: dict[str, object], message: str) -> None:
    with pytest.raises(ModelError, match=message):
        Block("bad", **parts)  # type: ignore[arg-type]


def test_relations_are_evaluated_after_those_they_depend_on() -> None:
    late = sp.Symbol("late")
    block = Block(
        "order",
        outputs=[Output("y", expression=sp.Piecewise((1, sp.Symbol("early")), (0, True)))],
        relations=[Relation("early", sp.Piecewise((1, late), (-1, True))), Relation("late", TIME - 0.5)],
    )
    assert [one.name for one in block.relations] == ["late", "early"]
    result = br.simulate(block, 1.0, step_size=0.25)
    assert list(result["y"].values) == [0, 0, 0, 1, 1]


def test_blocks_show_themselves_shortly() -> None:
    assert repr(br.blocks.circle()) == "<Block circle: 5 parameters, 8 outputs>"
    assert repr(br.blocks.closed_loop()).startswith("<Diagram closed_loop: 2 inputs, 20 parameters, 6 states, 24")
    table = br.blocks.circle().table().splitlines()
    assert table[0].startswith("| name ") and len(table) == 2 + 13 and len({len(line) for line in table}) == 1
    assert repr(br.blocks.robot_linearization()) == "<Linearization: relative degree (3, 3), det G = -eta_1, full>"


def test_forgotten_parentheses_are_named() -> None:
    with pytest.raises(ModelError, match=r"simulate takes a Block, not <function closed_loop.*parentheses"):
        br.simulate(br.blocks.closed_loop, 1.0)  # type: ignore[arg-type]
