"""FMI 3 co-simulation with event mode: a step ends at its first event, which the master handles."""

import fmpy
import numpy as np
import pytest
import sympy as sp
from masters import in_event_mode, initialize, read, write

import brunovsky as br
from brunovsky.blocks import Block, Mode, Output, Parameter, State, Transition, library, symbols
from brunovsky.fmi.component import Component

DORMAND_PRINCE = 2
DISCARD, ERROR = 2, 3


@pytest.fixture(scope="module")
def relay_loop() -> Block:
    """An integrator under a relay: it switches at 0.1 s and every 0.2 s after that."""
    x, relay, width = symbols("x", "relay", "width")
    return Block(
        "relay_loop",
        parameters=(Parameter("width", "m", value=0.1),),
        states=(State("x", "m", derivative=-relay),),
        modes=(Mode("relay", "m/s", start=1),),
        outputs=(Output("x", "m", expression=x), Output("speed", "m/s", expression=-relay)),
        transitions=(
            Transition("up", sp.And(sp.Eq(relay, -1), x > width), {relay: sp.S(1)}),
            Transition("down", sp.And(sp.Eq(relay, 1), x < -width), {relay: sp.S(-1)}),
        ),
    )


def _component(block: Block, *, early: bool = True, **options: object) -> Component:
    return br.component(block, 3, event_mode_used=True, early_return_allowed=early, **options)


def test_a_step_returns_early_at_its_first_event_and_leaves_it_to_the_master(relay_loop):
    with _component(relay_loop) as one:
        initialize(one, solver=DORMAND_PRINCE)
        one.updateDiscreteStates()
        one.enterStepMode()
        needed, terminate, early, reached = one.doStep(0.0, 1.0)
        assert (needed, terminate, early) == (True, False, True)
        assert reached == pytest.approx(0.1, abs=1e-8)
        assert read(one, ["x", "speed", "time"]) == pytest.approx([-0.1, -1.0, reached], abs=1e-8)
        one.enterEventMode()
        changed = one.updateDiscreteStates()
        assert changed == (False, False, False, False, False, 0.0)
        assert read(one, ["speed"]) == [1.0]
        one.enterStepMode()
        assert one.doStep(reached, 0.15) == (False, False, False, pytest.approx(reached + 0.15))


def test_the_event_that_the_master_does_not_handle_is_handled_by_the_next_step(relay_loop):
    with _component(relay_loop) as one:
        initialize(one, solver=DORMAND_PRINCE)
        one.updateDiscreteStates()
        one.enterStepMode()
        reached = one.doStep(0.0, 1.0)[3]
        one.doStep(reached, 0.1)
        assert read(one, ["x", "speed"]) == pytest.approx([0.0, 1.0], abs=1e-7)


def test_without_early_return_events_within_a_step_are_handled_there(relay_loop):
    with _component(relay_loop, early=False) as one:
        initialize(one, solver=DORMAND_PRINCE)
        one.updateDiscreteStates()
        one.enterStepMode()
        assert one.doStep(0.0, 1.0) == (False, False, False, 1.0)
        assert read(one, ["x", "speed"]) == pytest.approx([0.0, 1.0], abs=1e-7)


def test_events_that_do_not_end_are_an_error_though_each_step_ends_at_one():
    with _component(library.closed_loop()) as one:
        initialize(one, {"phi": 0.0}, solver=DORMAND_PRINCE, start=-10.0)
        one.updateDiscreteStates()
        one.enterStepMode()
        times = [-10.0]
        with pytest.raises(br.BrunovskyError, match="events do not end: over 200 within") as caught:
            while len(times) < 1000:
                times.append(one.doStep(times[-1], 0.01)[3])
                one.enterEventMode()
                one.updateDiscreteStates()
                one.enterStepMode()
        assert caught.value.status == DISCARD
        time = times[-1]
        assert time > -9.0
        assert time - times[-200] < 1e-6
        write(one, {"phi": 0.05})
        assert one.doStep(time, 0.01)[3] == pytest.approx(time + 0.01)


@pytest.mark.parametrize("solver", [1, DORMAND_PRINCE])
def test_events_come_at_the_instants_of_the_native_simulation(relay_loop, solver):
    times = [0.0, 0.35, 0.5, 1.3]
    with _component(relay_loop) as one:
        initialize(one, {"width": 0.1005}, solver=solver)
        rows, events = in_event_mode(one, times, {}, ["x", "speed"])
    exact = 0.1005 + 0.201 * np.arange(6)
    assert len(events) == 6
    lateness = np.array(events) - exact
    assert (lateness >= -1e-12).all()
    assert lateness.max() <= (1e-7 if solver == DORMAND_PRINCE else 7e-3)  # RK4: a substep after each crossing adds up
    assert rows[-1][0] == pytest.approx(0.1005 - (1.3 - exact[-1]), abs=1e-6 if solver == DORMAND_PRINCE else 1e-2)


