"""A fault in what an FMU does fails the check that is for it, and no other; a crash or hang ends no more than that."""

from collections.abc import Callable
from pathlib import Path

import pytest

from brunovsky import check_fmu
from brunovsky.fmi import CheckReport


def failed(report: CheckReport) -> dict[str, str]:
    return {one.name: one.detail for one in report.failed}


def test_a_sound_fmu_of_another_tool_passes(tiny: Callable[..., Path]) -> None:
    report = check_fmu(tiny(), strict=True)
    assert report.passed, failed(report)
    found = {one.name: one for one in report.checks}
    assert found["step refinement"].detail.endswith("order 1.0")  # Euler's rule
    assert found["life cycle"].detail.startswith("100 steps of 0.01 s")
    assert {one.name for one in report.checks if one.status != "passed"} == {"reference results"}  # it has none
    assert (report.model, report.fmi_version) == ("tiny", "2.0")


@pytest.mark.parametrize(
    ("fault", "checks", "says"),
    [
        pytest.param("ANY_TOKEN", {"wrong token"}, "another token", marks=pytest.mark.slow),
        pytest.param("ENDLESS", {"stop time"}, "beyond the stop time, 1 s", marks=pytest.mark.slow),
        pytest.param("IGNORES_RESET", {"reset"}, "outputs differ by", marks=pytest.mark.slow),
        pytest.param("ANY_VARIABLE", {"illegal calls"}, "a variable that there isn't", marks=pytest.mark.slow),
        ("FEEDTHROUGH", {"declared dependencies"}, "y changes by 1 with u"),
        ("WRONG_DERIVATIVE", {"directional derivatives"}, "d y / d u is given as 1, differences say 0"),
        ("NAN_AT_HALF", {"finite outputs"}, "y is nan at 0.5 s"),
        pytest.param("NOISY", {"step refinement"}, "halved twice", marks=pytest.mark.slow),
        pytest.param("FORGETS", {"state round trip", "serialised state"}, "outputs differ by", marks=pytest.mark.slow),
        pytest.param("LOSES", {"serialised state"}, "outputs differ by", marks=pytest.mark.slow),
        ("SHARED", {"two instances"}, "outputs differ by"),
        pytest.param("CRASHES", {"life cycle"}, "it crashes the process (SIGABRT)", marks=pytest.mark.slow),
        pytest.param("EXITS", {"life cycle"}, "it ends the process with status 0", marks=pytest.mark.slow),
        ("CRASHES_ON_RESTORE", {"state round trip", "serialised state"}, "it crashes the process (SIGABRT)"),
    ],
)
def test_a_fault_fails_its_check(tiny: Callable[..., Path], fault: str, checks: set[str], says: str) -> None:
    found = failed(check_fmu(tiny(fault), strict=True))
    if fault == "SHARED":  # whatever else goes through two instances sees it too
        assert checks <= set(found)
    else:
        assert set(found) == checks
    assert all(says in found[name] for name in checks), found


def test_faults_together_fail_their_checks(tiny: Callable[..., Path]) -> None:
    faults = (
        "ANY_TOKEN",
        "ENDLESS",
        "ANY_VARIABLE",
        "NOISY",
        "FORGETS",
        "LOSES",
        "IGNORES_RESET",
    )  # each alone: among the slow ones
    states = {"state round trip", "serialised state"}
    found = failed(check_fmu(tiny(*faults), strict=True))
    assert set(found) == {"wrong token", "stop time", "illegal calls", "step refinement", "reset", *states}


def test_a_hang_ends_at_the_limit(tiny: Callable[..., Path]) -> None:
    report = check_fmu(tiny("HANGS"), time_limit=1.0)
    assert failed(report) == {"life cycle": "it hangs: not done after 1 s"}
    assert all(
        one.status == "not run" for one in report.checks if one.part == "CoSimulation" and one.name != "life cycle"
    )


def test_illegal_calls_are_not_made_unasked(tiny: Callable[..., Path]) -> None:
    report = check_fmu(tiny("ANY_TOKEN", "ANY_VARIABLE"))
    assert report.passed
    assert not {"wrong token", "illegal calls"} & {one.name for one in report.checks}


def test_features_that_are_not_claimed_are_not_failed(tiny: Callable[..., Path], edited: Callable[..., Path]) -> None:
    claimed = 'canSerializeFMUstate="true" providesDirectionalDerivative="true"'
    report = check_fmu(edited(tiny("FORGETS", "LOSES"), claimed, ""))
    assert [one.name for one in report.failed] == ["state round trip"]
    assert {one.name for one in report.checks if one.status == "not provided"} == {
        "serialised state",
        "directional derivatives",
        "reference results",
    }


def test_what_needs_its_tool_is_run_as_far_as_it_goes(tiny: Callable[..., Path], edited: Callable[..., Path]) -> None:
    before, after = 'modelIdentifier="tiny"', 'modelIdentifier="tiny" needsExecutionTool="true"'
    assert check_fmu(edited(tiny(), before, after)).passed
    report = check_fmu(edited(tiny("CRASHES"), before, after))
    assert report.passed and "needs its tool" in report.checks[-1].detail and report.checks[-1].status == "not run"
