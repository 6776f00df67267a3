"""modelDescription.xml of any block: valid, complete, and with the value references that the binary computes."""

import dataclasses

import pytest
from fmpy import read_model_description
from fmpy.validation import validate_fmu
from fmu_driver import Driver
from lxml import etree

from brunovsky.blocks import Block, Output, Parameter, library
from brunovsky.errors import ModelError
from brunovsky.fmi import scalar_variables
from brunovsky.native.output_derivatives import output_derivatives


@pytest.fixture(params=["zoo", "relay", "sampled_integrator", "ball", "circle", "sliding_mode", "robot_plant"])
def any_fmu(request, exported):
    blocks = {"circle": library.circle, "sliding_mode": library.sliding_mode, "robot_plant": library.robot}
    name = request.param
    return exported(blocks[name]() if name in blocks else request.getfixturevalue(name))


def test_fmpy_finds_nothing_in_the_fmu_of_any_block(any_fmu):
    assert validate_fmu(str(any_fmu.fmu)) == []


def test_both_interfaces_say_what_they_can(any_fmu):
    description = read_model_description(str(any_fmu.fmu))
    for one in (description.coSimulation, description.modelExchange):
        assert one.modelIdentifier == any_fmu.block.name
        assert one.canGetAndSetFMUstate and one.canSerializeFMUstate
        assert one.providesDirectionalDerivative and not one.canBeInstantiatedOnlyOncePerProcess
    assert description.coSimulation.canHandleVariableCommunicationStepSize
    assert description.coSimulation.canInterpolateInputs
    assert description.coSimulation.maxOutputDerivativeOrder == output_derivatives(any_fmu.block).order == 3
    assert not description.modelExchange.completedIntegratorStepNotNeeded
    assert description.numberOfEventIndicators == len(any_fmu.block.indicators)
    assert description.generationDateAndTime is None


def test_every_unknown_declares_its_dependencies(any_fmu):
    root = etree.fromstring((any_fmu.folder / "modelDescription.xml").read_bytes())
    unknowns = root.findall("ModelStructure//Unknown")
    assert unknowns
    for one in unknowns:
        knowns = one.attrib["dependencies"].split()
        assert knowns == sorted(knowns, key=int)
        assert len(knowns) == len(one.attrib["dependenciesKind"].split())


def test_the_binary_knows_each_variable_by_the_same_reference_and_type(any_fmu):
    with Driver(any_fmu.folder) as instance:
        instance.initialize()
        expected = {one.name: one.start for one in any_fmu.block.inputs}
        expected |= {one.name: one.value for one in any_fmu.block.parameters}
        for name, value in expected.items():
            assert instance.get(name) == [value]
        for name, one in instance.variables.items():
            instance.get(name)
            wrong = "Boolean" if one.type != "Boolean" else "Real"
            one.type = wrong
            assert instance.status_of_get(name) == 3
            assert name.removeprefix("der(").removesuffix(")") in instance.text
            assert "type" in instance.text


def test_an_output_that_is_a_state_sample_or_mode_is_exposed_once(zoo):
    names = [one.name for one in scalar_variables(zoo)]
    assert names == [
        "time", "step_size", "solver", "x_start", "gain", "u", "x", "gear", "fast", "copy", "mixed", "y", "held",
        "hidden", "der(x)", "der(y)",
    ]  # fmt: skip


def test_types_and_variabilities_follow_from_the_expressions(zoo):
    found = {one.name: (one.type, one.variability, one.causality) for one in scalar_variables(zoo)}
    assert found["gear"] == ("Integer", "discrete", "output")
    assert found["fast"] == ("Boolean", "discrete", "output")
    assert found["copy"] == ("Real", "discrete", "output")
    assert found["mixed"] == ("Real", "continuous", "output")
    assert found["held"] == ("Real", "discrete", "local")
    assert found["hidden"] == ("Integer", "discrete", "local")
    assert found["gain"] == ("Real", "tunable", "parameter")
    assert [one.name for one in scalar_variables(zoo) if one.reinit] == ["y"]


def test_text_with_special_characters_survives(zoo, exported):
    assert read_model_description(str(exported(zoo).fmu)).description == zoo.description


def test_a_block_without_states_has_no_solver(exported):
    circle = exported(library.circle())
    names = {one.name for one in scalar_variables(circle.block)}
    assert "step_size" in names and "solver" not in names
    with Driver(circle.folder) as instance:
        instance.initialize()
        instance.variables["step_size"].valueReference = 2
        assert instance.status_of_get("step_size") == 3
        assert "no variable with value reference 2" in instance.text


@pytest.mark.parametrize("name", ["step_size", "solver"])
def test_names_that_every_fmu_has_are_refused(name, sampled_integrator):
    block = Block("taken", parameters=(Parameter(name),), outputs=(Output("y", expression=Parameter(name).symbol),))
    with pytest.raises(ModelError, match=f"taken: '{name}'"):
        scalar_variables(block)
    assert scalar_variables(dataclasses.replace(sampled_integrator, name="free"))
