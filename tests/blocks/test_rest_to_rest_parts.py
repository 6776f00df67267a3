"""Path, timing and reference of manoeuvres from rest to rest, each against its definition."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import quad
from scipy.optimize import minimize

import brunovsky as br
from brunovsky.blocks.engine import NumpyEngine
from brunovsky.blocks.library.heading import direction
from brunovsky.blocks.library.rest_to_rest.course import EDGE, NEVER, course
from brunovsky.blocks.library.rest_to_rest.path import PARAMETER, Pose, curvature, hermite, path_speed
from brunovsky.blocks.library.rest_to_rest.reference import Drive, Reference
from brunovsky.blocks.library.rest_to_rest.timing import (
    TURN_SHARE,
    Limits,
    duration,
    path_timing,
    rise,
    rise_time,
    swept,
)
from brunovsky.blocks.variables import TIME

LEG = sp.symbols("along left turn tangent", real=True)
LIMITS = Limits(sp.Float(1.4), sp.Float(1.5), sp.Float(22.0))
PATH = hermite(sp.Matrix(LEG[:2]), sp.Matrix([LEG[3], 0]), LEG[3] * sp.Matrix([sp.cos(LEG[2]), sp.sin(LEG[2])]))


@pytest.fixture(scope="module")
def timing():
    return sp.lambdify(LEG, [getattr(path_timing(*LEG, LIMITS), one) for one in
                             ("length", "speed", "acceleration", "cost")], cse=True)  # fmt: skip


def test_the_path_has_the_poses_and_no_curvature_at_its_ends() -> None:
    start, end, tangent = (
        Pose(*sp.symbols("x0 y0 t0", real=True)),
        Pose(*sp.symbols("x1 y1 t1", real=True)),
        sp.Symbol("m", positive=True),
    )
    path = start.path_to(end, tangent)
    for s, pose in ((0, start), (1, end)):
        assert sp.simplify(path.subs(PARAMETER, s) - pose.position) == sp.zeros(2, 1)
        assert sp.simplify(path.diff(PARAMETER).subs(PARAMETER, s) - tangent * direction(pose.heading)) == sp.zeros(
            2, 1
        )
        assert sp.simplify(curvature(path).subs(PARAMETER, s)) == 0


def test_the_rise_and_the_turn_have_least_jerk() -> None:
    s = sp.Symbol("s")
    for curve, fixed in ((sp.integrate(rise(s), s), (0,)), (swept(s), (0, 1))):
        velocity = sp.diff(curve, s)
        assert velocity.subs(s, 0) == 0
        assert sp.diff(curve, s, 6) == 0  # Euler-Lagrange
        assert all(sp.diff(curve, s, 3).subs(s, end) == 0 for end in fixed)  # natural, where s'' is free
    assert rise(1) == 1 and sp.diff(rise(s), s).subs(s, 1) == 0
    assert swept(0) == 0 and swept(1) == 1 and sp.diff(swept(s), s).subs(s, 1) == 0


def test_no_polynomial_turns_with_less_jerk_than_the_turn() -> None:
    base = np.polynomial.Polynomial([0, 0, 2.5, 0, -2.5, 1])

    def cost(free: np.ndarray) -> float:
        bump = (
            np.polynomial.Polynomial([0, 0, 1])
            * np.polynomial.Polynomial([1, -1]) ** 2
            * np.polynomial.Polynomial(free)
        )
        return float(((base + bump).deriv(3) ** 2).integ()(1.0))

    assert cost(np.zeros(3)) == pytest.approx(minimize(cost, np.ones(3)).fun, rel=1e-6)


def test_the_time_of_a_drive_is_its_length_over_its_speed() -> None:
    length, speed, acceleration = 4.0, 1.2, 1.5
    time = float(duration(length, speed, acceleration))
    drive = Drive(sp.Float(0), sp.Float(time), sp.Float(speed), sp.Float(acceleration))
    velocity = sp.lambdify(TIME, _settled(drive.velocity, drive))
    assert quad(velocity, 0, time, limit=200)[0] == pytest.approx(length, rel=1e-9)
    assert sp.diff(speed * rise(TIME / rise_time(speed, acceleration)), TIME).subs(TIME, 0) == pytest.approx(
        acceleration
    )


def _settled(expression: sp.Expr, drive: Drive) -> sp.Expr:
    return expression.xreplace({one.symbol: one.expression > 0 for one in drive.relations})


def test_a_straight_path_is_limited_by_speed_and_acceleration(timing) -> None:
    length, speed, acceleration, cost = timing(8.0, 0.0, 0.0, 8.0)
    assert length == pytest.approx(8.0)
    assert 0.95 * 1.4 < speed <= 1.4
    assert acceleration == pytest.approx(1.5)
    assert cost == pytest.approx(float(duration(length, speed, acceleration)), rel=0.01)


def test_the_limits_hold_along_paths_that_are_worth_driving(timing) -> None:
    rng = np.random.default_rng(0)
    s = np.linspace(0, 1, 2001)
    bends = sp.lambdify(
        (PARAMETER, *LEG), [curvature(PATH), curvature(PATH).diff(PARAMETER) / path_speed(PATH)], cse=True
    )
    checked = 0
    between = 1.15  # what lies between the points of a plan, well within RESERVE
    for _ in range(300):
        along, left, turn = rng.uniform(-3, 3), rng.uniform(-3, 3), rng.uniform(-np.pi, np.pi)
        distance = np.hypot(along, left)
        choices = [(*timing(along, left, turn, one * distance), one * distance) for one in (-1.5, -0.7, 0.7, 1.5)]
        length, speed, acceleration, cost, tangent = min(choices, key=lambda one: one[3])
        assert speed <= 1.4 and acceleration <= 1.5
        assert length >= 1.875 * speed**2 / acceleration * (1 - 1e-12)  # there is a cruise
        if cost > 3 * (distance / 1.4 + 1):  # other manoeuvres are chosen there
            continue
        bend, slope = (np.abs(np.broadcast_to(one, s.shape)) for one in bends(s, along, left, turn, tangent))
        assert (slope * speed**2).max() <= between * (1 - TURN_SHARE) * 22.0
        assert (bend * acceleration).max() <= between * TURN_SHARE * 22.0
        checked += 1
    assert checked > 150


def test_the_reference_is_the_path_differentiated_in_time() -> None:
    path = Pose(*map(sp.Float, (0, 0, 0.3))).path_to(Pose(*map(sp.Float, (-1.0, 2.0, 0.9))), sp.Float(2.0))
    begin, time, speed, acceleration = 0.0, 3.0, 1.0, 1.2
    drive = Drive(*map(sp.Float, (begin, time, speed, acceleration)))
    reference = Reference.along(path, drive, sp.S.One)
    quantities = [reference.parameter_rate, *reference.position,
                  *(one for each in reference.derivatives for one in each),
                  reference.yaw_rate, reference.yaw_acceleration]  # fmt: skip
    function = sp.lambdify((TIME, PARAMETER), [_settled(one, drive) for one in quantities], cse=True)
    h, t, s = 1e-3, 0.4, 0.0
    grid = np.arange(0, t + 3 * h, h)
    history = [s]
    for now in grid[:-1]:  # RK4 of the path parameter
        k1 = function(now, s)[0]
        k2 = function(now + h / 2, s + h / 2 * k1)[0]
        k3 = function(now + h / 2, s + h / 2 * k2)[0]
        k4 = function(now + h, s + h * k3)[0]
        s += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        history.append(s)
    values = np.array([function(now, one) for now, one in zip(grid, history, strict=True)])
    middle = len(grid) - 3
    for lower, upper in ((1, 3), (2, 4), (3, 5), (4, 6), (5, 7), (6, 8), (9, 10)):
        slope = (values[middle + 1, lower] - values[middle - 1, lower]) / (2 * h)
        assert slope == pytest.approx(values[middle, upper], rel=1e-4, abs=1e-5)


def test_a_regular_start_has_its_acceleration_along_the_heading() -> None:
    start = Pose(*map(sp.Float, (0, 0, 0.3)))
    path = start.path_to(Pose(*map(sp.Float, (-1.0, 2.0, 0.9))), sp.Float(2.0))
    drive = Drive(*map(sp.Float, (0.0, 3.0, 1.0, 1.2)))
    reference = Reference.along(path, drive, sp.S.One)
    at_start = {TIME: sp.S.Zero, PARAMETER: sp.S.Zero}
    first, second, third = (_settled(one, drive).subs(at_start) for one in reference.derivatives)
    h, across = direction(start.heading), direction(start.heading + sp.pi / 2)
    assert first.norm() == 0
    assert float(second.dot(h)) == pytest.approx(1.2) and float(second.dot(across)) == pytest.approx(0, abs=1e-12)
    assert float(third.dot(across)) == pytest.approx(0, abs=1e-12)  # j_perp = 0: the yaw rate begins at 0


CURVE = sp.Matrix([sp.sin(PARAMETER) + PARAMETER, 2 * PARAMETER - sp.cos(PARAMETER / 2)])


def test_a_clocked_reference_is_the_curve_differentiated_in_time() -> None:
    begin, time, speed, acceleration, scale = 0.0, 9.0, 0.7, 0.5, 2.0
    drive = Drive(*map(sp.Float, (begin, time, speed, acceleration)))
    path = [CURVE.diff(PARAMETER, k) if k else CURVE for k in range(4)]
    reference = Reference.driven(path, drive, sp.S.One, sp.Float(scale))
    clock = speed / scale * sp.integrate(rise(TIME / rise_time(speed, acceleration)), (TIME, 0, TIME))
    exact = CURVE.subs(PARAMETER, clock)
    tangent = exact.diff(TIME)
    yaw_rate = (tangent[0] * tangent[1].diff(TIME) - tangent[1] * tangent[0].diff(TIME)) / tangent.dot(tangent)
    wanted = [*(one for k in (1, 2, 3) for one in exact.diff(TIME, k)), yaw_rate, yaw_rate.diff(TIME)]
    found = [*(one for each in reference.derivatives for one in each), reference.yaw_rate, reference.yaw_acceleration]
    for now in (0.2, 1.1, 1.9):  # while the clock's rate rises
        at = {PARAMETER: clock.subs(TIME, now), TIME: sp.Float(now)}
        for one, other in zip(found, wanted, strict=True):
            assert float(_settled(one, drive).subs(at)) == pytest.approx(float(other.subs(TIME, now)), rel=1e-9)


def test_a_clocked_reference_starts_regularly() -> None:
    drive = Drive(*map(sp.Float, (0.0, 9.0, 0.7, 0.5)))
    path = [CURVE.diff(PARAMETER, k) if k else CURVE for k in range(4)]
    reference = Reference.driven(path, drive, sp.S.One, sp.Float(2.0))
    at = {PARAMETER: sp.Float(0.6), TIME: sp.S.Zero}
    first, second, third, heading = (
        _settled(one, drive).subs(at) for one in (*reference.derivatives, reference.direction)
    )
    across = sp.Matrix([-heading[1], heading[0]])
    assert first.norm() == 0
    assert float(second.dot(heading)) > 0
    assert float(second.dot(across)) == pytest.approx(0, abs=1e-12)
    assert float(third.dot(across)) == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(
    ("reference", "values", "span"),
    [
        (br.blocks.circle(), {}, NEVER),
        (br.blocks.polynomial(), {}, 4.0 - 2 * EDGE),
        (br.blocks.polynomial(), {"start_time": -1.0}, 3.0 - 2 * EDGE),
        (br.blocks.polynomial(), {"start_time": 2.0, "duration": 1.0}, 1.0 - 2 * EDGE),
        (br.blocks.polynomial(), {"start_time": 2.0, "start_velocity[1]": 1.0}, 6.0 - EDGE),
        (br.blocks.polynomial(), {"end_velocity[1]": 1.0}, NEVER),
        (br.blocks.waypoints([[0, 0], [1, 2], [3, 3]], [-0.5, 2.0, 4.0]), {}, 4.0 - 2 * EDGE),
    ],
)
def test_a_course_ends_where_its_reference_comes_to_rest(
    reference: br.Block, values: dict[str, float], span: float
) -> None:
    block = course(reference)
    assert not block.failed_checks(block.parameter_values(values), "start")
    engine = NumpyEngine(block)
    engine.set_parameters(values)
    engine.initialize()
    found = dict(zip((one.name for one in block.outputs), engine.outputs(), strict=True))
    assert found["span"] == pytest.approx(span, abs=1e-8)
    assert np.hypot(found["Z1d[2]"], found["Z2d[2]"]) > 0


def test_a_course_that_is_over_is_refused() -> None:
    block = course(br.blocks.polynomial())
    assert block.failed_checks(block.parameter_values({"start_time": -5.0}), "start")
    assert block.failed_checks(block.parameter_values({"end[2]": 0.0}), "start")
