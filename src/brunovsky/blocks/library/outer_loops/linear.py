"""What all laws with a linear part share: its gains, which have to be stable, and v = -K e + feedforward."""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.library.gains import Gains, vector_gains
from brunovsky.errors import ModelError, ParameterError

_ROBOT_GAINS = (2500.0, 550.0, 15.0)


def linear_gains(chains: Chains, gains: Sequence[ArrayLike] | None, law: str) -> Gains:
    """Parameters ``K[k]``, by default, for the robot's chains alone, the linear part of the paper's law.

    Raises
    ------
    ModelError
        If they are missing or do not fit the chains; ``law`` names the block.
    """
    if gains is None:
        if chains != ROBOT_CHAINS:
            raise ModelError(
                f"{law}: gains are missing; brunovsky.analysis.place(poles) or lqr_gain(order, weights) gives them for "
                "each chain"
            )
        gains = _ROBOT_GAINS
    return vector_gains(chains, "K", gains, lambda r, k: r - k + 1, "gain of the error's derivative {k}")


def unstable_poles(gain: Gains, integral: Gains | None = None) -> str:
    """Sentence on a chain whose default gains are not stable; empty if all are."""
    for i, row in enumerate(gain.rows):
        values = [*(one.value for one in (integral.rows[i] if integral else ())), *(one.value for one in row)]
        if not np.all(np.isfinite(values)):
            continue  # the block refuses it
        poles = np.roots([1.0, *reversed(values)])
        if np.max(poles.real) >= 0.0:
            return (
                f"the gains K = {values} of chain {i + 1} give the poles "
                f"{np.round(np.sort_complex(poles), 4).tolist()}, not all in the open left half plane, so that the "
                "error does not decay; "
                "brunovsky.analysis.place(poles) or lqr_gain(order, weights) gives stable ones"
            )
    return ""


def refuse_unstable(gain: Gains, law: str) -> None:
    """Refuse default gains that a law can't stand on.

    Raises
    ------
    ParameterError
        With the poles.
    """
    if problem := unstable_poles(gain):
        raise ParameterError(f"{law}: {problem}")


def warn_unstable(gain: Gains, law: str, integral: Gains | None = None) -> None:
    """Warn of default gains that make a linear loop unstable; a class may want to see it."""
    if problem := unstable_poles(gain, integral):
        warnings.warn(f"{law}: {problem}", UserWarning, stacklevel=3)


def linear_law(chains: Chains, gain: Gains) -> dict[int, sp.Expr]:
    """Law v_i = -K e_i + y_d^(r_i), by number of the chain."""
    return {i: chains.feedforward(i) - (sp.Matrix([gain[i]]) * chains.error(i))[0] for i in chains.numbers}
