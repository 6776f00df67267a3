"""Reference results that an FMU brings: its experiments again, and what differs."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from fmpy import read_csv

from brunovsky.fmi.checks.experiment import REALS
from brunovsky.fmi.checks.instance import Refused
from brunovsky.fmi.checks.related import Described, experiments
from brunovsky.fmi.checks.report import FAILED, NOT_PROVIDED, NOT_RUN, PASSED
from brunovsky.fmi.checks.stepping import Stepper
from brunovsky.fmi.checks.subject import Answer, Subject

_LEAST_TOLERANCE, _TOLERANCES = 1e-6, 100.0
"""What may differ is the tolerance of an experiment times the latter, and at least the former."""


def reference_results(subject: Subject) -> Answer:
    """Each experiment again, with its stimuli; its results against those that the FMU brings."""
    found = list(experiments(subject.folder))
    if not found:
        return NOT_PROVIDED, "no experiments with results by FMI-LS-REF"
    said = [_repeated(subject, one) for one in found]
    statuses = [status for status, _ in said]
    worst = next((one for one in (FAILED, PASSED) if one in statuses), NOT_RUN)
    return worst, "; ".join(text for _, text in said)


def _repeated(subject: Subject, one: Described) -> Answer:
    if one.parameters:
        return NOT_RUN, f"{one.name}: parameter sets are not read"
    apart, name = _difference(subject, one)
    status = PASSED if apart <= max(_LEAST_TOLERANCE, _TOLERANCES * one.tolerance) else FAILED
    return status, f"{one.name}: {name} differs by {apart:.1e} of its largest value"


def _difference(subject: Subject, one: Described) -> tuple[float, str]:
    """Largest difference of a result, relative to its largest value or, where that is greater, its nominal; whose."""
    known = {each.name: each for each in subject.description.modelVariables if each.type in REALS and not each.shape}
    expected = read_csv(one.results)
    names = [name for name in expected.dtype.names[1:] if name in known]
    at = (expected["time"] - one.run.start) / one.run.step
    wanted = {round(float(k)): row for row, k in enumerate(at) if abs(k - round(float(k))) < 1e-6}
    if not names or not wanted:
        raise Refused(f"{one.name}: no real variable of the results is known, or no time of theirs is that of a step")
    if not all(np.all(np.isfinite(expected[name])) for name in names):
        raise Refused(f"{one.name}: the results are not finite")
    inputs = None if one.stimuli is None else read_csv(one.stimuli)
    stepper = subject.stepper(subject.instance("reference"), one.run)
    compared = [known[name] for name in names]
    stepper.instance.initialize(one.run, leave=False)
    _stimulate(stepper, known, inputs)
    stepper.instance.fmu.exitInitializationMode()
    found: dict[int, np.ndarray] = {}
    for step in range(one.run.steps + 1):
        if step:
            _stimulate(stepper, known, inputs)
            stepper.advance()
        if step in wanted:
            found[wanted[step]] = stepper.instance.get(compared)
    stepper.instance.free()
    apart = {}
    for column, name in enumerate(names):
        largest = max(float(np.max(np.abs(expected[name]))), float(known[name].nominal or 1.0))
        errors = [abs(float(values[column]) - float(expected[name][row])) for row, values in found.items()]
        apart[name] = max((error if math.isfinite(error) else math.inf for error in errors), default=0.0) / largest
    worst = max(apart, key=lambda name: apart[name])
    return apart[worst], worst


def _stimulate(stepper: Stepper, known: dict[str, Any], inputs: Any) -> None:
    """Set inputs to what they are now, on straight lines between the rows."""
    if inputs is None:
        return
    names = [name for name in inputs.dtype.names[1:] if name in known]
    values = [float(np.interp(stepper.time, inputs["time"], inputs[name])) for name in names]
    stepper.instance.set([known[name] for name in names], values)
