"""The four forms of the sliding-mode controller, in every way that FMI 3 runs them, against their native simulation."""

from ctypes import CFUNCTYPE, c_double, c_int, c_uint
from functools import partial

import numpy as np
import pytest
from fmi3_masters import in_event_mode, in_model_exchange, in_scheduled_execution, initialize, read, tick, write

import brunovsky as br
from brunovsky.blocks import Block, Clock, Input, Output, Sample, library, symbols
from brunovsky.fmi.instances import FMU3ScheduledComponent

PERIOD = 0.01
TIMES = [index * PERIOD for index in range(101)]
INPUTS = {
    "Z1[1]": lambda t: 0.1 * np.cos(8 * t),
    "Z1[2]": lambda t: -0.8 * np.sin(8 * t),
    "Z1[3]": lambda t: -6.4 * np.cos(8 * t),
    "Z2[1]": lambda t: 0.05 * np.sin(2 * t),
    "Z2[3]": lambda t: -0.2 * np.sin(2 * t),
    "zd3[2]": lambda t: 0.1 * t,
}
AT_START = {name: signal(0.0) for name, signal in INPUTS.items()}  # of the first sample, which ends initialization
OUTPUTS = ["v[1]", "v[2]", "S[1]", "S[2]"]
FORMS = {
    "sliding_mode": (library.sliding_mode, {}),
    "sliding_mode_relay": (library.sliding_mode_relay, {"dwell": 0.4551}),
    "sliding_mode_sampled": (library.sliding_mode_sampled, {"sampling_period": 0.03}),
    "sliding_mode_clocked": (library.sliding_mode_clocked, {"sampling_period": PERIOD}),
}


def _native(name: str, step_size: float = PERIOD) -> np.ndarray:
    make, values = FORMS[name]
    data = br.simulate(
        make(), TIMES[-1], step_size=step_size, parameters=values, inputs=INPUTS, solver="dormand_prince"
    )
    return np.column_stack([data[one] for one in OUTPUTS])


@pytest.mark.parametrize("name", FORMS)
@pytest.mark.parametrize("early", [False, True])
def test_every_form_in_event_mode(name, early):
    make, values = FORMS[name]
    block = make()
    clocks = [one.name for one in block.clocks]
    with br.component(block, 3, event_mode_used=True, early_return_allowed=early) as one:
        initialize(one, values | AT_START, solver=2 if block.states else None, tolerance=1e-6)
        rows, events = in_event_mode(one, TIMES, INPUTS, OUTPUTS, clocks)
    expected = _native(name)
    assert np.ptp(expected, axis=0).min() > 1e-3
    np.testing.assert_allclose(rows, expected, rtol=1e-12, atol=1e-12)
    assert bool(events) == (early and name == "sliding_mode_relay")  # a dwell ends between communication points


@pytest.mark.parametrize("name", FORMS)
def test_every_form_without_event_mode(name):
    """Clocks that nobody drives tick by themselves; outputs after a step show what was before the events of its end."""
    make, values = FORMS[name]
    block = make()
    with br.component(block, 3) as one:
        initialize(one, values | AT_START, solver=2 if block.states else None, tolerance=1e-6)
        rows = []
        for time in TIMES[:-1]:
            write(one, {key: signal(time) for key, signal in INPUTS.items()})
            one.doStep(time, PERIOD)
            rows.append(read(one, OUTPUTS[:2]))
    held = _native(name)[:-1, :2]  # what the events at the beginning of each step set holds at its end
    if name == "sliding_mode_relay":  # but for relays whose dwell ends within a step
        assert np.mean(np.isclose(rows, held, rtol=1e-12, atol=1e-12)) > 0.9
    else:
        np.testing.assert_allclose(rows, held, rtol=1e-12, atol=1e-12)


def test_the_clocked_form_in_model_exchange():
    with br.component(library.sliding_mode_clocked(), 3, "ModelExchange") as one:
        initialize(one)
        rows = in_model_exchange(one, TIMES, INPUTS, OUTPUTS, ["sampling"])
    np.testing.assert_array_equal(rows, _native("sliding_mode_clocked"))


def test_the_clocked_form_in_scheduled_execution():
    with br.component(library.sliding_mode_clocked(), 3, "ScheduledExecution") as one:
        initialize(one)
        rows = in_scheduled_execution(one, TIMES, INPUTS, OUTPUTS, "sampling")
    np.testing.assert_array_equal(rows, _native("sliding_mode_clocked"))


@pytest.fixture
def ticking():
    with br.component(library.sliding_mode_clocked(), 3, event_mode_used=True) as one:
        initialize(one, {"Z1[1]": 0.001})
        yield one


