"""Chatter by which a prediction is judged is steady and converged with the step."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from brunovsky.comparison.chatter_section import AT_V, SAMPLED, PredictedChatter, _findings
from brunovsky.comparison.metrics import Metrics

TIME = np.linspace(0.0, 10.0, 10_001)


def run(amplitude=1.0, error=0.0, samples=100.0, factor=1.0):
    """A run with S of an amplitude and a position error, whose chatter is a factor as large at half the step."""
    wave = amplitude * np.sin(60.0 * TIME)
    signals = {"S[1]": wave * np.cos(0.5 * TIME), "S[2]": wave * np.sin(0.5 * TIME), "e1[1]": error + 0.0 * TIME}
    data = xr.Dataset({name: ("time", one) for name, one in signals.items()} | {"e2[1]": ("time", 0.0 * TIME)})
    metrics, half = (
        Metrics(chatter_frequency=60.0, chatter_amplitude=one, chatter_samples=samples) for one in (1, factor)
    )
    return SimpleNamespace(
        planned=SimpleNamespace(name="s/sign"),
        trajectory=data.assign_coords(time=TIME),
        metrics=metrics,
        facts=SimpleNamespace(),
        half_step=SimpleNamespace(metrics=half, facts=SimpleNamespace()),
    )


@pytest.mark.parametrize(
    ("given", "state"),
    [
        ({}, ""),
        ({"amplitude": np.exp(0.05 * TIME)}, ""),
        ({"amplitude": np.exp(0.2 * TIME)}, "grows"),
        ({"amplitude": np.exp(-0.2 * TIME)}, "decays"),
        ({"error": 1e-6 * np.exp(0.48 * TIME)}, "grows"),
        ({"error": 1e-15 * np.exp(0.48 * TIME)}, ""),
        ({"error": np.exp(-TIME)}, ""),
        ({"samples": 3.5}, "not converged"),
        ({"factor": 0.5}, "not converged"),
    ],
)
def test_what_grows_or_is_of_the_step_judges_no_prediction(given, state):
    one = PredictedChatter(run(**given), AT_V, 80.0, 1.0)
    text = " ".join(_findings([one]))
    assert one.state == state and ("it misses the chatter" in text) is (state == "")
    assert (one.errors == (None, None)) is (state != "")


def test_the_map_from_sample_to_sample_is_about_the_step():
    assert PredictedChatter(run(samples=2.0, factor=0.5), SAMPLED, 60.0, 1.0).state == ""
