"""Time derivatives of outputs as straight-line code: equal to plain Lie derivatives, and bounded in length."""

import random

import pytest
import sympy as sp

from brunovsky.blocks import TIME, Block, Input, Output, Parameter, State, library, symbols
from brunovsky.fmi import shipped_block, shipped_fmus
from brunovsky.native import output_derivatives as module
from brunovsky.native.library import ENGINE_SOURCES
from brunovsky.native.output_derivatives import input_derivative, output_derivatives


def _lie(block: Block, expression: sp.Expr, order: int) -> sp.Expr:
    """Derivative written out, by partial derivatives."""
    slopes = {one.symbol: one.derivative for one in block.states} | {TIME: sp.S.One}
    for index, one in enumerate(block.inputs):
        slopes[one.symbol] = input_derivative(index, 1)
        slopes |= {input_derivative(index, k): input_derivative(index, k + 1) for k in (1, 2)}
    for _ in range(order):
        expression = sum((expression.diff(one) * slope for one, slope in slopes.items()), sp.S.Zero)
    return expression


def _numbers(block: Block) -> dict[sp.Symbol, sp.Expr]:
    draw = random.Random(1)
    smooth = [one.symbol for group in (block.states, block.inputs, block.parameters, block.samples) for one in group]
    smooth += [TIME, *(input_derivative(index, k) for index in range(len(block.inputs)) for k in (1, 2, 3))]
    numbers: dict[sp.Symbol, sp.Expr] = {one: sp.Float(draw.uniform(0.5, 1.5)) for one in smooth}
    return numbers | {one.symbol: draw.choice([sp.true, sp.false]) for one in block.relations}


@pytest.fixture
def odd() -> Block:
    """Powers, quotients, a function of two arguments, branches, an input that only derivatives reach."""
    x, y, u, w, gain = symbols("x", "y", "u", "w", "gain")
    return Block(
        "odd",
        inputs=(Input("u", start=0.0), Input("w", start=0.0)),
        parameters=(Parameter("gain", value=2.0),),
        states=(State("x", derivative=y), State("y", derivative=u * sp.exp(-gain * x) + sp.sin(TIME) * x**2)),
        outputs=(
            Output("power", expression=x**gain + gain**y + (1 + x**2) ** y),
            Output("angle", expression=sp.atan2(y, x + u)),
            Output("branch", expression=sp.Piecewise((x**3, y > 0), (x * w**2, True)) / (1 + w)),
            Output("flag", expression=y > 0),
            Output("constant", expression=gain),
        ),
    )


@pytest.mark.parametrize("name", ["odd", "linearized_robot", "circle", "integral_sliding_mode"])
def test_every_order_is_the_lie_derivative(name: str, request: pytest.FixtureRequest) -> None:
    block = request.getfixturevalue("odd") if name == "odd" else getattr(library, name)()
    code, numbers = output_derivatives(block), _numbers(block)
    assert code.order == 3
    values = dict(numbers)
    for target, expression in code.statements:
        assert expression.free_symbols <= values.keys(), "each statement after those it needs"
        values[target] = expression.xreplace(values)
    for order, row in enumerate(code.values, 1):
        for one, value in zip(block.outputs, row, strict=True):
            plain = sp.S.Zero if one.is_boolean else _lie(block, one.expression, order).xreplace(numbers)
            assert float(value.xreplace(values)) == pytest.approx(float(plain), rel=1e-11, abs=1e-11), (one.name, order)


def test_whole_powers_have_derivatives_where_their_base_is_zero() -> None:
    x = symbols("x")[0]
    block = Block(
        "cube", states=(State("x", derivative=sp.S.One),), outputs=(Output("cube", expression=x**3 + sp.sin(x) ** 2),)
    )
    code = output_derivatives(block)
    values: dict[sp.Symbol, sp.Expr] = {x: sp.S.Zero}
    for target, expression in code.statements:
        values[target] = expression.xreplace(values)
    assert [row[0].xreplace(values) for row in code.values] == [0, 2, 6]


def test_a_block_of_long_derivatives_has_fewer_orders(monkeypatch: pytest.MonkeyPatch) -> None:
    block = library.linearized_robot()
    whole = output_derivatives(block)
    for most, order in ((whole.operations, 3), (whole.operations - 1, 2), (0, 1)):
        monkeypatch.setattr(module, "MOST_OPERATIONS", most)
        code = output_derivatives.__wrapped__(block)
        assert code.order == order
        assert code.operations <= max(most, whole.operations // 2)


def test_what_ships_has_three_orders() -> None:
    assert {name: output_derivatives(shipped_block(name)).order for name in shipped_fmus()} == dict.fromkeys(
        shipped_fmus(), 3
    )


def test_the_simulation_is_not_compiled_with_them() -> None:
    assert not any("derivatives" in name for name in ENGINE_SOURCES)
