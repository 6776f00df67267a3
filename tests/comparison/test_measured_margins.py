"""Measured margins against those of linear loops that are known exactly."""

import json
import math

import control
import numpy as np
import pytest

from brunovsky.analysis import margins
from brunovsky.blocks import closed_loop, pole_placement
from brunovsky.comparison.measured_margins import bisect_margin, bounded_at_the_end, measured_margins
from brunovsky.errors import ParameterError, SimulationError
from brunovsky.native import simulate

TIME = np.linspace(0.0, 8.0, 801)
K = np.array([2500.0, 550.0, 15.0])


@pytest.mark.parametrize(
    ("error", "stable"),
    [
        (np.exp(-TIME), True),
        (5.0 * np.exp(-0.1 * TIME), True),
        (1e-4 * np.abs(np.sin(50.0 * TIME)), True),
        (0.0 * TIME, True),
        (1e-15 * np.exp(TIME), True),
        (0.2 + 0.0 * TIME, False),
        (1e-4 * np.exp(0.1 * TIME), False),
        (np.exp(TIME), False),
        (np.where(TIME > 7.0, np.nan, 0.0), False),
        (np.where(TIME > 7.9, 1.0, 0.0), False),
        (3e-5 * np.exp(0.03 * TIME) * np.abs(np.sin(21.0 * TIME)), False),
        (3e-5 * np.exp(0.005 * TIME) * np.abs(np.sin(21.0 * TIME)), True),
    ],
    ids=[
        "decays",
        "slow",
        "chatters",
        "rest",
        "rounding",
        "remains",
        "creeps",
        "grows",
        "nan",
        "late",
        "slowly",
        "stays",
    ],
)
def test_what_counts_as_stable(error, stable):
    assert bounded_at_the_end(TIME, error, bound=0.01) is stable


def test_what_grows_slowly_below_the_bound_is_unstable_unless_it_may_be_chatter():
    error = 3e-5 * np.exp(0.15 * TIME) * np.abs(np.sin(21.0 * TIME))
    assert not bounded_at_the_end(TIME, error, bound=2e-3)
    assert bounded_at_the_end(TIME, error, bound=2e-3, still=1e-3)


@pytest.mark.parametrize(("low", "high"), [(1.0, 100.0), (0.0, 100.0)])
@pytest.mark.parametrize("below", [True, False])
def test_bisection_finds_the_edge_from_the_stable_side(low, high, below):
    found = bisect_margin(lambda k: (k < math.pi) == below, low, high, rtol=1e-3)
    assert found.value == pytest.approx(math.pi, rel=1e-3) and (found.value < math.pi) == below
    assert abs(found.value - found.unstable_from) <= 1e-3 * math.pi * 1.001
    assert found.reason == "" and found.runs <= 20


@pytest.mark.parametrize(("always", "reason"), [(True, "stable at both ends"), (False, "not stable at either end")])
def test_without_an_edge_the_reason_is_given(always, reason):
    found = bisect_margin(lambda _: always, 0.1, 1.0)
    assert found.value is None and found.runs == 2 and found.reason.startswith(reason)


@pytest.mark.parametrize("given", [(1.0, 1.0, 0.1), (-1.0, 1.0, 0.1), (0.0, math.inf, 0.1), (0.0, 1.0, 0.0)])
def test_impossible_ranges_are_refused(given):
    with pytest.raises(ParameterError, match="bisect_margin"):
        bisect_margin(bool, *given)


def test_an_edge_at_zero_ends():
    assert bisect_margin(lambda k: k == 0.0, 0.0, 1.0).value == 0.0


def delayed_chain(gain: float, delay: float, step: float = 2e-3, duration: float = 30.0):
    """Three integrators under v = -gain K e, v held over steps and late by whole steps and a part of one."""
    plant = control.c2d(control.ss(np.eye(3, k=1), [[0.0], [0.0], [1.0]], np.eye(3), np.zeros((3, 1))), step)
    late = delay / step
    whole, part = int(late), late - int(late)
    e, queue, errors = np.array([1.0, 0.0, 0.0]), [0.0] * (whole + 2), []
    for _ in range(round(duration / step)):
        queue.insert(0, -gain * float(K @ e))
        v = (1.0 - part) * queue[whole] + part * queue[whole + 1]
        queue.pop()
        e = plant.A @ e + plant.B[:, 0] * v
        errors.append(abs(e[0]))
        if errors[-1] > 1e6:
            return None
    return step * np.arange(1, len(errors) + 1), np.array(errors)


def sampled_gain_margins(step: float = 2e-3) -> tuple[float, float]:
    """Factors at which the sampled loop has a pole on the unit circle."""
    plant = control.c2d(control.ss(np.eye(3, k=1), [[0.0], [0.0], [1.0]], np.eye(3), np.zeros((3, 1))), step)
    factors = np.geomspace(0.05, 300.0, 20_001)
    radii = [np.max(np.abs(np.linalg.eigvals(plant.A - factor * plant.B @ K[np.newaxis]))) for factor in factors]
    stable = factors[np.array(radii) < 1.0]
    return float(stable[0]), float(stable[-1])


@pytest.mark.slow
def test_measured_margins_of_a_linear_loop_are_its_margins():
    exact = margins(K)
    found = measured_margins(delayed_chain, bound=1e-3, lowest_gain=0.05, highest_gain=300.0, longest_delay=0.1)
    low, high = sampled_gain_margins()
    assert found.gain_lower.value == pytest.approx(low, rel=0.02)
    assert found.gain_upper.value == pytest.approx(high, rel=0.02)
    # holding v over a step of 2 ms is a mean delay of 1 ms
    assert found.delay.value == pytest.approx(exact.delay - 1e-3, rel=0.03)
    json.dumps(found.as_dict(), allow_nan=False)


def test_a_loop_that_is_unstable_as_it_is_has_no_margins():
    found = measured_margins(lambda gain, delay: None, bound=1.0)
    assert found.delay.value is None and "as it is" in found.delay.reason


def test_the_lower_gain_margin_of_the_robot_is_that_of_its_chains_near_the_circle_alone():
    """Exact linearisation leaves the linear loop; from far away its swings pass the singularity before that."""
    block = closed_loop(pole_placement())
    near = {"x_start": math.sqrt(2.0) + 0.02, "eta_start[1]": 0.5 * math.sqrt(2.0), "eta_start[2]": 0.5}

    def margin(start: dict[str, float]) -> float:
        def stable(gain: float) -> bool:
            parameters = {f"K[{k}]": gain * one for k, one in enumerate(K, 1)} | start
            try:
                run = simulate(block, 40.0, step_size=2e-3, parameters=parameters, record=("e1[1]", "e2[1]"))
            except SimulationError:
                return False
            error = np.hypot(run["e1[1]"].values, run["e2[1]"].values)
            return bounded_at_the_end(run["time"].values, error, 1e-3)

        return bisect_margin(stable, 0.1, 1.0, rtol=0.005).value

    linear = margins(K).gain_lower
    assert margin(near) == pytest.approx(linear, rel=0.015)
    assert margin({}) > 1.05 * linear
