"""A run that fails is recorded with its status, and the comparison still ends with its report."""

import json

import numpy as np
import pytest

from brunovsky.comparison import load_study, run_study, write_report
from brunovsky.comparison.engines import recorded
from brunovsky.comparison.metrics import position_error


@pytest.fixture(params=["native", "fmpy"])
def failed(request, small, failing, tmp_path):
    small.write_text(small.read_text() + failing)
    return run_study(load_study(small), engine=request.param, folder=tmp_path)


def test_a_failed_run_leaves_the_others_and_the_report(failed, tmp_path):
    written = write_report(failed, tmp_path / "out")
    runs = {run["name"]: run for run in json.loads(written.metrics.read_text())["runs"]}
    assert runs["circle/linear"]["status"] == runs["circle/relay"]["status"] == "ok"
    for name in ("rest/linear", "rest/relay"):
        assert runs[name]["status"] == "singular"
        assert runs[name]["status_time"] == 0.0
        assert "singular at eta[1] = 0" in runs[name]["status_message"]
        assert set(runs[name]["metrics"].values()) == {None}
    assert runs["away/linear"]["status"] == "diverged"
    assert 1.0 < runs["away/linear"]["status_time"] < 100.0
    text = written.report.read_text(encoding="utf-8")
    assert "3 of 5 runs failed" in text
    assert "rest/linear (singular)" in text and "away/linear (diverged)" in text
    assert "singular at 0 s" in text
    assert "because it diverged; the figure shows it until then" in " ".join(text.split())


def test_the_trajectory_until_the_failure_is_kept(failed):
    away = next(run for run in failed.runs if run.planned.name == "away/linear")
    assert set(away.trajectory.data_vars) == set(recorded(away.planned.loop.block))
    assert float(away.trajectory["time"][-1]) == pytest.approx(away.status.time, abs=2e-3)
    assert abs(float(away.trajectory["x"][-1])) > 1e6


def test_both_engines_end_alike(failed):
    if failed.engine == "fmpy":
        assert all(run.agreement.same_status for run in failed.runs)


def test_a_robot_that_is_lost_has_diverged_though_its_numbers_are_finite(small, failing):
    small.write_text(small.read_text() + failing.replace("duration_s = 100.0", "duration_s = 2.5"))
    away = next(run for run in run_study(load_study(small)).runs if run.planned.name == "away/linear")
    assert away.status.state == "diverged" and away.facts is None
    assert away.status.message.startswith("the position error exceeds 1000 m from t = ")
    assert np.all(position_error(away.trajectory) <= 1e3) and away.trajectory.sizes["time"] > 100
