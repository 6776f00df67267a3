"""A package is read as it was written, and what isn't read is refused by name."""

from collections.abc import Callable
from pathlib import Path

import pytest

import brunovsky as br
from brunovsky.errors import BrunovskyError
from brunovsky.fmi import Variant
from brunovsky.fmi.checks.unpacking import unpack_ssp
from brunovsky.fmi.ssp.reading import SystemStructure, read_structure
from brunovsky.fmi.ssp.wiring import wiring


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("ssp") / "loop.ssp"
    return br.export_ssp(br.blocks.closed_loop(), path, variants=[Variant("mine", {"x_start": 1.25})])


def unpacked(package: Path, folder: Path) -> Path:
    unpack_ssp(package, folder)
    return folder


@pytest.fixture(scope="module")
def structure(package: Path, tmp_path_factory: pytest.TempPathFactory) -> SystemStructure:
    return read_structure(unpacked(package, tmp_path_factory.mktemp("unpacked")), "loop.ssp")


def test_components_connections_and_parameters_are_the_diagram_s(structure: SystemStructure) -> None:
    loop = br.blocks.closed_loop()
    plan = wiring(loop, 2, True)
    assert structure.name == loop.name and list(structure.components) == list(loop.components)
    assert {(one.source, one.target) for one in structure.wires} == {(one.source, one.target) for one in plan.wires}
    assert dict(structure.parameters) == {name: tuple(ports) for name, ports in plan.parameters.items()}
    assert [(one.name, one.unit) for one in structure.of_system("input").values()] == [
        (one.name, one.unit) for one in loop.inputs
    ]
    assert structure.connectors["plant", "x"].description == "position of the centre of mass along x"


def test_values_are_the_variant_s(structure: SystemStructure) -> None:
    loop = br.blocks.closed_loop()
    values = loop.parameter_values({"x_start": 1.25})
    for name, ports in structure.parameters.items():
        assert all(structure.values[port] == values[name] for port in ports)
    assert structure.values["plant", "x_start"] == 1.25
    assert structure.ports("plant.x_start") == structure.ports("x_start") and structure.ports("x_begin") == ()


def test_a_value_at_the_system_goes_before_one_at_its_component(package: Path, tmp_path: Path) -> None:
    folder = unpacked(package, tmp_path)
    ssv = folder / "resources" / "mine.ssv"
    ssv.write_text(ssv.read_text().replace('value="1.25"', 'value="0.75"'))
    assert read_structure(folder, "loop.ssp").values["plant", "x_start"] == 0.75


def edited(name: str, old: str, new: str) -> Callable[[Path], None]:
    def edit(folder: Path) -> None:
        path = folder / name
        text = path.read_text()
        assert old in text
        path.write_text(text.replace(old, new, 1))

    return edit


SSD = "SystemStructure.ssd"
WIRE = 'endElement="controller" endConnector="Z1[1]">'


@pytest.mark.parametrize(
    ("edit", "told"),
    [
        (edited(SSD, "<ssd:System ", "<ssd:System"), "not well-formed"),
        (edited(SSD, "<ssd:System", "<!DOCTYPE a><ssd:System"), "document type"),
        (edited(SSD, "<ssd:Elements>", '<ssd:Elements><ssd:System name="inner"/>'), "a System among its elements"),
        (edited(SSD, WIRE, f"{WIRE}<ssc:LinearTransformation/>"), "transforms the values of a connection"),
        (edited(SSD, WIRE, WIRE.replace("Z1[1]", "Z9")), "ends at 'controller.Z9', which is no connector"),
        (edited(SSD, '<ssc:Real unit="m"/>', '<ssc:Real unit="km"/>'), "connected to another unit: km and m"),
        (edited(SSD, "resources/plant.fmu", "../plant.fmu"), "'../plant.fmu', which is not in the package"),
        (edited("resources/mine.ssv", 'value="1.25"', 'value="much"'), "parameter 'x_start' is no number: Real 'much'"),
        (edited("resources/parameters.ssm", '"plant.x_start"', '"wheel.x"'), "binds 'wheel.x'"),
        (lambda folder: (folder / "resources/mine.ssv").unlink(), "names the file 'resources/mine.ssv'"),
    ],
)
def test_what_is_not_read_is_refused(package: Path, tmp_path: Path, edit: Callable[[Path], None], told: str) -> None:
    folder = unpacked(package, tmp_path)
    edit(folder)
    with pytest.raises(BrunovskyError) as caught:
        read_structure(folder, "loop.ssp")
    assert str(caught.value).startswith("loop.ssp: ") and told in str(caught.value)
