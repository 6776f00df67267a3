"""Dormand-Prince in both engines: orders, located events, samples, endless events and steps of any length."""

import math

import numpy as np
import pytest
import sympy as sp
import xarray as xr
from scipy.integrate import solve_ivp

import brunovsky as br
from brunovsky.blocks import Block, Mode, NumpyEngine, Output, Parameter, State, Transition, symbols
from brunovsky.errors import ParameterError, SimulationError
from brunovsky.native import NativeEngine

ENGINES = ("native", "numpy")


def adaptive(block: Block, t_end: float, engine: str = "native", **options: object) -> xr.Dataset:
    return br.simulate(block, t_end, engine=engine, solver="dormand_prince", **options)  # type: ignore[arg-type]


def difference(one: xr.Dataset, other: xr.Dataset) -> float:
    """Largest difference of all variables, each relative to its peak."""
    return max(
        float(
            abs(one[name].astype(float) - other[name].astype(float)).max()
            / (1e-9 + abs(other[name].astype(float)).max())
        )
        for name in one
    )


@pytest.fixture(scope="module")
def oscillator() -> Block:
    """x'' = -x from x = 1: cos t."""
    x, rate = symbols("x", "rate")
    states = (State("x", derivative=rate, start=sp.S.One), State("rate", derivative=-x))
    return Block("oscillator", states=states, outputs=(Output("x", expression=x),))


@pytest.mark.parametrize("engine", ENGINES)
def test_the_error_follows_the_tolerance(oscillator: Block, engine: str) -> None:
    """One communication step of three periods: the error is about proportional to the tolerance."""
    tolerances = 10.0 ** np.arange(-4, -11, -2)
    end = 6 * math.pi
    errors = [
        float(np.hypot(run["x"][-1] - 1, run["rate"][-1]))
        for run in (adaptive(oscillator, end, engine, step_size=end, tolerance=one) for one in tolerances)
    ]
    slope = np.polyfit(np.log10(tolerances), np.log10(errors), 1)[0]
    assert 0.9 < slope < 1.1
    assert all(error < 100 * tolerance for error, tolerance in zip(errors, tolerances, strict=True))


@pytest.mark.parametrize("engine", ENGINES)
def test_steps_held_by_a_loose_tolerance_have_order_five(oscillator: Block, engine: str) -> None:
    """At the tolerance 1 each communication step is one internal one."""
    errors = []
    for count in (80, 160, 320):
        run = adaptive(oscillator, 6.0, engine, step_size=6 / count, tolerance=1.0)
        errors.append(float(np.hypot(run["x"][-1] - math.cos(6), run["rate"][-1] + math.sin(6))))
    assert np.diff(-np.log2(errors)) == pytest.approx(5, abs=0.1)


@pytest.mark.parametrize("name", ["robot", "linearized_robot", "circle", "pole_placement", "closed_loop"])
def test_engines_agree_to_rounding(name: str) -> None:
    block = getattr(br.blocks, name)()
    inputs = {one.name: (lambda time, k=index: math.sin(time + k)) for index, one in enumerate(block.inputs)}
    native, numpy = (adaptive(block, 0.5, engine, step_size=0.05, inputs=inputs) for engine in ENGINES)
    assert difference(native, numpy) < 1e-9


def test_it_agrees_with_rk4_of_short_steps() -> None:
    loop = br.blocks.closed_loop(br.blocks.pole_placement())
    rk4 = br.simulate(loop, 2.0, step_size=1e-4)
    assert difference(adaptive(loop, 2.0, step_size=1e-3, tolerance=1e-10), rk4.isel(time=slice(None, None, 10))) < 1e-9
    long = adaptive(loop, 2.0, step_size=2.0, tolerance=1e-10)
    for name in ("x", "y", "theta", "eta[1]", "eta[2]"):
        assert float(long[name][-1]) == pytest.approx(float(rk4[name][-1]), abs=1e-9)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("step_size", [0.01, 0.4, 3.0])
def test_relay_with_hysteresis_switches_on_time(relay: Block, engine: str, step_size: float) -> None:
    """Slope 1 from x = 0.05: down to -0.1 at 0.15 s, then 0.2 s a half-period, whatever is recorded.

    Fifteen switches, each late by at most 1e-9 step_size, prolong the half-periods on both sides by that.
    """
    run = adaptive(relay, 3.0, engine, step_size=step_size)
    time = run["time"].values
    since = (time - 0.15) % 0.4
    expected = np.where(time < 0.15, 0.05 - time, np.minimum(since, 0.4 - since) - 0.1)
    assert run["x"].values == pytest.approx(expected, abs=2 * 15 * 1e-9 * step_size + 1e-12)


