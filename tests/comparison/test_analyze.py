"""The analysis of a study: its numbers against the functions behind them, the model's known numbers, and simulation."""

import json
import math
from xml.etree import ElementTree

import numpy as np
import pytest

import brunovsky as br
from brunovsky import analysis as ana
from brunovsky.comparison import (
    analysis_data,
    analysis_tables,
    analyze_study,
    write_analysis,
)
from brunovsky.comparison import analyze as module
from brunovsky.comparison.study.keys import study_block
from brunovsky.errors import StudyError

C, Q, P, PHI = (500.0, 10.0, 1.0), 5.0, 2.5, 0.05
FIGURES = {"poles", "root-locus", "loop", "gang-of-four", "step-response", "boundary-layer", "input-sensitivity"}


@pytest.fixture(scope="module")
def paper_analysis(paper):
    return analyze_study(paper)


@pytest.fixture(scope="module")
def paper_data(paper_analysis):
    return json.loads(json.dumps(analysis_data(paper_analysis), allow_nan=False))


def test_the_numbers_of_the_papers_linear_part(paper_data):
    laws = {one["law"]: one for one in paper_data["laws"]}
    assert set(laws) == {"linear", "saturation", "sign"}
    for law in laws.values():
        part = law["linear_part"]
        assert part["gain"] == [2500.0, 550.0, 15.0] and part["stable"] is True
        assert round(1e3 * part["margins"]["lag"], 1) == 19.0
        assert round(1e3 * part["margins"]["two_lags"], 1) == 9.2
        assert math.floor(1e4 * part["margins"]["delay"]) / 10 == 18.4  # 18.45; the model's page cuts it off
        assert round(part["margins"]["gain_lower"], 3) == 0.303
        assert part["margins"]["gain_upper"] is None
        real, imaginary = np.transpose(part["poles"])
        assert real == pytest.approx([-5.0] * 3)
        assert sorted(imaginary) == pytest.approx([-math.sqrt(475), 0.0, math.sqrt(475)], abs=1e-9)
        assert law["matched_disturbance_bound"] == law["P"]
    assert laws["linear"]["boundary_layer"] is None and laws["sign"]["boundary_layer"] is None
    assert laws["saturation"]["boundary_layer"]["gain"] == ana.boundary_layer_gain(C, Q, P, PHI).tolist()


def test_each_loop_is_what_the_functions_of_the_analysis_say(paper_analysis):
    for law in paper_analysis.laws:
        for loop in (law.linear_part, law.boundary_layer):
            if loop is None:
                continue
            assert loop.margins == ana.margins(loop.gain)
            assert loop.disk_margin == ana.disk_margin(ana.loop_transfer(loop.gain))
            assert loop.bandwidth == ana.bandwidth(loop.gain)
            assert dict(loop.step) == ana.step_information(loop.gain)


def test_starts_are_those_of_the_simulation(paper, paper_analysis):
    for run, planned in zip(paper_analysis.runs, paper.plan(), strict=True):
        assert run.name == planned.name
        data = br.simulate(study_block(), 1e-3, parameters=dict(planned.parameters), record=["S[1]", "S[2]"])
        for found, name in zip(run.sliding_start, ("S[1]", "S[2]"), strict=True):
            assert found == pytest.approx(float(data[name][0]), rel=1e-12, abs=1e-11)


def test_reaching_times_are_those_of_the_runs(paper_runs, paper_analysis):
    compared = 0
    for run, simulated in zip(paper_analysis.runs, paper_runs.runs, strict=True):
        p, inputs = simulated.planned.parameters, simulated.planned.inputs
        if run.law == "linear":
            assert run.reaching_time == (math.inf, math.inf)
            continue
        if any(inputs.values()) or p["rho[1]"] != 1.0 or p["rho[2]"] != 1.0:
            continue
        for axis, expected in enumerate(run.reaching_time, 1):
            S = simulated.trajectory[f"S[{axis}]"].values
            width = p["phi"] if run.law == "saturation" else 0.0
            if expected < 1e-9:  # on the surface but for rounding
                assert abs(S[0]) <= width + 1e-11
                continue
            inside = np.abs(S) <= width if width else np.sign(S) != np.sign(S[0])
            first = float(simulated.trajectory["time"][np.argmax(inside)])
            if p["radius"] == 0.0:  # at a set point the guarded law takes over before S is reached
                assert expected == pytest.approx(1.6, abs=0.1) and first == pytest.approx(2.0, abs=0.1)
                continue
            assert first == pytest.approx(expected, abs=5e-3)  # steps of 1 ms, coarse where u2 is largest
            compared += 1
    assert compared == 12


