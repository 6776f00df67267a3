"""How components exchange values at communication points, and signals as Taylor polynomials between them.

``"jacobi"``: all components step at once, each from what the others gave at its beginning. ``"gauss_seidel"``: they
step one after the other, each from the end of the step for those before it. With ``order`` m every exchanged signal is
continued by its first m time derivatives; 0 holds it. Both names are those of the iterations for linear equations.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from math import factorial
from typing import Any, Literal

import numpy as np

from brunovsky.analysis._checks import finite_scalar
from brunovsky.errors import ParameterError

Scheme = Literal["jacobi", "gauss_seidel"]
SCHEMES: tuple[Scheme, ...] = ("jacobi", "gauss_seidel")
ORDERS: Mapping[str, str] = {"jacobi": "all at once", "gauss_seidel": "in sequence"}
"""The schemes in words."""
HIGHEST_ORDER = 3
Array = np.ndarray[Any, np.dtype[np.float64]]


def shifted(signals: Array, time: float) -> Array:
    """Values and derivatives of Taylor polynomials, rows 0 to m of ``signals``, at a later (or earlier) time in s."""
    if time == 0.0:
        return signals
    moved: Array = np.tensordot(_weights(len(signals), time), signals, 1)
    return moved


@lru_cache(maxsize=64)
def _weights(count: int, time: float) -> Array:
    return np.array(
        [[time ** (j - i) / factorial(j - i) if j >= i else 0.0 for j in range(count)] for i in range(count)]
    )


def check_scheme(scheme: str, order: int, communication_step: float, where: str) -> float:
    """Communication step as a number, or ParameterError for one of the three."""
    if scheme not in SCHEMES:
        raise ParameterError(f"{where}: there is no scheme {scheme!r}; use {' or '.join(map(repr, SCHEMES))}")
    if order not in range(HIGHEST_ORDER + 1) or isinstance(order, bool):
        raise ParameterError(f"{where}: order = {order!r}; signals are continued by 0 to {HIGHEST_ORDER} derivatives")
    return finite_scalar(communication_step, "communication_step", where, minimum=0.0, strict=True)
