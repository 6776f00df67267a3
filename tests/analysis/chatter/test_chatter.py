"""The gates: prediction against simulation over lags, surfaces, Q and P where the linear part is stable."""

import dataclasses
import itertools
import json

import numpy as np
import pytest

from brunovsky.analysis import (
    SwitchingLoop,
    chatter_table,
    cycle_state,
    lag_margin,
    predicted_cycles,
    relay_cycles,
    simulated_cycle,
    sliding_gain,
    surface_from_poles,
)
from brunovsky.errors import ParameterError

C, Q, P = (500.0, 10.0, 1.0), 5.0, 2.5
SURFACES = [
    C,
    surface_from_poles([-2, -3]),
    surface_from_poles([-5, -5]),
    surface_from_poles([-20, -30]),
    surface_from_poles([-1 + 2j, -1 - 2j]),
    surface_from_poles([-5 + 5j, -5 - 5j]),
    surface_from_poles([-10 + 10j, -10 - 10j]),
    surface_from_poles([-3, -4], leading=2.0),
    surface_from_poles([-3, -4], leading=-0.5),
    surface_from_poles([-2]),
    surface_from_poles([-10]),
    surface_from_poles([-2, -3, -4]),
]
LAGS = [0.005, 0.007, 0.01, 0.014, 0.02, 0.03, 0.04, 0.05]


def stable(surface, rate, lag):
    return lag < lag_margin(sliding_gain(surface, rate), 2) * (1 - 1e-9)


def two_lags(surface, rate, switching, lag):
    return SwitchingLoop(surface, rate, switching, lags=[lag, lag])


def check(rows):
    """The gates of a grid; returns its errors (frequency and amplitude by describing function, then by the locus)."""
    assert all(row.outcome == "cycle" for row in rows)
    errors = np.array(
        [
            [
                row.predicted_frequency_rad_s / row.simulated_frequency_rad_s,
                row.predicted_amplitude / row.simulated_amplitude,
                row.locus_frequency_rad_s / row.simulated_frequency_rad_s,
                row.locus_amplitude / row.simulated_amplitude,
            ]
            for row in rows
        ]
    )
    errors = np.abs(errors - 1.0)
    assert np.max(errors[:, 0]) < 0.05
    assert np.max(errors[:, 1]) < 0.10
    assert np.quantile(errors[:, 1], 0.95) < 0.05
    assert np.max(errors[:, 2:]) < 0.01
    return errors


def test_prediction_on_a_part_of_the_grid():
    grid = [
        (surface, (0.5, 2.0, 5.0, 10.0)[i % 4], (0.5, 2.5, 20.0)[i % 3], lag)
        for i, (surface, lag) in enumerate(itertools.product(SURFACES, (0.005, 0.01, 0.05)))
    ]
    loops = [two_lags(*point) for point in grid if stable(point[0], point[1], point[3])]
    assert len(loops) > 25
    check(chatter_table(loops))


@pytest.mark.parametrize("fraction", [0.9, 0.97, pytest.param(0.99, marks=pytest.mark.slow)])
def test_prediction_next_to_the_loss_of_stability(fraction):
    loops = []
    for surface, rate in itertools.product(SURFACES[:7], (0.5, 5.0)):
        lag = fraction * lag_margin(sliding_gain(surface, rate), 2)
        if lag <= 0.1:
            loops.append(two_lags(surface, rate, P, lag))
    assert len(loops) >= 4
    check(chatter_table(loops))


def test_two_stable_cycles_side_by_side_just_before_the_loss_of_stability():
    lag = 0.99 * lag_margin(sliding_gain(C, 0.5), 2)
    loop = two_lags(C, 0.5, P, lag)
    small, middle, large = relay_cycles(loop)
    assert [one.stable for one in predicted_cycles(loop)] == [True, False, True]
    assert (small.stable, middle.stable, large.stable) == (True, False, True)
    edge = cycle_state(loop, middle.frequency)
    for factor, expected in ((0.97, small), (1.05, large)):
        seen = simulated_cycle(loop, factor * edge)
        assert seen.outcome == "cycle"
        assert seen.cycle.amplitude == pytest.approx(expected.amplitude, rel=1e-2)
    check(chatter_table([loop]))


