"""Packages of both versions against the standard's own schemas and rules for connections, by another project's reader.

pyssp-standard brings the schemas of SSP 2.0, fmpy those of 1.0 alone.
"""

from pathlib import Path
from zipfile import ZipFile

import pytest
from fmpy import read_model_description
from lxml import etree
from ssp_reader import Package

import brunovsky as br
from brunovsky.fmi.ssp import export_ssp, robot_system, robot_variants

pyssp = pytest.importorskip("pyssp_standard")
from pyssp_standard.ssp import SSP  # noqa: E402

SCHEMAS = Path(pyssp.__file__).parent / "resources" / "ssp2"
KINDS = {".ssd": "Description", ".ssv": "ParameterValues", ".ssm": "ParameterMapping"}
LAWS = ("sliding_mode", "sliding_mode_relay", "sliding_mode_sampled", "sliding_mode_clocked", "super_twisting")


@pytest.fixture(scope="module", params=["robot", *LAWS])
def package(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("ssp") / f"{request.param}.ssp"
    if request.param == "robot":
        return export_ssp(robot_system(), path, ssp_version=2, variants=robot_variants(), system_connectors=False)
    return export_ssp(br.blocks.closed_loop(getattr(br.blocks, request.param)()), path, ssp_version=2)


def schema(kind: str) -> etree.XMLSchema:
    return etree.XMLSchema(file=str(SCHEMAS / f"SystemStructure{kind}.xsd"))


def test_version_2_is_valid_against_the_schemas_of_the_standard(package: Path) -> None:
    found = Package(package)
    texts = {name: KINDS[Path(name).suffix] for name in found.files if Path(name).suffix in KINDS}
    assert len(texts) >= 3
    for name, kind in texts.items():
        assert found.tree(name).get("version") == "2.0"
        schema(kind).assertValid(found.tree(name))
    for inline in found.all(".//ssv:ParameterSet"):
        schema("ParameterValues").assertValid(etree.fromstring(etree.tostring(inline)))


def test_the_schemas_are_those_of_version_2() -> None:
    text = etree.parse(SCHEMAS / "SystemStructureDescription.xsd")
    assert "Version: 2.0" in "".join(text.getroot().itertext())
    wrong = etree.fromstring('<ssd:Nothing xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription"/>')
    assert not schema("Description").validate(wrong)


def test_connections_are_allowed_and_each_connector_of_an_input_has_one(package: Path) -> None:
    with SSP(str(package), mode="r") as opened, opened.system_structure as structure:
        assert structure.version == "2.0"
        assert structure.check_connections(connector_not_in_system=True) == []
        ends = [(one.end_element, one.end_connector) for one in structure.connections()]
        starts = {(one.start_element, one.start_connector) for one in structure.connections()}
        inputs = [(part.name, one.name) for part in structure.system.elements for one in kinds(part, "input")]
        outputs = [(None, one.name) for one in kinds(structure.system, "output")]
        assert sorted(ends, key=str) == sorted(inputs + outputs, key=str)
        assert {(None, one.name) for one in kinds(structure.system, "input")} <= starts  # none leads nowhere


def kinds(part: object, kind: str) -> list[object]:
    return [one for one in part.connectors if one.kind == kind]


def test_units_and_types_of_what_is_connected_are_the_same(package: Path) -> None:
    found = Package(package)
    units = {one.get("name") for one in found.all("ssd:Units/ssc:Unit")}
    kinds = {}
    for part in (*found.all("ssd:System"), *found.all(".//ssd:Component")):
        owner = "" if part.tag.endswith("System") else f"{part.get('name')}."
        for one in part.findall("{*}Connectors/{*}Connector"):
            kinds[owner + one.get("name")] = (etree.QName(one[0]).localname, one[0].get("unit"))
    assert {unit for _, unit in kinds.values() if unit} == units
    for target, source in found.connections().items():
        assert kinds[target] == kinds[source]


def test_a_clock_has_no_connector_but_that_of_its_fmu(tmp_path: Path) -> None:
    loop = br.blocks.closed_loop(br.blocks.sliding_mode_clocked())
    path = export_ssp(loop, tmp_path / "loop.ssp", ssp_version=2)
    assert not [one for one in Package(path).all(".//ssd:Connector") if "sampling" in one.get("name")]
    with ZipFile(path) as archive:
        (tmp_path / "controller.fmu").write_bytes(archive.read("resources/controller.fmu"))
    with ZipFile(tmp_path / "controller.fmu") as archive:
        description = etree.fromstring(archive.read("modelDescription.xml"))
    assert [one.get("name") for one in description.iter("Clock")] == ["sampling"]


def test_bindings_set_parameters_of_the_fmus_in_their_units(package: Path, tmp_path: Path) -> None:
    found = Package(package)
    known = {}
    for part in found.all(".//ssd:Component"):
        (tmp_path / "one.fmu").write_bytes(found.files[part.get("source")])
        for one in read_model_description(str(tmp_path / "one.fmu")).modelVariables:
            if one.causality == "parameter" and one.initial == "exact":
                known[f"{part.get('name')}.{one.name}"] = one.unit
        for row in part.findall(".//{*}Parameter"):
            assert known[f"{part.get('name')}.{row.get('name')}"] == row[0].get("unit")
    values = [name for name in found.files if name.endswith(".ssv")]
    targets = {one.get("target"): one.get("source") for one in found.tree("resources/parameters.ssm")}
    for name in values:
        units = {one.get("name"): one[0].get("unit") for one in found.tree(name).iter("{*}Parameter")}
        assert set(units) == set(targets.values())  # none is dropped, none is missing
        assert all(known[target] == units[source] for target, source in targets.items())
