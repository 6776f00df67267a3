"""The relay with hysteresis and dwell time in model exchange: its switches are those of the native simulation."""

import sys
from pathlib import Path

import fmpy
import numpy as np
import pytest

from brunovsky.fmi import ComponentError, component
from brunovsky.native import simulate

sys.path.append(str(Path(__file__).parents[1] / "blocks"))
from outer_loop_cases import SURFACE, B, chain_plant, chain_reference

TIMER = "controller.timer[1]"


@pytest.fixture(scope="module")
def loop(exported):
    law = B.sliding_mode_relay(chain_plant(), SURFACE, P=20.0)
    return exported(B.closed_loop(law, plant=chain_plant(), reference=chain_reference(), name="relay_chain"))


def exchanged(loop, end, **options):
    return fmpy.simulate_fmu(
        str(loop.fmu), fmi_type="ModelExchange", stop_time=end, output_interval=1e-3, relative_tolerance=1e-9, **options
    )


def switches(time, timer):
    """Instants at which the relay switched, from the time that has passed since."""
    began = time - timer
    began = began[began > 1e-9]
    return began[np.diff(began, prepend=-1.0) > 1e-6]


@pytest.mark.parametrize(
    ("values", "count"),
    [
        ({"hysteresis": 0.5, "dwell": 0.0}, 32),
        ({"hysteresis": 0.02, "dwell": 0.0}, 802),
        ({"hysteresis": 0.0, "dwell": 0.05}, 33),
        ({"hysteresis": 0.1, "dwell": 0.03}, 54),
        ({"hysteresis": 0.2, "dwell": 0.005}, 80),
    ],
)
def test_switches_are_those_of_the_native_simulation(loop, values, count):
    native = simulate(loop.block, 2.0, solver="dormand_prince", tolerance=1e-10, parameters=values)
    found = exchanged(loop, 2.0, start_values=values, output=["S[1]", "e1[1]", TIMER], record_events=False)
    instants = switches(found["time"], found[TIMER])
    expected = switches(native["time"].values, native[TIMER].values)
    assert len(instants) == len(expected) == count
    np.testing.assert_allclose(instants, expected, rtol=0, atol=1e-6)
    np.testing.assert_allclose(found["e1[1]"], native["e1[1]"], rtol=0, atol=1e-7)
    assert np.diff(instants).min() > values["dwell"] - 1e-9
    if not values["dwell"]:
        assert abs(found["S[1]"][found["time"] > 1.0]).max() <= values["hysteresis"] + 1e-6


def test_both_relays_of_the_robot_switch_as_in_the_native_simulation(exported):
    loop = exported(B.closed_loop(B.sliding_mode_relay(), name="relay_robot"))
    timers = ["controller.timer[1]", "controller.timer[2]"]
    native = simulate(loop.block, 2.0, solver="dormand_prince", tolerance=1e-10)
    found = exchanged(loop, 2.0, output=["x", *timers], record_events=False)
    for timer in timers:
        instants, expected = (
            switches(found["time"], found[timer]),
            switches(native["time"].values, native[timer].values),
        )
        assert len(instants) == len(expected) >= 15
        np.testing.assert_allclose(instants, expected, rtol=0, atol=1e-6)
    np.testing.assert_allclose(found["x"], native["x"], rtol=0, atol=1e-7)


def test_chatter_ends_by_the_dwell_time_alone(loop):
    """Two events a switch: the switch, and the end of the time for which it is kept."""
    dwell, end = 0.01, 1.0
    found = exchanged(loop, end, start_values={"hysteresis": 0.0, "dwell": dwell}, record_events=True)
    events = (len(found) - (round(end / 1e-3) + 1)) / 2
    assert found["time"][-1] == pytest.approx(end)
    assert 50 < events <= 2 * (end / dwell + 1)
    assert set(np.unique(found["relay[1]"])) == {-1, 1}


@pytest.mark.parametrize("values", [{"hysteresis": 0.0}, {"hysteresis": 1e-14}, {"hysteresis": 0.0, "dwell": 1e-9}])
def test_a_relay_that_would_chatter_without_end_is_refused(loop, values):
    with component(loop.block, 2, "ModelExchange") as one:
        one.setupExperiment()
        one.enterInitializationMode()
        one.setReal([one.references[name] for name in values], list(values.values()))
        with pytest.raises(ComponentError, match=r"more than once in 1e-06 s.*or use co-simulation"):
            one.exitInitializationMode()


def test_without_a_gain_the_relay_has_nothing_to_chatter_with(loop):
    found = exchanged(loop, 1.0, start_values={"P": 0.0, "hysteresis": 0.0})
    assert found["time"][-1] == pytest.approx(1.0)
    assert len(found) < 1001 + 20
