"""References: exact derivatives, boundary and continuity, the least jerk."""

import itertools

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from reference_cases import ACCELERATIONS, BOUNDARY, CASES, POINTS, TIMES, B
from scipy.interpolate import make_interp_spline

import brunovsky as br
from brunovsky.blocks import TIME, symbols
from brunovsky.errors import ModelError, ParameterError

KNOTS = {"polynomial": (-0.2, 2.5), "waypoints": TIMES, "lemniscate": ()}


def expression(block: br.Block, name: str) -> sp.Expr:
    return next(one.expression for one in block.outputs if one.name == name)


def pieces(block: br.Block, name: str, **values: float) -> list[sp.Expr]:
    """Expressions of the pieces in turn, with defaults or other values of the parameters, as functions of time."""
    numbers = {one.symbol: sp.Float(values.get(one.name, one.value), 30) for one in block.parameters}
    relations = [one.symbol for one in block.relations]
    found = []
    for k in range(len(relations) + 1):
        acting = {one: sp.true if j >= k else sp.false for j, one in enumerate(relations)}
        found.append(expression(block, name).xreplace(acting).xreplace(numbers))
    return found


@pytest.mark.parametrize("name", CASES)
def test_derivatives_are_those_of_the_position(name: str) -> None:
    make, values = CASES[name]
    data = br.simulate(make(), 4.0, step_size=1e-3, parameters=values)
    time = data["time"].values[1:-1]
    smooth = np.all([abs(time - knot) > 1.5e-3 for knot in (-1, *KNOTS[name.split(",")[0]])], axis=0)
    assert smooth.sum() > 3900
    for chain in (1, 2):
        names = [*(f"Z{chain}d[{k}]" for k in (1, 2, 3)), f"zd3[{chain}]"]
        for low, high in itertools.pairwise(names):
            slope = (data[low].values[2:] - data[low].values[:-2]) / 2e-3
            np.testing.assert_allclose(slope[smooth], data[high].values[1:-1][smooth], atol=5e-5)
        assert np.ptp(data[names[-1]].values) > 0.1


@pytest.mark.parametrize("name", CASES)
def test_engines_agree(name: str) -> None:
    make, values = CASES[name]
    native, numpy = (br.simulate(make(), 4.0, step_size=0.05, parameters=values, engine=e) for e in ("native", "numpy"))  # type: ignore[arg-type]
    for one in native:
        np.testing.assert_allclose(native[one], numpy[one], atol=1e-11 * (1 + abs(numpy[one]).max()))


def test_the_lemniscate_is_gerono_s_and_never_rests() -> None:
    block = B.lemniscate()
    a, rate = symbols("half_width", "rate")
    centre = dict.fromkeys(symbols("center[1]", "center[2]"), 0)
    x, y, vx, vy = (expression(block, one).xreplace(centre) for one in ("Z1d[1]", "Z2d[1]", "Z1d[2]", "Z2d[2]"))
    assert sp.simplify(x**4 - a**2 * (x**2 - y**2)) == 0
    angle = np.linspace(0, 2 * np.pi, 200_001)
    speed = sp.lambdify(TIME, sp.sqrt(vx**2 + vy**2).subs({a: 1, rate: 1, symbols("phase")[0]: 0}))(angle)
    assert speed.min() == pytest.approx(7**0.5 / 4, abs=1e-9) and speed.max() == pytest.approx(2**0.5, abs=1e-9)


def test_rest_to_rest_polynomials_are_the_known_ones() -> None:
    s = (TIME - symbols("start_time")[0]) / symbols("duration")[0]
    start, end = symbols("start[1]", "end[1]")
    known = {"given": 10 * s**3 - 15 * s**4 + 6 * s**5, "free": sp.Rational(5, 2) * (s**2 - s**4) + s**5}
    for acceleration, course in known.items():
        block = B.polynomial(acceleration=acceleration)  # type: ignore[arg-type]
        first, second = (one.symbol for one in block.relations)
        rest = {one.symbol: 0 for one in block.parameters if "_velocity" in one.name or "_acceleration" in one.name}
        position = expression(block, "Z1d[1]").xreplace(rest)
        inside = position.xreplace({first: sp.false, second: sp.true})
        assert sp.simplify(inside - (start + (end - start) * course)) == 0
        assert position.xreplace({first: sp.true}) == start
        assert position.xreplace({first: sp.false, second: sp.false}) == end


