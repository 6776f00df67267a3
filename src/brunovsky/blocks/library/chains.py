"""What every outer loop and every reference shares: the chains of integrators with their names, units and errors."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.units import derivative_unit, unit_exponents
from brunovsky.blocks.variables import TIME, Input, Output, symbol
from brunovsky.errors import ModelError

_ELEMENT = re.compile(r"Z([1-9]\d*)\[([1-9]\d*)\]")


@dataclass(frozen=True)
class Chains:
    """Chains of integrators y_i^(r_i) = v_i as an outer loop sees them; the default is the robot's.

    Chain i has the elements ``Zi[1]``, ..., ``Zi[r_i]``, its reference ``Zid[1]``, ..., ``Zid[r_i]`` and, for r = 3,
    ``zd3[i]``, the derivative of the reference that goes with ``v[i]``.

    Parameters
    ----------
    orders : tuple of int, shape (m,)
        Their lengths r_i.
    units : tuple of str, shape (m,)
        Units of the outputs y_i that head them.

    Raises
    ------
    ModelError
        If there is no chain, a length is not positive, or there is not one readable unit for each.
    """

    orders: tuple[int, ...] = (3, 3)
    units: tuple[str, ...] = ("m", "m")

    def __post_init__(self) -> None:
        """Check lengths and units."""
        orders = (int(one) if isinstance(one, np.integer) else one for one in self.orders)
        object.__setattr__(self, "orders", tuple(orders))
        object.__setattr__(self, "units", tuple(self.units))
        if not self.orders or any(not isinstance(one, int) or isinstance(one, bool) or one < 1 for one in self.orders):
            raise ModelError(f"chains of the lengths {self.orders}: give a positive whole number for each chain")
        if len(self.units) != len(self.orders):
            raise ModelError(f"{len(self.units)} unit(s) for {len(self.orders)} chain(s); give one for each")
        for unit in self.units:
            unit_exponents(unit)

    @classmethod
    def of(cls, source: Chains | Block) -> Chains:
        """Chains of a block with outputs ``Zi[k]``, as :func:`brunovsky.linearized_block` makes it.

        Raises
        ------
        ModelError
            If the block has no such outputs.
        """
        if isinstance(source, Chains):
            return source
        if not isinstance(source, Block):
            raise ModelError(f"{source!r} has no chains; give Chains(orders, units) or a linearised plant")
        found: dict[int, list[str]] = {}
        for output in source.outputs:
            if match := _ELEMENT.fullmatch(output.name):
                found.setdefault(int(match[1]), []).append(output.unit)
        if sorted(found) != list(range(1, len(found) + 1)):
            raise ModelError(f"{source.name} has outputs Zi[k] for i = {sorted(found)}; chains are numbered 1, 2, …")
        if not found:
            raise ModelError(f"{source.name} has no outputs Z1[1], …; make it with linearized_block")
        rows = [found[i] for i in sorted(found)]
        return cls(tuple(map(len, rows)), tuple(row[0] for row in rows))

    @property
    def numbers(self) -> range:
        """Numbers of the chains, from 1."""
        return range(1, len(self.orders) + 1)

    @property
    def are_alike(self) -> bool:
        """Whether all have the same length and unit, so that they can share their parameters."""
        return len(set(zip(self.orders, map(unit_exponents, self.units), strict=True))) == 1

    def unit(self, chain: int, derivative: int) -> str:
        """Unit of a derivative of the output that heads a chain."""
        return derivative_unit(self.units[chain - 1], derivative)

    def error(self, chain: int) -> sp.Matrix:
        """Tracking error of a chain, Z - Zd (eq. 19 of the paper), shape (r_i, 1)."""
        elements = range(1, self.orders[chain - 1] + 1)
        return sp.Matrix([symbol(f"Z{chain}[{k}]") - symbol(f"Z{chain}d[{k}]") for k in elements])

    def feedforward(self, chain: int) -> sp.Symbol:
        """Symbol of the r_i-th derivative of a chain's reference."""
        return symbol(f"zd{self.orders[chain - 1]}[{chain}]")

    @property
    def states(self) -> tuple[Input, ...]:
        """Inputs ``Zi[k]``."""
        return self._elements("", "chain")

    @property
    def references(self) -> tuple[Input, ...]:
        """Inputs ``Zid[k]``."""
        return self._elements("d", "reference of chain")

    def _elements(self, suffix: str, what: str) -> tuple[Input, ...]:
        return tuple(
            Input(f"Z{i}{suffix}[{k}]", self.unit(i, k - 1), f"{what} {i}, element {k}")
            for i, order in enumerate(self.orders, 1)
            for k in range(1, order + 1)
        )

    @property
    def inputs(self) -> tuple[Input, ...]:
        """All inputs of an outer loop: the chains, their references, and the derivatives ``zdr[i]``."""
        highest = (
            Input(f"zd{order}[{i}]", self.unit(i, order), f"derivative {order} of the reference of chain {i}")
            for i, order in enumerate(self.orders, 1)
        )
        return (*self.states, *self.references, *highest)

    def outer_inputs(self, law: Mapping[int, sp.Expr]) -> tuple[Output, ...]:
        """Outputs ``v[i]`` of a law given per chain."""
        return tuple(Output(f"v[{i}]", self.unit(i, self.orders[i - 1]), f"input of chain {i}", law[i]) for i in law)

    def reference(self, positions: Sequence[sp.Expr]) -> tuple[Output, ...]:
        """Outputs ``Zid[k]`` and ``zdr[i]`` of a reference given as functions of time, differentiated symbolically."""
        derivatives = [[sp.diff(z, TIME, k) for k in range(r + 1)] for z, r in zip(positions, self.orders, strict=True)]
        elements = [
            Output(f"Z{i}d[{k + 1}]", self.unit(i, k), f"reference of z{i}, derivative {k}", derivative)
            for i, chain in enumerate(derivatives, 1)
            for k, derivative in enumerate(chain[:-1])
        ]
        highest = [
            Output(f"zd{r}[{i}]", self.unit(i, r), f"reference of z{i}, derivative {r}", chain[-1])
            for i, (r, chain) in enumerate(zip(self.orders, derivatives, strict=True), 1)
        ]
        return (*elements, *highest)


ROBOT_CHAINS = Chains()
"""Two chains of three integrators that begin with a position in m."""
