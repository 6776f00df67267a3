"""What an unpacked package says: components, connectors, connections and the values that it binds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote

from lxml import etree

from brunovsky.errors import BrunovskyError
from brunovsky.fmi.checks.markup import require_plain
from brunovsky.fmi.ssp.elements import NAMESPACES, tag
from brunovsky.fmi.ssp.wiring import SYSTEM, Port, Wire

_NUMBERS = ("Real", "Float64", "Float32", "Integer", "Int64", "Int32", "Enumeration")


@dataclass(frozen=True)
class Connector:
    """A connector of a component or of the system: kind (``"input"``, …), unit and description, empty if not given."""

    name: str
    kind: str
    unit: str
    description: str


@dataclass(frozen=True)
class SystemStructure:
    """A flat system of FMUs.

    Attributes
    ----------
    name : str
        Of the system.
    components : mapping of str to Path
        FMU of each component, in the order of the file.
    connectors : mapping of Port to Connector
        Those of the system under :data:`SYSTEM`.
    wires : tuple of Wire
        Its connections.
    parameters : mapping of str to tuple of Port
        What each parameter of the system sets: by its mapping, and by connectors of parameters.
    values : mapping of Port to float
        What the package binds; a binding at the system goes before one at a component.
    """

    name: str
    components: Mapping[str, Path]
    connectors: Mapping[Port, Connector]
    wires: tuple[Wire, ...]
    parameters: Mapping[str, tuple[Port, ...]]
    values: Mapping[Port, float]

    def of_system(self, kind: str) -> dict[str, Connector]:
        """Connectors of the system of this kind, by name."""
        return {name: one for (part, name), one in self.connectors.items() if part == SYSTEM and one.kind == kind}

    def ports(self, parameter: str) -> tuple[Port, ...]:
        """What a parameter of the system sets: what is mapped to its name, or ``component.variable``; else nothing."""
        return self.parameters.get(parameter) or _dotted(parameter, self.components)


def read_structure(folder: Path, shown: str) -> SystemStructure:
    """Read ``SystemStructure.ssd`` of an unpacked package.

    Parameters
    ----------
    folder : Path
        Where it is unpacked.
    shown : str
        Name of the package in messages.

    Raises
    ------
    BrunovskyError
        If it is not well formed, refers to what is missing, or has what is not read here: systems within the system,
        transformations of values or units, components that are no FMUs, values that are no numbers.

    References
    ----------
    Modelica Association, System Structure and Parameterization, version 1.0, 2019, https://ssp-standard.org.
    """
    return _Reader(folder, shown).structure()


class _Reader:
    def __init__(self, folder: Path, shown: str) -> None:
        self.folder, self.shown = folder, shown

    def structure(self) -> SystemStructure:
        top = self._parsed("SystemStructure.ssd")
        system = top.find("ssd:System", NAMESPACES)
        if top.tag != tag("ssd:SystemStructureDescription") or system is None:
            raise self._refused("its SystemStructure.ssd describes no system")
        nested = [one.tag for one in system.iterfind("ssd:Elements/*", NAMESPACES) if one.tag != tag("ssd:Component")]
        if nested:
            raise self._refused(f"it has a {etree.QName(nested[0]).localname} among its elements; flatten the system")
        parts = {_name(one, "name"): one for one in system.iterfind("ssd:Elements/ssd:Component", NAMESPACES)}
        components = {name: self._file(one.get("source") or "", name) for name, one in parts.items()}
        if not components:
            raise self._refused("it has no components")
        connectors = {(SYSTEM, one.name): one for one in _connectors(system)}
        connectors |= {(name, one.name): one for name, part in parts.items() for one in _connectors(part)}
        wires = tuple(self._wires(system, connectors))
        parameters: dict[str, tuple[Port, ...]] = {}
        for wire in wires:
            if wire.source[0] == SYSTEM and connectors[wire.source].kind == "parameter":
                parameters[wire.source[1]] = (*parameters.get(wire.source[1], ()), wire.target)
        values = {(name, one): value for name, part in parts.items() for one, value in self._bound(part, {})}
        mapped: dict[str, tuple[str, ...]] = {}
        bound = list(self._bound(system, mapped))
        for source, targets in mapped.items():
            parameters[source] = tuple(port for one in targets for port in self._target(one, components, parameters))
        for name, value in bound:
            values |= dict.fromkeys(parameters.get(name) or self._target(name, components, {}), value)
        signals = tuple(one for one in wires if connectors[one.source].kind != "parameter")
        return SystemStructure(system.get("name") or "", components, connectors, signals, parameters, values)

    def _wires(self, system: etree._Element, connectors: Mapping[Port, Connector]) -> Iterator[Wire]:
        for one in system.iterfind("ssd:Connections/ssd:Connection", NAMESPACES):
            if any(etree.QName(inner).namespace == NAMESPACES["ssc"] for inner in one):
                raise self._refused("it transforms the values of a connection, which is not done here")
            start, end = (
                (one.get(f"{side}Element") or SYSTEM, _name(one, f"{side}Connector")) for side in ("start", "end")
            )
            for port in (start, end):
                if port not in connectors:
                    raise self._refused(f"a connection ends at '{'.'.join(filter(None, port))}', which is no connector")
            units = {connectors[port].unit for port in (start, end)} - {""}
            if len(units) > 1:
                raise self._refused(f"'{end[1]}' is connected to another unit: {' and '.join(sorted(units))}")
            yield Wire(start, end)

    def _bound(self, element: etree._Element, mapped: dict[str, tuple[str, ...]]) -> Iterator[tuple[str, float]]:
        """Names and values of the bindings of an element; what its mappings say is added to `mapped`."""
        for binding in element.iterfind("ssd:ParameterBindings/ssd:ParameterBinding", NAMESPACES):
            prefix = binding.get("prefix") or ""
            values = binding.find("ssd:ParameterValues/ssv:ParameterSet", NAMESPACES)
            if values is None:
                values = self._parsed(binding.get("source") or "")
            mapping = binding.find("ssd:ParameterMapping", NAMESPACES)
            own: dict[str, tuple[str, ...]] = {}
            if mapping is not None:
                inline = mapping.find("ssm:ParameterMapping", NAMESPACES)
                table = self._parsed(mapping.get("source") or "") if inline is None else inline
                for entry in table.iterfind("ssm:MappingEntry", NAMESPACES):
                    if len(entry):
                        raise self._refused("it transforms parameters in a mapping, which is not done here")
                    source = _name(entry, "source")
                    own[source] = (*own.get(source, ()), _name(entry, "target"))
            mapped.update(own)
            for one in values.iterfind("ssv:Parameters/ssv:Parameter", NAMESPACES):
                name = prefix + _name(one, "name")
                for target in (name,) if element.tag == tag("ssd:System") else own.get(name, (name,)):
                    yield target, self._number(one, name)

    def _number(self, parameter: etree._Element, name: str) -> float:
        typed = next((one for one in parameter if etree.QName(one).namespace == NAMESPACES["ssv"]), None)
        kind = None if typed is None else etree.QName(typed).localname
        text = "" if typed is None else typed.get("value") or ""
        try:
            if kind == "Boolean":
                return {"true": 1.0, "1": 1.0, "false": 0.0, "0": 0.0}[text]
            if kind in _NUMBERS:
                return float(text)
        except (KeyError, ValueError):
            pass
        raise self._refused(f"its parameter '{name}' is no number: {kind} {text!r}")

    def _target(self, name: str, parts: Mapping[str, Path], wired: Mapping[str, tuple[Port, ...]]) -> tuple[Port, ...]:
        ports = wired.get(name) or _dotted(name, parts)
        if not ports:
            raise self._refused(f"it binds '{name}', which is no parameter of a component")
        return ports

    def _file(self, source: str, component: str) -> Path:
        path = (self.folder / unquote(source)).resolve()
        if not source or not path.is_relative_to(self.folder.resolve()) or not path.is_file():
            named = f"component '{component}'" if component else "a binding"
            raise self._refused(f"{named} names the file {source!r}, which is not in the package")
        return path

    def _parsed(self, name: str) -> etree._Element:
        path = self._file(name, SYSTEM) if name != "SystemStructure.ssd" else self.folder / name
        shown = f"{self.shown}: {name}"
        require_plain(path, shown)
        parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, remove_comments=True)
        return etree.parse(str(path), parser).getroot()

    def _refused(self, why: str) -> BrunovskyError:
        return BrunovskyError(f"{self.shown}: {why}")


def _connectors(element: etree._Element) -> Iterator[Connector]:
    for one in element.iterfind("ssd:Connectors/ssd:Connector", NAMESPACES):
        typed = next((inner for inner in one if etree.QName(inner).namespace == NAMESPACES["ssc"]), None)
        unit = "" if typed is None else typed.get("unit") or ""
        yield Connector(_name(one, "name"), one.get("kind") or "", unit, one.get("description") or "")


def _name(element: etree._Element, attribute: str) -> str:
    return element.get(attribute) or ""


def _dotted(name: str, components: Sequence[str] | Mapping[str, object]) -> tuple[Port, ...]:
    """Component and variable of ``component.variable``; nothing where there is no such component."""
    part = max((key for key in components if name.startswith(f"{key}.")), key=len, default=None)
    return () if part is None else ((part, name.removeprefix(f"{part}.")),)
