"""The compiled engine reproduces the plain NumPy evaluation of the same block, events included."""

import math

import numpy as np
import pytest
import sympy as sp
import xarray as xr

import brunovsky as br
from brunovsky.blocks import (
    Block,
    Diagram,
    Input,
    Mode,
    NumpyEngine,
    Output,
    Parameter,
    Sample,
    State,
    Transition,
    symbols,
)
from brunovsky.errors import SimulationError
from brunovsky.native import NativeEngine


def both(block: Block, t_end: float, **options: object) -> tuple[xr.Dataset, xr.Dataset]:
    return tuple(br.simulate(block, t_end, engine=engine, **options) for engine in ("native", "numpy"))  # type: ignore


def difference(one: xr.Dataset, other: xr.Dataset) -> float:
    """Largest difference over all variables, each relative to its peak."""
    assert set(one) == set(other)
    return max(
        float(
            abs(one[name].astype(float) - other[name].astype(float)).max()
            / (1e-9 + abs(other[name].astype(float)).max())
        )
        for name in one
    )


@pytest.mark.parametrize(
    "name",
    ["robot", "linearized_robot", "robot_with_lags", "circle", "line", "lemniscate", "polynomial", "sliding_mode",
     "pole_placement", "closed_loop"],
)  # fmt: skip
def test_shipped_blocks_agree_to_rounding(name: str) -> None:
    block = getattr(br.blocks, name)()
    inputs = {one.name: (lambda time, k=index: math.sin(time + k)) for index, one in enumerate(block.inputs)}
    native, numpy = both(block, 0.2, inputs=inputs)
    assert difference(native, numpy) < 1e-11


def test_relay_with_hysteresis(relay: Block) -> None:
    native, numpy = both(relay, 3.0, parameters={"width": 0.25}, step_size=0.01)
    assert difference(native, numpy) == 0
    settled = native["x"].values[100:]
    assert settled.max() == pytest.approx(0.25, abs=0.0101)
    assert settled.min() == pytest.approx(-0.25, abs=0.0101)
    assert set(np.unique(native["u"])) == {-1.0, 1.0}
    # slope 1: a period is four half-widths, and each switch is seen at most a step late
    switches = native["time"].values[1:][np.diff(native["u"].values) != 0]
    assert np.diff(switches) == pytest.approx(0.5, abs=0.0201)


@pytest.mark.parametrize("step_size", [0.03, 0.007, 0.1])
def test_sampled_integrator(sampled_integrator: Block, step_size: float) -> None:
    def u(time: float) -> float:
        return 1.0 + time

    native, numpy = both(sampled_integrator, 1.0, inputs={"u": u}, step_size=step_size)
    assert difference(native, numpy) < 1e-14
    held = native.attrs.get("step", native["time"].values[1])
    # sample k at k T by integer count sees the input held since the last instant of the grid
    instants = [k * 0.03 for k in range(34)]
    expected = 0.03 * sum(u(math.floor(instant / held + 1e-6) * held) for instant in instants)
    assert native["total"].values[-1] == pytest.approx(expected, rel=1e-12)


def test_sampled_integrator_makes_the_continuous_state_exact_between_samples(sampled_integrator: Block) -> None:
    """The piece between two samples is smooth, so RK4 gives the exact solution of lag' = total - lag to 1e-10."""
    result = br.simulate(sampled_integrator, 0.9, inputs={"u": 1.0}, step_size=0.01)
    lag = 0.0
    for sample in range(30):
        total = 0.03 * (sample + 1)
        lag = total + (lag - total) * math.exp(-0.03)
    assert result["lag"].values[-1] == pytest.approx(lag, abs=1e-10)


def test_bouncing_ball(ball: Block) -> None:
    native, numpy = both(ball, 3.0, step_size=1e-3)
    assert difference(native, numpy) == 0
    velocity = native["velocity"].values
    jumps = np.flatnonzero(np.diff(velocity) > 0.1)
    fall = math.sqrt(2 * 1.0 / 9.81)
    first, second = native["time"].values[jumps[:2] + 1]
    assert first == pytest.approx(fall, abs=2e-3)
    assert second == pytest.approx(fall + 2 * 0.7 * fall, abs=6e-3)
    assert velocity[jumps[0] + 1] == pytest.approx(-0.7 * velocity[jumps[0]], rel=5e-3)


