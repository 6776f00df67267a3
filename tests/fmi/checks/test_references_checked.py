"""Related files and reference results that an FMU brings: changed files, other numbers, foreign and hostile ones."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from brunovsky.blocks import library
from brunovsky.fmi import Check
from brunovsky.fmi.checks.behaviour import Subject
from brunovsky.fmi.checks.child import answer
from brunovsky.fmi.checks.description import load_description, load_root, static_checks
from brunovsky.fmi.contents import fmu_files

FOLDER = "extra/org.fmi-standard.fmi-ls-ref/"
Files = dict[str, bytes]


@pytest.fixture(scope="module")
def files() -> Files:
    return dict(fmu_files(library.pole_placement()))


@pytest.fixture
def checked(files: Files, tmp_path: Path) -> Callable[..., dict[str, Check]]:
    """Both checks of an unpacked FMU with some of its files replaced; None removes one."""

    def check(changes: dict[str, bytes | None]) -> dict[str, Check]:
        for name, text in (files | changes).items():
            path = tmp_path / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.unlink(missing_ok=True)
            if text is not None:
                path.write_bytes(text)
        description = load_description(tmp_path, load_root(tmp_path, "one"))
        found = {one.name: one for one in static_checks(tmp_path, description)}
        repeated = answer(Subject(tmp_path, description, "CoSimulation"), "reference results")
        return {"related files": found["related files"], "reference results": Check("reference results", *repeated)}

    return check


def test_what_is_shipped_passes(checked: Callable[..., dict[str, Check]]) -> None:
    found = checked({})
    assert {one.status for one in found.values()} == {"passed"}
    assert found["related files"].detail == "5 as the manifest says, 0 missing"
    assert "ramps: v[" in found["reference results"].detail


def test_another_number_fails_both(files: Files, checked: Callable[..., dict[str, Check]]) -> None:
    name = FOLDER + "ramps-outputs.csv"
    lines = files[name].decode().splitlines()
    cells = lines[50].split(",")
    lines[50] = ",".join([cells[0], str(float(cells[1]) + 0.5), *cells[2:]])
    found = checked({name: "\n".join(lines).encode()})
    assert found["related files"].status == found["reference results"].status == "failed"
    assert "ramps-outputs.csv is not the file" in found["related files"].detail
    assert re.search(r"default: .*; ramps: v\[1\] differs by 3\.8e-03", found["reference results"].detail)


def test_stimuli_matter(files: Files, checked: Callable[..., dict[str, Check]]) -> None:
    name = FOLDER + "ramps-inputs.csv"
    header, first, last = files[name].decode().splitlines()
    last = ",".join(["10.0", *(str(2 * float(one)) for one in last.split(",")[1:])])
    found = checked({name: "\n".join([header, first, last]).encode()})
    assert found["reference results"].status == "failed"


def test_a_missing_file_is_allowed_and_none_is_no_failure(checked: Callable[..., dict[str, Check]]) -> None:
    found = checked({FOLDER + "ramps-outputs.csv": None})
    assert found["related files"].detail == "4 as the manifest says, 1 missing"
    assert found["reference results"].status == "passed" and "ramps" not in found["reference results"].detail
    found = checked({FOLDER + "fmi-ls-manifest.xml": None})
    assert found["related files"].status == "passed"
    assert found["reference results"].status == "not provided"


def experiments(text: str) -> bytes:
    return f'<Experiments name="e"><Experiment name="one" {text}</Experiment></Experiments>'.encode()


RESULTS = '<References source="default-outputs.csv"/>'
TIMES = 'startTime="0" stopTime="10" stepSize="0.01"'


@pytest.mark.parametrize(
    ("text", "status", "says"),
    [
        (f"{TIMES}>{RESULTS}", "passed", "one: v[1] differs by 0.0e+00"),  # times as in the draft's text
        (f"{TIMES}>" + RESULTS.replace("/>", ' type="application/hdf5"/>'), "not provided", "no experiments"),
        (f'{TIMES}><Parameters source="p.ssv"/>{RESULTS}', "not run", "parameter sets are not read"),
        (f'{TIMES}><Stimuli source="none.csv"/>{RESULTS}', "failed", "no file of CSV with its stimuli, 'none.csv'"),
        (f'stopTime="10">{RESULTS}', "failed", "from 0 to 10 s with steps of nan s"),
        (f'startTime="9" stopTime="1" stepSize="0.1">{RESULTS}', "failed", "from 9 to 1 s"),
        (f'{TIMES}><References source="../../../../etc/hostname"/>', "not provided", "no experiments"),
        (f'{TIMES}><References source="ramps-inputs.csv"/>', "failed", "one: zd3[2] differs by 1.0e-01"),
        (f'{TIMES}><References source="experiments.exp"/>', "failed", ""),
    ],
)
def test_experiments_of_others(
    files: Files, checked: Callable[..., dict[str, Check]], text: str, status: str, says: str
) -> None:
    found = checked({FOLDER + "experiments.exp": experiments(text)})
    assert found["reference results"].status == status, found
    assert says in found["reference results"].detail
    assert found["related files"].status == "failed"  # it isn't the file any more


def test_a_hostile_manifest_fails_its_check(checked: Callable[..., dict[str, Check]]) -> None:
    bomb = b'<!DOCTYPE x [<!ENTITY a "b">]><fmiReferences/>'
    found = checked({FOLDER + "fmi-ls-manifest.xml": bomb})
    assert {one.status for one in found.values()} == {"failed"}
    assert all("document type" in one.detail for one in found.values())
