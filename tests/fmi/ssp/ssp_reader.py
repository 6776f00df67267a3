"""An independent reader of the files of a package."""

from pathlib import Path
from zipfile import ZipFile

from lxml import etree

from brunovsky.fmi.ssp.elements import NAMESPACES


class Package:
    """Files of a package, and what its descriptions say."""

    def __init__(self, path: Path) -> None:
        with ZipFile(path) as archive:
            self.files = {name: archive.read(name) for name in archive.namelist()}

    def tree(self, name: str = "SystemStructure.ssd") -> etree._Element:
        return etree.fromstring(self.files[name])

    def all(self, path: str, name: str = "SystemStructure.ssd") -> list[etree._Element]:
        found: list[etree._Element] = self.tree(name).findall(path, NAMESPACES)
        return found

    def connections(self) -> dict[str, str]:
        ends = (("endElement", "endConnector"), ("startElement", "startConnector"))
        found = (
            tuple(".".join(filter(None, map(one.get, end))) for end in ends) for one in self.all(".//ssd:Connection")
        )
        return dict(found)  # type: ignore[arg-type]
