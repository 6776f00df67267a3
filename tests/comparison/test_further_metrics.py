"""Reaching, chatter, inputs and the linear part's metrics against what can be worked out by hand."""

import json
import math
from dataclasses import fields

import control
import numpy as np
import pytest
import xarray as xr

from brunovsky.analysis import SwitchingLoop, boundary_layer_gain, simulated_cycle, sliding_gain
from brunovsky.comparison import Metrics, compute_metrics
from brunovsky.comparison.definitions import CONTRACT_METRICS, METRIC_DEFINITIONS, definition
from brunovsky.comparison.facts import FINER
from brunovsky.comparison.linear_metrics import LINEAR_DEFINITIONS, LinearMetrics, linear_metrics

TIME = np.linspace(0.0, 8.0, 8001)
SURFACE = (500.0, 10.0, 1.0)


def record(time=TIME, **given) -> xr.Dataset:
    """A run at rest on its reference, but for the signals given by name (u1 for u[1])."""
    names = ["x", "y", "e1[1]", "e2[1]", "eta[1]", *(f"{one}[{k}]" for one in "uvS" for k in (1, 2))]
    short = {name: name.replace("[", "").replace("]", "") for name in names}
    data = {name: ("time", np.broadcast_to(given.get(short[name], 0.0), time.shape)) for name in names}
    return xr.Dataset(data, {"time": time})


def square(time, period):
    return np.where((time / period) % 1.0 < 0.5, 1.0, -1.0)


def test_a_ramp_of_u():
    metrics = compute_metrics(record(u1=TIME, u2=4.0 - TIME))
    assert metrics.peak_forward_acceleration == 8.0
    assert metrics.rms_u1 == pytest.approx(8.0 / math.sqrt(3.0), rel=1e-6)
    assert metrics.rms_u2 == pytest.approx(4.0 / math.sqrt(3.0), rel=1e-6)


def test_effort_of_v_is_that_of_both_axes():
    metrics = compute_metrics(record(v1=3.0, v2=-4.0))
    assert metrics.effort_v == pytest.approx(25.0 * 8.0)


def test_an_impulse_counts_by_its_area():
    u = np.zeros_like(TIME)
    u[4000] = 10.0
    metrics = compute_metrics(record(u1=u))
    assert metrics.peak_forward_acceleration == 10.0
    assert metrics.rms_u1 == pytest.approx(math.sqrt(100.0 * 1e-3 / 8.0))
    assert metrics.total_variation_u1 == 20.0


@pytest.mark.parametrize(
    ("layer", "band"), [(None, 0.01), (0.0, 0.01), (0.05, 0.05), (0.002, 0.01)], ids=["linear", "relay", "wide", "thin"]
)
def test_reaching_time_of_a_decay_is_that_to_its_band(layer, band):
    metrics = compute_metrics(record(S1=np.exp(-TIME), S2=-3.0 * np.exp(-TIME)), layer=layer)
    assert metrics.reaching_time == pytest.approx(math.log(3.0 / band), abs=1e-3)
    assert metrics.sliding_band == pytest.approx(3.0 * math.exp(-6.0))
    common = compute_metrics(record(S1=np.exp(-TIME)), layer=layer, band=0.1)
    assert common.reaching_time == pytest.approx(math.log(10.0), abs=1e-3)


def test_a_surface_that_is_left_again_is_not_reached_before():
    S = np.where((TIME > 1.0) & (TIME < 5.0), 0.0, 1.0)
    assert compute_metrics(record(S1=S)).reaching_time is None
    S = np.where((TIME > 1.0) & (TIME < 2.0) | (TIME > 3.0), 0.0, 1.0)
    assert compute_metrics(record(S1=S)).reaching_time == pytest.approx(3.0)
    assert compute_metrics(record()).reaching_time == 0.0