def _oscillator_under_a_relay(t_end: float) -> float:
    """x at the end of x'' = -x - 0.3 x' - relay, by scipy's events at its smallest tolerance."""
    time, relay, states = 0.0, 1, np.array([1.0, 0.0])
    while time < t_end:

        def edge(_time: float, x: np.ndarray, side: int = relay) -> float:
            return x[0] + 0.1 * side

        def slope(_time: float, x: np.ndarray, side: int = relay) -> list[float]:
            return [x[1], -x[0] - 0.3 * x[1] - side]

        edge.terminal, edge.direction = True, -relay  # type: ignore[attr-defined]
        found = solve_ivp(slope, (time, t_end), states, "DOP853", rtol=1e-13, atol=1e-15, events=edge)
        time, states, relay = found.t[-1], found.y[:, -1], -relay
    return float(states[0])


@pytest.mark.parametrize("engine", ENGINES)
def test_events_in_curved_motion_follow_the_tolerance(engine: str) -> None:
    """Against scipy's integration and location of events."""
    x, rate, relay = symbols("x", "rate", "relay")
    block = Block(
        "relay_oscillator",
        states=(State("x", derivative=rate, start=sp.S.One), State("rate", derivative=-x - 0.3 * rate - relay)),
        modes=(Mode("relay", start=1),),
        outputs=(Output("x", expression=x),),
        transitions=(
            Transition("up", sp.And(sp.Eq(relay, -1), x > 0.1), {relay: sp.S(1)}),
            Transition("down", sp.And(sp.Eq(relay, 1), x < -0.1), {relay: sp.S(-1)}),
        ),
    )
    expected = _oscillator_under_a_relay(20.0)
    for tolerance, bound in ((1e-4, 2e-3), (1e-6, 2e-5), (1e-8, 2e-7), (1e-10, 2e-9)):
        for step_size in (20.0, 0.1):
            run = adaptive(block, 20.0, engine, step_size=step_size, tolerance=tolerance)
            assert float(run["x"][-1]) == pytest.approx(expected, abs=bound)
    assert abs(float(br.simulate(block, 20.0, step_size=1e-3)["x"][-1]) - expected) > 1e-2, "RK4 switches late"


@pytest.mark.parametrize("engine", ENGINES)
def test_ball_bounces_on_time(ball: Block, engine: str) -> None:
    """Impacts and the height between them are exact to the location of the event; gravity is integrated exactly."""
    fall = math.sqrt(2 / 9.81)
    times = fall * np.array([1 + 2 * sum(0.7**k for k in range(1, n + 1)) for n in range(8)])
    run = adaptive(ball, 2.0, engine, step_size=2.0 / 7)
    for time, height in zip(run["time"].values, run["height"].values, strict=True):
        bounces = int(np.searchsorted(times, time))
        if bounces:
            since = time - times[bounces - 1]
            expected = 0.7**bounces * 9.81 * fall * since - 9.81 / 2 * since**2
        else:
            expected = 1 - 9.81 / 2 * time**2
        assert height == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("engine", ENGINES)
def test_accumulating_impacts_end_in_an_error_at_their_limit(ball: Block, engine: str) -> None:
    with pytest.raises(SimulationError, match=r"ball: events do not end: over 200 within .*use solver RK4") as caught:
        adaptive(ball, 3.0, engine, step_size=0.1)
    limit = math.sqrt(2 / 9.81) * (1 + 2 * 0.7 / 0.3)
    assert caught.value.time == pytest.approx(2.5), "the step from there is undone"
    assert float(str(caught.value).rpartition("t = ")[2].split()[0]) == pytest.approx(limit, abs=1e-4)
    assert caught.value.trajectory["time"].values[-1] == pytest.approx(2.5)