def test_between_ticks_the_law_is_held(ticking):
    tick(ticking, ["sampling"])
    ticking.updateDiscreteStates()
    held = read(ticking, ["v[1]"])
    assert held[0] != 0
    ticking.enterStepMode()
    write(ticking, {"Z1[1]": -0.002})
    ticking.doStep(0.0, 0.005)
    assert read(ticking, ["v[1]"]) == held
    ticking.enterEventMode()
    ticking.updateDiscreteStates()  # without a tick
    assert read(ticking, ["v[1]"]) == held


def test_while_a_clock_ticks_outputs_follow_the_inputs(ticking):
    assert read(ticking, ["v[1]"]) == [0.0]
    tick(ticking, ["sampling"])
    assert ticking.getClock([ticking.references["sampling"]]) == [True]
    first = read(ticking, ["v[1]"])
    write(ticking, {"Z1[1]": 0.002})
    second = read(ticking, ["v[1]"])
    assert len({0.0, *first, *second}) == 3
    write(ticking, {"Z1[1]": 0.001})
    assert read(ticking, ["v[1]"]) == first
    ticking.updateDiscreteStates()
    assert read(ticking, ["v[1]"]) == first
    assert ticking.getClock([ticking.references["sampling"]]) == [False]


def test_a_tick_can_be_taken_back(ticking):
    tick(ticking, ["sampling"])
    assert read(ticking, ["v[1]"]) != [0.0]
    tick(ticking, ["sampling"], active=False)
    assert read(ticking, ["v[1]"]) == [0.0]
    ticking.updateDiscreteStates()
    assert read(ticking, ["v[1]"]) == [0.0]


def test_a_state_saved_during_a_tick_restores_it(ticking):
    tick(ticking, ["sampling"])
    law = read(ticking, ["v[1]"])
    state = ticking.getFMUState()
    ticking.updateDiscreteStates()
    write(ticking, {"Z1[1]": 0.003})
    tick(ticking, ["sampling"])
    ticking.updateDiscreteStates()
    ticking.setFMUState(state)
    assert ticking.getClock([ticking.references["sampling"]]) == [True]
    ticking.updateDiscreteStates()
    assert read(ticking, ["v[1]"]) == law
    ticking.freeFMUState(state)


def test_a_state_goes_on_in_a_fresh_instance(ticking):
    """Between ticks the law is held there too, through instants at which the period would sample it."""
    tick(ticking, ["sampling"])
    ticking.updateDiscreteStates()
    ticking.enterStepMode()
    ticking.doStep(0.0, 0.015)
    law, state = read(ticking, ["v[1]"]), ticking.serializeFMUState(ticking.getFMUState())
    with br.component(library.sliding_mode_clocked(), 3, event_mode_used=True) as fresh:
        fresh.setFMUState(fresh.deserializeFMUState(state))
        write(fresh, {"Z1[1]": 0.01})
        fresh.doStep(0.015, 0.05)
        assert read(fresh, ["v[1]", "time"]) == [*law, 0.065]
        fresh.enterEventMode()
        tick(fresh, ["sampling"])
        fresh.updateDiscreteStates()
        assert read(fresh, ["v[1]"]) != law


def test_derivatives_of_the_law_are_those_of_the_tick(ticking):
    law, error = [ticking.references["v[1]"]], [ticking.references[one] for one in ("Z1[1]", "Z1[3]", "zd3[1]")]
    assert ticking.getDirectionalDerivative(law, error, [1.0, 1.0, 1.0]) == [0.0]
    tick(ticking, ["sampling"])
    found = ticking.getAdjointDerivative(law, error, [1.0])
    for name, derivative, seed in zip(("Z1[1]", "Z1[3]", "zd3[1]"), found, np.eye(3), strict=True):
        assert ticking.getDirectionalDerivative(law, error, list(seed)) == [derivative]
        value = read(ticking, [name])[0]
        ends = []
        for step in (-1e-6, 1e-6):
            write(ticking, {name: value + step})
            ends += read(ticking, ["v[1]"])
        write(ticking, {name: value})
        assert derivative == pytest.approx((ends[1] - ends[0]) / 2e-6, rel=1e-6)
    assert found[0] != 0 and found[2] == pytest.approx(1.0)
    ticking.updateDiscreteStates()
    assert ticking.getDirectionalDerivative(law, error, [1.0, 1.0, 1.0]) == [0.0]


@pytest.fixture
def timed_and_clocked():
    a, b, u = symbols("a", "b", "u")
    return Block(
        "timed_and_clocked",
        inputs=(Input("u"),),
        clocks=(Clock("tick", period=0.1),),
        samples=(Sample("a", update=u, period=0.1), Sample("b", update=u, clock="tick")),
        outputs=(Output("a", expression=a), Output("b", expression=b)),
    )


