"""Amplitude and frequency in a record, against signals whose numbers are known."""

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from brunovsky.analysis import SwitchingLoop, measured_chatter, simulated_cycle
from brunovsky.analysis.chatter.switched_response import trajectory
from brunovsky.errors import ParameterError


def record(values, time):
    return xr.Dataset({"S[1]": ("time", values)}, coords={"time": time})


@given(
    st.floats(1e-6, 1e3),
    st.floats(40.0, 200.0),
    st.floats(-5.0, 5.0),
    st.floats(0.0, 6.0),
)
def test_a_sinusoid(amplitude, frequency, offset, phase):
    time = np.linspace(0, 2, 20001)
    found = measured_chatter(record(amplitude * (offset + np.sin(frequency * time + phase)), time))
    assert found.amplitude == pytest.approx(amplitude, rel=1e-3)
    assert found.largest == pytest.approx(amplitude, rel=1e-3)
    assert found.frequency == pytest.approx(frequency, rel=1e-3)
    assert found.mean == pytest.approx(amplitude * offset, abs=0.02 * amplitude)
    assert found.samples == pytest.approx(2 * np.pi / frequency / 1e-4, abs=1)


def test_ripple_below_a_tenth_is_not_counted():
    time = np.linspace(0, 2, 40001)
    found = measured_chatter(record(np.sin(50 * time) + 0.04 * np.sin(3000 * time), time))
    assert found.frequency == pytest.approx(50, rel=1e-3)


def test_only_the_part_asked_for_is_measured():
    time = np.linspace(0, 4, 40001)
    values = np.where(time < 2, np.sin(40 * time), 3 * np.sin(90 * time))
    data = record(values, time)
    assert measured_chatter(data, start=0, end=2).frequency == pytest.approx(40, rel=1e-3)
    assert measured_chatter(data).frequency == pytest.approx(90, rel=1e-3)
    assert measured_chatter(data).amplitude == pytest.approx(3, rel=1e-3)


def test_a_growing_oscillation_has_a_largest_period():
    time = np.linspace(0, 2, 20001)
    found = measured_chatter(record(np.exp(time) * np.sin(60 * time), time))
    assert found.amplitude < 0.85 * found.largest


@pytest.mark.parametrize("values", [np.zeros(1001), np.linspace(0, 1, 1001), np.sin(np.linspace(0, 12, 1001))])
def test_what_does_not_oscillate_is_none(values):
    assert measured_chatter(record(values, np.linspace(0, 1, 1001))) is None


def test_it_agrees_with_the_simulated_cycle_of_a_chain():
    loop = SwitchingLoop([500, 10, 1], 5, 2.5, lags=[0.005, 0.005])
    pieces = trajectory(loop, np.array([0, 0, 0.025, 0, 0]))
    parts = [next(pieces) for _ in range(3000)]
    time, values = (np.concatenate(one) for one in zip(*parts, strict=True))
    found = measured_chatter(record(values, time))
    expected = simulated_cycle(loop).cycle
    assert found.periods > 20
    assert found.frequency == pytest.approx(expected.frequency, rel=1e-3)
    assert found.amplitude == pytest.approx(expected.amplitude, rel=1e-2)


def test_bad_input_is_refused_with_a_remedy():
    time = np.linspace(0, 1, 101)
    data = record(np.sin(50 * time), time)
    with pytest.raises(ParameterError, match=r"S\[1\]"):
        measured_chatter(data, "S[7]")
    with pytest.raises(ParameterError, match="no instants"):
        measured_chatter(data, start=2.0)
    with pytest.raises(ParameterError, match=r"brunovsky\.simulate"):
        measured_chatter({"S[1]": [1.0]})
    with pytest.raises(ParameterError, match="finite"):
        measured_chatter(record(np.full(101, np.nan), time))
    with pytest.raises(ParameterError, match="start"):
        measured_chatter(data, start=np.inf)
