"""What both super-twisting laws share: the gains k and the slope L, their conditions, and the square root."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from brunovsky.blocks.library.chains import Chains
from brunovsky.blocks.library.gains import Gains, scalar_gains
from brunovsky.blocks.variables import Check, Parameter
from brunovsky.errors import ModelError

WELL_ESTABLISHED = (1.5, 1.1)
"""Levant's k1 and k2 of a slope of 1."""


def twisting_gains(k: ArrayLike) -> tuple[Parameter, Parameter]:
    """Parameters ``k[1]`` and ``k[2]``, shared by all chains since they have no unit.

    Raises
    ------
    ModelError
        If they are not two.
    """
    values = np.asarray(k, dtype=float)
    if values.shape != (2,):
        raise ModelError(f"super-twisting: k has the shape {values.shape}; give k1 and k2, (1.5, 1.1) say")
    names = ("gain of the square root, in sqrt(L)", "gain of the integral, in L")
    first, second = (
        Parameter(f"k[{i}]", "1", name, float(value), 0.0, tunable=True)
        for i, (name, value) in enumerate(zip(names, values, strict=True), 1)
    )
    return first, second


def slope_bounds(chains: Chains, slope: ArrayLike) -> Gains:
    """Parameters ``L``, or ``L[i]``: bounds of the slope of the disturbance of S_i'."""
    return scalar_gains(
        chains,
        "L",
        slope,
        lambda i: chains.unit(i, chains.orders[i - 1] + 1),
        "bound of the slope of the disturbance, times c_r",
        0.0,
    )


def twisting_checks(k: Sequence[Parameter], slopes: Gains) -> tuple[Check, ...]:
    """L > 0 and k2 > 1 are necessary, k1^2 > k2 + 1 is sufficient with them."""
    k1, k2 = (one.symbol for one in k)
    return (
        *(
            Check(
                "slope of the disturbance",
                slope.symbol > 0,
                f"{slope.name} = 0 leaves the law without feedback of S; give the largest slope that a disturbance at "
                "the level of v is to have, times c_r",
            )
            for (slope,) in dict.fromkeys(slopes.rows)
        ),
        Check(
            "integral gain",
            k2 > 1,
            f"{k[1].name} is not above 1: a disturbance whose slope is L outruns the integral; set {k[1].name} above "
            "1, 1.1 say, or raise L",
        ),
        Check(
            "gain of the square root",
            k1**2 > k2 + 1,
            f"{k[0].name} is not above sqrt({k[1].name} + 1), so that convergence is not guaranteed; raise "
            f"{k[0].name}, 1.5 say for {k[1].name} = 1.1",
            when="failure",
        ),
    )