def test_events_without_end_are_an_error_that_keeps_the_state() -> None:
    x, mode = symbols("x", "mode")
    block = Block(
        "endless",
        states=(State("x", derivative=sp.S.One),),
        modes=(Mode("mode", start=1),),
        outputs=(Output("x", expression=x),),
        transitions=(Transition("flip", x > 0.5, {mode: -mode}),),
    )
    for engine in (NativeEngine(block, 0.1), NumpyEngine(block, 0.1)):
        engine.initialize()
        engine.advance(0.5)
        with pytest.raises(SimulationError, match=r"endless: events do not end.*t = 0\.6"):
            for _ in range(3):
                engine.advance(0.1)
        assert engine.time == pytest.approx(0.6)
        assert engine.states[0] == pytest.approx(0.6)


def test_samples_of_a_diagram_see_fresh_values_in_feedthrough_order() -> None:
    """A sampled gain behind a sampled copy: at each instant the gain sees the copy's new value, not the old one."""
    u, held = symbols("u", "held")
    copy = Block(
        "copy",
        inputs=(Input("u"),),
        samples=(Sample("held", update=u, period=sp.Float(0.1)),),
        outputs=(Output("y", expression=held),),
    )
    chain = Diagram(
        "chain",
        components={"second": copy, "first": copy},
        connections={"second.u": "first.y"},
        inputs={"u": "first.u"},
        outputs={"first": "first.y", "second": "second.y"},
    )
    native, numpy = both(chain, 1.0, inputs={"u": lambda time: time}, step_size=0.05)
    assert difference(native, numpy) == 0
    assert (native["first"] == native["second"]).all()
    assert native["first"].values[-1] == pytest.approx(1.0)


def test_first_declared_transition_wins() -> None:
    x, mode = symbols("x", "mode")
    block = Block(
        "race",
        states=(State("x", derivative=sp.S.One),),
        modes=(Mode("mode", start=0),),
        outputs=(Output("m", expression=mode),),
        transitions=(
            Transition("first", sp.And(sp.Eq(mode, 0), x > 0.45), {mode: sp.Integer(1)}),
            Transition("second", sp.And(sp.Eq(mode, 0), x > 0.45), {mode: sp.Integer(2)}),
        ),
    )
    native, numpy = both(block, 1.0, step_size=0.1)
    assert difference(native, numpy) == 0
    assert native["m"].values[-1] == 1


def test_minimum_maximum_absolute_value_and_sign() -> None:
    t = br.blocks.TIME
    wave = sp.sin(5 * t)
    block = Block(
        "switching",
        outputs=(
            Output("absolute", expression=sp.Abs(wave)),
            Output("sign", expression=sp.sign(wave)),
            Output("largest", expression=sp.Max(wave, sp.cos(3 * t), 0.2)),
            Output("smallest", expression=sp.Min(wave, sp.cos(3 * t), 0.2)),
            Output("high", expression=wave >= 0.5),
        ),
    )
    native, numpy = both(block, 2.0, step_size=0.01)
    assert difference(native, numpy) < 1e-15
    s, c = np.sin(5 * native["time"].values), np.cos(3 * native["time"].values)
    assert native["absolute"].values == pytest.approx(abs(s), abs=1e-15)
    assert (native["sign"].values == np.sign(s)).all()
    assert native["largest"].values == pytest.approx(np.maximum(np.maximum(s, c), 0.2), abs=1e-15)
    assert native["smallest"].values == pytest.approx(np.minimum(np.minimum(s, c), 0.2), abs=1e-15)
    assert (native["high"].values == (s >= 0.5)).all() and native["high"].dtype == bool


def test_rk4_has_order_four() -> None:
    loop = br.blocks.closed_loop(br.blocks.pole_placement())
    reference = br.simulate(loop, 0.5, step_size=1 / 64000)
    errors = []
    for steps in (1000, 2000, 4000):
        result = br.simulate(loop, 0.5, step_size=1 / steps)
        errors.append(abs(float(result["x"][-1] - reference["x"][-1])))
    orders = np.diff(-np.log2(errors))
    assert orders == pytest.approx(4, abs=0.35)


def test_substeps_are_the_ceiling_of_the_step_over_step_size() -> None:
    """x' = x over one step of 0.1 with step_size 0.03 is four equal substeps of RK4."""
    x = symbols("x")[0]
    block = Block("growth", states=(State("x", derivative=x, start=sp.S.One),), outputs=(Output("x", expression=x),))
    h = 0.1 / 4
    factor = 1 + h + h**2 / 2 + h**3 / 6 + h**4 / 24
    for engine in (NativeEngine(block, 0.03), NumpyEngine(block, 0.03)):
        engine.initialize()
        engine.advance(0.1)
        assert engine.states[0] == pytest.approx(factor**4, rel=1e-15)


