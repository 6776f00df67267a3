"""Adjoint derivatives of FMI 3 against directional ones: the one matrix is the transpose of the other."""

from __future__ import annotations

import numpy as np

from brunovsky.fmi.checks.derivatives import place
from brunovsky.fmi.checks.report import FAILED, NOT_PROVIDED, NOT_RUN, PASSED
from brunovsky.fmi.checks.subject import Answer, Subject

_LIMIT = 1e-9
"""Of the difference, relative to the largest entry beside it: the same products, summed in another order."""


def adjoint_derivatives(subject: Subject) -> Answer:
    """For each unknown by itself, and for all of them with different seeds."""
    if not subject.capabilities.providesAdjointDerivatives:
        return NOT_PROVIDED, "providesAdjointDerivatives is false"
    if not subject.capabilities.providesDirectionalDerivative:
        return NOT_RUN, "there are no directional derivatives to compare them with"
    here = place(subject)
    instance, unknowns, knowns = here.stepper.instance, here.unknowns, here.knowns
    if not (unknowns and knowns):
        instance.free()
        return PASSED, "there is no known on which a continuous unknown depends"
    matrix = np.array([instance.directional(unknowns, one) for one in knowns])
    seeds = np.vstack([np.eye(len(unknowns)), 1.0 + np.arange(len(unknowns))])
    found = np.array([instance.adjoint(unknowns, knowns, seed) for seed in seeds])
    instance.free()
    expected, sizes = seeds @ matrix.T, seeds @ np.abs(matrix.T)
    apart = np.abs(found - expected) / (1.0 + sizes)
    apart[np.isnan(apart)] = np.inf
    row, column = np.unravel_index(np.argmax(apart), apart.shape)
    if apart[row, column] <= _LIMIT:
        return (
            PASSED,
            f"{matrix.size} of them, off the directional ones by at most {apart[row, column]:.1e}{here.remark}",
        )
    of = unknowns[row].name if row < len(unknowns) else "the seeded sum of all unknowns"
    return FAILED, (
        f"d {of} / d {knowns[column].name} is given as {found[row, column]:.9g}, "
        f"from directional ones it is {expected[row, column]:.9g}"
    )
