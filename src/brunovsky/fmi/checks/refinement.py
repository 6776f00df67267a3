"""Halving the step: what changes must shrink, and by how much is the order."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
from fmpy.fmi1 import FMICallException

from brunovsky.fmi.checks.report import FAILED, NOT_PROVIDED, NOT_RUN, PASSED
from brunovsky.fmi.checks.subject import Answer, Subject

_NOTHING = 1e-6
"""Difference that is taken for none, relative to the largest value of an output: internal steps fit differently."""


def step_refinement(subject: Subject) -> Answer:
    """End values for the step, its half and its quarter."""
    fixed = float(getattr(subject.capabilities, "fixedInternalStepSize", None) or 0.0)
    if fixed and subject.run.step < 3.9 * fixed:
        return NOT_PROVIDED, f"the internal step is fixed at {fixed:g} s"
    if not np.all(np.isfinite(subject.reference)):
        return NOT_RUN, "the outputs are not finite"
    ends = []
    for parts in (1, 2, 4):
        run = replace(subject.run, step=subject.run.step / parts, steps=subject.run.steps * parts)
        stepper = subject.started(run=run)
        try:
            for _ in range(run.steps):
                stepper.advance()
        except FMICallException as error:
            return FAILED, f"a step of {run.step:g} s is refused: {error}"
        ends.append(subject.outputs(stepper))
        stepper.instance.free()
    scale = np.maximum(np.max(np.abs(subject.reference), axis=0), 1e-12) if ends[0].size else np.ones(0)
    coarse, fine = (float(np.max(np.abs(a - b) / scale, initial=0.0)) for a, b in pairwise(ends))
    if max(coarse, fine) <= _NOTHING:
        return PASSED, f"halved twice, the end changes by no more than {max(coarse, fine):.1e}"
    order = f", order {np.log2(coarse / fine):.1f}" if fine > 0 and coarse > 0 else ""
    what = f"halved twice, the end changes by {coarse:.1e}, then {fine:.1e}{order}"
    return (PASSED if fine < coarse else FAILED), what
