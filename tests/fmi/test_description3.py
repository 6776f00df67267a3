"""modelDescription.xml of FMI 3: valid for any block, with the variables of FMI 2 beside indicators and clocks."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import sympy as sp
from fmpy.model_description import ModelDescription, read_build_description
from lxml import etree

from brunovsky.blocks import Block, Clock, Diagram, Input, Output, Parameter, Sample, State, library, symbols
from brunovsky.fmi import description3, scalar_variables, shipped_block, shipped_fmus
from brunovsky.fmi.build_description import build_description
from brunovsky.fmi.indicators import indicators
from brunovsky.fmi.variables import reference_offsets

sys.path.append(str(Path(__file__).parents[1] / "blocks"))
from gallery_blocks import gallery_block

Describe = Callable[..., ModelDescription]


def clocked() -> Block:
    """Clocks alone make it act: two of them, one with a parameter as period, one sample reading another."""
    a, b, u, w, h = symbols("a", "b", "u", "w", "h")
    return Block(
        "clocked",
        inputs=[Input("u", "m", "sampled by both"), Input("w", "m", "read by nothing but an output")],
        parameters=[Parameter("h", "s", "period of slow", 0.25, 0.01)],
        samples=[
            Sample("b", "m", "reads a", update=a + u, clock="slow", rank=1),
            Sample("a", "m", "a", update=u, clock="quick"),
        ],
        clocks=[Clock("slow", "every h", h), Clock("quick", "", sp.Rational(1, 8))],
        outputs=[Output("a", "m", "a", a), Output("sum", "m", "both", a + b), Output("through", "m", "w", w)],
    )


def user_diagram(ball: Block) -> Block:
    """A bouncing ball of the user's, watched by a saturated law."""
    watch = Block(
        "watch",
        inputs=[Input("height", "m", "height")],
        outputs=[Output("low", "1", "below a metre", symbols("height")[0] < 1)],
    )
    (height,) = [one.name for one in ball.outputs if one.unit == "m"]
    return Diagram(
        "watched",
        components={"ball": ball, "watch": watch},
        connections={"watch.height": f"ball.{height}"},
        outputs={"height": f"ball.{height}", "low": "watch.low"},
    )


WITH_CLOCKS = "sliding_mode_clocked"  # which FMI 2 does not know
OTHERS = [*(one for one in shipped_fmus() if one != WITH_CLOCKS), "unicycle", "quadrotor", "zoo", "relay",
          "sampled_integrator", "ball", "diagram"]  # fmt: skip


@pytest.fixture
def block(request: pytest.FixtureRequest) -> Block:
    name = request.param
    if name in shipped_fmus():
        return shipped_block(name)
    if name in ("unicycle", "quadrotor"):
        return gallery_block(name)[0]
    if name == "diagram":
        return user_diagram(request.getfixturevalue("ball"))
    return request.getfixturevalue(name)


@pytest.mark.parametrize("block", [*OTHERS, WITH_CLOCKS], indirect=True)
@pytest.mark.parametrize("arrays", [False, True], ids=["scalars", "arrays"])
def test_fmpy_finds_nothing_in_any_block(block: Block, arrays: bool, described: Describe) -> None:
    description = described(block, arrays=arrays)
    assert description.fmiVersion == "3.0" and description.instantiationToken == "{token}"
    assert sum(max(1, *one.shape, 1) for one in description.modelVariables) >= len(block.variables)
    assert all(one.description for one in description.modelVariables)
    assert all(one.unit for one in description.modelVariables if one.type == "Float64")
    states = [one.variable.derivative for one in description.derivatives]
    assert sum(one.shape[0] if one.shape else 1 for one in states) == len(block.states)
    assert len(description.eventIndicators) == len(indicators(block))