def test_a_sine_about_zero_is_chatter_of_its_frequency():
    w = 40.0
    data = record(S1=0.2 * np.sin(w * TIME), S2=0.1 * np.sin(3 * w * TIME), u1=5.0 + 2.0 * np.sin(w * TIME), u2=TIME)
    metrics = compute_metrics(data, layer=0.05)
    assert metrics.chatter_frequency == pytest.approx(w, rel=1e-4)
    assert metrics.chatter_amplitude == pytest.approx(0.2, rel=1e-3)
    assert metrics.chatter_amplitude_u1 == pytest.approx(2.0, rel=1e-3)
    assert metrics.chatter_amplitude_u2 == pytest.approx(0.5 * 2.0 * math.pi / w, rel=1e-2)  # a ramp of 1 in a period
    assert metrics.chatter_samples == pytest.approx(2.0 * math.pi / w * 1e3, rel=1e-2)


def test_a_square_wave_is_chatter_of_its_height():
    metrics = compute_metrics(record(S2=0.3 * square(TIME, 0.1), u2=7.0 * square(TIME, 0.1)), layer=0.0)
    assert metrics.chatter_frequency == pytest.approx(2.0 * math.pi / 0.1, rel=1e-3)
    assert metrics.chatter_amplitude == pytest.approx(0.3)
    assert metrics.chatter_amplitude_u2 == pytest.approx(7.0)


def test_a_relay_that_switches_at_every_step_shows_the_step():
    zigzag = 1e-3 * (-1.0) ** np.arange(TIME.size)
    metrics = compute_metrics(record(S1=zigzag, u2=zigzag), layer=0.0)
    assert metrics.chatter_samples == pytest.approx(2.0)
    assert metrics.chatter_frequency == pytest.approx(math.pi / 1e-3, rel=1e-9)
    assert metrics.chatter_amplitude_u2 == pytest.approx(1e-3)


@pytest.mark.parametrize(
    ("S", "layer"),
    [
        (0.2 * np.sin(40.0 * TIME), None),
        (0.04 * np.sin(40.0 * TIME), 0.05),
        (0.2 * np.sin(4.0 * TIME), 0.05),
        (0.5 + 0.2 * np.sin(40.0 * TIME), 0.0),
        (0.0 * TIME, 0.0),
        (1e-12 * np.sin(40.0 * TIME), 0.0),
        (TIME, 0.0),
    ],
    ids=["no switching", "within the layer", "two periods", "not about zero", "rest", "rounding", "ramp"],
)
def test_what_is_not_chatter(S, layer):
    metrics = compute_metrics(record(S1=S), layer=layer)
    assert [value for name, value in metrics.as_dict().items() if name.startswith("chatter")] == [None] * 5


def test_measured_chatter_of_a_lagged_relay_is_that_of_the_analysis():
    """A chain of three integrators under the paper's relay behind two lags, integrated here."""
    lag, step = 0.005, 2.5e-5
    loop = SwitchingLoop(surface=(500.0, 10.0, 1.0), reaching_rate=5.0, switching_gain=2.5, lags=(lag, lag))
    expected = simulated_cycle(loop).cycle
    K = sliding_gain([500.0, 10.0, 1.0], 5.0)
    A = np.zeros((5, 5))
    A[0, 1] = A[1, 2] = A[2, 3] = 1.0
    A[3, 3:], A[4, 4], A[4, :3] = np.array([-1.0, 1.0]) / lag, -1.0 / lag, -K / lag
    B = np.array([[0.0], [0.0], [0.0], [0.0], [-2.5 / lag]])
    held = control.c2d(control.ss(A, B, np.eye(5), np.zeros((5, 1))), step)
    time, e = np.arange(120_001) * step, np.array([0.0, 0.0, 0.1, 0.0, 0.0])
    S = np.empty(time.size)
    for k in range(time.size):
        S[k] = np.dot([500.0, 10.0, 1.0], e[:3])
        e = held.A @ e + held.B[:, 0] * np.sign(S[k])
    metrics = compute_metrics(record(time, S1=S, u1=S), layer=0.0)
    assert metrics.chatter_frequency == pytest.approx(expected.frequency, rel=0.02)
    assert metrics.chatter_amplitude == pytest.approx(expected.amplitude, rel=0.02)
    assert metrics.chatter_amplitude_u1 == pytest.approx(expected.amplitude, rel=0.02)


