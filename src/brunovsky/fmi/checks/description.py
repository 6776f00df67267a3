"""Static checks: the description against the schema and itself, and against the files beside it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import fmpy
from fmpy import read_model_description
from fmpy.model_description import ModelDescription, ValidationError
from lxml import etree

from brunovsky.errors import BrunovskyError
from brunovsky.fmi.checks.markup import require_plain
from brunovsky.fmi.checks.related import related_files
from brunovsky.fmi.checks.report import FAILED, PASSED, Check

INTERFACES = ("CoSimulation", "ModelExchange", "ScheduledExecution")
_ATTRIBUTES = {name: name[0].lower() + name[1:] for name in INTERFACES}
_C_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*\Z")
_READ = ("modelDescription.xml", "sources/buildDescription.xml", "terminalsAndIcons/terminalsAndIcons.xml")


class Unreadable(Exception):
    """A description so wrong that there is no model to check; the message says what is."""


def load_root(folder: Path, shown: str) -> Any:
    """Root element of the description of an unpacked FMU.

    Raises
    ------
    BrunovskyError
        If its XML is hostile or not well-formed, or of a version of FMI that isn't checked.
    """
    for name in _READ:
        if (folder / name).is_file():
            require_plain(folder / name, f"{shown}: {name}")
    root = etree.parse(folder / "modelDescription.xml").getroot()
    version = root.get("fmiVersion", "")
    if version != "2.0" and not re.match(r"3\.\d", version):
        raise BrunovskyError(f"{shown}: fmiVersion '{version}' is not known; FMI 2.0 and 3.x can be checked")
    return root


def load_description(folder: Path, root: Any) -> ModelDescription:
    """What fmpy reads of a description, with what it leaves out.

    Raises
    ------
    Unreadable
        If a reference leads nowhere, or if it doesn't keep to the schema so far that fmpy stumbles.
    """
    dangling = _dangling(root)
    if dangling:
        raise Unreadable(_summary(dangling))
    try:
        description = read_model_description(str(folder), validate=False)
    except Exception as error:  # whatever fmpy stumbles over
        problems = [
            line for file, schema in _schemas(folder, int(root.get("fmiVersion")[0])) for line in _wrong(file, schema)
        ]
        raise Unreadable(_summary(problems or [f"{type(error).__name__}: {error}"])) from None
    for name, one in interfaces(description).items():
        element = root.find(name)
        if root.get("fmiVersion") != "2.0" and element is not None:  # fmpy knows the flag of FMI 2 alone
            one.providesDirectionalDerivative = element.get("providesDirectionalDerivatives") in ("true", "1")
    return description


def _dangling(root: Any) -> list[str]:
    """References in the model structure to variables that there aren't."""
    variables = root.findall("ModelVariables/*")
    if root.get("fmiVersion") == "2.0":
        known, key = {str(index) for index in range(1, len(variables) + 1)}, "index"
    else:
        known, key = {one.get("valueReference") for one in variables}, "valueReference"
    found = []
    for unknown in root.iterfind("ModelStructure//*[@dependencies]"):
        missing = [one for one in (unknown.get("dependencies") or "").split() if one not in known]
        found += [f"line {unknown.sourceline}: dependency {one} is not a variable" for one in missing]
    for unknown in root.iterfind(f"ModelStructure//*[@{key}]"):
        if unknown.get(key) not in known:
            found.append(f"line {unknown.sourceline}: {key} {unknown.get(key)} is not a variable")
    return found


def interfaces(description: ModelDescription) -> dict[str, Any]:
    """The interfaces that an FMU has, by name, each with its capabilities."""
    found = {name: getattr(description, _ATTRIBUTES[name], None) for name in INTERFACES}
    return {name: one for name, one in found.items() if one is not None}


def binary_path(folder: Path, identifier: str, version: int) -> Path | None:
    """Shared library for this machine, where the standard says it lies."""
    if not _C_NAME.match(identifier):  # it could lead elsewhere
        return None
    names = (fmpy.platform, fmpy.platform_tuple) if version == 2 else (fmpy.platform_tuple,)
    paths = (folder / "binaries" / name / f"{identifier}{fmpy.sharedLibraryExtension}" for name in names)
    return next((path for path in paths if path.is_file()), None)


def static_checks(folder: Path, description: ModelDescription) -> list[Check]:
    """All checks that need no run."""
    found = []
    for name, check in _CHECKS.items():
        try:
            problems, what = check(folder, description)
        except Exception as error:  # what the schema would not let pass
            problems, what = [f"{type(error).__name__}: {error}"], ""
        status = FAILED if problems else PASSED
        found.append(Check(name, status, _summary(problems) if problems else what, _PARTS.get(name, "description")))
    return found


def _summary(problems: list[str]) -> str:
    more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
    return " ".join(problems[0].split())[:400] + more


Found = tuple[list[str], str]


def _schema(folder: Path, description: ModelDescription) -> Found:
    problems = []
    for file, schema in _schemas(folder, int(description.fmiMajorVersion)):
        problems += _wrong(file, schema)
    return problems, f"modelDescription.xml of FMI {description.fmiVersion}"


def _wrong(file: Path, schema: etree.XMLSchema) -> list[str]:
    if schema.validate(etree.parse(file)):
        return []
    return [f"{file.name}, line {one.line}: {one.message}" for one in schema.error_log]


