"""The command line: what it prints, writes and exits with."""

import json
from pathlib import Path
from zipfile import ZipFile

import pytest
from fmpy import read_model_description
from fmpy.validation import validate_fmu

from brunovsky import cli
from brunovsky._resources import resource


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]):  # type: ignore[no-untyped-def]
    def call(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr("sys.argv", ["brunovsky", *map(str, arguments)])
        monkeypatch.setenv("COLUMNS", "200")
        status = 0
        try:
            cli.main()
        except SystemExit as error:
            status = int(error.code or 0)
        written = capfd.readouterr()
        return status, written.out, written.err

    return call


def test_derive_prints_the_derivation(run) -> None:  # type: ignore[no-untyped-def]
    status, out, _ = run("derive")
    assert status == 0
    for piece in ("relative degree", "-eta_1", "w_1"):
        assert piece in out
    status, out, _ = run("derive", "robot", "--latex")
    assert status == 0 and "\\begin" in out


def test_derive_takes_a_plant_of_the_gallery(run) -> None:  # type: ignore[no-untyped-def]
    status, out, _ = run("derive", "trailer")
    assert status == 0 and "Transformation of the inputs" in out


def test_list_derives_nothing(run, monkeypatch: pytest.MonkeyPatch) -> None:  # type: ignore[no-untyped-def]
    def derived() -> None:
        """What it is."""
        raise AssertionError("list has derived a system")

    for name in cli.SYSTEMS:
        monkeypatch.setitem(cli.SYSTEMS, name, derived)  # type: ignore[arg-type]
    status, out, _ = run("list")
    assert status == 0 and out.count("What it is") == len(cli.SYSTEMS)


def test_list_names_everything_that_ships(run) -> None:  # type: ignore[no-untyped-def]
    status, out, _ = run("list")
    assert status == 0
    for name in (*cli.SYSTEMS, *cli.BLOCKS, "paper", "chatter"):
        assert name in out


def test_build_writes_valid_fmus_of_both_versions(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    status, out, _ = run("build", "-o", tmp_path, "circle", "linearized_robot")
    assert status == 0
    for version in (2, 3):
        for name in ("circle", "linearized_robot"):
            path = tmp_path / f"fmi{version}" / f"{name}.fmu"
            assert str(path) in out and validate_fmu(str(path)) == []


def test_build_writes_the_package_that_ships(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    for arguments, version in (([], "2.0"), (["--ssp", "2"], "3.0")):
        status, out, _ = run("build", "-o", tmp_path, "--ssp", "1", "circle", *arguments)
        path = tmp_path / "ssp" / "robot.ssp"
        assert status == 0 and str(path) in out.split()
        with ZipFile(path) as archive:
            archive.extract("resources/circle.fmu", tmp_path)
        assert read_model_description(tmp_path / "resources" / "circle.fmu").fmiVersion == version


def test_build_writes_the_version_asked_for(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    for version in ("2", "3"):
        status, out, _ = run("build", "-o", tmp_path / version, "--fmi", version, "circle")
        assert status == 0 and out.strip() == str(tmp_path / version / f"fmi{version}" / "circle.fmu")


def test_build_knows_that_clocks_need_fmi_3(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    status, out, _ = run("build", "-o", tmp_path, "sliding_mode_clocked")
    assert status == 0 and out.strip() == str(tmp_path / "fmi3" / "sliding_mode_clocked.fmu")
    status, out, err = run("build", "-o", tmp_path, "--fmi", "2", "sliding_mode_clocked")
    assert status == 2 and out == "" and "sliding_mode_clocked has clocks (sampling), which FMI 2 does not know" in err
    assert not (tmp_path / "fmi2").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["derive", "bicycle"], "there is no system 'bicycle'; did you mean 'unicycle'?"),
        (["derive", "gyroscope"], "there is no system 'gyroscope'; there is robot, ball_and_beam"),
        (["build", "aeroplane"], "there is no block 'aeroplane'; there is robot, linearized_robot"),
        (["build", "--fmi", "1"], "'1' is not"),
        (["build", "--platform", "vax"], "'vax' is not"),
        (["derive", "Robot"], "did you mean 'robot'?"),
        (["build", "robott"], "did you mean 'robot'?"),
        (
            ["compare", "no-such-study"],
            "'no-such-study' is not a .toml file, and there is no study 'no-such-study'; there is ",
        ),
        (["compare", "papper"], "did you mean 'paper'?"),
        (["compare", "missing.toml"], "missing.toml"),
        (["compare"], "Missing argument"),
        (["analyze", "no-such-study"], "there is no study 'no-such-study'; there is "),
        (["analyze", "chater"], "did you mean 'chatter'?"),
        (["analyze", "missing.toml"], "missing.toml: there is no such study file; check the path"),
        (["analyze"], "Missing argument"),
        (["frobnicate"], "No such command 'frobnicate'"),
    ],
)
def test_unusable_input_is_one_line_and_status_2(run, arguments: list[str], message: str) -> None:  # type: ignore[no-untyped-def]
    status, out, err = run(*arguments)
    assert status == 2 and out == ""
    assert err.startswith("brunovsky: ") and message in err
    assert err.count("\n") == 1 and "Traceback" not in err


def test_debug_shows_the_traceback(run) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(Exception, match="there is no system"):
        run("--debug", "derive", "aeroplane")


def test_unknown_key_of_a_study_is_named(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    shipped = Path(cli.resource("comparisons", "paper.toml")).read_text()
    study = tmp_path / "mine.toml"
    study.write_text(f"colour = 'red'\n{shipped}")
    status, _, err = run("compare", study, "-o", tmp_path / "out")
    assert status == 2 and "mine.toml" in err and "colour" in err
    assert not (tmp_path / "out").exists()


ANALYZED = """
name = "mine"
title = "A study [with] brackets"
[[laws]]
name = "relay"
kind = "sign"
[[scenarios]]
name = "circle"
title = "Circle"
duration_s = 1.0
[[chatter]]
title = "two [b] lags"
lags_s = [[0.005, 0.005], [0.02, 0.02]]
"""


def test_analyze_prints_tables_and_writes_figures_and_numbers(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    study = tmp_path / "mine.toml"
    study.write_text(ANALYZED)
    status, out, err = run("analyze", study, "-o", tmp_path / "out")
    assert status == 0 and "Traceback" not in err and "chatter: two" not in out
    for piece in ("19.01", "9.229", "18.45", "0.3030", "Chatter: two [b] lags", "diverges", "circle/relay"):
        assert piece in out
    data = json.loads((tmp_path / "out" / "analysis.json").read_text())
    assert [row["lag_s"] for row in data["chatter"]] == [[0.005, 0.005], [0.02, 0.02]]
    assert data["chatter"][1]["simulated_amplitude"] is None
    assert (tmp_path / "out" / "figures" / "describing-function.svg").exists()
    assert str(tmp_path / "out" / "analysis.json") in out


def test_analyze_goes_to_build_and_leaves_nothing_when_stopped(run, monkeypatch, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    from brunovsky.comparison import analyze

    def interrupt(loops: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(analyze, "chatter_table", interrupt)
    (tmp_path / "mine.toml").write_text(ANALYZED)
    status, out, err = run("analyze", "mine.toml")
    assert status == 130 and out == "" and err.endswith("brunovsky: stopped\n")
    assert not (tmp_path / "build").exists()


def test_analyze_refuses_what_it_cannot_use_before_any_work(run, monkeypatch, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    study = tmp_path / "mine.toml"
    study.write_text(ANALYZED.replace("lags_s", "lags_ms"))
    status, out, err = run("analyze", study, "-o", tmp_path / "out")
    assert status == 2 and out == "" and err.count("\n") == 1
    assert "mine.toml, line 13: chatter[1].lags_ms: unknown key" in err and "write lags_s" in err
    study.write_text(ANALYZED)
    status, out, err = run("analyze", study, "-o", study)
    assert status == 2 and out == "" and err.count("\n") == 1 and "is a file where a folder is needed" in err
    assert sorted(one.name for one in tmp_path.iterdir()) == ["mine.toml"]


def test_failed_runs_are_named_and_all_of_them_failing_is_status_1(run, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    study = tmp_path / "rest.toml"
    study.write_text(
        """
name = "rest"
title = "A start at rest without the guard"
description = "Fails at once."
model = "closed_loop"
engine = "native"
step_size_s = 1e-3
{shared}
[[laws]]
name = "linear"
kind = "linear"

[[scenarios]]
name = "rest"
title = "At rest"
duration_s = 0.1
[scenarios.parameters]
eta_start_1_m_per_s = 0.0
eta_min_m_per_s = 0.0
""".replace("{shared}", "")
    )
    status, out, err = run("compare", study, "-o", tmp_path / "out")
    assert status == 1 and "report.html" in out
    assert "rest/linear failed: " in err and "singular at eta[1] = 0" in err
    assert (tmp_path / "out" / "report.html").exists()


def test_an_unusable_study_does_not_hide_the_others(run, monkeypatch, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "mine.toml").write_text("colour = 'red'")
    monkeypatch.setattr(cli, "resource", lambda *parts: tmp_path)
    status, out, _ = run("list")
    assert status == 0 and "mine" in out and "unusable" in out and "closed_loop" in out


def test_help_and_version(run) -> None:  # type: ignore[no-untyped-def]
    for arguments in ((), ("-h",), ("--help",)):
        status, out, err = run(*arguments)
        assert status == 0 and "Usage: " in out and err == ""
    status, out, _ = run("--version")
    assert status == 0 and out.strip() == cli.br.__version__


def test_ctrl_c_is_status_130(run, monkeypatch: pytest.MonkeyPatch) -> None:  # type: ignore[no-untyped-def]
    def interrupt() -> None:
        raise KeyboardInterrupt

    monkeypatch.setitem(cli.SYSTEMS, "robot", interrupt)  # type: ignore[arg-type]
    status, _, err = run("derive")
    assert status == 130 and err == "brunovsky: stopped\n"


def test_schema_is_printed_as_it_ships(run) -> None:  # type: ignore[no-untyped-def]
    status, out, _ = run("schema")
    assert status == 0 and out == resource("comparisons", "study.schema.json").read_text(encoding="utf-8")
