"""What is told by log category: the singularity, other events; switched on and off during the run."""

from ctypes import c_double
from functools import partial

import pytest
import sympy as sp
from masters import initialize, write

import brunovsky as br
from brunovsky.blocks import library

THROUGH_REST = {"eta_start[1]": 0.2, "v[2]": -4.0}  # eta[1] crosses the guard's band from 0.05 to -0.05 m/s


def _told(one) -> list[tuple[str, str]]:
    return [(category, text) for category, text in one.messages if category in ("logSingularity", "logEvents")]


def _through_rest(one, steps=200, length=0.005):
    told = []
    for index in range(steps):
        one.doStep(index * length, length)
        told += _told(one)
    return told


@pytest.mark.parametrize("solver", [1, 2])
@pytest.mark.parametrize("event_mode", [False, True])
def test_the_singularity_is_told_when_it_comes_and_goes(solver, event_mode):
    with br.component(library.linearized_robot(), 3, logging=True, event_mode_used=event_mode) as one:
        initialize(one, THROUGH_REST, solver=solver)
        if event_mode:
            one.updateDiscreteStates()
            one.enterStepMode()
        told = _through_rest(one)
    assert [category for category, _ in told] == ["logSingularity"] * 2
    assert [text.split(" at t")[0] for _, text in told] == ["singular became true", "singular became false"]


def test_the_same_in_fmi_2():
    with br.component(library.linearized_robot(), 2, logging=True) as one:
        one.setupExperiment()
        one.enterInitializationMode()
        one.setReal([one.references[name] for name in THROUGH_REST], list(THROUGH_REST.values()))
        one.exitInitializationMode()
        told = _through_rest(one)
    assert [text.split(" at t")[0] for _, text in told] == ["singular became true", "singular became false"]


def test_a_singular_start_is_told_at_once():
    with br.component(library.linearized_robot(), 3, logging=True) as one:
        initialize(one, {"eta_start[1]": 0.01})
        assert _told(one) == [("logSingularity", "singular became true at t = 0 s")]


def test_categories_are_switched_by_themselves():
    with br.component(library.linearized_robot(), 3) as one:
        initialize(one, THROUGH_REST)
        assert not _through_rest(one, 20)
        one.setDebugLogging(True, ["logEvents"])
        assert not _through_rest_from(one, 20, 60)
        one.setDebugLogging(True, ["logSingularity"])
        assert "singular became" in str(_through_rest_from(one, 60, 200))
        with pytest.raises(br.BrunovskyError, match="no log category 'logColours'"):
            one.setDebugLogging(True, ["logColours"])


def test_what_is_not_listed_is_switched_off():
    with br.component(library.linearized_robot(), 3, logging=True) as one:
        initialize(one, THROUGH_REST)
        one.setDebugLogging(True, ["logEvents"])
        assert not _through_rest(one)


def _through_rest_from(one, first, last, length=0.005):
    told = []
    for index in range(first, last):
        one.doStep(index * length, length)
        told += _told(one)
    return told


def test_a_relay_is_told_as_an_event():
    block = library.sliding_mode_relay()
    with br.component(block, 3, logging=True) as one:
        initialize(one, {"Z1[3]": 1.0})
        one.doStep(0.0, 0.01)
        write(one, {"Z1[3]": -1.0})
        one.doStep(0.01, 0.01)
        assert ("logEvents", "relay[1] changed from 1 to -1 at t = 0.01 s") in _told(one)


@pytest.mark.parametrize("version", [2, 3])
def test_model_exchange_tells_the_singularity_at_its_event(version):
    """The crossing is an indicator's; singular changes in event mode, and is told."""
    with br.component(library.linearized_robot(), version, "ModelExchange", logging=True) as one:
        if version == 2:
            one.setupExperiment()
            one.enterInitializationMode()
        else:
            one.enterInitializationMode()
        one.exitInitializationMode()
        update = one.newDiscreteStates if version == 2 else one.updateDiscreteStates
        update()
        one.enterContinuousTimeMode()
        states, indicators = (c_double * 6)(), (c_double * 2)()
        one.getContinuousStates(states, 6)
        names = [state.name for state in one.block.states]
        signs = []
        for speed in (0.051, 0.049):
            states[names.index("robot.eta[1]" if "robot.eta[1]" in names else "eta[1]")] = speed
            one.setContinuousStates(states, 6)
            one.getEventIndicators(indicators, 2)
            signs.append([value > 0 for value in indicators])
        assert signs == [[True, True], [False, True]]
        needed, _ = one.completedIntegratorStep()
        assert needed and not _told(one)
        one.enterEventMode()
        update()
        assert ("logSingularity", "singular became true at t = 0 s") in _told(one)


@pytest.mark.parametrize("event_mode", [False, True])
def test_what_a_failure_took_back_is_no_change_afterwards(event_mode):
    mode, u = br.blocks.symbols("mode", "u")
    block = br.Block(
        "without_end",
        inputs=(br.blocks.Input("u"),),
        modes=(br.blocks.Mode("mode", start=0),),
        outputs=(br.blocks.Output("shown", expression=mode),),
        transitions=(
            br.blocks.Transition("up", sp.And(sp.Eq(mode, 0), u > 1), {mode: sp.S(1)}),
            br.blocks.Transition("down", sp.And(sp.Eq(mode, 1), u > 2), {mode: sp.S(0)}),
        ),
    )
    with br.component(block, 3, event_mode_used=event_mode, logging=True) as one:
        initialize(one)
        go = one.updateDiscreteStates if event_mode else partial(one.doStep, 0.0, 0.1)
        write(one, {"u": 3.0})
        with pytest.raises(br.BrunovskyError, match="events do not end"):
            go()
        write(one, {"u": 1.5})
        go()
        assert [text for _, text in _told(one) if text.startswith("mode")] == ["mode changed from 0 to 1 at t = 0 s"]