def test_rest_at_the_goal_is_no_approach_to_the_singularity():
    e, speed = np.exp(-2.0 * TIME), 3.0 * np.exp(-2.0 * TIME)
    regulation = compute_metrics(record(x=e, e11=e, eta1=speed))
    assert regulation.min_speed == pytest.approx(3.0 * math.exp(-16.0))
    assert regulation.min_speed_moving == pytest.approx(3.0 * 0.01, rel=3e-3)
    tracking = compute_metrics(record(x=TIME, eta1=1.0 + 0.9 * np.sin(TIME)))
    assert tracking.min_speed_moving == tracking.min_speed == pytest.approx(0.1, abs=1e-6)
    reversing = compute_metrics(record(x=TIME, eta1=np.where(TIME < 3.0005, 1.0, -1.0)))
    assert (reversing.min_speed_moving, reversing.min_speed) == (0.0, 1.0)


def test_what_was_not_recorded_is_none():
    short = record(v1=1.0, S1=1.0).drop_vars(["x", "v[1]", "S[2]"])
    metrics = compute_metrics(short, layer=0.0)
    assert (metrics.effort_v, metrics.reaching_time, metrics.sliding_band, metrics.min_speed_moving) == (None,) * 4


def test_signals_that_overflow_give_none_and_never_nan():
    metrics = compute_metrics(record(u1=1e200, v1=1e200, S1=1e300, e11=1e300), layer=0.0)
    json.dumps(metrics.as_dict(), allow_nan=False)
    assert metrics.rms_u1 is None and metrics.effort_v is None


def test_every_metric_has_one_definition():
    names = [one.name for one in METRIC_DEFINITIONS]
    assert len(set(names)) == len(names)
    assert set(names) == {one.name for one in fields(Metrics)} | set(FINER)
    assert [one.name for one in CONTRACT_METRICS] == names[: len(CONTRACT_METRICS)]
    for one in (*METRIC_DEFINITIONS, *LINEAR_DEFINITIONS):
        assert one.title and one.unit and one.formula and one.sentence.endswith(".")
        assert one.header == f"{one.name} [{one.unit}]"
    assert {one.name for one in LINEAR_DEFINITIONS} == {one.name for one in fields(LinearMetrics)}
    assert definition("iae").unit == "m s" and definition("IAE") is None


def test_linear_metrics_of_the_paper():
    found = linear_metrics(sliding_gain(SURFACE, 5.0))
    assert found.gain_lower == pytest.approx(2500.0 / (550.0 * 15.0))  # k1/(k2 k3), by Routh
    assert found.gain_upper is None
    s = 1j * np.geomspace(0.1, 1e4, 200_001)
    L = (15.0 * s**2 + 550.0 * s + 2500.0) / s**3
    assert found.max_sensitivity == pytest.approx(np.max(np.abs(1.0 / (1.0 + L))), rel=1e-6)
    assert found.disk_margin == pytest.approx(1.0 / np.max(np.abs(0.5 * (1.0 - L) / (1.0 + L))), rel=1e-6)
    layer = linear_metrics(boundary_layer_gain(SURFACE, 5.0, 2.5, 0.05))
    assert layer == linear_metrics(sliding_gain([500.0, 10.0, 1.0], 55.0))
    assert layer.gain_lower == pytest.approx(27500.0 / (1050.0 * 65.0))


def test_an_unstable_linear_part_has_no_linear_metrics():
    assert linear_metrics([1.0, 0.1, 0.1]) == LinearMetrics()
