"""What people see of an FMU: icon, terminals and page."""

import io
from pathlib import Path

import fmpy
import pytest
from lxml import etree, html
from PIL import Image

from brunovsky.blocks import Block, Input, Output, library, symbols
from brunovsky.fmi import shipped_block, shipped_fmus
from brunovsky.fmi.contents import fmu_files
from brunovsky.fmi.documentation import documentation
from brunovsky.fmi.icon import icon
from brunovsky.fmi.terminals import terminals, terminals_and_icons
from brunovsky.fmi.variables import scalar_variables

SCHEMAS = Path(fmpy.__file__).parent / "schema" / "fmi3"


def members(block: Block) -> dict[str, tuple[str, ...]]:
    return terminals(block, [one.name for one in scalar_variables(block)])


def test_icons_lie_where_each_version_looks_for_them() -> None:
    two, three = (fmu_files(library.circle(), version) for version in (2, 3))
    picture = icon(library.circle())
    assert two["model.png"] == two["terminalsAndIcons/icon.png"] == three["terminalsAndIcons/icon.png"] == picture
    assert "model.png" not in three
    with Image.open(io.BytesIO(picture)) as image:
        assert image.format == "PNG" and min(image.size) > 50
        corner, middle = (image.convert("RGBA").getpixel(at) for at in ((0, 0), (image.width // 2, image.height // 2)))
    assert corner[3] == 0 and middle[3] == 255 and min(middle[:3]) >= 250  # paper with round corners, on nothing
    assert len(picture) < 5_000


def test_an_icon_follows_the_interface() -> None:
    u, v = symbols("u", "v")
    one = Block("same", inputs=(Input("u"),), outputs=(Output("y", expression=u),))
    other = Block("same", inputs=(Input("v"),), outputs=(Output("y", expression=v),))
    assert icon(one) == icon(one) != icon(other)
    many = Block("many", inputs=tuple(Input(f"u{i}") for i in range(40)))
    with Image.open(io.BytesIO(icon(many))) as image, Image.open(io.BytesIO(icon(one))) as small:
        assert small.height < image.height < 600


@pytest.mark.parametrize("name", shipped_fmus())
def test_terminals_and_page_of_every_fmu_that_ships(name: str) -> None:
    block = shipped_block(name)
    variables = scalar_variables(block, 3)
    names = [one.name for one in variables]
    text = terminals_and_icons(block, names)
    etree.XMLSchema(file=str(SCHEMAS / "fmi3TerminalsAndIcons.xsd")).assertValid(etree.fromstring(text))
    assert {one.get("variableName") for one in etree.fromstring(text).iter("TerminalMemberVariable")} <= set(names)
    page = documentation(block, variables)
    root = html.document_fromstring(page)
    assert {one.text_content() for one in root.iter("h2")} >= {"Variables", "Equations"}
    assert b"http" not in page and b"<script" not in page  # nothing from a network
    cells = {one.text for one in root.iter("code")}
    assert set(names) <= cells
    formulas = [one for one in root.iter("math") if one.get("displaystyle")]
    computed = [one for one in block.outputs if one.expression != one.symbol]
    assert len(formulas) == len(computed) + 2 * (len(block.states) + len(block.samples)) + len(block.relations)


def test_robot_loop_and_reference_connect_by_terminals() -> None:
    plant, reference = members(library.linearized_robot()), members(library.circle())
    for law in (library.sliding_mode, library.pole_placement, library.super_twisting):
        outer = members(law())
        assert sorted(outer) == ["chains", "command", "reference"]
        assert set(outer["chains"]) == set(plant["chains"]) and len(plant["chains"]) == 6
        assert set(outer["command"]) == set(plant["command"]) == {"v[1]", "v[2]"}
        assert set(outer["reference"]) == set(reference["reference"]) and len(outer["reference"]) == 8
    assert members(library.robot()) == {}


def test_arrays_are_members_as_a_whole() -> None:
    files = fmu_files(library.circle(), 3, arrays=True)
    root = etree.fromstring(files["terminalsAndIcons/terminalsAndIcons.xml"])
    shown = [one.get("variableName") for one in root.iter("TerminalMemberVariable")]
    assert shown == [*(f"Z{i}d[{k}]" for i in (1, 2) for k in (1, 2, 3)), "zd3"]  # the others have different units


def test_texts_are_escaped_on_the_page() -> None:
    block = Block("tricky", 'a <b> & "c"', inputs=(Input("u", description="x < y"),))
    page = html.document_fromstring(documentation(block, scalar_variables(block)))
    assert page.findtext(".//p") == 'a <b> & "c"'
    assert page.find(".//b") is None