@settings(max_examples=10)
@given(values=st.lists(st.floats(-5, 5), min_size=12, max_size=12), duration=st.floats(0.2, 20), free=st.booleans())
def test_polynomial_meets_its_boundary(values: list[float], duration: float, free: bool) -> None:
    block = B.polynomial(acceleration="free" if free else "given")
    names = [one.name for one in block.parameters][:-2]
    given_values = dict(zip(names, values, strict=False)) | {"start_time": 0.7, "duration": duration}
    for i in (1, 2):
        for end, time in (("start", 0.7), ("end", 0.7 + duration)):
            wanted = [given_values[f"{end}[{i}]"], given_values[f"{end}_velocity[{i}]"]]
            wanted.append(0.0 if free else given_values[f"{end}_acceleration[{i}]"])
            names = [f"Z{i}d[1]", f"Z{i}d[2]", f"zd3[{i}]" if free else f"Z{i}d[3]"]
            for name, value in zip(names, wanted, strict=True):
                inside = pieces(block, name, **given_values)[1].subs(TIME, sp.Float(time, 30))
                assert float(inside) == pytest.approx(value, abs=1e-9 * (1 + 100 / duration**3))


@pytest.mark.parametrize("acceleration", ["given", "free"])
def test_waypoints_are_met_and_smooth_between(acceleration: str) -> None:
    """Continuous to the fourth derivative between, which is one more than zd3; rest at both ends."""
    block = B.waypoints(POINTS, TIMES, acceleration=acceleration)  # type: ignore[arg-type]
    for i in (1, 2):
        names = [*(f"Z{i}d[{k}]" for k in (1, 2, 3)), f"zd3[{i}]"]
        parts = [pieces(block, name) for name in names]
        parts.append([sp.diff(one, TIME) for one in parts[-1]])
        for k, knot in enumerate(TIMES):
            before, after = ([float(part[j].subs(TIME, knot)) for part in parts] for j in (k, k + 1))
            assert before[0] == pytest.approx(POINTS[k][i - 1], abs=1e-13)
            if 0 < k < len(TIMES) - 1:
                np.testing.assert_allclose(before, after, rtol=1e-12, atol=1e-12)
                assert abs(sp.diff(parts[-1][k + 1] - parts[-1][k], TIME)) > 1
            else:
                inside, outside = (after, before) if k == 0 else (before, after)
                assert outside == [POINTS[k][i - 1], 0, 0, 0, 0]
                assert inside[1] == pytest.approx(0, abs=1e-12)
                assert inside[3 if acceleration == "free" else 2] == pytest.approx(0, abs=1e-11)
                assert abs(inside[2 if acceleration == "free" else 3]) > 0.1


@settings(max_examples=5)
@given(
    intervals=st.lists(st.floats(0.1, 2.0), min_size=1, max_size=5), free=st.booleans(), seed=st.integers(0, 2**31 - 1)
)
def test_waypoints_are_scipy_s_interpolating_spline(intervals: list[float], free: bool, seed: int) -> None:
    times = np.concatenate([[-0.3], -0.3 + np.cumsum(intervals)])
    points = np.random.default_rng(seed).normal(size=(len(times), 2))
    block = B.waypoints(points, times, acceleration="free" if free else "given")
    still = [(1, np.zeros(2)), (3 if free else 2, np.zeros(2))]
    spline = make_interp_spline(times, points, k=5, bc_type=(still, still))
    for i, order, name in ((1, 0, "Z1d[1]"), (2, 2, "Z2d[3]"), (1, 3, "zd3[1]")):
        for k, part in enumerate(pieces(block, name)[1:-1]):
            at = np.linspace(times[k], times[k + 1], 7)[1:-1]
            found = sp.lambdify(TIME, part, "math")
            expected = spline(at, order)[:, i - 1]
            np.testing.assert_allclose([found(one) for one in at], expected, rtol=1e-7, atol=1e-7)


def cost(jerk: list[sp.Expr], times: list[float]) -> float:
    """Integral of the square, exactly."""
    squares = (sp.Poly(one, TIME) ** 2 for one in jerk)
    return float(sum(one.integrate().eval(b) - one.integrate().eval(a)
                     for one, (a, b) in zip(squares, itertools.pairwise(times), strict=True)))  # fmt: skip


@pytest.mark.parametrize("free", [False, True])
@pytest.mark.parametrize("name", ["polynomial", "waypoints"])
def test_no_other_motion_with_this_boundary_has_less_jerk(name: str, free: bool) -> None:
    """A change that keeps points and boundary adds its own cost, no more and no less: the first variation is zero."""
    choice = "free" if free else "given"
    if name == "polynomial":
        block = B.polynomial(acceleration=choice)  # type: ignore[arg-type]
        values, times = BOUNDARY | ({} if free else ACCELERATIONS), [-0.2, 2.5]
    else:
        block, values, times = B.waypoints(POINTS, TIMES, acceleration=choice), {}, TIMES  # type: ignore[arg-type]
    jerk = pieces(block, "zd3[1]", **values)[1:-1]
    least = cost(jerk, times)
    first, *between, last = (sp.Rational(one) for one in times)
    ends = ((TIME - first) * (TIME - last)) ** (2 if free else 3)
    for shape in (1, TIME, sp.Rational(1, 3) - TIME**2):
        change = shape * ends * sp.prod(TIME - one for one in between)
        extra = sp.diff(change, TIME, 3) / 10
        added = cost([extra] * len(jerk), times)
        assert added > 1e-3 * least
        assert cost([one + extra for one in jerk], times) == pytest.approx(least + added, rel=1e-9)