@pytest.mark.parametrize("block", OTHERS, indirect=True)
def test_scalars_are_those_of_fmi_2(block: Block, described: Describe) -> None:
    types = {"Real": "Float64", "Integer": "Int32"}
    keys = ("valueReference", "causality", "variability", "initial", "unit", "start", "min", "max", "description")
    second, third = described(block, 2), {one.name: one for one in described(block).modelVariables}
    for one in second.modelVariables:
        other = third.pop(one.name)
        assert other.type == types.get(one.type, one.type)
        assert {key: getattr(other, key) for key in keys} == {key: getattr(one, key) for key in keys}
        assert getattr(other.derivative, "name", None) == getattr(one.derivative, "name", None)
    assert len(third) == len(indicators(block))
    references = [one.valueReference for one in third.values()]
    assert references == list(range(reference_offsets(block)["indicators"], reference_offsets(block)["end"]))


def test_an_indicator_that_is_a_state_is_no_unknown_of_initialisation(described: Describe) -> None:
    (x,) = symbols("x")
    block = Block("watched", states=[State("x", "m", derivative=-x, start=1)], outputs=[Output("up", expression=x > 0)])
    description = described(block)  # validated
    assert [one.variable.name for one in description.initialUnknowns] == ["up", "x", "der(x)"]
    assert block.indicators == (x,) and len(description.eventIndicators) == 1


def test_both_interfaces_say_what_they_can() -> None:
    root = etree.fromstring(description3.model_description(library.linearized_robot(), "", "0"))
    flags = {one.tag: {key for key, value in one.attrib.items() if value == "true"} for one in root[:2]}
    common = {"canGetAndSetFMUState", "canSerializeFMUState", "providesPerElementDependencies"}
    common |= {"providesDirectionalDerivatives", "providesAdjointDerivatives", "providesEvaluateDiscreteStates"}
    steps = {"canHandleVariableCommunicationStepSize", "hasEventMode", "providesIntermediateUpdate"}
    steps |= {"mightReturnEarlyFromDoStep", "canReturnEarlyAfterIntermediateUpdate"}
    assert flags == {"ModelExchange": common | {"needsCompletedIntegratorStep"}, "CoSimulation": common | steps}
    assert root.find("ScheduledExecution") is None
    found = {one.get("name"): one.get("intermediateUpdate") for one in root.find("ModelVariables")}
    assert {name for name, value in found.items() if value} == {
        one.name for one in scalar_variables(library.linearized_robot()) if one.causality in ("input", "output")
    } - {"singular"}


def test_indicators_have_name_unit_and_meaning(described: Describe) -> None:
    description = described(library.linearized_robot())
    found = {one.variable.name: one for one in description.eventIndicators}
    assert list(found) == [f"inner_loop.indicator_{one}_eta_min" for one in ("above", "below_minus")]
    first, second = (one.variable for one in found.values())
    assert (first.unit, second.unit, first.causality, first.variability) == ("m/s", "m/s", "local", "continuous")
    assert first.description.startswith("eta[1] - eta_min: ") and second.description.startswith("eta[1] + eta_min: ")
    assert [one.name for one in found[first.name].dependencies if one.causality == "output"] == ["eta[1]"]
    loop = [one.variable for one in described(library.closed_loop()).eventIndicators]
    assert [one.unit for one in loop] == ["m/s2"] * 4 + ["m/s"] * 2
    assert loop[0].name == "controller.indicator_relation_1"