@pytest.mark.parametrize("engine", ENGINES)
def test_the_sign_function_ends_in_an_error_that_names_the_remedies(engine: str) -> None:
    """The law with phi = 0 reaches S = 0 and would switch there for ever."""
    with pytest.raises(SimulationError, match=r"boundary layer, hysteresis or a sampled law at t = 0\.32") as caught:
        adaptive(br.blocks.closed_loop(), 6.0, engine, step_size=0.05, parameters={"phi": 0.0})
    assert caught.value.variable == "events"
    assert caught.value.trajectory["time"].values[-1] == caught.value.time == pytest.approx(0.3)


def test_a_thin_boundary_layer_settles() -> None:
    """RK4 of 1 ms does not (0.5 mm/s² is half of what its stability asks for)."""
    options = {"parameters": {"phi": 0.0005}, "inputs": {}}
    settled = adaptive(br.blocks.closed_loop(), 6.0, **options)
    assert float(abs(settled["S[1]"][-1000:]).max()) < 1e-6
    assert float(abs(br.simulate(br.blocks.closed_loop(), 6.0, **options)["S[1]"][-1000:]).max()) > 1e-4  # type: ignore


@pytest.mark.parametrize("engine", ENGINES)
def test_the_guard_is_crossed_at_any_step(engine: str) -> None:
    """eta[1] runs through 0 at 119 m/s²; the heading is that of RK4 with steps of 1 µs."""
    robot = br.blocks.linearized_robot()
    fast = {"eta_start[1]": -0.06, "u_start[1]": 119.0}
    options = {"parameters": fast, "inputs": {"v[1]": 1.0}}
    fine = float(br.simulate(robot, 0.004, step_size=1e-6, **options)["theta"][-1])  # type: ignore[arg-type]
    for step_size in (1e-3, 4e-3):
        run = adaptive(robot, 0.004, engine, step_size=step_size, tolerance=1e-8, **options)
        assert float(run["theta"][-1]) == pytest.approx(fine, rel=1e-3)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("length", [1e-6, 1e-4, 0.0137, 0.5, 10.0])
def test_communication_steps_of_any_length(sampled_integrator: Block, engine: str, length: float) -> None:
    """Samples fall at k T whatever the step, and the lag between them is exact to the tolerance."""
    make = NativeEngine if engine == "native" else NumpyEngine
    instance = make(sampled_integrator, 1e-3, "dormand_prince", 1e-9)
    instance.inputs[0] = 1.0
    instance.initialize()
    count = max(1, min(40, round(10 / length)))
    for _ in range(count):
        instance.advance(length)
    end, lag = count * length, 0.0
    for k in range(math.ceil(end / 0.03 - 1e-9)):
        total, piece = 0.03 * (k + 1), min(end - 0.03 * k, 0.03)
        lag = total + (lag - total) * math.exp(-piece)
    assert instance.states[0] == pytest.approx(lag, rel=1e-8)


@pytest.mark.parametrize("engine", ENGINES)
def test_escape_in_finite_time_is_an_error_that_keeps_the_state(engine: str) -> None:
    x = symbols("x")[0]
    block = Block("escape", states=(State("x", derivative=x**2, start=sp.S.One),), outputs=(Output("x", expression=x),))
    make = NativeEngine if engine == "native" else NumpyEngine
    instance = make(block, 0.1, "dormand_prince")
    instance.initialize()
    instance.advance(0.5)
    before = float(instance.states[0])
    assert before == pytest.approx(2.0, rel=1e-5)
    with pytest.raises(SimulationError, match=r"escape: (solver finds no step|x is not finite).*t = (1|0\.99)"):
        instance.advance(5.0)
    assert (instance.time, instance.states[0]) == (0.5, before)
    instance.advance(0.25)
    assert instance.states[0] == pytest.approx(4.0, rel=1e-5)


