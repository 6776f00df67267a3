"""What is told by log category: the singularity, other events; switched on and off during the run."""

import pytest

import brunovsky as br
from brunovsky.blocks import library
from masters import initialize, write

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