def test_derivatives_after_a_tick_know_nothing_of_it(timed_and_clocked):
    """A reset during a tick: the sample that initialization takes at its period is held afterwards."""
    with br.component(timed_and_clocked, 3, event_mode_used=True) as one:
        unknowns, known = [one.references["a"], one.references["b"]], [one.references["u"]]
        initialize(one)
        tick(one, ["tick"])
        assert one.getDirectionalDerivative(unknowns, known, [1.0]) == [0.0, 1.0]
        one.reset()
        one.enterInitializationMode()
        assert one.getDirectionalDerivative(unknowns, known, [1.0]) == [1.0, 0.0]
        one.exitInitializationMode()
        assert one.getDirectionalDerivative(unknowns, known, [1.0]) == [0.0, 0.0]


def test_the_law_depends_on_what_it_samples_and_on_the_clock(ticking):
    structure = ticking.model_description.outputs
    found = {one.variable.name: {known.name for known in one.dependencies} for one in structure}
    assert {"Z1[1]", "zd3[1]", "sampling", "P", "sampling_period"} <= found["v[1]"]
    assert not {"Z2[1]", "zd3[2]"} & found["v[1]"]


def test_the_interval_is_that_of_the_parameter():
    with br.component(library.sliding_mode_clocked(), 3, event_mode_used=True) as one:
        reference, interval, qualifier = (c_uint * 1)(one.references["sampling"]), (c_double * 1)(), (c_int * 1)()
        one.setIntervalDecimal(reference, (c_double * 1)(0.02))
        one.enterInitializationMode()
        one.getIntervalDecimal(reference, interval, qualifier)
        assert interval[0] == 0.02
        assert qualifier[0] == 1  # fmi3IntervalUnchanged: the importer sets it
        assert read(one, ["sampling_period"]) == [0.02]
        with pytest.raises(br.BrunovskyError, match="out of its range"):
            one.setIntervalDecimal(reference, (c_double * 1)(-1.0))
        one.exitInitializationMode()
        with pytest.raises(br.BrunovskyError, match="in event mode"):
            one.setIntervalDecimal(reference, (c_double * 1)(0.03))


def test_scheduled_execution_goes_forward_only():
    with br.component(library.sliding_mode_clocked(), 3, "ScheduledExecution") as one:
        initialize(one, {"Z1[1]": 0.001}, start=1.0)
        clock = one.references["sampling"]
        for wrong in (0.5, float("nan"), float("inf")):
            with pytest.raises(br.BrunovskyError, match="later"):
                one.activateModelPartition(clock, wrong)
        one.activateModelPartition(clock, 1.0)
        law = read(one, ["v[1]"])
        with pytest.raises(br.BrunovskyError, match="later"):
            one.activateModelPartition(clock, 1.0)
        assert read(one, ["v[1]"]) == law
        with pytest.raises(br.BrunovskyError, match="not Clock"):
            one.activateModelPartition(one.references["Z1[1]"], 2.0)
        one.terminate()


def test_a_partition_is_not_interrupted():
    """Every call that uses the memory of the instance is between the master's lock and unlock, failed ones too."""
    calls = []
    lock, unlock = (CFUNCTYPE(None)(partial(calls.append, name)) for name in ("lock", "unlock"))
    with br.component(library.sliding_mode_clocked(), 3, "ScheduledExecution") as one:
        own, token = one.component, one.model_description.instantiationToken.encode()
        options = (b"two", token, b"", False, False, None, one.logMessage, one.clockUpdate, lock, unlock)
        one.component = one.fmi3InstantiateScheduledExecution(*options)
        initialize(one, {"Z1[1]": 0.001})
        for call in (
            lambda: write(one, {"Z1[1]": 0.002}),
            lambda: one.activateModelPartition(one.references["sampling"], 0.0),
            lambda: read(one, ["v[1]"]),
            lambda: one.getDirectionalDerivative([one.references["v[1]"]], [one.references["Z1[1]"]], [1.0]),
        ):
            calls.clear()
            call()
            assert calls == ["lock", "unlock"]
        calls.clear()
        with pytest.raises(br.BrunovskyError, match="later"):
            one.activateModelPartition(one.references["sampling"], 0.0)
        with pytest.raises(br.BrunovskyError, match="not finite"):
            write(one, {"Z1[1]": float("nan")})
        assert calls == ["lock", "unlock"] * 2
        one.fmi3FreeInstance(one.component)
        one.component = own


def test_scheduled_execution_is_for_clocks_alone(timed_and_clocked):
    with pytest.raises(Exception, match="Failed to instantiate"):
        FMU3ScheduledComponent(timed_and_clocked)


def test_clock_functions_are_refused_outside_event_mode():
    with br.component(library.sliding_mode_clocked(), 3) as one:
        initialize(one)
        with pytest.raises(br.BrunovskyError, match="not allowed"):
            tick(one, ["sampling"])
