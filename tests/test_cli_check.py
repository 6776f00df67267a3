"""``brunovsky check``: what it prints and exits with."""

import json
import zipfile
from pathlib import Path

import pytest

from brunovsky import cli
from brunovsky.blocks import library
from brunovsky.fmi import export_fmu


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]):  # type: ignore[no-untyped-def]
    def call(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr("sys.argv", ["brunovsky", "check", *map(str, arguments)])
        monkeypatch.setenv("COLUMNS", "200")
        status = 0
        try:
            cli.main()
        except SystemExit as error:
            status = int(error.code or 0)
        written = capfd.readouterr()
        return status, written.out, written.err

    return call


@pytest.fixture(scope="module")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export_fmu(library.pole_placement(), tmp_path_factory.mktemp("fmu") / "[red].fmu")


def test_a_table_of_a_sound_fmu(run, fmu: Path) -> None:  # type: ignore[no-untyped-def]
    status, out, _ = run(fmu)
    assert status == 0
    for piece in (f"{fmu}: pole_placement, FMI 2.0", "model exchange", "life cycle", "100 steps of 0.01 s"):
        assert piece in out
    assert " passed" in out.splitlines()[-2] and "failed" not in out.splitlines()[-2]


def test_a_failed_check_is_status_1(run, fmu: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    bad = tmp_path / "bad.fmu"
    with zipfile.ZipFile(fmu) as before, zipfile.ZipFile(bad, "w") as after:
        for name in before.namelist():
            text = before.read(name)
            after.writestr(
                name, text.replace(b'canGetAndSetFMUstate="true"', b"", 1) if name.endswith(".xml") else text
            )
    status, out, _ = run("--static", "--json", bad, fmu)
    assert status == 1
    reports = json.loads(out)
    assert [one["passed"] for one in reports] == [False, True]
    failed = [one for one in reports[0]["checks"] if one["status"] == "failed"]
    assert [one["name"] for one in failed] == ["capability flags"]


def test_an_unusable_file_is_one_line_and_status_2(run, fmu: Path, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    text = tmp_path / "text.fmu"
    text.write_text("no archive")
    status, out, err = run("--static", text, fmu)
    assert status == 2 and "pole_placement" in out  # the other one is checked
    lines = [line for line in err.splitlines() if line.startswith("brunovsky: ")]
    assert len(lines) == 1 and f"{text}: not a zip archive" in lines[0] and "Traceback" not in err
    status, out, _ = run("--json", text)
    assert status == 2 and "not a zip archive" in json.loads(out)[0]["unusable"]


def test_a_limit_that_is_none(run, fmu: Path) -> None:  # type: ignore[no-untyped-def]
    status, _, err = run("--time-limit", "0", fmu)
    assert status == 2 and "must be positive" in err
    assert run()[0] == 2
