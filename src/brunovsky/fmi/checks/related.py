"""What an FMU brings by FMI-LS-REF: related files, unchanged, and experiments with their results."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from fmpy.model_description import ModelDescription
from lxml import etree

from brunovsky.errors import BrunovskyError
from brunovsky.fmi.checks.experiment import Experiment
from brunovsky.fmi.checks.markup import require_plain

_MANIFEST = Path("extra", "org.fmi-standard.fmi-ls-ref", "fmi-ls-manifest.xml")
_DIGESTS = {
    f"SHA{kind}{size}": f"sha{name}{size}" for kind, name in (("3-", "3_"), ("-", "")) for size in (224, 256, 384, 512)
}


def related_files(folder: Path, _: ModelDescription) -> tuple[list[str], str]:
    """Checksums of the files that the manifest names; that one is missing is allowed."""
    problems, same, missing = [], 0, 0
    for one in _related(folder):
        path = _inside(folder, folder / _MANIFEST, one.get("source"))
        kind, expected = one.get("checksumType", "SHA3-256"), one.get("checksum")
        if path is None:
            missing += 1
        elif expected and kind not in _DIGESTS:
            problems.append(f"{path.name}: '{kind}' is no algorithm of FMI-LS-REF")
        elif expected and hashlib.new(_DIGESTS[kind], path.read_bytes()).hexdigest() != expected.lower():
            problems.append(f"{path.name} is not the file that the manifest of FMI-LS-REF was made for (checksum)")
        else:
            same += 1
    return problems, f"{same} as the manifest says, {missing} missing" if same or missing else "none"


@dataclass(frozen=True)
class Described:
    """An experiment as its file says it."""

    name: str
    run: Experiment
    tolerance: float
    parameters: bool
    stimuli: Path | None
    results: Path


def _related(folder: Path) -> Iterator[Any]:
    path = folder / _MANIFEST
    if path.is_file():
        yield from _root(path).iterfind("Related")


def _root(path: Path) -> Any:
    require_plain(path, path.name)
    return etree.parse(path).getroot()


def _inside(folder: Path, beside: Path, source: str | None) -> Path | None:
    """File of the FMU that a relative URI names; None for what is elsewhere or missing."""
    parts = urlsplit(source or "")
    if parts.scheme or parts.netloc or not parts.path:
        return None
    path = (beside.parent / unquote(parts.path)).resolve()
    return path if path.is_relative_to(folder.resolve()) and path.is_file() else None


def experiments(folder: Path) -> Iterator[Described]:
    """Experiments of an unpacked FMU that have results in a CSV file.

    Raises
    ------
    BrunovskyError
        If one can't be run as it is described.
    """
    for related in _related(folder):
        path = _inside(folder, folder / _MANIFEST, related.get("source"))
        if path is None or related.get("role", "").partition("/")[0] != "experiment":
            continue
        for one in _root(path).iterfind("Experiment"):
            results = _series(folder, path, one.find("References"))
            if results is not None:
                yield _described(folder, path, one, results)


def _series(folder: Path, path: Path, element: Any) -> Path | None:
    if element is None or element.get("type", "text/csv") != "text/csv":
        return None
    return _inside(folder, path, element.get("source"))


def _described(folder: Path, path: Path, one: Any, results: Path) -> Described:
    name = one.get("name", "")
    times = one.find("TransientSimulation")
    times = one if times is None else times  # the text of the draft has them here, its schema there
    start, stop = float(times.get("startTime", 0.0)), float(times.get("stopTime", "nan"))
    step = float(times.get("stepSize", "nan"))
    if not (math.isfinite(start) and start < stop < math.inf and 0 < step <= stop - start):
        raise BrunovskyError(f"{name}: the experiment is from {start:g} to {stop:g} s with steps of {step:g} s")
    stimuli = one.find("Stimuli")
    inputs = _series(folder, path, stimuli)
    if stimuli is not None and inputs is None:
        raise BrunovskyError(f"{name}: there is no file of CSV with its stimuli, '{stimuli.get('source')}'")
    run = Experiment(start, step, round((stop - start) / step))
    tolerance = float(one.get("tolerance", 0.0))
    return Described(name, run, tolerance, one.find("Parameters") is not None, inputs, results)
