"""An FMU declares the interfaces in which it runs with the values it starts with, and its binary has no others."""

import zipfile
from collections.abc import Callable
from pathlib import Path

import fmpy
import pytest
import sympy as sp
from fmpy.model_description import ModelDescription

from brunovsky.blocks import Block, Check, Input, Output, Parameter, State, Transition, library, symbols
from brunovsky.errors import ParameterError
from brunovsky.fmi import ComponentError, check_fmu, component, export_fmu, scalar_variables
from brunovsky.fmi.instances import FMU2ModelComponent, FMU3ModelComponent

SIGN = "has no end of events in model exchange"
phi, x, u = symbols("phi", "x", "u")


def layered(width: float) -> Block:
    """A state behind a boundary layer that may vanish, and that is reset where it gets large."""
    return Block(
        "layered",
        inputs=[Input("u", "1", "disturbance")],
        parameters=[Parameter("phi", "1", "half-width of the layer", width, 0.0)],
        states=[State("x", "1", derivative=u - sp.Piecewise((sp.sign(x), sp.Abs(x) >= phi), (x / phi, True)), start=1)],
        outputs=[Output("y", "1", expression=2 * x)],
        transitions=[Transition("large", x > 3, {x: sp.Integer(0)})],
        checks=[Check("layer", phi > 0, f"phi = 0 {SIGN}; set phi > 0", when="model exchange")],
    )


@pytest.mark.parametrize("version", [2, 3])
def test_without_a_width_there_is_nothing_of_model_exchange(
    version: int, described: Callable[..., ModelDescription]
) -> None:
    wide, thin = described(layered(0.1), version), described(layered(0.0), version)
    assert wide.modelExchange is not None and thin.modelExchange is None and thin.coSimulation is not None
    assert wide.numberOfEventIndicators > 0 == thin.numberOfEventIndicators
    indicators = {one.variable.name for one in wide.eventIndicators}
    assert bool(indicators) == (version == 3) and not thin.eventIndicators
    assert {one.name for one in wide.modelVariables} - {one.name for one in thin.modelVariables} == indicators
    assert [one.reinit for one in scalar_variables(layered(0.1), version) if one.name == "x"] == [True]
    assert not any(one.reinit for one in scalar_variables(layered(0.0), version))
    references = [{one.name: one.valueReference for one in each.modelVariables} for each in (wide, thin)]
    assert references[1].items() <= references[0].items()


@pytest.mark.parametrize("version", [2, 3])
def test_an_fmu_that_has_no_model_exchange_passes_its_check(version: int, tmp_path: Path) -> None:
    fmu = export_fmu(layered(0.0), tmp_path / "layered.fmu", version)
    report = check_fmu(fmu)
    assert report.passed, report.failed
    assert {one.part for one in report.checks} == {"file", "description", "CoSimulation"}
    found = fmpy.simulate_fmu(str(fmu), stop_time=0.5, start_values={"phi": 0.5})
    assert found["y"][-1] == pytest.approx(1.0, abs=1e-6)  # x falls at unit rate until it is at phi


@pytest.mark.parametrize("kind", [FMU2ModelComponent, FMU3ModelComponent])
def test_the_binary_makes_no_instance_of_what_it_does_not_declare(kind: type) -> None:
    one = kind.__new__(kind)
    with pytest.raises(Exception, match="Failed to instantiate"):
        one.__init__(library.super_twisting())
    ((category, message),) = one.messages
    assert category == "logStatusError" and "Instantiate" in message and SIGN in message


def test_a_component_says_why(tmp_path: Path) -> None:
    with pytest.raises(
        ParameterError, match=rf"'ModelExchange' of layered in FMI 2: phi = 0 {SIGN}.*; use CoSimulation"
    ):
        component(layered(0.0), interface="ModelExchange")
    with component(layered(0.1), interface="ModelExchange") as one:
        one.setupExperiment()
        one.enterInitializationMode()
        one.setReal([one.references["phi"]], [0.0])
        with pytest.raises(ComponentError, match=SIGN):
            one.exitInitializationMode()


def test_the_reasons_are_text_of_the_source(tmp_path: Path) -> None:
    """Whatever is in a message, it is the same behind the C compiler."""
    message = 'a "law" \\ with 100 %\nof it'
    block = Block("odd", outputs=[Output("y", expression=sp.Integer(1))],
                  checks=[Check("never", sp.false, message, when="model exchange")])  # fmt: skip
    with zipfile.ZipFile(export_fmu(block, tmp_path / "odd.fmu")) as file:
        assert r"\"law\" \\ with 100 %\nof it" in file.read("sources/description.c").decode()