def _schemas(folder: Path, version: int) -> Iterator[tuple[Path, etree.XMLSchema]]:
    names = {"modelDescription.xml": f"fmi{version}ModelDescription.xsd"}
    if version == 3:
        names["sources/buildDescription.xml"] = "fmi3BuildDescription.xsd"
        names["terminalsAndIcons/terminalsAndIcons.xml"] = "fmi3TerminalsAndIcons.xsd"
    for name, schema in names.items():
        if (folder / name).is_file():
            path = Path(fmpy.__file__).parent / "schema" / f"fmi{version}" / schema
            yield folder / name, etree.XMLSchema(file=str(path))


def _standard(folder: Path, description: ModelDescription) -> Found:
    """Units, names, starts, InitialUnknowns: what fmpy validates, if the schema holds."""
    try:
        read_model_description(str(folder), validate=True, validate_variable_names=True, validate_model_structure=True)
    except ValidationError as error:
        return [one.strip().partition("\n")[0] for one in error.problems], ""
    except Exception as error:
        return [f"{type(error).__name__}: {error}"], ""
    count = len(description.modelVariables)
    return [], f"names, units, starts and InitialUnknowns of {count} variables (fmpy.validation)"


def _dependencies(_folder: Path, description: ModelDescription) -> Found:
    states = [one.variable.derivative for one in description.derivatives if one.variable is not None]
    problems, count = [], 0
    lists = ("outputs", "derivatives", "clockedStates", "eventIndicators", "initialUnknowns")
    for kind in lists:
        for unknown in getattr(description, kind):
            given = unknown.dependencies or ()
            count += len(given)
            if len({one.name for one in given}) < len(given):
                problems.append(f"{unknown.variable.name} in {kind} names a dependency twice")
            problems += [
                f"{unknown.variable.name} in {kind} depends on {one.name}, which is calculated and not a known"
                for one in given
                if one.initial == "calculated" and one.variability == "continuous" and one not in states
            ]
    return problems, f"{count} dependencies"


def _flags(_folder: Path, description: ModelDescription) -> Found:
    problems = []
    for name, one in interfaces(description).items():
        if one.canSerializeFMUstate and not one.canGetAndSetFMUstate:
            problems.append(f"{name} says that it serialises its state but not that it can get and set it")
        if not _C_NAME.match(one.modelIdentifier or ""):
            problems.append(f"the modelIdentifier '{one.modelIdentifier}' of {name} is not a C identifier")
        if name == "CoSimulation" and one.canReturnEarlyAfterIntermediateUpdate and not one.providesIntermediateUpdate:
            problems.append(f"{name} returns early after intermediate updates, which it doesn't provide")
        if name == "CoSimulation" and float(one.fixedInternalStepSize or 1.0) <= 0:
            problems.append("fixedInternalStepSize is not positive")
    if not interfaces(description):
        problems.append("there is no CoSimulation, ModelExchange or ScheduledExecution")
    return problems, ", ".join(interfaces(description))


def _experiment(_folder: Path, description: ModelDescription) -> Found:
    one = description.defaultExperiment
    if one is None:
        return [], "none is given; 0 to 1 s in 100 steps is taken"
    start, stop, step = (float(value) if value else None for value in (one.startTime, one.stopTime, one.stepSize))
    problems = []
    if stop is not None and stop <= (start or 0.0):
        problems.append(f"the stop time {stop:g} s is not after the start time {start or 0.0:g} s")
    if step is not None and step <= 0:
        problems.append(f"the step size {step:g} s is not positive")
    return problems, f"{start or 0.0:g} to {'?' if stop is None else format(stop, 'g')} s"


def _token(_folder: Path, description: ModelDescription) -> Found:
    token = description.instantiationToken or ""
    return ([] if token.strip() else ["it is empty"]), token


def _binaries(folder: Path, description: ModelDescription) -> Found:
    version = int(description.fmiMajorVersion)
    problems, sizes = [], []
    for name, one in interfaces(description).items():
        path = binary_path(folder, one.modelIdentifier or "", version)
        if path is None:
            there = sorted(path.name for path in (folder / "binaries").iterdir())
            wanted = fmpy.platform if version == 2 else fmpy.platform_tuple
            file = f"binaries/{wanted}/{one.modelIdentifier}{fmpy.sharedLibraryExtension}"
            problems.append(f"no {file} for {name}; there is {', '.join(there)}")
        else:
            sizes.append(f"{path.relative_to(folder).as_posix()}, {path.stat().st_size / 1024:.0f} KiB")
    return problems, "; ".join(dict.fromkeys(sizes))


def _sources(folder: Path, description: ModelDescription) -> Found:
    listed = [
        name
        for configuration in description.buildConfigurations
        for files in configuration.sourceFileSets
        for name in files.sourceFiles
    ]
    missing = [f"sources/{name} is listed and missing" for name in listed if not _inside(folder / "sources", name)]
    return missing, f"{len(listed)} files listed" if listed else "none are listed"


def _inside(folder: Path, name: str) -> bool:
    path = (folder / name).resolve()
    return path.is_relative_to(folder.resolve()) and path.is_file()


_CHECKS: Mapping[str, Callable[[Path, ModelDescription], Found]] = {
    "schema": _schema,
    "variables and structure": _standard,
    "dependencies": _dependencies,
    "capability flags": _flags,
    "default experiment": _experiment,
    "token": _token,
    "binary for this machine": _binaries,
    "listed sources": _sources,
    "related files": related_files,
}
_PARTS = dict.fromkeys(("binary for this machine", "listed sources", "related files"), "file")
