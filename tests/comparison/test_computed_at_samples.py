"""What a sampled computer computes is what it computed at its last sample."""

from dataclasses import replace

import numpy as np
import pytest

from brunovsky.comparison import Study
from brunovsky.comparison.engines import NativeSimulation, check_outcome, opened_fmus
from brunovsky.comparison.metrics import compute_metrics
from brunovsky.comparison.residuals import predicted_residual
from brunovsky.fmi import export_fmu

STUDY = {
    "name": "sampled",
    "title": "Sampled",
    "step_size_s": 1e-3,
    "parameters": {"C_1_per_s2": 500.0, "C_2_per_s": 10.0, "Q_per_s": 5.0},
    "laws": [{"name": "sign", "kind": "sign", "parameters": {"P_m_per_s3": 2.5}}],
    "scenarios": [
        {
            "name": "near",
            "title": "Near the circle",
            "duration_s": 4.0,
            "parameters": {
                "x_start_m": 1.4152,
                "eta_start_1_m_per_s": 0.7071067811865476,
                "eta_start_2_rad_per_s": 0.5,
            },
            "hardware": {"sampling_period_s": 0.01},
        }
    ],
}


@pytest.fixture(scope="module")
def planned():
    return Study.model_validate(STUDY).plan()[0]


def test_sampled_relay_chatters_from_sample_to_sample(planned):
    data = check_outcome(NativeSimulation().run(planned), planned).trajectory
    S = data["S[1]"].values[:-1].reshape(-1, 10)
    assert np.all(S[:, :1] == S)  # held for ten steps
    found = compute_metrics(data, layer=0.0)
    assert found.chatter_frequency == pytest.approx(np.pi / 0.01, rel=1e-3)
    assert found.chatter_amplitude == pytest.approx(0.01 * 2.5 / (2.0 - 0.01 * 5.0), rel=0.08)  # of S alone


def test_the_fmu_shows_what_was_computed_at_the_last_sample(planned, tmp_path):
    """At the very instant of a sample the FMU has not taken it yet: its inputs may still change."""
    native = NativeSimulation().run(planned).trajectory
    path = export_fmu(planned.loop.block, tmp_path / "sampled.fmu")
    with opened_fmus({planned.loop: path}) as simulation:
        found = simulation.run(planned).trajectory
    steps = np.arange(native.sizes["time"])
    for name in ("S[1]", "S[2]", "e1[1]", "e2[2]", "v[1]", "v[2]"):
        np.testing.assert_array_equal(found[name].values, native[name].values[steps - (steps % 10 == 0) * (steps > 0)])
    assert compute_metrics(found, layer=0.0).chatter_frequency == pytest.approx(np.pi / 0.01, rel=1e-3)


def test_samples_need_not_fall_on_steps(planned):
    odd = replace(planned, parameters={**planned.parameters, "sampling_period": 0.0105})
    data = check_outcome(NativeSimulation().run(odd), odd).trajectory
    instants = np.floor(data["time"].values[:400] / 0.0105 + 1e-9)
    S = data["S[1]"].values[:400]
    assert np.array_equal(np.diff(S) != 0.0, np.diff(instants) > 0)


def test_a_law_of_another_kind_has_no_predicted_residual():
    table = {**STUDY["scenarios"][0], "disturbances": {"d_2_rad_per_s2": 0.2}}
    laws = [{"name": "implicit", "kind": "sampled", "parameters": {"P_m_per_s3": 2.5}}]
    study = Study.model_validate({**STUDY, "laws": laws, "scenarios": [table]})
    run = study.plan()[0]
    assert run.parameters["controller.sampling_period"] == run.parameters["sampling_period"] == 0.01
    assert predicted_residual(run, study.law("implicit")) is None
