"""One number for each actuator."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from brunovsky.blocks.variables import Variable
from brunovsky.errors import ModelError, ParameterError


def one_for_each(
    actuators: Sequence[Variable], values: ArrayLike, what: str, name: str, remedy: str, *, finite: bool = False
) -> list[float]:
    """Numbers from 0 on, one for each actuator; one number stands for all.

    Raises
    ------
    ModelError
        If there is no actuator, or neither one number nor as many as actuators.
    ParameterError
        If one is negative or no number, or infinite where it must be ``finite``; ``remedy`` ends the message.
    """
    if not actuators:
        raise ModelError(f"{name}: there is no actuator; give at least one")
    try:
        numbers = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise ParameterError(f"{name}: {what} = {values!r}; {remedy}") from None
    if numbers.shape not in ((), (len(actuators),)):
        raise ModelError(
            f"{name}: {what} has the shape {numbers.shape}; give one number, or {len(actuators)}, one for each"
        )
    if np.any(np.isnan(numbers)) or np.any(numbers < 0.0) or (finite and not np.all(np.isfinite(numbers))):
        raise ParameterError(f"{name}: {what} = {numbers.tolist()}; {remedy}")
    return [float(one) for one in np.broadcast_to(numbers, len(actuators))]
