"""Relay with hysteresis and dwell time: its cycle against the closed form, its memory, its refusals."""

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from outer_loop_cases import SURFACE, B, chain_loop, chain_plant

import brunovsky as br
from brunovsky import analysis
from brunovsky.blocks import NumpyEngine
from brunovsky.errors import ModelError

STEP = 1e-4
RELAY = B.sliding_mode_relay(chain_plant(), SURFACE)


def settled(**options: float) -> xr.Dataset:
    """The last two of four seconds of the chain's loop."""
    loop = chain_loop(B.sliding_mode_relay(chain_plant(), SURFACE, **options))
    data = br.simulate(loop, 4.0, step_size=STEP, record=["S[1]", "relay[1]"])
    return data.isel(time=slice(20000, None))


def switches(data: xr.Dataset) -> np.ndarray:
    """Rows at which the relay has just switched."""
    return np.flatnonzero(np.diff(data["relay[1]"].values)) + 1


@pytest.mark.parametrize(
    "options",
    [
        {"Q": 5.0, "P": 20.0, "hysteresis": 0.2, "dwell": 0.0},
        {"Q": 0.0, "P": 40.0, "hysteresis": 0.3, "dwell": 0.0},
        {"Q": 5.0, "P": 20.0, "hysteresis": 0.0, "dwell": 0.05},
        {"Q": 5.0, "P": 20.0, "hysteresis": 0.1, "dwell": 0.03},
        {"Q": 0.0, "P": 40.0, "hysteresis": 0.1, "dwell": 0.02},
        {"Q": 5.0, "P": 20.0, "hysteresis": 0.2, "dwell": 0.005},
    ],
)
def test_cycle_is_that_of_the_closed_form(options: dict[str, float]) -> None:
    """Each switch is up to one step late, by which S runs on."""
    cycle = analysis.relay_cycle(
        options["P"], options["hysteresis"], reaching_rate=options["Q"], dwell=options["dwell"]
    )
    data = settled(**options)
    at = switches(data)
    times, swings = data["time"].values[at], abs(np.diff(data["S[1]"].values[at]))
    late = 1.1 * STEP * (options["P"] + options["Q"] * cycle.amplitude)
    assert swings / 2 == pytest.approx(np.full(len(swings), cycle.amplitude), abs=late)
    assert np.diff(times).mean() == pytest.approx(cycle.period / 2, abs=1.1 * STEP)
    assert np.diff(times).min() > options["dwell"] - 1e-9
    assert set(np.unique(data["relay[1]"])) == {-1.0, 1.0}


def test_the_relay_switches_at_once_where_the_start_asks_for_it() -> None:
    law = B.sliding_mode_relay(chain_plant(), SURFACE, dwell=10.0)
    for offset, expected in ((1.0, -1), (-1.0, 1)):
        engine = NumpyEngine(chain_loop(law))
        engine.set_parameters({"offset": offset})
        engine.initialize()
        assert engine.modes.tolist() == [expected]


@pytest.mark.parametrize("d", [-15.0, 15.0])
def test_a_matched_disturbance_below_the_gain_stays_within_the_hysteresis(d: float) -> None:
    loop = chain_loop(B.sliding_mode_relay(chain_plant(), SURFACE, P=20.0, hysteresis=0.1, disturbance=15.0))
    data = br.simulate(loop, 4.0, step_size=STEP, inputs={"d": d}).isel(time=slice(20000, None))
    assert abs(data["S[1]"]).max() < 0.1 + 1.1 * STEP * 36.0
    # the relay's mean is the equivalent control
    assert float(data["relay[1]"].mean()) == pytest.approx(d / 20.0, abs=0.03)
    assert abs(data["e1[1]"]).max() < 1.05 * 0.1 / SURFACE[0]


def test_without_hysteresis_and_dwell_it_is_the_sign_function() -> None:
    law = B.sliding_mode_relay(chain_plant(), SURFACE, P=20.0, hysteresis=0.0)
    for endless in ({}, {"hysteresis": 0.9e-5}, {"dwell": 0.9e-6}):
        (check,) = law.failed_checks(law.parameter_values(endless), "model exchange")
        assert "hysteresis and dwell let the relay switch more than once in 1e-06 s" in check.message
        assert "raise hysteresis to P 5e-07 s at least, or dwell to 1e-06 s, or set P = 0" in check.message
    for values in ({"hysteresis": 0.1}, {"hysteresis": 1.1e-5}, {"dwell": 0.1}, {"dwell": 1.1e-6}, {"P": 0.0}):
        assert not law.failed_checks(law.parameter_values(values), "model exchange", "start")
    sign = B.sliding_mode(chain_plant(), SURFACE, P=20.0, switching="sign")
    one, other = (br.simulate(chain_loop(item), 3.0, record=["e1[1]"])["e1[1]"] for item in (law, sign))
    assert abs(one - other).max() < 1e-4


@given(
    s=st.floats(-1.0, 1.0) | st.sampled_from([-0.1, 0.1, 0.0]),
    relay=st.sampled_from([-1, 1]),
    timer=st.floats(0.0, 0.1) | st.just(0.05),
    band=st.sampled_from([0.0, 1e-300, 0.1]),
    dwell=st.sampled_from([0.0, 1e-300, 0.05]),
)
def test_an_event_ends_after_one_switch_at_most(s: float, relay: int, timer: float, band: float, dwell: float) -> None:
    """Wherever an event happens, no transition is left to fire, and the relay is as hysteresis and dwell say."""
    engine = NumpyEngine(RELAY)
    engine.set_parameters({"hysteresis": band, "dwell": dwell})
    engine.initialize()
    engine.inputs[:] = 0.0
    engine.inputs[0] = s / SURFACE[0]
    engine.modes[:], engine.states[:] = relay, timer
    engine.event()
    s = SURFACE[0] * engine.inputs[0]
    wanted = -relay if relay * s < -band and timer >= dwell else relay
    assert engine.modes.tolist() == [wanted]
    assert engine.states.tolist() == [0.0 if wanted != relay else timer]
    before = engine.modes.copy(), engine.states.copy()
    engine.event()
    assert (engine.modes, engine.states) == before or (band, dwell) == (0.0, 0.0)


def test_python_control_cannot_hold_its_modes() -> None:
    with pytest.raises(ModelError, match="has modes"):
        analysis.to_control(B.sliding_mode_relay())
