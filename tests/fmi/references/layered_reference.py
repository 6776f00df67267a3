"""What FMI-LS-REF 1.0.0-alpha.1 and the schema of MA-HS-Experiments ask of their files, as tables of the tests' own.

The schemas themselves are in no package of the registry.
"""

import hashlib
import re
from dataclasses import dataclass
from pathlib import Path

from lxml import etree

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
NAMESPACE = "{http://fmi-standard.org/fmi-ls-manifest}"
ROOT = {
    f"{NAMESPACE}fmi-ls-name": "org.fmi-standard.fmi-ls-ref",
    f"{NAMESPACE}fmi-ls-version": "1.0.0-alpha.1",
    f"{NAMESPACE}fmi-ls-description": "Layered Standard providing information on related files included in an FMU.",
}
ROLE = re.compile(
    "document|requirement|specification|model|parameter|system|testcase|method|rationale|report|request|delivery|"
    "configuration|signature|meta-data|other|result|serialized-state(/.*)?|"
    "experiment(/(smoke-test|validation|uncertainty-analysis))?"
)
DIGESTS = {f"SHA3-{size}": f"sha3_{size}" for size in (224, 256, 384, 512)}
NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?")


@dataclass(frozen=True)
class Rule:
    """Attributes that an element must and may have, those that are numbers, and its children in their order."""

    required: frozenset[str]
    optional: frozenset[str] = frozenset()
    numbers: frozenset[str] = frozenset()
    children: str = ""


def rule(required: str, optional: str = "", numbers: str = "", children: str = "") -> Rule:
    return Rule(*(frozenset(one.split()) for one in (required, optional, numbers)), children)


RULES = {
    "Related": rule("source role", "type description checksum checksumType", children="(Label )*"),
    "Experiments": rule("name", "description", children="(Experiment )+"),
    "Experiment": rule(
        "name", "description tolerance", "tolerance", "TransientSimulation (Parameters )?(Stimuli )?(References )?"
    ),
    "TransientSimulation": rule("", "startTime stopTime stepSize", "startTime stopTime stepSize"),
    "Stimuli": rule("source", "type"),
    "References": rule("source", "type"),
}


def check(element: etree._Element) -> None:
    """Assert that an element and those in it keep their rules."""
    keeps, names = RULES[element.tag], set(element.keys())
    assert keeps.required <= names <= keeps.required | keeps.optional, (element.tag, names)
    assert all(NUMBER.fullmatch(element.get(one)) for one in keeps.numbers & names), dict(element.attrib)
    assert re.fullmatch(keeps.children, "".join(f"{one.tag} " for one in element)), etree.tostring(element)
    for one in element:
        check(one)


def related_files(unpacked: Path) -> dict[str, tuple[str, Path]]:
    """Role and path of each file that the manifest of an unpacked FMU names, after all assertions about it."""
    folder = unpacked / FOLDER
    root = etree.parse(folder / "fmi-ls-manifest.xml").getroot()
    assert root.tag == "fmiReferences" and dict(root.attrib) == ROOT
    found = {}
    for one in root:
        assert one.tag == "Related"
        check(one)
        assert ROLE.fullmatch(one.get("role"))
        path = (folder / one.get("source")).resolve()
        assert path.is_relative_to(unpacked.resolve())
        digest = hashlib.new(DIGESTS[one.get("checksumType")], path.read_bytes()).hexdigest()
        assert one.get("checksum") == digest
        found[one.get("source")] = (one.get("role"), path)
    return found
