"""Files of FMI-LS-REF in an FMU: manifest, experiments, stimuli and results.

The layered standard describes related files in a manifest and leaves the format of experiments to the harmonised
specification MA-HS-Experiments, a draft without a version. Its README says that its text may lag behind; its schema, to
which a file must conform, is followed here: times are those of an element ``TransientSimulation``.

References
----------
Modelica Association, FMI Layered Standard References, version 1.0.0-alpha.1, https://github.com/modelica/fmi-ls-ref.
Modelica Association, MA-HS-Experiments, draft of 2026, https://github.com/modelica/ma-hs-experiments.
"""

from __future__ import annotations

import csv
import hashlib
import io
from collections.abc import Iterable, Sequence

from lxml import etree

from brunovsky.blocks import Block
from brunovsky.fmi.arrays import ArrayVariable, array_variables
from brunovsky.fmi.definitions import COMMUNICATION_STEP, STOP_TIME, TOLERANCE, xml_text
from brunovsky.fmi.references.experiments import STEPS_PER_ROW, Experiment, Run, runs
from brunovsky.fmi.variables import scalar_variables

NAME = "org.fmi-standard.fmi-ls-ref"
VERSION = "1.0.0-alpha.1"
FOLDER = f"extra/{NAME}"
NOTES = "documentation/fmi-ls-ref.txt"
_NAMESPACE = "http://fmi-standard.org/fmi-ls-manifest"
_DESCRIPTION = "Layered Standard providing information on related files included in an FMU."
_EXPERIMENTS = "experiments.exp"
_DIGITS = 9


def reference_files(block: Block, arrays: bool = False) -> dict[str, bytes]:
    """Files by their path in the FMU, the same for equal blocks and compilers.

    Parameters
    ----------
    block : Block
        What the FMU runs; it is compiled and simulated here.
    arrays : bool
        Whether the FMU shows arrays; their elements are then one column, with spaces between.

    Returns
    -------
    dict of str to bytes
        The manifest; notes for people; and of each experiment that reaches its end stimuli (if any) and results.

    Raises
    ------
    CompilerError
        If there is no C compiler or it fails.
    """
    shown = array_variables(scalar_variables(block, fmi_version=3), arrays)
    found = runs(block)
    done = [one for one in found if not one.failure]
    related: dict[str, tuple[bytes, str, str, str]] = {}
    if done:
        text = _experiments_file(block, [one.experiment for one in done])
        related[_EXPERIMENTS] = (text, "application/x-ma-hs-experiments", "experiment/smoke-test", "what was run")
    for one in done:
        name = one.experiment.name
        if one.experiment.ramps:
            text = _stimuli(one.experiment, _columns(shown, "input"))
            related[_stimuli_name(name)] = (text, "text/csv", "other", f"inputs of the experiment {name}")
        text = _results(block, one, _columns(shown, "output"))
        related[_results_name(name)] = (text, "text/csv", "result", f"outputs of the experiment {name}")
    related[f"../../{NOTES}"] = (_notes(block, found), "text/plain", "document", "how the results were computed")
    files = {f"{FOLDER}/{path}": text for path, (text, *_) in related.items() if not path.startswith("../")}
    manifest = _manifest(related.items())
    return files | {f"{FOLDER}/fmi-ls-manifest.xml": manifest, NOTES: related[f"../../{NOTES}"][0]}


def _stimuli_name(experiment: str) -> str:
    return f"{experiment}-inputs.csv"


def _results_name(experiment: str) -> str:
    return f"{experiment}-outputs.csv"


def _manifest(related: Iterable[tuple[str, tuple[bytes, str, str, str]]]) -> bytes:
    root = etree.Element("fmiReferences", nsmap={"fmi-ls": _NAMESPACE})
    for key, value in (("name", NAME), ("version", VERSION), ("description", _DESCRIPTION)):
        root.set(f"{{{_NAMESPACE}}}fmi-ls-{key}", value)
    for source, (text, kind, role, description) in related:
        attributes = {"type": kind, "source": source, "role": role, "description": description}
        digest = hashlib.sha3_256(text).hexdigest()
        etree.SubElement(root, "Related", attributes, checksum=digest, checksumType="SHA3-256")
    return xml_text(root)


def _experiments_file(block: Block, done: Iterable[Experiment]) -> bytes:
    root = etree.Element("Experiments", name=block.name, description=f"reference results of {block.name}")
    for one in done:
        element = etree.SubElement(
            root, "Experiment", name=one.name, description=one.description, tolerance=repr(TOLERANCE)
        )
        times = {"startTime": "0.0", "stopTime": repr(STOP_TIME), "stepSize": repr(COMMUNICATION_STEP)}
        etree.SubElement(element, "TransientSimulation", times)
        if one.ramps:
            etree.SubElement(element, "Stimuli", type="text/csv", source=_stimuli_name(one.name))
        etree.SubElement(element, "References", type="text/csv", source=_results_name(one.name))
    return xml_text(root)


def _columns(shown: Iterable[ArrayVariable], causality: str) -> list[ArrayVariable]:
    return [one for one in shown if one.first.causality == causality and one.first.type != "Clock"]


def _stimuli(experiment: Experiment, columns: Sequence[ArrayVariable]) -> bytes:
    ends: tuple[dict[str, str], ...] = ({}, {})
    for name, ramp in experiment.ramps.items():
        for row, value in zip(ends, ramp, strict=True):
            row[name] = repr(value)
    return _table(columns, zip(("0.0", repr(STOP_TIME)), ends, strict=True))


def _results(block: Block, run: Run, columns: Sequence[ArrayVariable]) -> bytes:
    names = [one.name for one in block.outputs]
    rows = (
        (f"{time:.{_DIGITS}g}", {name: f"{value + 0.0:.{_DIGITS}g}" for name, value in zip(names, row, strict=True)})
        for time, row in zip(run.times, run.rows, strict=True)
    )
    return _table(columns, rows)


def _table(columns: Sequence[ArrayVariable], rows: Iterable[tuple[str, dict[str, str]]]) -> bytes:
    """CSV text with a column of times; ``rows`` has the text of each element by its name."""
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(["time", *(one.name for one in columns)])
    for time, values in rows:
        writer.writerow([time, *(" ".join(values[element.name] for element in one.elements) for one in columns)])
    return text.getvalue().encode()


def _notes(block: Block, found: Iterable[Run]) -> bytes:
    listed = "\n".join(f"* {one.experiment.name}: {one.experiment.description}{_outcome(one)}" for one in found)
    return f"""\
Reference results of {block.name}, by FMI-LS-REF {VERSION}

The folder {FOLDER} has experiments ({_EXPERIMENTS}) and what came of them:

{listed}

They were computed by compiled code of the same equations, without this FMU, as a master of co-simulation does it:
from 0 to {STOP_TIME} s in communication steps of {COMMUNICATION_STEP} s, all parameters at their start values. Inputs
are set at the beginning of each step, on a straight line between the rows of NAME-inputs.csv, and held.
NAME-outputs.csv has the outputs at the start and after every {STEPS_PER_ROW} steps, with {_DIGITS} significant digits.
Boolean ones are 0 or 1; the elements of an array stand in one column, with spaces between.

Co-simulation with these steps and the solver RK4 gives these numbers but for rounding, and what the model makes of it.
Another solver, other steps and model exchange differ by their errors, and where inputs rise, by holding them.
""".encode()


def _outcome(run: Run) -> str:
    return f"; no results: {run.failure}" if run.failure else ""