@pytest.mark.slow
def test_prediction_on_the_whole_grid():
    points = itertools.product(SURFACES, (0.5, 1.0, 2.0, 5.0, 10.0), (0.5, 2.5), LAGS)
    loops = [two_lags(*point) for point in points if stable(point[0], point[1], point[3])]
    assert len(loops) > 700
    errors = check(chatter_table(loops))
    print(len(loops), errors.max(axis=0), np.quantile(errors, 0.95, axis=0))


def test_a_row_is_ready_for_json_and_null_where_nothing_oscillates():
    loops = [
        two_lags(C, Q, P, 0.005),
        SwitchingLoop(C, Q, P, lags=[0.01]),
        SwitchingLoop(C, Q, P),
        SwitchingLoop(C, Q, P, boundary_layer=0.004, lags=[0.005, 0.005]),
        SwitchingLoop(C, Q, P, lags=[0.005, 0.005], sampling=0.001),
    ]
    rows = json.loads(json.dumps([dataclasses.asdict(row) for row in chatter_table(loops)]))
    assert (rows[0]["lag_s"], rows[0]["C"]) == ([0.005, 0.005], list(C))
    assert rows[1]["lag_s"] == [0.01] and rows[2]["lag_s"] == []
    assert (rows[0]["Q"], rows[0]["P"], rows[0]["phi"]) == (Q, P, 0.0)
    quantities = [
        f"{source}_{what}"
        for source in ("predicted", "locus", "simulated")
        for what in ("amplitude", "frequency_rad_s")
    ]
    assert all(rows[0][key] > 0 for key in quantities)
    for row in rows[1:3]:
        assert all(row[key] is None for key in quantities)
        assert row["outcome"] == "slides"
    assert rows[3]["locus_amplitude"] is None
    assert rows[3]["simulated_amplitude"] == pytest.approx(rows[3]["predicted_amplitude"], rel=0.1)
    assert rows[4]["sampling_s"] == 0.001
    assert rows[4]["locus_amplitude"] > 0


def test_lags_may_differ_in_any_order():
    loops = [SwitchingLoop(C, Q, P, lags=lags) for lags in ([0.004, 0.009], [0.009, 0.004])]
    first, second = chatter_table(loops)
    assert (first.lag_s, second.lag_s) == ((0.004, 0.009), (0.009, 0.004))
    check([first, second])
    assert first.locus_amplitude == pytest.approx(second.locus_amplitude, rel=1e-9)


def test_a_row_says_whether_its_linear_part_is_stable():
    limit = lag_margin(sliding_gain(C, Q), 2)
    rows = chatter_table([two_lags(C, Q, P, factor * limit) for factor in (0.99, 1.01, 2.0)])
    assert [row.linear_part_stable for row in rows] == [True, False, False]
    assert [row.outcome for row in rows] == ["cycle", "cycle", "diverges"]
    assert rows[2].predicted_amplitude is None and rows[2].simulated_amplitude is None


def test_behind_a_delay_alone_only_the_locus_holds():
    """Nothing filters the relay there: S is a triangle, whose first harmonic is smaller than its peak."""
    for row in chatter_table([SwitchingLoop(C, Q, P, delay=delay) for delay in (0.002, 0.005)]):
        assert row.predicted_amplitude / row.simulated_amplitude == pytest.approx(0.81, abs=0.01)
        assert row.locus_amplitude == pytest.approx(row.simulated_amplitude, rel=0.01)
        assert row.locus_frequency_rad_s == pytest.approx(row.simulated_frequency_rad_s, rel=0.01)


def test_a_loop_that_does_not_switch_is_refused():
    with pytest.raises(ParameterError, match="P > 0"):
        chatter_table([SwitchingLoop(C, Q, 0.0, lags=[0.01])])