def test_a_free_acceleration_costs_less() -> None:
    costs = [
        cost(pieces(B.waypoints(POINTS, TIMES, acceleration=one), "zd3[1]")[1:-1], TIMES) for one in ("free", "given")
    ]
    assert costs[0] < 0.9 * costs[1]


def test_two_waypoints_are_the_polynomial() -> None:
    for choice in ("given", "free"):
        line = B.waypoints([[1.0, -2.0], [3.0, 0.5]], [0.5, 2.0], acceleration=choice)  # type: ignore[arg-type]
        values = {"start[1]": 1.0, "start[2]": -2.0, "end[1]": 3.0, "end[2]": 0.5, "start_time": 0.5, "duration": 1.5}
        one = br.simulate(line, 2.5, step_size=0.01)
        other = br.simulate(B.polynomial(acceleration=choice), 2.5, step_size=0.01, parameters=values)  # type: ignore[arg-type]
        for name in one:
            np.testing.assert_allclose(one[name], other[name], atol=1e-11)


def test_a_switch_on_the_grid_of_steps_is_not_a_step_late() -> None:
    """The k-th step of 0.3 s begins a rounding before 3 k/10 s or after it; it sees the piece that begins there."""
    block, late = B.polynomial(), 0
    for k in range(1, 40, 2):
        data = br.simulate(block, 12.0, step_size=0.3, parameters={"duration": 3 * k / 10}, record=["zd3[2]"])
        late += data["time"].values[k] < 3 * k / 10
        assert data["zd3[2]"].values[k] == 0 and data["zd3[2]"].values[k - 1] != 0
    assert late > 3


def test_references_are_known_ahead() -> None:
    block = B.preview(B.waypoints(POINTS, TIMES), 0.05)
    data = br.simulate(block, 4.0, step_size=0.05)
    for name in ("Z1d[1]", "Z2d[2]"):
        ahead = name.replace("d[", "d_next[")
        np.testing.assert_allclose(data[ahead].values[:-1], data[name].values[1:], atol=1e-12)


@pytest.mark.parametrize(
    ("points", "times", "message"),
    [
        ([[0, 0]], [0], r"1 point\(s\); give from 2 to 20"),
        (np.zeros((21, 2)), range(21), r"21 point\(s\); give from 2 to 20"),
        ([], [], "no list of pairs"),
        ([[0, 0], [1, 1]], [0, 1, 2], r"3 time\(s\) for 2 point\(s\); give one for each"),
        ([[0, 0], [1, 1], [2, 2]], [0, 2, 1], r"times\[2\] = 1 s does not follow times\[1\] = 2 s"),
        ([[0, 0], [1, 1]], [1, 1], "give increasing times"),
        ([[0, 0], [1, 1]], [0, 1e-4], "by 0.001 s at least"),
        ([[0, 0], [1, np.nan]], [0, 1], "no list of pairs of finite real numbers"),
        ([[0, 0, 0], [1, 1, 1]], [0, 1], r"give \[\[x, y\], …\]"),
        ([[0, 0], [1]], [0, 1], "no list of pairs"),
        ("corners", [0, 1], "no list of pairs"),
        ([[0, 0], [1, 1]], [0, np.inf], "times: .* no flat list of finite real numbers"),
        ([[0, 0], [1, 1]], 3.0, "times: .* no flat list"),
    ],
)
def test_waypoints_that_make_no_motion_are_refused(points: object, times: object, message: str) -> None:
    with pytest.raises(ModelError, match=message):
        B.waypoints(points, times)  # type: ignore[arg-type]


def test_other_values_without_meaning_are_refused() -> None:
    for make in (B.polynomial, lambda **options: B.waypoints(POINTS, TIMES, **options)):
        with pytest.raises(ModelError, match="no acceleration 'zero'; use 'given' or 'free'"):
            make(acceleration="zero")
    with pytest.raises(ParameterError, match=r"duration = 0 s is not a finite number from 0\.001"):
        br.simulate(B.polynomial(), 1.0, parameters={"duration": 0.0})
    with pytest.raises(ParameterError, match="half_width = -1"):
        br.simulate(B.lemniscate(), 1.0, parameters={"half_width": -1.0})


def test_points_are_parameters_and_not_tunable() -> None:
    block = B.waypoints(POINTS, TIMES)
    assert [one.name for one in block.parameters] == [f"point[{k},{i}]" for k in range(1, 6) for i in (1, 2)]
    assert not any(one.tunable for one in (*block.parameters, *B.polynomial().parameters, *B.lemniscate().parameters))
    moved = br.simulate(block, 1.3, step_size=0.01, parameters={"point[3,1]": 7.0})
    assert moved["Z1d[1]"].values[-1] == pytest.approx(7.0, abs=1e-12)
