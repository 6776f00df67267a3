"""A fault in a description fails the check that is for it."""

from collections.abc import Callable
from pathlib import Path

import pytest

from brunovsky import check_fmu
from brunovsky.blocks import library


@pytest.fixture(scope="module")
def fmus(exported) -> dict[int, Path]:  # type: ignore[no-untyped-def]
    return {version: exported(library.linearized_robot(), version).fmu for version in (2, 3)}


@pytest.mark.parametrize(
    ("version", "before", "after", "check", "says"),
    [
        (2, '<Unit name="m/s">', '<Unit name="knot">', "variables and structure", 'unit "m/s"'),
        (3, '<Unit name="m/s">', '<Unit name="knot">', "variables and structure", 'unit "m/s"'),
        (2, 'dependencies="', 'dependencies="99999 ', "readable", "dependency 99999 is not a variable"),
        (3, 'dependencies="', 'dependencies="99999 ', "readable", "dependency 99999 is not a variable"),
        (3, '<Output valueReference="', '<Output valueReference="99', "readable", "is not a variable"),
        (3, 'stopTime="10', 'stopTime="ten', "default experiment", "ten"),
        (3, 'canGetAndSetFMUState="true"', 'canGetAndSetFMUState="false"', "capability flags", "serialises its state"),
        (2, 'modelIdentifier="linearized_robot"', 'modelIdentifier="other"', "binary for this machine", "other.so"),
        (2, '<File name="model.c"/>', '<File name="lost.c"/>', "listed sources", "sources/lost.c"),
        (3, 'stopTime="10', 'stopTime="-10', "default experiment", "not after the start time"),
        (3, "<ModelVariables>", "<ModelVariables><Oddity/>", "schema", "Oddity"),
        (2, 'causality="output"', 'causality="outlet"', "schema", "outlet"),
    ],
)
def test_a_fault_fails_its_check(fmus, edited, version, before, after, check, says) -> None:  # type: ignore[no-untyped-def]
    found = {one.name: one.detail for one in check_fmu(edited(fmus[version], before, after), run=False).failed}
    assert says in found[check], found


def test_no_library_from_elsewhere_is_loaded(tiny: Callable[..., Path], edited: Callable[..., Path]) -> None:
    report = check_fmu(edited(tiny(), 'modelIdentifier="tiny"', 'modelIdentifier="../linux64/tiny"'))
    assert {"binary for this machine", "capability flags"} == {one.name for one in report.failed}
    assert report.checks[-1].status == "not run"


def test_another_token_gives_no_instance(fmus: dict[int, Path], edited: Callable[..., Path]) -> None:
    report = check_fmu(edited(fmus[2], 'guid="{', 'guid="{0'))
    assert {(one.part, one.name) for one in report.failed} == {
        ("CoSimulation", "life cycle"),
        ("ModelExchange", "life cycle"),
    }
    assert all("instantiate" in one.detail for one in report.failed)
