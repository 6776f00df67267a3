"""A system structure description as it opens in a tool: its own geometry, drawn."""

from __future__ import annotations

from pathlib import Path
from zipfile import ZipFile

from lxml import etree
from matplotlib import pyplot
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

SSD = "{http://ssp-standard.org/SSP1/SystemStructureDescription}"
CORNERS = ("x1", "y1", "x2", "y2")


def draw(package: Path, description: str = "SystemStructure.ssd") -> Axes:
    """Axes with components, connectors and lines where the description puts them."""
    with ZipFile(package) as archive:
        system = etree.fromstring(archive.read(description)).find(f"{SSD}System")
    places: dict[tuple[str | None, str], tuple[float, float]] = {}
    _, ax = pyplot.subplots(figsize=(8, 3.6))
    ax.set(aspect="equal")
    ax.axis("off")
    _element(ax, system, system.find(f"{SSD}SystemGeometry"), None, places)
    for component in system.iter(f"{SSD}Component"):
        _element(ax, component, component.find(f"{SSD}ElementGeometry"), component.get("name"), places)
    for one in system.iter(f"{SSD}Connection"):
        route = one.find(f"{SSD}ConnectionGeometry")
        between = (
            [] if route is None else list(zip(_numbers(route, "pointsX"), _numbers(route, "pointsY"), strict=True))
        )
        start = places[one.get("startElement"), one.get("startConnector")]
        end = places[one.get("endElement"), one.get("endConnector")]
        ax.plot(*zip(start, *between, end, strict=True), color="0.35", linewidth=0.7)
    return ax


def _element(
    ax: Axes,
    element: etree._Element,
    geometry: etree._Element,
    name: str | None,
    places: dict[tuple[str | None, str], tuple[float, float]],
) -> None:
    x1, y1, x2, y2 = (float(geometry.get(key)) for key in CORNERS)
    ax.add_patch(Rectangle((x1, y1), x2 - x1, y2 - y1, facecolor="0.94" if name else "none", edgecolor="black"))
    ax.text((x1 + x2) / 2, y2 + 3, element.get("name"), ha="center", fontsize=9)
    for one in element.findall(f"{SSD}Connectors/{SSD}Connector"):
        place = one.find(f"{SSD}ConnectorGeometry")
        x, y = x1 + float(place.get("x")) * (x2 - x1), y1 + float(place.get("y")) * (y2 - y1)
        places[name, one.get("name")] = (x, y)
        left = float(place.get("x")) < 0.5
        ax.plot(x, y, marker=">", color="black", markersize=2.5)
        ax.text(x + (2 if left else -2), y, one.get("name"), fontsize=5, va="center", ha="left" if left else "right")


def _numbers(element: etree._Element, key: str) -> list[float]:
    return [float(one) for one in element.get(key).split()]