@pytest.mark.parametrize("engine", ENGINES)
def test_the_law_without_guard_is_followed_past_rest(engine: str) -> None:
    """At constant jerk the speed falls to 0.125 µm/s: the robot turns by pi there, the chains stay what they are."""
    parameters = {"eta_start[1]": 0.05, "u_start[1]": -100.0, "eta_min": 0.0}
    options = {"step_size": 0.01, "tolerance": 1e-9, "parameters": parameters, "inputs": {"v[1]": 1.0}}
    end = adaptive(br.blocks.linearized_robot(), 0.01, engine, **options).isel(time=-1)
    assert float(end["theta"]) == pytest.approx(-math.pi, abs=1e-3)
    chains = [float(end[name]) for name in ("Z1[1]", "Z1[2]", "Z1[3]", "Z2[2]", "Z2[3]")]
    assert chains == pytest.approx([1e-6 / 6, 5e-5, 0.01, -0.95, -100.0], rel=1e-3, abs=1e-7)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_crossing_that_is_left_again_within_a_step_is_seen_at_its_quarters(engine: str) -> None:
    """A pulse in time alone, of the part 0.3 of a step that nothing else shortens."""
    x, start = symbols("x", "start")
    t = br.blocks.TIME
    block = Block(
        "pulse",
        parameters=(Parameter("start", "s", "begin of the pulse", 0.6),),
        states=(State("x", derivative=sp.Piecewise((1, sp.And(t > start, t < start + 0.3)), (0, True))),),
        outputs=(Output("x", expression=x),),
    )
    for begin in (0.41, 0.55, 0.69):
        run = adaptive(block, 1.0, engine, step_size=1.0, parameters={"start": begin})
        assert run["x"].values[-1] == pytest.approx(0.3, abs=1e-8)


def test_a_block_without_states_runs() -> None:
    block = Block("wave", outputs=(Output("y", expression=sp.sign(sp.sin(5 * br.blocks.TIME))),))
    native, numpy = (adaptive(block, 2.0, engine, step_size=0.01) for engine in ENGINES)
    assert (native["y"].values == np.sign(np.sin(5 * native["time"].values))).all()
    assert difference(native, numpy) == 0


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"solver": "euler"}, "there is no solver 'euler'; use 'rk4' or 'dormand_prince'"),
        ({"tolerance": 0.0}, "tolerance = 0.0 is out of its range from 1e-13 to 1"),
        ({"tolerance": math.nan}, "tolerance = nan is out of its range"),
        ({"tolerance": "fine"}, "tolerance = 'fine' is out of its range"),
        ({"tolerance": 1e-16}, "tolerance = 1e-16 is out of its range"),
    ],
)
@pytest.mark.parametrize("engine", ENGINES)
def test_unknown_solvers_and_tolerances_are_refused(oscillator: Block, options: dict, text: str, engine: str) -> None:
    with pytest.raises(ParameterError, match=text):
        br.simulate(oscillator, 1.0, engine=engine, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("engine", ENGINES)
def test_a_sliding_motion_ends_in_an_error_at_any_length_of_step(engine: str) -> None:
    """x' = -sign x - 1/2 reaches 0 at 2/3 s."""
    x = symbols("x")[0]
    block = Block(
        "slide",
        states=(State("x", derivative=-sp.sign(x) - sp.Rational(1, 2), start=sp.S.One),),
        outputs=(Output("x", expression=x),),
    )
    for step_size in (1e-2, 3.0):
        with pytest.raises(SimulationError, match=r"slide: events do not end.* at t = 0\.666"):
            adaptive(block, 3.0, engine, step_size=step_size)


def test_a_stiff_system_ends_in_an_error_or_with_its_solution() -> None:
    """x' = -1e6 (x - cos t): a third of a million steps a second, which is too many only in one step_size."""
    x, t = symbols("x")[0], br.blocks.TIME
    block = Block(
        "stiff",
        states=(State("x", derivative=-1_000_000 * (x - sp.cos(t)), start=sp.S.One),),
        outputs=(Output("x", expression=x),),
    )
    with pytest.raises(SimulationError, match=r"solver needs over 100000 steps within 1 s: it is stiff"):
        adaptive(block, 1.0, step_size=1.0)
    assert adaptive(block, 0.5, step_size=0.01)["x"].values[-1] == pytest.approx(math.cos(0.5), abs=3e-6)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_branch_that_ends_in_a_square_root_is_no_endless_search(engine: str) -> None:
    """x' = -sqrt x until 0, which is at 2 s: nothing but an error or the solution comes out."""
    x = symbols("x")[0]
    outflow = sp.Piecewise((-sp.sqrt(x), x > 0), (0, True))
    tank = Block("tank", states=(State("x", derivative=outflow, start=sp.S.One),), outputs=(Output("x", expression=x),))
    with pytest.raises(SimulationError, match=r"tank: x is not finite after the step at t = 2\.0000") as caught:
        adaptive(tank, 3.0, engine, step_size=0.5)
    kept = caught.value.trajectory
    assert kept["x"].values == pytest.approx((1 - kept["time"].values / 2) ** 2, abs=1e-6)
