"""Values of expressions at a point, as NumPy arrays."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from brunovsky.errors import ParameterError
from brunovsky.linearization.affine import AffineSystem
from brunovsky.linearization.validation import resolve


def point_of(system: AffineSystem, values: Mapping[sp.Symbol | str, Any]) -> dict[sp.Symbol, sp.Expr]:
    """Exact values of states and parameters of a system, from values by symbol or by name."""
    return resolve(values, system.states + system.parameters, "state or parameter")


def evaluate(matrix: sp.Matrix, point: Mapping[sp.Symbol, sp.Expr]) -> NDArray[np.float64]:
    """Evaluate a matrix of expressions at a point that gives a value to all of their symbols."""
    needed = sorted(matrix.free_symbols, key=str)
    missing = [symbol for symbol in needed if symbol not in point]
    if missing:
        raise ParameterError(f"the point has no value for {', '.join(map(str, missing))}; give one")
    values = [np.float64(point[symbol]) for symbol in needed]  # of which 1/0 is inf
    with np.errstate(all="ignore"):
        return np.array(numeric_function(needed, matrix)(*values), dtype=float).reshape(matrix.shape)


def numeric_function(arguments: Sequence[sp.Symbol], expressions: Any) -> Any:
    """NumPy function of an expression, a list or a matrix of them."""
    return sp.lambdify(list(arguments), expressions, modules="numpy", cse=True)
