"""System structure packages: read back, checked against schemas, diagrams and the FMUs inside."""

from pathlib import Path
from zipfile import ZipFile

import fmpy.ssp
import pytest
from fmpy import read_model_description
from lxml import etree
from ssp_reader import Package

import brunovsky as br
from brunovsky.errors import ModelError, ParameterError
from brunovsky.fmi.ssp import Variant, export_ssp, robot_system, robot_variants
from brunovsky.fmi.ssp.elements import NAMESPACES

SCHEMAS = Path(fmpy.ssp.__file__).parent / "schema"
KINDS = {".ssd": "Description", ".ssv": "ParameterValues", ".ssm": "ParameterMapping"}


def test_it_holds_the_files_of_the_standard(robot_ssp: Path) -> None:
    assert sorted(Package(robot_ssp).files) == [
        "SystemStructure.ssd", "figure5.ssd", "resources/circle.fmu", "resources/figure5.ssv", "resources/figure6.ssv",
        "resources/linearized_robot.fmu", "resources/parameters.ssm", "resources/sliding_mode.fmu",
    ]  # fmt: skip


def test_version_1_is_valid_against_the_schemas_of_the_standard(tmp_path: Path) -> None:
    loop = export_ssp(br.blocks.closed_loop(), tmp_path / "loop.ssp")
    robot = export_ssp(robot_system(), tmp_path / "robot.ssp", variants=robot_variants(), system_connectors=False)
    for path in (loop, robot):
        for name, data in Package(path).files.items():
            if kind := KINDS.get(Path(name).suffix):
                schema = etree.XMLSchema(file=str(SCHEMAS / f"SystemStructure{kind}.xsd"))
                schema.assertValid(etree.fromstring(data))
        values = etree.XMLSchema(file=str(SCHEMAS / "SystemStructureParameterValues.xsd"))
        for inline in Package(path).all(".//ssv:ParameterSet"):
            values.assertValid(etree.fromstring(etree.tostring(inline)))


def test_connections_are_those_of_the_diagram(robot_ssp: Path, tmp_path: Path) -> None:
    assert Package(robot_ssp).connections() == dict(robot_system().connections)
    loop = br.blocks.closed_loop()
    inside = {k: v for k, v in Package(export_ssp(loop, tmp_path / "l.ssp")).connections().items() if "." in k}
    outside = {"plant.d[1]": "d[1]", "plant.d[2]": "d[2]"}
    assert inside == dict(loop.connections) | outside


def test_connectors_of_the_system_are_inputs_and_outputs_of_the_diagram(tmp_path: Path) -> None:
    loop = br.blocks.closed_loop()
    package = Package(export_ssp(loop, tmp_path / "loop.ssp"))
    kinds = {one.get("name"): one.get("kind") for one in package.all("ssd:System/ssd:Connectors/ssd:Connector")}
    assert kinds == {one.name: "input" for one in loop.inputs} | {one.name: "output" for one in loop.outputs}
    assert package.connections()["e1[2]"] == "errors.e1[2]" and package.connections()["v[1]"] == "controller.v[1]"


def test_connectors_have_the_types_and_units_of_the_fmus_inside(robot_ssp: Path, tmp_path: Path) -> None:
    package = Package(robot_ssp)
    units = {one.get("name") for one in package.all("ssd:Units/ssc:Unit")}
    for component in package.all(".//ssd:Component"):
        fmu = tmp_path / "one.fmu"
        fmu.write_bytes(package.files[component.get("source")])
        description = read_model_description(str(fmu))
        assert description.fmiVersion == ("2.0" if "robot1" in robot_ssp.name else "3.0")
        variables = {one.name: one for one in description.modelVariables}
        connectors = component.findall("ssd:Connectors/ssd:Connector", NAMESPACES)
        assert connectors
        for one in connectors:
            behind, kind = variables[one.get("name")], one[0]
            assert one.get("kind") == behind.causality and etree.QName(kind).localname == behind.type
            assert kind.get("unit") == behind.unit and (behind.type == "Boolean" or behind.unit in units)


def test_an_input_that_nothing_drives_has_no_connector(robot_ssp: Path) -> None:
    driven = Package(robot_ssp).connections()
    for component in Package(robot_ssp).all(".//ssd:Component"):
        for one in component.findall("ssd:Connectors/ssd:Connector[@kind='input']", NAMESPACES):
            assert f"{component.get('name')}.{one.get('name')}" in driven


def values(top: etree._Element) -> dict[str, float]:
    rows = top.findall("ssv:Parameters/ssv:Parameter", NAMESPACES)
    return {one.get("name"): float(one[0].get("value")) for one in rows}


