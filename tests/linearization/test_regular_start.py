"""Regular starts: the derived inputs are the limit of the law along exact trajectories, of several plants."""

from functools import cache
from typing import Any

import pytest
import sympy as sp
from gallery_plants import linearized

from brunovsky.errors import LinearizationError
from brunovsky.linearization import AffineSystem, Linearization, RegularStart, linearize

T = sp.Symbol("t", real=True)
MOVING_OFF = 2 * T + T**2 / 2 - T**3 / 7
TRUE_REST = T**2 - T**3 / 3 + T**4 / 5
CURVATURE = sp.Rational(1, 2) + T / 3 - T**2 / 5
TURNED = sp.Rational(3, 10) + sp.integrate(sp.expand(MOVING_OFF * CURVATURE), T)  # of what rolls on that curvature


def along(angle: sp.Expr, length: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    return length * sp.cos(angle), length * sp.sin(angle)


def robot(speed: sp.Expr) -> tuple[Any, ...]:
    heading = sp.Rational(3, 10) + T / 4 + T**2 / 3
    states = {"theta": heading, "eta1": speed, "eta2": sp.diff(heading, T), "u1": sp.diff(speed, T)}
    return states, 1, along(heading + sp.pi / 2, speed)


def car() -> tuple[Any, ...]:
    states = {"theta": TURNED, "phi": sp.atan(2 * CURVATURE), "v": MOVING_OFF, "w": sp.diff(MOVING_OFF, T)}
    return states, 1, along(TURNED, MOVING_OFF)


def trailer() -> tuple[Any, ...]:
    """The trailer's axle moves with v cos(theta - phi)."""
    heading = TURNED + sp.atan(2 * CURVATURE)
    speed = MOVING_OFF / sp.cos(heading - TURNED)
    states = {"theta": heading, "phi": TURNED, "v": speed, "mu1": sp.diff(MOVING_OFF, T)}
    return states, 1, along(TURNED, MOVING_OFF)


def vtol() -> tuple[Any, ...]:
    roll = sp.Rational(3, 10) + T / 4 + T**2 / 3
    states = {"phi": roll, "q": sp.diff(roll, T), "T": MOVING_OFF, "w": sp.diff(MOVING_OFF, T)}
    lift = along(roll + sp.pi / 2, MOVING_OFF / 3)
    return states, 2, (lift[0], lift[1] - sp.Rational(981, 100))


def motor() -> tuple[Any, ...]:
    """The torque vanishes at i_d = psi / (L_q - L_d) = 1."""
    i_d, i_q = 1 + T - T**2 / 3, 2 - T / 2 + T**2
    speed = 5 + sp.integrate(sp.expand((1 - i_d) * i_q), T)
    return {"i_d": i_d, "i_q": i_q, "omega": speed}, 0, (i_d, speed)


MOTOR = {"i_d": 1, "psi": 1, "L_d": 1, "L_q": 2, "J": 3, "n_p": 2, "R": 1}
CASES: dict[str, tuple[str, dict[str, Any], tuple[Any, ...]]] = {
    "robot moving off": ("nominal_robot", {"eta1": 0}, robot(MOVING_OFF)),
    "robot without acceleration": ("nominal_robot", {"eta1": 0, "u1": 0}, robot(TRUE_REST)),
    "car": ("car", {"v": 0, "L": 2}, car()),
    "trailer": ("trailer", {"v": 0, "L": 2}, trailer()),
    "aircraft": ("vtol", {"T": 0, "m": 3, "J": 1}, vtol()),
    "motor": ("pm_motor", MOTOR, motor()),
}
SMALL = [sign * sp.Rational(1, size) for size in (1000, 10000) for sign in (1, -1)]


class Passage:
    """An exact trajectory through a singular point; its outputs are given by their derivative of order `first`."""

    def __init__(
        self, result: Linearization, start: RegularStart, states: dict[str, Any], first: int, outputs: tuple[Any, ...]
    ) -> None:
        self.result, self.start = result, start
        fixed = {one: value for one, value in start.point.items() if one in result.extended_system.parameters}
        self.functions: dict[sp.Symbol, Any] = {
            state: states.get(state.name, sp.S.Zero) for state in result.extended_system.states
        } | fixed
        for index, names in enumerate(result.normal_form.chains):
            later = [orders[index] for orders in start.derivatives]
            symbols = (*names, result.outer_inputs[index], *later)[first:]
            derivative = outputs[index]
            for symbol in symbols:
                self.functions[symbol] = derivative
                derivative = sp.diff(derivative, T)

    def at(self, t: Any) -> dict[sp.Symbol, sp.Expr]:
        return {one: sp.sympify(value).subs(T, t).evalf(50) for one, value in self.functions.items()}

    def law(self, t: Any, error: float = 0) -> dict[sp.Symbol, sp.Expr]:
        numbers = self.at(t)
        numbers |= {v: numbers[v] + error * (index + 1) for index, v in enumerate(self.result.outer_inputs)}
        return {one: law.subs(numbers).evalf(40) for one, law in self.result.law.items()}


@cache
def passage(case: str) -> Passage:
    name, point, trajectory = CASES[case]
    result = linearized(name)
    return Passage(result, result.regular_start(point), *trajectory)


@pytest.mark.parametrize("case", CASES)
def test_the_derived_values_are_met_and_the_law_converges_to_the_inputs(case: str) -> None:
    one = passage(case)
    numbers = one.at(0)
    for condition in one.start.conditions:
        assert abs((condition.lhs - condition.rhs).subs(numbers).evalf()) < 1e-25, condition
    for symbol, value in one.start.states.items():
        assert abs(value.subs(numbers).evalf(30) - numbers[symbol]) < 1e-25, symbol
    assert all(abs(factor.subs(numbers).evalf()) > 1e-2 for factor in one.start.nonzero)
    assert set(one.start.inputs) == set(one.result.extended_system.inputs)
    limits = {symbol: value.subs(numbers).evalf(30) for symbol, value in one.start.inputs.items()}
    coarse, _, fine, _ = laws = [one.law(t) for t in SMALL]
    for symbol, limit in limits.items():
        for law, t in zip(laws, SMALL, strict=True):
            assert abs(law[symbol] - limit) < 20 * abs(t) * (1 + abs(limit)), symbol
        assert abs(fine[symbol] - limit) < 0.11 * abs(coarse[symbol] - limit) + 1e-20, symbol


@pytest.mark.parametrize("case", CASES)
def test_a_reference_that_violates_a_condition_needs_unbounded_inputs(case: str) -> None:
    coarse, _, fine, _ = [max(map(abs, passage(case).law(t, error=0.5).values())) for t in SMALL]
    assert fine > 9 * coarse > 100


def test_the_car_as_on_the_board() -> None:
    start = linearized("car").regular_start({"v": 0})
    theta, phi, w = (
        next(one for one in linearized("car").extended_system.states if one.name == name)
        for name in ("theta", "phi", "w")
    )
    normal = sp.Matrix([-sp.sin(theta), sp.cos(theta)])
    tangent = sp.Symbol("L", positive=True) * normal.dot(sp.Matrix(start.rates)) / (3 * w**2)
    assert sp.simplify(sp.tan(start.states[phi]) - tangent) == 0  # n . d4y/dt4 = 3 w^2 tan(phi) / L
    assert len(start.derivatives) == 2 and start.nonzero == (w,)


@pytest.mark.slow
def test_true_rest_of_the_car_needs_four_derivatives() -> None:
    start = linearized("car").regular_start({"v": 0, "w": 0, "phi": 0, "L": 1, "theta": 0})
    assert [str(one) for one in start.derivatives[-1]] == ["v1_ddddot", "v2_ddddot"]
    assert {str(one.lhs) for one in start.conditions} >= {"v2", "v2_dot", "v2_ddot", "v2_dddot"}


def test_what_stays_open_is_refused_with_the_reason() -> None:
    a, b, u = sp.symbols("a b u", real=True)
    stuck = AffineSystem((a, b), (u,), [0, 0], [b, 0], (a,))  # b = 0 stays, and u moves nothing
    with pytest.raises(
        LinearizationError, match=r"at b = 0 the derivatives .* up to order 2 do not determine u: nothing"
    ):
        linearize(stuck).regular_start({"b": 0})


def test_a_passage_is_explained_three_ways() -> None:
    start = linearized("car").regular_start({"v": 0})
    text = start.explain()
    assert text.startswith("Regular start at v = 0\n")
    assert all(f"  {one} = {value}\n" in text for one, value in start.states.items())
    assert "None of these may vanish: w." in text
    for rendered in (start.latex(), start._repr_markdown_()):
        assert all(f"{sp.latex(one)} = {sp.latex(value)}" in rendered for one, value in start.inputs.items())
        assert all(sp.latex(one) in rendered for one in start.conditions)
    level = linearized("ball_and_beam").regular_start({"omega": 0})
    assert "The inputs are solutions of" in level.explain() and str(level.equations[0].lhs) in level.explain()
