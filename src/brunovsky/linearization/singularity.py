"""How far a state is from where the linearising law does not exist."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import sympy as sp

from brunovsky.errors import ModelError
from brunovsky.linearization.input_transformation import InputTransformation
from brunovsky.linearization.numeric import evaluate, point_of

if TYPE_CHECKING:
    from brunovsky.linearization.linearize import Linearization

Measure = Literal["locus", "singular_value"]


def distance_to_singularity(
    linearization: Linearization, point: Mapping[sp.Symbol | str, Any], measure: Measure = "locus"
) -> float:
    """Say how far a point is from the singular locus of a law.

    Parameters
    ----------
    linearization : Linearization
        The law.
    point : mapping of sympy.Symbol or str to number
        States of the extended system and parameters, in their units; those that do not matter may be left out.
    measure : {"locus", "singular_value"}
        `"locus"`: the absolute value of the left side of `singular_locus`, in its unit (the robot: abs(eta1), in
        m/s); infinite where there is no locus. `"singular_value"`: the smallest singular value of the decoupling
        matrix and of the transformations of inputs, that is how much, in the 2-norm, a matrix may change before it can
        be singular; a mixture of units where outputs or inputs have different ones.

    Returns
    -------
    float
        Zero on the locus.

    Raises
    ------
    ModelError
        If the measure is none of these.
    ParameterError
        If a value is missing.

    References
    ----------
    G. H. Golub and C. F. Van Loan, *Matrix Computations*, 4th ed., 2013, section 2.4 (singular value).
    """
    values = point_of(linearization.extended_system, point)
    if measure == "locus":
        locus = linearization.singular_locus
        return float("inf") if locus == sp.false else float(np.abs(evaluate(sp.Matrix([locus.lhs]), values)[0, 0]))
    if measure != "singular_value":
        raise ModelError(f"measure is {measure!r}; give 'locus' or 'singular_value'")
    matrices = [linearization.decoupling_matrix, *map(_pivots, linearization.extension.transformations)]
    return float(min(np.linalg.svd(evaluate(matrix, values), compute_uv=False)[-1] for matrix in matrices))


def _pivots(transformation: InputTransformation) -> sp.Matrix:
    return sp.Matrix(list(transformation.combinations.values())).jacobian(list(transformation.replaced))
