"""Adjoint derivatives that are not the transpose of the directional ones fail their check, and no other."""

from collections.abc import Callable
from pathlib import Path

import pytest
import sympy as sp

from brunovsky import check_fmu
from brunovsky.blocks import Block, Input, Mode, Output, State, Transition, symbols
from brunovsky.fmi import Check, export_fmu

NAME = "adjoint derivatives"


def pair() -> Block:
    """Two states, two inputs, no two entries of the Jacobian alike."""
    x, y, u, w = symbols("x", "y", "u", "w")
    return Block(
        "pair",
        inputs=[Input("u", start=0.3), Input("w", start=0.7)],
        states=[State("x", derivative=2 * u - x * y, start=0.5), State("y", derivative=sp.sin(x) * w - 3 * y, start=1)],
        outputs=[Output("a", expression=x * u + 5 * w), Output("b", expression=y**2)],
    )


def adjoints(checks: tuple[Check, ...]) -> dict[str, Check]:
    return {one.part: one for one in checks if one.name == NAME}


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("0 : one->columns[column];", "0 : 1.000001 * one->columns[column];"),
        pytest.param("vector[index] += seed[i];", "vector[index] += seed[0];", marks=pytest.mark.slow),
    ],
    ids=["scaled", "one seed for all"],
)
def test_a_fault_fails_its_check(planted: Callable[..., Path], before: str, after: str) -> None:
    report = check_fmu(planted(pair(), "sensitivity.c", before, after))
    assert {(one.part, one.name) for one in report.failed} == {("CoSimulation", NAME), ("ModelExchange", NAME)}
    assert all("is given as" in one.detail and "from directional ones it is" in one.detail for one in report.failed)


def test_what_is_not_claimed_or_has_no_counterpart_is_not_failed(edited: Callable[..., Path], tmp_path: Path) -> None:
    fmu = export_fmu(pair(), tmp_path / "pair.fmu", 3)
    without = edited(fmu, 'providesAdjointDerivatives="true"', 'providesAdjointDerivatives="false"')
    assert sorted(one.status for one in adjoints(check_fmu(without).checks).values()) == ["not provided", "passed"]
    alone = edited(fmu, 'providesDirectionalDerivatives="true"', 'providesDirectionalDerivatives="false"')
    assert sorted(one.status for one in adjoints(check_fmu(alone).checks).values()) == ["not run", "passed"]


def test_where_the_first_instant_has_an_event_derivatives_are_taken_later(tmp_path: Path) -> None:
    x, u, begun = symbols("x", "u", "begun")
    block = Block(
        "begins",
        inputs=[Input("u", start=0.3)],
        modes=[Mode("begun")],
        states=[State("x", derivative=u - x, start=sp.S.Zero)],
        outputs=[Output("y", expression=x * u)],
        transitions=[Transition("begin", sp.Eq(begun, 0), {begun: sp.S.One, x: u})],
    )
    report = check_fmu(export_fmu(block, tmp_path / "begins.fmu", 3))
    assert report.passed, report.failed
    found = {one.part: one.detail for one in report.checks if "derivatives" in one.name}
    assert "after 3 steps, as initialisation mode refuses them" in found["CoSimulation"]
    assert "after" not in found["ModelExchange"]
