"""The protocols on the robot's closed loop, simulated natively."""

import json
import math

import pytest

from brunovsky.comparison.engines import NativeSimulation
from brunovsky.comparison.metrics import compute_metrics
from brunovsky.comparison.protocols import (
    Distribution,
    Failure,
    Knob,
    equal_effort,
    monte_carlo,
    pareto,
    step_sensitive_metrics,
    swept,
)
from brunovsky.comparison.study import PlannedRun
from brunovsky.comparison.study.keys import study_block

LINEAR, LAYER, RELAY = {"P": 0.0}, {"P": 2.5, "phi": 0.05}, {"P": 2.5, "phi": 0.0}


def evaluation(duration=4.0, step=2e-3):
    """Figure 6 from outside; the knob `speed_up` scales the poles of the surface and the reaching rate together."""
    block = study_block()
    engine = NativeSimulation(block)

    def evaluate(law, parameters, case):
        given = {"C[1]": 500.0, "C[2]": 10.0, "C[3]": 1.0, "Q": 5.0} | dict(parameters)
        factor = given.pop("speed_up", 1.0)
        given |= {"C[1]": given["C[1]"] * factor**2, "C[2]": given["C[2]"] * factor, "Q": given["Q"] * factor}
        values = block.parameter_values(given)
        inputs = {one.name: one.start for one in block.inputs}
        outcome = engine.run(PlannedRun("", "", law, duration, step, values, inputs))
        if outcome.status.state != "ok":
            return Failure(outcome.status.message, singular=outcome.status.state == "singular")
        return compute_metrics(outcome.trajectory, layer=values["phi"] if values["P"] else None, band=0.05).as_dict()

    return evaluate


def test_at_zero_of_the_switching_gain_the_laws_are_one():
    laws = {"layer": {"phi": 0.05}, "relay": {"phi": 0.0}}
    result = swept(evaluation(), laws, "P", [0.0, 2.5], metrics=["iae", "reaching_time", "sliding_band"])
    zero = [one for one in result.trials if one.parameters["P"] == 0.0]
    assert zero[0].metrics == zero[1].metrics
    _, reaching = result.curve("relay", "reaching_time")
    assert reaching[1] < reaching[0]  # the switching term reaches the surface sooner


def test_laws_are_tuned_to_equal_rms_yaw_acceleration():
    laws = {"linear": LINEAR, "layer": LAYER}
    knobs = {law: Knob("speed_up", 0.3, 1.5) for law in laws}
    result = equal_effort(evaluation(), laws, knobs, "rms_u2", 100.0, metrics=["iae"], scan=6)
    for one in result.tunings:
        assert one.status == "tuned" and one.trial.value("rms_u2") == pytest.approx(100.0, rel=0.01)
    json.dumps(result.as_dict(), allow_nan=False)


def test_the_relay_shows_the_chatter_of_its_step_and_is_not_ranked_by_it():
    """With nothing else in the loop S = -+ P h/2 turn about, at the step: half the range P h/2, period 2 h."""
    metrics = [evaluation(step=step)("relay", RELAY, 0) for step in (2e-3, 1e-3)]
    for found, step in zip(metrics, (2e-3, 1e-3), strict=True):
        assert found["chatter_frequency"] == pytest.approx(math.pi / step, rel=1e-3)
        assert found["chatter_amplitude"] == pytest.approx(0.5 * 2.5 * step, rel=0.01)
    sensitive = step_sensitive_metrics(metrics[:1], metrics[1:])
    assert {"chatter_frequency", "chatter_amplitude", "sliding_band"} <= sensitive
    assert "iae" not in sensitive


def test_cases_are_common_to_the_laws():
    draws = {"rho[1]": Distribution("uniform", 0.8, 1.2), "x_start": Distribution("uniform", 2.0, 3.0)}
    laws = {"linear": LINEAR, "layer": LAYER}
    result = monte_carlo(evaluation(), laws, draws, metrics=["iae", "reaching_time"], cases=16, seed=1)
    reaching = result.differences[1]
    assert reaching.metric == "reaching_time" and reaching.lower == "layer"
    again = monte_carlo(evaluation(), {"layer": LAYER}, draws, metrics=["iae"], cases=16, seed=1)
    assert again.values("layer", "iae") == result.values("layer", "iae")


def test_a_front_of_the_linear_law():
    spaces = {"linear": {"speed_up": (0.3, 1.5)}}
    result = pareto(evaluation(), {"linear": LINEAR}, spaces, objectives=("iae", "rms_u2"), budget=8)
    front = result.fronts["linear"]
    assert len(front) >= 4  # quicker poles cost more
    assert all(one.failure is None for one in result.trials)
