"""FMI 3 co-simulation: the master is asked after each internal step, sets inputs there, and may end the step."""

import numpy as np
import pytest
from masters import initialize, read, write

import brunovsky as br
from brunovsky.blocks import Block, Input, Output, State, library, symbols

STEP_SIZE = 1e-3
DORMAND_PRINCE = 2


@pytest.fixture(scope="module")
def integrator() -> Block:
    x, u = symbols("x", "u")
    return Block(
        "integrator",
        inputs=(Input("u", "m/s"),),
        states=(State("x", "m", derivative=u),),
        outputs=(Output("x", "m", expression=x), Output("speed", "m/s", expression=u)),
    )


class Master:
    """Notes each call, and does then what ``act`` says."""

    def __init__(self, act=lambda one, time, early, until: None):
        self.act = act
        self.times: list[float] = []
        self.flags: set[tuple[bool, ...]] = set()
        self.one = None

    def update(self, _environment, time, setting, getting, finished, can_return, early, until):
        self.times.append(time)
        self.flags.add((setting, getting, finished, can_return))
        self.act(self.one, time, early, until)

    def component(self, block: Block, *, early: bool = False, **options: object):
        self.one = br.component(block, 3, intermediate_update=self.update, early_return_allowed=early, **options)
        return self.one


def test_every_internal_step_is_reported(integrator):
    master = Master()
    with master.component(integrator) as one:
        initialize(one, {"u": 1.0})
        one.doStep(0.0, 0.01)
    assert master.times == pytest.approx(np.arange(1, 11) * STEP_SIZE)
    assert master.flags == {(True, True, True, False)}


def test_outputs_within_a_step_are_those_of_the_time_reached(integrator):
    seen = []
    master = Master(lambda one, time, early, until: seen.append((time, *read(one, ["x", "time"]))))
    with master.component(integrator) as one:
        initialize(one, {"u": 2.0})
        one.doStep(0.0, 0.01)
    assert [x for _, x, _ in seen] == pytest.approx([2 * time for time, _, _ in seen])
    assert [now for *_, now in seen] == [time for time, _, _ in seen]


@pytest.mark.parametrize("solver", [1, DORMAND_PRINCE])
def test_inputs_set_within_a_step_act_from_there_on(integrator, solver):
    """Steps of 0.5 s with the input renewed after each internal step, against the input held over them."""
    errors = {}
    for renew in (False, True):
        act = (lambda one, time, early, until: write(one, {"u": np.cos(time)})) if renew else (lambda *_: None)
        with Master(act).component(integrator) as one:
            initialize(one, {"u": 1.0}, solver=solver)
            for start in (0.0, 0.5):
                write(one, {"u": np.cos(start)})
                one.doStep(start, 0.5)
            errors[renew] = abs(read(one, ["x"])[0] - np.sin(1.0))
    assert errors[False] > 0.05
    assert errors[True] < (1e-3 if solver == 1 else errors[False])


def test_the_master_ends_a_step_where_it_is(integrator):
    def stop(one, time, early, until):
        if time > 0.0045:
            early[0], until[0] = True, time

    with Master(stop).component(integrator, early=True) as one:
        initialize(one, {"u": 1.0})
        assert one.doStep(0.0, 1.0) == (False, False, True, pytest.approx(0.005))
        assert read(one, ["x"])[0] == pytest.approx(0.005)
        assert one.doStep(0.005, 0.0005)[3] == pytest.approx(0.0055)


def test_the_master_ends_a_step_at_a_later_time(integrator):
    def stop(one, time, early, until):
        early[0], until[0] = True, 0.00725

    master = Master(stop)
    with master.component(integrator, early=True) as one:
        initialize(one, {"u": 1.0})
        assert one.doStep(0.0, 1.0) == (False, False, True, pytest.approx(0.00725, abs=1e-15))
        assert read(one, ["x"])[0] == pytest.approx(0.00725)


def test_the_master_cannot_end_a_step_if_that_was_not_agreed(integrator):
    def stop(one, time, early, until):
        early[0], until[0] = True, time

    with Master(stop).component(integrator) as one:
        initialize(one)
        assert one.doStep(0.0, 0.01) == (False, False, False, 0.01)


def test_what_is_not_allowed_within_a_step_is_refused(integrator):
    refused = []

    def misbehave(one, time, early, until):
        for call in (
            lambda: one.doStep(time, 0.1),
            lambda: one.reset(),
            lambda: one.getFMUState(),
            lambda: one.terminate(),
            lambda: write(one, {"step_size": 0.1}),
            lambda: write(one, {"u": float("nan")}),
        ):
            with pytest.raises(br.BrunovskyError) as caught:
                call()
            refused.append(str(caught.value))

    with Master(misbehave).component(integrator) as one:
        initialize(one, {"u": 1.0})
        one.doStep(0.0, STEP_SIZE)
        assert read(one, ["x"])[0] == pytest.approx(STEP_SIZE)
    assert len(refused) == 6
    assert all("within a communication step" in text for text in refused[:5]), refused
    assert "not finite" in refused[5]


def test_an_instance_cannot_be_freed_within_its_step(integrator):
    def free(one, time, early, until):
        one.dll.fmi3FreeInstance(one.component)

    with Master(free).component(integrator) as one:
        initialize(one, {"u": 1.0})
        one.doStep(0.0, STEP_SIZE)
        assert "fmi3FreeInstance is not allowed" in str(one.messages)
        assert read(one, ["x"])[0] == pytest.approx(STEP_SIZE)


def test_a_step_that_fails_after_the_master_was_asked_is_undone_whole():
    step = 2.0**-10  # so that eta[1] is zero without rounding after two internal steps
    start = {"eta_min": 0.0, "eta_start[1]": 2 * step, "eta_start[2]": 0.0, "u_start[1]": -1.0, "step_size": step}
    master = Master(lambda one, time, early, until: write(one, {"d[2]": 0.0}))
    with master.component(library.linearized_robot()) as one:
        initialize(one, start)
        state = one.serializeFMUState(one.getFMUState())
        with pytest.raises(br.BrunovskyError, match=r"singular at eta\[1\] = 0"):
            one.doStep(0.0, 8 * step)
        assert master.times == [step]
        assert one.serializeFMUState(one.getFMUState()) == state