def test_a_sample_due_at_the_end_of_a_step_is_an_event_there(sampled_integrator):
    with _component(sampled_integrator) as one:
        initialize(one, {"T": 0.07, "u": 1.0})
        *_, defined, following = one.updateDiscreteStates()
        assert defined and following == pytest.approx(0.07)
        one.enterStepMode()
        assert one.doStep(0.0, 0.05) == (False, False, False, 0.05)
        assert one.doStep(0.05, 0.05) == (True, False, True, pytest.approx(0.07))
        before = read(one, [*one.block.feedthrough])
        one.enterEventMode()
        *_, defined, following = one.updateDiscreteStates()
        assert defined and following == pytest.approx(0.14)
        assert read(one, [*one.block.feedthrough]) != before
        one.enterStepMode()
        needed, _, early, reached = one.doStep(0.07, 0.07)
        assert (needed, early, reached) == (True, False, pytest.approx(0.14))


@pytest.mark.parametrize("early", [False, True])
def test_the_whole_loop_in_fmpys_event_mode(early, tmp_path):
    block = library.closed_loop()
    fmu = br.export_fmu(block, tmp_path / "loop.fmu", fmi_version=3)
    options = {"fmi_type": "CoSimulation", "stop_time": 2.0, "output_interval": 0.01}
    found = fmpy.simulate_fmu(str(fmu), use_event_mode=True, early_return_allowed=early, **options)
    data = br.simulate(block, 2.0, step_size=1e-3)
    last = dict(zip(found.dtype.names, found[-1], strict=True))
    for name in ("x", "y", "theta", "eta[1]", "eta[2]"):
        assert last[name] == pytest.approx(float(data[name][-1]), abs=2e-6), name


def test_inputs_that_change_a_relation_between_steps_wait_for_event_mode(sampled_integrator):
    """Between steps relations are frozen, so that a Boolean output changes in event mode only."""
    u, x = symbols("u", "x")
    block = Block(
        "gate",
        inputs=(br.blocks.Input("u"),),
        states=(State("x", derivative=u),),
        outputs=(Output("open", expression=u > 1), Output("x", expression=x)),
    )
    with _component(block) as one:
        initialize(one)
        one.updateDiscreteStates()
        one.enterStepMode()
        write(one, {"u": 2.0})
        assert one.getBoolean([one.references["open"]]) == [False]
        one.enterEventMode()
        one.updateDiscreteStates()
        assert one.getBoolean([one.references["open"]]) == [True]


def test_a_step_into_the_singularity_is_discarded_and_undone():
    step = 2.0**-10  # so that eta[1] is zero without rounding after two internal steps
    start = {"eta_min": 0.0, "eta_start[1]": 2 * step, "eta_start[2]": 0.0, "u_start[1]": -1.0, "step_size": step}
    with br.component(library.linearized_robot(), 3) as one:
        initialize(one, start)
        one.doStep(0.0, step)
        state = one.serializeFMUState(one.getFMUState())
        with pytest.raises(br.BrunovskyError, match=r"singular at eta\[1\] = 0") as caught:
            one.doStep(step, 4 * step)
        assert caught.value.status == DISCARD
        assert one.serializeFMUState(one.getFMUState()) == state
        write(one, {"v[1]": 9e3})
        assert one.doStep(step, step / 2)[3] == 1.5 * step


def test_at_rest_without_a_guard_initialization_cannot_end():
    with br.component(library.linearized_robot(), 3) as one:
        one.enterInitializationMode()
        write(one, {"eta_min": 0.0, "eta_start[1]": 0.0})
        with pytest.raises(br.BrunovskyError, match=r"singular at eta\[1\] = 0") as caught:
            one.exitInitializationMode()
        assert caught.value.status == ERROR
        write(one, {"eta_start[1]": 0.1})
        one.exitInitializationMode()


@pytest.mark.parametrize("length", [0.0, -0.1, float("nan"), float("inf"), 1e-20])
def test_a_step_that_is_no_step_is_an_error(length):
    with br.component(library.linearized_robot(), 3) as one:
        initialize(one)
        one.doStep(0.0, 0.5)
        with pytest.raises(br.BrunovskyError, match="communication step of") as caught:
            one.doStep(0.5, length)
        assert caught.value.status == ERROR
        assert one.doStep(0.5, 0.5)[3] == 1.0