def test_instances_do_not_disturb_each_other() -> None:
    loop = br.blocks.closed_loop()
    alone = br.simulate(loop, 0.05)
    engines = [NativeEngine(loop) for _ in range(20)]
    for index, engine in enumerate(engines):
        engine.set_parameters({"x_start": 2.5 + 0.1 * index})
        engine.initialize()
    for _ in range(50):
        for engine in engines:
            engine.advance(1e-3)
    assert engines[0].outputs()[0] == alone["x"].values[-1]
    assert len({engine.outputs()[0] for engine in engines}) == 20


@pytest.mark.parametrize("engine", ["native", "numpy"])
def test_start_at_rest_without_guard_names_the_singularity(engine: str) -> None:
    with pytest.raises(SimulationError, match=r"u\[2\].*t = 0 s.*singular at eta\[1\] = 0.*eta_min > 0") as caught:
        br.simulate(
            br.blocks.closed_loop(),
            1.0,
            parameters={"eta_start[1]": 0.0, "eta_min": 0.0},
            engine=engine,  # type: ignore
        )
    assert caught.value.reason == "singular" and caught.value.trajectory.sizes["time"] == 0


@pytest.mark.parametrize("engine", ["native", "numpy"])
def test_a_step_into_the_singularity_names_it(engine: str) -> None:
    """From eta[1] = 0.05 with u[1] = -100 and v = 0 the middle of the first step is at eta[1] = 0, its start is not."""
    with pytest.raises(
        SimulationError, match=r"not finite after the step at t = 0 s: .*singular at eta\[1\] = 0"
    ) as caught:
        br.simulate(
            br.blocks.linearized_robot(),
            0.01,
            parameters={"eta_start[1]": 0.05, "u_start[1]": -100.0, "eta_min": 0.0},
            engine=engine,  # type: ignore
        )
    assert caught.value.reason == "singular"


@pytest.mark.parametrize("engine", ["native", "numpy"])
def test_divergence_keeps_what_was_simulated(engine: str) -> None:
    x = symbols("x")[0]
    block = Block("blowup", states=(State("x", derivative=x**2, start=sp.S.One),), outputs=(Output("x", expression=x),))
    with pytest.raises(SimulationError, match=r"blowup: (der\(x\)|x) is not finite") as caught:
        br.simulate(block, 5.0, step_size=0.01, engine=engine)  # type: ignore
    kept = caught.value.trajectory
    assert 1.0 < caught.value.time < 1.3 and caught.value.reason == "diverged"
    assert kept["time"].values[-1] == pytest.approx(caught.value.time) and np.isfinite(kept["x"]).all()


def test_nested_switching_is_evaluated_inside_out() -> None:
    t = br.blocks.TIME
    inner = sp.Piecewise((t - 0.5, t > 0.3), (-1, True))
    block = Block("nested", outputs=(Output("y", expression=sp.Piecewise((1, inner > 0), (0, True))),))
    native, numpy = both(block, 1.0, step_size=0.01)
    assert difference(native, numpy) == 0
    assert (native["y"].values == (native["time"].values > 0.5)).all()


def test_parameter_only_relations_are_no_indicators() -> None:
    loop = br.blocks.closed_loop()
    assert len(loop.indicators) == 6  # two a chain at the edges of the boundary layer, two at the singularity
    assert not any(str(one) == "phi" for one in loop.indicators)


def test_symbols_of_parameters_reach_the_c_code_by_position() -> None:
    a, b = symbols("a", "b")
    block = Block(
        "positions",
        parameters=(Parameter("a", value=2.0), Parameter("b", value=3.0)),
        outputs=(Output("y", expression=a - 10 * b),),
    )
    assert br.simulate(block, 0.1, step_size=0.1, parameters={"b": 5.0})["y"].values[0] == 2.0 - 50.0


@pytest.mark.parametrize("engine", [NativeEngine, NumpyEngine])
def test_a_step_that_would_not_end_is_refused(engine: type, sampled_integrator: Block) -> None:
    instance = engine(sampled_integrator, 0.01)
    instance.initialize()
    with pytest.raises(SimulationError, match="step_size is too small: the step would take over a billion substeps"):
        instance.advance(1e12)
    assert instance.time == 0.0


@pytest.mark.parametrize("engine", [NativeEngine, NumpyEngine])
def test_a_long_period_does_not_make_a_sample_early(engine: type, sampled_integrator: Block) -> None:
    """Rounding of time is forgiven by the step, not by the period: an hour does not fall 2 ms early."""
    instance = engine(sampled_integrator, 1000.0)
    instance.set_parameters({"T": 3600.0})
    instance.initialize()
    instance.inputs[0] = 1.0
    for length, total in ((3599.998, 0.0), (1e-4, 0.0), (2.0, 3600.0)):
        instance.advance(length)
        assert instance.samples[0] == total