def test_forecasts_are_those_of_the_runs(paper_runs, paper_analysis):
    runs = {run.planned.name: run for run in paper_runs.runs}
    seen = 0
    for run in paper_analysis.runs:
        if run.forecast is None:
            assert ("switches" in run.forecast_reason) == (run.law != "linear")
            continue
        metrics = runs[run.name].metrics
        seen += 1
        if run.forecast.guarded:  # a set point, where the robot comes to rest
            assert runs[run.name].planned.parameters["radius"] == 0.0
        else:  # the simulation is sampled every millisecond
            assert run.forecast.closest_speed == pytest.approx(metrics.min_speed, rel=0.01)
            assert run.forecast.closest_speed <= metrics.min_speed * (1.0 + 1e-6)
    assert seen == 6


def test_bounds_and_residuals_of_the_disturbed_runs(paper_data):
    runs = {one["name"]: one for one in paper_data["runs"]}
    assert runs["outside-d1/sign"]["predicted_residual"] == pytest.approx(4e-4, rel=0.01)
    assert runs["outside-d1/linear"]["predicted_residual"] == pytest.approx(1.20e-3, rel=0.01)
    assert runs["outside-d2/saturation"]["predicted_residual"] == pytest.approx(5.1e-6, rel=0.01)
    assert runs["fig6-outside/sign"]["predicted_residual"] is None
    circle = runs["fig6-outside/sign"]
    assert circle["forward_disturbance_bound"] == ana.forward_disturbance_bound(C, P, 0.5)
    assert circle["yaw_disturbance_bound"] == ana.yaw_disturbance_bound(C, P, 0.5 * math.sqrt(2.0))
    assert runs["fig5/sign"]["yaw_disturbance_bound"] is None  # at rest d2 does not reach the chains
    assert runs["fig5/linear"]["yaw_disturbance_bound"] == 0.0


def test_margins_at_the_actuators_where_the_reference_is_steady(paper_analysis):
    runs = {one.name: one for one in paper_analysis.runs}
    still = runs["fig5/sign"]
    assert still.actuators is None and "stands still" in still.actuators_reason
    found = runs["fig6-inside/saturation"].actuators
    assert set(found) == {"linear_part", "boundary_layer"}
    motion = ana.steady_motion(br.blocks.circle())
    for name, gain in (
        ("linear_part", ana.sliding_gain(C, Q)),
        ("boundary_layer", ana.boundary_layer_gain(C, Q, P, PHI)),
    ):
        loop = ana.actuator_loop_transfer(gain, motion, 2)
        assert found[name].u2.delay == pytest.approx(ana.loop_margins(loop).delay, rel=1e-9)
        assert found[name].disk_both.radius == pytest.approx(ana.disk_margin(ana.actuator_loop(gain, motion)).radius)


def test_files_and_figures(chatter_analysis, tmp_path):
    heard = []
    written = write_analysis(chatter_analysis, tmp_path / "new" / "out", progress=lambda *seen: heard.append(seen))
    data = json.loads(written.analysis.read_text(encoding="utf-8"))
    assert data["study"] == "mine"
    assert data["provenance"]["study_sha256"] == chatter_analysis.study.digest()
    assert data["provenance"]["resolved_study"]["chatter"][0]["lags_s"][0] == [0.005, 0.005]
    names = {path.stem for path in written.figures}
    assert names >= FIGURES | {"describing-function", "relay-locus", "chatter-1", "chatter-2"}
    assert sorted(data["figures"]) == sorted(f"figures/{path.name}" for path in written.figures)
    for path in written.figures:
        text = path.read_text(encoding="utf-8")
        assert ElementTree.fromstring(text).tag.endswith("svg") and len(text) < 3e5
    assert heard[0][0] == 0 and heard[-1][0] == heard[-1][1] == len(names)
    assert sorted(one.name for one in (tmp_path / "new" / "out").iterdir()) == ["analysis.json", "figures"]


def test_what_is_there_stays_whole_when_the_writing_fails(chatter_analysis, tmp_path, monkeypatch):
    monkeypatch.setattr(module, "analysis_figures", lambda *_: {"poles": "<svg/>"})
    written = write_analysis(chatter_analysis, tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}

    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("os.replace", interrupt)
    with pytest.raises(KeyboardInterrupt):
        write_analysis(chatter_analysis, tmp_path)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before
    assert written.analysis in before


