"""Phase portraits, whatever the scales of their two axes."""

from dataclasses import replace

import numpy as np
import pytest

from brunovsky.comparison import Comparison, load_study, run_study
from brunovsky.comparison.figures import phase_figure
from brunovsky.comparison.metrics import instants


@pytest.mark.parametrize(
    ("size", "scales"),
    [
        (1e-3, ("linear", "linear")),
        (0.05, ("linear", "symlog")),  # small, but fast
        (5.0, ("symlog", "symlog")),
    ],
)
def test_sliding_variables_that_swing_from_step_to_step(small, size: float, scales: tuple[str, str]) -> None:
    found = run_study(load_study(small))

    def swinging(run):
        swing = ("time", size * (-1.0) ** np.arange(instants(run.trajectory).size))
        return replace(run, trajectory=run.trajectory.assign({"S[1]": swing, "S[2]": swing}))

    comparison = Comparison(found.study, found.engine, tuple(map(swinging, found.runs)), found.provenance)
    portrait = phase_figure(comparison, found.study.scenarios[0]).axes[2]
    assert (portrait.get_xscale(), portrait.get_yscale()) == scales
    assert portrait.lines and portrait.get_xlim()[1] > size
