"""Relay with hysteresis and dwell time: its cycle against the closed form, its memory, its refusals."""

import numpy as np
import pytest
import xarray as xr
from outer_loop_cases import SURFACE, B, chain_loop, chain_plant

import brunovsky as br
from brunovsky import analysis
from brunovsky.blocks import NumpyEngine
from brunovsky.errors import ModelError

STEP = 1e-4


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
    (check,) = law.failed_checks(law.parameter_values(), "model exchange")
    assert "hysteresis = 0 with dwell = 0" in check.message
    for values in ({"hysteresis": 0.1}, {"dwell": 0.1}, {"P": 0.0}):
        assert not law.failed_checks(law.parameter_values(values), "model exchange", "start")
    sign = B.sliding_mode(chain_plant(), SURFACE, P=20.0, switching="sign")
    one, other = (br.simulate(chain_loop(item), 3.0, record=["e1[1]"])["e1[1]"] for item in (law, sign))
    assert abs(one - other).max() < 1e-4


def test_python_control_cannot_hold_its_modes() -> None:
    with pytest.raises(ModelError, match="has modes"):
        analysis.to_control(B.sliding_mode_relay())