def test_a_file_in_the_place_of_the_folder_is_refused(chatter_analysis, tmp_path):
    (tmp_path / "taken").write_text("mine")
    for folder in (tmp_path / "taken", tmp_path / "taken" / "deeper"):
        with pytest.raises(StudyError, match="is a file where a folder is needed"):
            write_analysis(chatter_analysis, folder)
    assert (tmp_path / "taken").read_text() == "mine"


def test_an_unstable_loop_has_no_margins_and_does_not_stop_the_rest(mine, tmp_path):
    text = mine.read_text().replace(
        '[[laws]]\nname = "relay"', '[parameters]\nQ_per_s = 0.0\n\n[[laws]]\nname = "relay"'
    )
    mine.write_text(text[: text.index("[[chatter]]")])
    found = analyze_study(mine)
    relay, layer = found.laws
    assert not relay.linear_part.stable and relay.linear_part.margins is None
    assert layer.boundary_layer is not None and layer.boundary_layer.stable
    run = next(one for one in found.runs if one.law == "relay")
    assert run.actuators is None and "not stable" in run.actuators_reason
    assert {path.stem for path in write_analysis(found, tmp_path / "out").figures} >= {"poles", "loop"}


ODD = {
    "linear alone": ('kind = "sign"\nparameters = { P_m_per_s3 = 2.5 }', 'kind = "linear"'),
    "a reference that stands still": ("x_start_m = 1.0", "x_start_m = 1.0\nrate_rad_per_s = 0.0"),
    "other gains in a scenario": ("x_start_m = 1.0", "x_start_m = 1.0\nQ_per_s = 2.0\nC_1_per_s2 = 50.0"),
    "a start at rest": ("eta_start_1_m_per_s = 0.5", "eta_start_1_m_per_s = 0.0"),
    "no guard": ("eta_min_m_per_s = 0.05", "eta_min_m_per_s = 0.0"),
    "a short run": ("duration_s = 3.0", "duration_s = 1e-3"),
    "no switching": ("P_m_per_s3 = 2.5", "P_m_per_s3 = 0.0"),
}


@pytest.mark.parametrize("name", ODD)
def test_odd_studies(small, name):
    small.write_text(small.read_text().replace(*ODD[name]))
    found = analyze_study(small)
    assert analysis_tables(found)
    data = json.loads(json.dumps(analysis_data(found), allow_nan=False))
    assert data["chatter"] == [] and len(data["laws"]) == len(data["runs"]) == 2


def test_figures_of_a_study_without_switching(small, tmp_path):
    small.write_text(small.read_text().replace(*ODD["linear alone"]))
    written = write_analysis(analyze_study(small), tmp_path)
    assert {path.stem for path in written.figures} == FIGURES - {"boundary-layer"}


def test_gains_that_differ_between_scenarios_are_told_apart(small):
    other = '[[scenarios]]\nname = "other"\ntitle = "Other"\nduration_s = 1.0\nparameters = { Q_per_s = 2.0 }\n'
    small.write_text(small.read_text() + other)
    laws = analyze_study(small).laws
    assert [(one.law, one.Q, one.scenarios) for one in laws] == [
        ("linear", 5.0, ("circle",)),
        ("linear", 2.0, ("other",)),
        ("relay", 5.0, ("circle",)),
        ("relay", 2.0, ("other",)),
    ]


def test_progress_counts_every_run_and_point(mine):
    heard = []
    text = mine.read_text()
    mine.write_text(text[: text.rindex("[[chatter]]")])
    analyze_study(mine, progress=lambda *seen: heard.append(seen))
    assert [done for done, _, _ in heard] == sorted(done for done, _, _ in heard)
    assert heard[-1][:2] == (5, 5) and "chatter: two lags" in {what for _, _, what in heard}


def test_tables_fit_their_words(chatter_analysis, paper_analysis):
    from rich.console import Console

    for analysis, words in (
        (chatter_analysis, ("Chatter: two lags", "diverges *", "linear part is unstable")),
        (paper_analysis, ("19.01", "9.229", "18.45", "0.3030", "outside-turned/linear", "guarded")),
    ):
        console = Console(width=130, record=True, file=open("/dev/null", "w"))  # noqa: SIM115
        for table in analysis_tables(analysis):
            console.print(table)
        text = console.export_text()
        assert all(word in text for word in words), text
        assert "nan" not in text and "None" not in text