@pytest.mark.parametrize("variant", robot_variants(), ids=lambda one: one.name)
def test_both_bindings_set_the_values_of_the_variant(robot_ssp: Path, variant: Variant) -> None:
    package = Package(robot_ssp)
    ssd = "SystemStructure.ssd" if variant.name == "figure6" else f"{variant.name}.ssd"
    (binding,) = package.all("ssd:System/ssd:ParameterBindings/ssd:ParameterBinding", ssd)
    mapping = package.tree(binding[0].get("source"))
    targets = {one.get("source"): one.get("target") for one in mapping}
    at_system = {targets[k]: v for k, v in values(package.tree(binding.get("source"))).items()}
    at_components = {
        f"{component.get('name')}.{name}": value
        for component in package.all(".//ssd:Component", ssd)
        for name, value in values(component.find(".//ssv:ParameterSet", NAMESPACES)).items()
    }
    assert at_system == at_components
    for name, value in variant.parameters.items():
        assert at_system[targets[name]] == value
    (experiment,) = package.all("ssd:DefaultExperiment", ssd)
    assert float(experiment.get("stopTime")) == variant.stop_time


def test_a_shared_parameter_is_mapped_to_all_that_share_it(tmp_path: Path) -> None:
    lag = br.Block(
        "lag",
        inputs=[br.blocks.Input("u", "m")],
        parameters=[br.blocks.Parameter("T", "s", "time constant", 0.1, 1e-3)],
        states=[
            br.blocks.State(
                "y", "m", derivative=(br.blocks.symbol("u") - br.blocks.symbol("y")) / br.blocks.symbol("T")
            )
        ],
        outputs=[br.blocks.Output("y", "m", "behind the lag", br.blocks.symbol("y"))],
    )
    two = br.Diagram(
        "two",
        components={"first": lag, "second": lag},
        connections={"second.u": "first.y"},
        inputs={"u": "first.u"},
        outputs={"y": "second.y"},
        parameters={"T": ("first.T", "second.T")},
    )
    assert two.exports == {"u": ("first.u",), "T": ("first.T", "second.T"), "y": ("second.y",)}
    mapping = Package(export_ssp(two, tmp_path / "two.ssp")).tree("resources/parameters.ssm")
    assert [(one.get("source"), one.get("target")) for one in mapping] == [("T", "first.T"), ("T", "second.T")]


def test_equal_arguments_give_equal_bytes(robot_ssp: Path, tmp_path: Path) -> None:
    version = int(robot_ssp.stem[-1])
    again = export_ssp(
        robot_system(), tmp_path / "r.ssp", ssp_version=version, variants=robot_variants(), system_connectors=False
    )
    assert again.read_bytes() == robot_ssp.read_bytes()


def test_what_a_zip_needs_is_version_2_at_most(robot_ssp: Path) -> None:
    with ZipFile(robot_ssp) as archive:
        assert all(one.extract_version <= 20 and one.compress_type in (0, 8) for one in archive.infolist())


def test_signals_run_from_left_to_right(robot_ssp: Path) -> None:
    boxes = {
        one.get("name"): [
            float(one.find("ssd:ElementGeometry", NAMESPACES).get(key)) for key in ("x1", "y1", "x2", "y2")
        ]
        for one in Package(robot_ssp).all(".//ssd:Component")
    }
    assert boxes["circle"][2] < boxes["sliding_mode"][0] and boxes["sliding_mode"][2] < boxes["linearized_robot"][0]
    lowest = min(one[1] for one in boxes.values())
    for one in Package(robot_ssp).all(".//ssd:Connection"):
        route = one.find("ssd:ConnectionGeometry", NAMESPACES)
        if one.get("startElement") == "linearized_robot":
            assert min(map(float, route.get("pointsY").split())) < lowest


def test_no_two_lines_overlap(robot_ssp: Path) -> None:
    routes = [one for one in Package(robot_ssp).all(".//ssd:ConnectionGeometry")]
    verticals = [float(x) for one in routes for x in set(one.get("pointsX").split())]
    assert len(set(verticals)) == len(verticals)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda path: export_ssp(br.blocks.circle(), path), ModelError, "takes a Diagram"),
        (
            lambda path: export_ssp(br.Diagram("one", components={"c": br.blocks.circle()}), path),
            ModelError,
            "one component only",
        ),
        (lambda path: export_ssp(robot_system(), path, ssp_version=3), ParameterError, "use ssp_version=1 or"),
        (lambda path: export_ssp(robot_system(), path, variants=()), ParameterError, "the variants are none"),
        (lambda path: export_ssp(robot_system(), path, variants=[Variant("a")] * 2), ParameterError, "are a, a"),
        (lambda path: export_ssp(robot_system(), path, variants=[Variant("a", {"QQ": 1})]), ParameterError, "'QQ'"),
        (lambda path: export_ssp(robot_system(), path, platforms=("vax",)), ParameterError, "vax"),
        (lambda _: Variant("a/b"), ParameterError, "cannot be called 'a/b'"),
        (lambda _: Variant("a", stop_time=0.0), ParameterError, "stop_time = 0.0"),
        (
            lambda path: export_ssp(br.blocks.closed_loop(br.blocks.sliding_mode_clocked()), path),
            ModelError,
            "use ssp_version=2",
        ),
    ],
)
def test_what_cannot_be_packed_is_refused(tmp_path: Path, call, error, message) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(error, match=message):
        call(tmp_path / "no.ssp")
    assert not (tmp_path / "no.ssp").exists()