def _switched(expression: sp.Expr) -> Block:
    (x,) = symbols("x")
    return Block(
        "switched",
        states=[State("x", "m", derivative=sp.S.Zero), State("y", "kg.m2/s2", derivative=sp.S.Zero)],
        inputs=[Input("k", "m3"), Input("w", "rad/s")],
        outputs=[Output("up", expression=expression > 0), Output("indicator_relation_1", expression=x * 0 + 1)],
    )


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("x - 3", "m"),
        ("sqrt(x*k) - 2*x**2", "m2"),
        ("y/x", "kg.m/s2"),
        ("x*w**2 - 1", "m.rad2/s2"),
        ("sin(x) - 1/2", "1"),
        ("x + y", "1"),
        ("sqrt(x) - 1", "1"),
        ("w*x - Derivative", "m.rad/s"),
    ],
)
def test_units_of_indicators_follow_from_their_expressions(text: str, unit: str) -> None:
    known = dict(zip("xykw", symbols("x", "y", "k", "w"), strict=True)) | {"Derivative": 5}
    (row,) = [one for one in scalar_variables(_switched(sp.sympify(text, known)), 3) if one.indicator]
    assert row.unit == unit
    assert row.name == "indicator_relation_1_", "the other name is an output's"


def test_clocks_are_inputs_with_their_interval(described: Describe) -> None:
    block = clocked()
    description = described(block)
    variables = {one.name: one for one in description.modelVariables}
    root = etree.fromstring(description3.model_description(block, "", "0"))
    clocks = {one.get("name"): dict(one.attrib) for one in root.iter("Clock")}
    assert list(clocks) == ["slow", "quick"]
    assert {one["causality"] for one in clocks.values()} == {"input"}
    assert (clocks["slow"]["intervalVariability"], clocks["slow"]["intervalDecimal"]) == ("fixed", "0.25")
    assert (clocks["quick"]["intervalVariability"], clocks["quick"]["intervalDecimal"]) == ("constant", "0.125")
    assert [clocks[name]["priority"] for name in ("slow", "quick")] == ["1", "0"], "slow reads what quick updates"
    assert description.scheduledExecution is not None
    both = ["slow", "quick"]
    found = {name: [clock.name for clock in one.clocks] for name, one in variables.items() if one.clocks}
    assert found == {"u": both, "w": both, "a": ["quick"], "b": ["slow"], "sum": both, "through": both}
    assert {variables[name].variability for name in found} == {"discrete"}
    assert not {one.variable.name for one in description.initialUnknowns} & found.keys()
    assert "slow" in {one.name for one in description.outputs[1].dependencies}


def test_beside_states_only_held_samples_are_clocked(described: Describe) -> None:
    held, x, u = symbols("held", "x", "u")
    block = Block(
        "mixed",
        inputs=[Input("u", "m")],
        states=[State("x", "m.s", derivative=held)],
        samples=[Sample("held", "m", update=u, clock="tick")],
        clocks=[Clock("tick", "tick", sp.Rational(1, 10))],
        outputs=[
            Output("copy", "m", expression=held),
            Output("y", "m", expression=2 * held),
            Output("x", "m.s", expression=x),
        ],
    )
    description = described(block)
    assert {one.name for one in description.modelVariables if one.clocks} == {"copy", "held"}
    assert description.scheduledExecution is None
    assert next(one for one in description.modelVariables if one.name == "u").variability == "continuous"


def test_nominal_values_are_those_of_the_block(described: Describe) -> None:
    x = symbols("x")[0]
    block = Block("far", states=[State("x", "m", derivative=-x, nominal=1e6)], outputs=[Output("x", "m", expression=x)])
    for version in (2, 3):
        found = {one.name: one.nominal for one in described(block, version).modelVariables if one.nominal}
        assert found == {"x": "1000000.0"}


def test_the_build_description_lists_the_sources(tmp_path: Path) -> None:
    (tmp_path / "sources").mkdir()
    text = build_description(library.circle(), ("model.c", "fmi3.c"))
    (tmp_path / "sources" / "buildDescription.xml").write_bytes(text)
    for configuration in read_build_description(str(tmp_path)):
        assert configuration.modelIdentifier == "circle"
        assert configuration.sourceFileSets[0].sourceFiles == ["model.c", "fmi3.c"]
    root = etree.fromstring(text)
    libraries = {one.get("platform"): [lib.get("name") for lib in one.iter("Library")] for one in root}
    assert libraries == {None: ["m"], "x86_64-windows": [], "aarch64-windows": []}
