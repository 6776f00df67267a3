"""Studies through packages: the master of the coupling pages, first order in its step, failures, inputs, own files."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import brunovsky as br
from brunovsky import analysis, cli
from brunovsky.comparison import Comparison, load_study, run_study, write_report
from brunovsky.comparison.agreement import common_instants, differences_table
from brunovsky.comparison.run import _built
from brunovsky.comparison.run_files import hardware_text
from brunovsky.comparison.sensitivity import sensitivity
from brunovsky.comparison.ssp_engine import opened_ssps
from brunovsky.comparison.study import Loop
from brunovsky.comparison.study.loops import Hardware
from brunovsky.errors import StudyError

LAWS = """
[[laws]]
name = "linear"
kind = "linear"

[[laws]]
name = "relay"
kind = "sign"
parameters = { P_m_per_s3 = 2.5 }
"""
OUTSIDE = """
[scenarios.parameters]
eta_min_m_per_s = 0.05
x_start_m = 2.5
eta_start_1_m_per_s = 0.5
"""
SCENARIO = f"""
[[scenarios]]
name = "outside"
title = "Figure 6 of the paper, from outside"
duration_s = 0.3
{OUTSIDE}
"""


def studied(folder: Path, keys: str = 'engine = "ssp"', scenarios: str = SCENARIO, laws: str = LAWS) -> Path:
    path = folder / "six.toml"
    path.write_text(f'name = "six"\ntitle = "Figure 6"\n{keys}\n{laws}\n{scenarios}', encoding="utf-8")
    return path


@pytest.fixture(scope="module", params=["gauss_seidel", "jacobi"])
def coupled(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Comparison:
    keys = f'engine = "ssp"\nstep_size_s = 5e-4\ncommunication_step_s = 2e-3\nscheme = "{request.param}"'
    return run_study(load_study(studied(tmp_path_factory.mktemp("ssp"), keys)))


def test_it_is_the_coupled_simulation(coupled: Comparison) -> None:
    """Read from the package and run from its FMUs, against the diagram in this process: the same to the last digits."""
    for run in coupled.runs:
        one = run.planned
        expected = analysis.coupled_simulation(
            one.loop.block, 0.3, 2e-3, scheme=coupled.study.scheme, step_size=5e-4, parameters=one.parameters
        )
        assert set(run.trajectory.data_vars) <= set(expected.data_vars)
        for name in run.trajectory.data_vars:
            found = run.trajectory[name]
            np.testing.assert_allclose(found.astype(float), expected[name].astype(float), rtol=1e-12, atol=1e-12)
            assert found.attrs["units"] == expected[name].attrs["units"]
            assert found.dtype == expected[name].dtype


def test_the_distance_from_the_native_simulation_is_of_first_order_in_the_step(coupled: Comparison) -> None:
    for run in coupled.runs:
        whole = br.simulate(run.planned.loop.block, 0.3, step_size=5e-4, parameters=run.planned.parameters)
        apart = np.hypot(*(run.trajectory[name].values - whole[name].values[::4] for name in "xy")).max()
        found = run.agreement
        assert found.position == pytest.approx(apart, rel=1e-9) and found.position > 1e-4
        assert found.position_at_half_step / found.position == pytest.approx(0.5, abs=0.03)
        assert found.basis == "coupling" and found.agrees and found.same_status and found.explanation == ""
        assert run.trajectory.sizes["time"] == 151


def test_the_bound_is_kept_where_it_is_known(coupled: Comparison) -> None:
    linear, relay = (run.agreement for run in coupled.runs)
    assert relay.bound is None
    if coupled.study.scheme == "jacobi":
        assert 0.3 * linear.bound < linear.position < linear.bound
    else:
        assert linear.bound is None


def test_the_report_speaks_of_the_coupling_error(coupled: Comparison, tmp_path: Path) -> None:
    written = write_report(coupled, tmp_path)
    text = " ".join(written.report.read_text(encoding="utf-8").split())
    order = "in sequence" if coupled.study.scheme == "gauss_seidel" else "all at once"
    assert f"Run through the FMUs of closed_loop.ssp, which exchange values every 2 ms, {order}" in text
    assert "coupling error of the communication step" in text and "in every run half the step leaves" in text
    assert ("kept by all of them" in text) == (coupled.study.scheme == "jacobi")
    assert "counts as agreement" not in text and "not through an FMU" not in text
    verdict = text[text.index("<li>", text.index('id="verdict"')) :]
    assert verdict.startswith(f"<li>Coupled {order} with inputs held and a communication step of 2 ms")
    assert "error of order 1.0" in verdict or "error of order 0.9" in verdict
    assert (
        text.count("communication step of 2 ms (internal 0.5 ms)") == 2
        and "the communication points, 2 ms apart" in text
    )
    assert "internal step of 0.5 ms" not in text
    assert "says nothing about the model or the integrator" in text
    differences = differences_table([run.agreement for run in coupled.runs])
    assert [row[0] for row in differences.rows] == ["position", *(f"{k}[{i}]" for k in ("eta", "u", "v") for i in "12")]
    assert differences.rows[0][2] == max(run.agreement.position for run in coupled.runs)
    assert differences.rows[0][4] == pytest.approx(0.5, abs=0.03) and "at half of it" in text
    provenance = json.loads(written.metrics.read_text())["provenance"]
    agreement = provenance["agreement_with_native"]
    assert agreement["position_tolerance"] is None and agreement["all_agree"] and agreement["basis"] == "coupling"
    assert (provenance["communication_step"], provenance["scheme"]) == (2e-3, coupled.study.scheme)
    assert len(provenance["ssp_sha256"]) == 64 and provenance["units"]["communication_step"] == "s"
    (file,) = provenance["files"]
    assert file["sha256"] == provenance["ssp_sha256"] and file["hardware"] == "ideal"
    assert file["runs"] == ["outside/linear", "outside/relay"]
    assert [part["name"] for part in file["components"]] == list(coupled.runs[0].planned.loop.block.components)
    assert all(len(part["sha256"]) == 64 and part["sha256"] in text for part in file["components"])
    assert "How it was coupled: Components step " in text and "(no derivatives are exchanged, order 0)" in text
    assert "0.002 s</dd>" in text


def test_runs_that_fail_are_recorded(tmp_path: Path) -> None:
    rest = """
