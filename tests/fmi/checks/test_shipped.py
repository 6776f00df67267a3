"""The FMUs that ship pass every check, in both versions."""

from pathlib import Path

import pytest

from brunovsky import check_fmu
from brunovsky.fmi import Check, export_fmu, shipped_block, shipped_fmus

IN_CI = [(2, "closed_loop"), (3, "linearized_robot"), (3, "sliding_mode_clocked")]
ALL = [
    pytest.param(version, name, id=f"{name}-{version}", marks=() if (version, name) in IN_CI else pytest.mark.slow)
    for version in (2, 3)
    for name in shipped_fmus(version)
]


@pytest.mark.parametrize(("version", "name"), ALL)
def test_every_check_passes(tmp_path: Path, version: int, name: str) -> None:
    report = check_fmu(export_fmu(shipped_block(name), tmp_path / f"{name}.fmu", version))
    assert report.passed, report.failed
    others = {one.name: one.status for one in report.checks if one.status != "passed"}
    assert others == ({"reference results": "not provided", "run": "not run"} if "clocked" in name else {})
    parts = ("CoSimulation", "ModelExchange")[: 1 if name == "super_twisting" else 2]
    assert [one for one in ("CoSimulation", "ModelExchange") if part_of(report.checks, one)] == [*parts]
    for part in parts:
        assert part_of(report.checks, part)["illegal calls"].status == "passed"


def part_of(checks: tuple[Check, ...], part: str) -> dict[str, Check]:
    return {one.name: one for one in checks if one.part == part}


@pytest.mark.slow
def test_the_order_of_rk4_is_seen(tmp_path: Path) -> None:
    report = check_fmu(export_fmu(shipped_block("closed_loop"), tmp_path / "loop.fmu", 3))
    order = float(part_of(report.checks, "ModelExchange")["step refinement"].detail.rpartition("order ")[2])
    assert 3.5 < order < 5.5
