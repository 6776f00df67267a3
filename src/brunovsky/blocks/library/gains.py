"""Parameters of outer loops: one set for chains that are alike, one per chain otherwise."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from brunovsky.blocks.library.chains import Chains
from brunovsky.blocks.units import derivative_unit
from brunovsky.blocks.variables import Parameter
from brunovsky.errors import ModelError


@dataclass(frozen=True)
class Gains:
    """Parameters of an outer loop, a row per chain; chains that share them have the same row.

    Parameters
    ----------
    rows : tuple of tuples of Parameter, one per chain
        The declarations.
    """

    rows: tuple[tuple[Parameter, ...], ...]

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Each declaration once."""
        return tuple(dict.fromkeys(one for row in self.rows for one in row))

    def __getitem__(self, chain: int) -> tuple[sp.Symbol, ...]:
        """Symbols of a chain, counted from 1."""
        return tuple(one.symbol for one in self.rows[chain - 1])


def numbers(name: str, values: Any) -> list[float]:
    """Flat list of finite real numbers.

    Raises
    ------
    ModelError
        If it is none; ``name`` says of what.
    """
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        array = np.array(np.nan)
    if array.ndim != 1 or not np.all(np.isfinite(array)):
        raise ModelError(f"{name}: {values!r} is no flat list of finite real numbers; give one number for each element")
    return [float(one) for one in array]


def vector_gains(
    chains: Chains, name: str, values: Sequence[ArrayLike], unit_order: Callable[[int, int], int], description: str
) -> Gains:
    """Tunable parameters, a vector per chain: ``name[k]`` where all chains share it, else ``name`` + ``i[k]``.

    Parameters
    ----------
    chains : Chains
        Whose.
    name : str
        Stem of their names.
    values : sequence of float, or one sequence of float per chain
        Defaults; a single vector is shared, by chains that are alike.
    unit_order : callable
        From the length r and the element k to the power of 1/s of the unit.
    description : str
        With ``{k}`` for the derivative of the error that the element belongs to.

    Raises
    ------
    ModelError
        If the numbers do not fit the chains.
    """
    given = list(values) if np.iterable(values) else [values]
    shared = not any(np.iterable(one) for one in given)
    rows = [numbers(name, given)] * len(chains.orders) if shared else [numbers(name, row) for row in given]
    if shared and not chains.are_alike:
        raise ModelError(f"{name}: the chains are not alike and can't share one vector; give one for each of them")
    if [len(row) for row in rows] != list(chains.orders):
        found, needed = (", ".join(map(str, one)) for one in (map(len, rows), chains.orders))
        raise ModelError(f"{name}: vectors of the lengths {found} for chains of the lengths {needed}; make them equal")
    return Gains(
        tuple(
            tuple(
                Parameter(
                    f"{name}{'' if shared else i}[{k}]",
                    derivative_unit("1", unit_order(len(row), k)),
                    description.format(k=k - 1) + ("" if shared else f", chain {i}"),
                    value,
                    tunable=True,
                )
                for k, value in enumerate(row, 1)
            )
            for i, row in enumerate(rows, 1)
        )
    )


def scalar_gains(
    chains: Chains,
    name: str,
    values: ArrayLike,
    unit: Callable[[int], str],
    description: str,
    minimum: float = -float("inf"),
) -> Gains:
    """Tunable parameters, a number per chain: ``name`` where all chains share it, else ``name[i]``.

    Parameters
    ----------
    chains, name, description
        As for :func:`vector_gains`.
    values : float, or one per chain
        Defaults; a single number is shared by chains that are alike, and given to each otherwise.
    unit : callable
        From the number of a chain to the unit.
    minimum : float
        The least value allowed.

    Raises
    ------
    ModelError
        If the numbers do not fit the chains.
    """
    single = not np.iterable(values)
    row = numbers(name, [values] * len(chains.orders) if single else values)
    if len(row) != len(chains.orders):
        raise ModelError(f"{name}: {len(row)} value(s) for {len(chains.orders)} chain(s); give one, or one for each")
    shared = single and chains.are_alike
    return Gains(
        tuple(
            (
                Parameter(
                    name if shared else f"{name}[{i}]",
                    unit(i),
                    description if shared else f"{description}, chain {i}",
                    value,
                    minimum,
                    tunable=True,
                ),
            )
            for i, value in enumerate(row, 1)
        )
    )