[[scenarios]]
name = "rest"
title = "From rest, under the printed law"
duration_s = 0.1
laws = ["linear"]
[scenarios.parameters]
eta_min_m_per_s = 0.0
eta_start_1_m_per_s = 0.0
"""
    away = SCENARIO.replace("duration_s = 0.3", "duration_s = 40.0\nlaws = ['linear']")
    keys = 'engine = "ssp"\nstep_size_s = 0.01\ncommunication_step_s = 0.05\nscheme = "jacobi"'
    singular, unstable = run_study(load_study(studied(tmp_path, keys, rest + away))).runs
    assert (singular.status.state, singular.status.time) == ("singular", 0.0)
    assert "singular at eta[1] = 0" in singular.status.message and singular.agreement.same_status
    assert unstable.status.state == "diverged" and 0.05 < unstable.status.time < 40.0
    assert float(unstable.trajectory["time"][-1]) == pytest.approx(unstable.status.time)
    assert not unstable.agreement.same_status and not unstable.agreement.agrees


def test_a_disturbance_acts_from_its_instant_on_and_is_held(tmp_path: Path) -> None:
    signal = (
        '[[scenarios.signals]]\nkind = "step"\nstart_s = 0.1\namplitude = { d_1_m_per_s2 = 2.0, d_2_rad_per_s2 = 1.0 }'
    )
    two = SCENARIO + SCENARIO.replace('"outside"', '"pushed"') + signal
    laws = LAWS[: LAWS.index('[[laws]]\nname = "relay"')]
    plain, pushed = run_study(load_study(studied(tmp_path, scenarios=two, laws=laws))).runs
    apart = (pushed.trajectory["eta[1]"] - plain.trajectory["eta[1]"]).values
    assert not apart[:101].any()
    # eta[1]' = u[1] + d[1], and u[1] is an integrator's: the first step shows d[1] alone
    assert apart[101] == pytest.approx(2.0 * 1e-3, rel=1e-2)
    assert pushed.agreement.agrees and pushed.agreement.position < 0.02
    whole = run_study(load_study(studied(tmp_path, scenarios=two, laws=laws)), engine="native").runs
    effect = (whole[1].trajectory["eta[1]"] - whole[0].trajectory["eta[1]"]).values
    assert np.abs(apart - effect).max() < 0.1 * np.abs(effect).max()


@pytest.fixture
def command(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str]]:
    def call(*arguments: object) -> tuple[int, str]:
        monkeypatch.setattr("sys.argv", ["brunovsky", *map(str, arguments)])
        status = 0
        try:
            cli.main()
        except SystemExit as error:
            status = int(error.code or 0)
        return status, capfd.readouterr().err

    return call


def test_the_command_runs_a_study_through_packages(tmp_path: Path, command: Callable[..., tuple[int, str]]) -> None:
    study = studied(tmp_path, 'engine = "native"')
    status, error = command("compare", study, "-o", tmp_path / "out", "--engine", "ssp")
    assert status == 0, error
    assert json.loads((tmp_path / "out" / "metrics.json").read_text())["provenance"]["engine"] == "ssp"
    assert [one.name for one in (tmp_path / "out" / "ssps").iterdir()] == ["closed_loop.ssp"]


def test_components_step_in_the_order_of_feedthrough_whatever_the_file_s(tmp_path: Path) -> None:
    loop = br.fmi.robot_system()
    turned = br.Diagram(
        "robot",
        components={name: loop.components[name] for name in reversed(list(loop.components))},
        connections=loop.connections,
        inputs={one.name: list(loop.exports[one.name]) for one in loop.inputs},
        outputs={one.name: loop.exports[one.name][0] for one in loop.outputs},
    )
    assert list(turned.components) == ["linearized_robot", "sliding_mode", "circle"]
    path = br.export_ssp(turned, tmp_path / "turned.ssp")
    with opened_ssps({Loop(): path}, 1e-3, "gauss_seidel") as engine:
        assert list(engine.packages[Loop()].fmus) == ["circle", "sliding_mode", "linearized_robot"]


def test_names_of_files_are_numbered_each_for_itself(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("brunovsky.fmi.export_ssp", lambda _block, path: path)
    loops = [Loop("disturbance_observer"), Loop(), Loop(hardware=Hardware(lags=(0.01, 0.01)))]
    paths = _built([*loops, Loop(hardware=Hardware(delays=(0.01, 0.0)))], tmp_path, ".ssp", lambda _: None)
    assert [paths[one].stem for one in loops[1:]] == ["closed_loop", "closed_loop_2"]
    assert {path.stem for path in paths.values()} - {"closed_loop", "closed_loop_2"} == {
        "closed_loop_disturbance_observer",
        "closed_loop_3",
    }


@pytest.mark.parametrize(
    ("hardware", "text"),
    [
        (Hardware(), "ideal"),
        (Hardware(lags=(0.01, 0.01), number=2, limits=(1.0, 2.0)), "two lags in series and limits"),
        (Hardware(period=0.02, noisy=True, delays=(0.1, 0.1)), "delays, sampling every 20 ms and noise"),
    ],
)
def test_hardware_of_a_file_in_words(hardware: Hardware, text: str) -> None:
    assert hardware_text(hardware) == text


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("own")
    br.export_ssp(br.blocks.closed_loop(), folder / "loop.ssp")
    br.export_ssp(br.fmi.robot_system(), folder / "robot.ssp")
    br.export_fmu(br.blocks.closed_loop(), folder / "loop.fmu", fmi_version=2)
    br.export_fmu(br.blocks.closed_loop(), folder / "three.fmu", fmi_version=3)
    br.export_fmu(br.blocks.circle(), folder / "circle.fmu", fmi_version=2)
    (folder / "text.ssp").write_text("no archive")
    return folder


@pytest.mark.parametrize(("engine", "file", "bound"), [("ssp", "loop.ssp", 5e-3), ("fmpy", "loop.fmu", 1e-9)])
def test_a_file_of_one_s_own_is_compared_as_another_model(files: Path, engine: str, file: str, bound: float) -> None:
    keys = f'engine = "{engine}"\n{Path(file).suffix[1:]} = "{file}"'
    comparison = run_study(load_study(studied(files, keys)))
    for run in comparison.runs:
        assert run.ok and run.agreement.basis == "models" and run.agreement.position < bound
        assert run.agreement.agrees == (engine == "fmpy") == (run.agreement.explanation == "")
    written = write_report(comparison, files / f"out_{engine}")
    text = " ".join(written.report.read_text(encoding="utf-8").split())
    assert "this compares two models" in text and file in comparison.provenance[engine.replace("fmpy", "fmu")]


def test_what_a_file_of_one_s_own_owes_to_the_step_is_told_by_the_file(files: Path) -> None:
    """Not by the native loop, which here has no lags."""
    plant = br.blocks.robot_with_hardware(lags=0.01)
    br.export_fmu(br.blocks.closed_loop(plant=plant), files / "lagged.fmu", fmi_version=2)
    for run in run_study(load_study(studied(files, 'fmu = "lagged.fmu"'))).runs:
        assert run.agreement.basis == "models" and run.agreement.position > 1e-3
        assert abs(sensitivity(run, "peak_speed")) < 1e-4


@pytest.mark.parametrize(
    ("keys", "told"),
    [
        ('ssp = "none.ssp"', ["none.ssp: there is no such file"]),
        ('ssp = "text.ssp"', ["text.ssp: not a zip archive"]),
        ('ssp = "loop.fmu"', ["loop.fmu: refused", "no SystemStructure.ssd"]),
        ('ssp = "robot.ssp"', ["robot.ssp: has no output 'e1[1]'", "run 'outside/linear'"]),
        ('fmu = "none.fmu"', ["none.fmu: there is no such file"]),
        ('fmu = "text.ssp"', ["text.ssp: not a zip archive"]),
        ('fmu = "loop.ssp"', ["loop.ssp: refused", "no modelDescription.xml"]),
        ('fmu = "three.fmu"', ["three.fmu: is FMI 3.0; give one for co-simulation in FMI 2.0"]),
        ('fmu = "circle.fmu"', ["circle.fmu: has no parameter 'P', which the study sets in run 'outside/linear'"]),
    ],
)
def test_files_that_cannot_be_run_are_told(
    files: Path, keys: str, told: list[str], command: Callable[..., tuple[int, str]]
) -> None:
    study = studied(files, f'engine = "{"ssp" if keys.startswith("ssp") else "fmpy"}"\n{keys}')
    with pytest.raises(StudyError) as caught:
        run_study(load_study(study))
    assert all(one in str(caught.value) for one in told), caught.value
    assert str(caught.value).startswith(f"{study}, line 4: {keys[:3]}: "), "file, line and key"
    status, error = command("compare", study, "-o", files / "refused")
    assert status == 2 and "Traceback" not in error and told[0] in error and "line 4: " in error
    assert "Figure 6" not in error, "no progress bar"


@pytest.mark.parametrize(
    ("keys", "more", "told"),
    [
        ('ssp = "loop.ssp"', "", "ssp is run by engine 'ssp', but engine is 'fmpy'"),
        ('engine = "native"\nfmu = "a.fmu"', "", "write engine = 'fmpy', or remove fmu"),
        ('engine = "ssp"\nscheme = "seidel"', "", "scheme"),
        ('engine = "ssp"\ncommunication_step_s = 0', "", "communication_step_s"),
        ('engine = "ssp"\ncommunication_step_s = 0.0007', "", "a multiple or a fraction of step_size_s"),
        ('engine = "ssp"\ncommunication_step_s = 1e-9', "", "lengthen it"),
        (
            'engine = "ssp"\ncommunication_step_s = 0.01',
            '[[scenarios.signals]]\nkind = "impulse"\nwidth_s = 0.005\namplitude = { d_1_m_per_s2 = 1.0 }',
            "longer than the impulse of signals[1]",
        ),
    ],
)
def test_keys_that_cannot_be_used_are_told(tmp_path: Path, keys: str, more: str, told: str) -> None:
    with pytest.raises(StudyError) as caught:
        load_study(studied(tmp_path, keys, SCENARIO + more))
    assert told in str(caught.value) and str(tmp_path) in str(caught.value)


def test_a_step_that_only_the_other_engine_refuses_is_refused_when_it_is_chosen(tmp_path: Path) -> None:
    study = load_study(studied(tmp_path, 'engine = "native"\ncommunication_step_s = 0.0007'))
    with pytest.raises(StudyError, match=r"study 'six': scenario 'outside': communication_step_s = 0\.0007 cuts"):
        run_study(study, engine="ssp")


def test_common_instants_are_found_on_grids_that_divide_one_another() -> None:
    fine, coarse = np.linspace(0, 1, 1001), np.linspace(0, 1, 251)
    mine, other = common_instants(coarse, fine)
    assert list(mine) == list(range(251)) and list(other) == list(range(0, 1001, 4))
    mine, other = common_instants(fine[:9], coarse)
    assert list(mine) == [0, 4, 8] and list(other) == [0, 1, 2]
    assert not len(common_instants(fine, np.empty(0))[0])
