"""The sixth protocol: what it costs to couple a loop's components at communication points."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from brunovsky.analysis import CouplingError, measured_order
from brunovsky.comparison.facts import joined, number
from brunovsky.comparison.output import plain
from brunovsky.comparison.protocols.explanation import COUPLING, Explanation
from brunovsky.errors import ParameterError

SCHEMES = {"jacobi": "all at once", "gauss_seidel": "in sequence"}
Key = tuple[str, str, int]
"""Law, scheme, and how many derivatives are exchanged."""


@dataclass(frozen=True)
class Coupling:
    """Coupling errors of all laws.

    Attributes
    ----------
    errors : mapping of str to tuple of CouplingError
        By law.
    limits : mapping of Key to float
        Communication steps (s) at which the coupled linear part loses stability, where it is known.
    large : float
        Error from which a run counts as lost (m).
    small : float
        Longest step from which the order of convergence is taken (s).
    explanation : Explanation
        The protocol in words.
    """

    errors: Mapping[str, tuple[CouplingError, ...]]
    limits: Mapping[Key, float]
    large: float
    small: float
    explanation: Explanation = COUPLING

    @property
    def laws(self) -> tuple[str, ...]:
        """Names of the laws."""
        return tuple(self.errors)

    @property
    def keys(self) -> tuple[Key, ...]:
        """Laws, schemes and derivatives, in their order."""
        return tuple(dict.fromkeys((law, one.scheme, one.order) for law in self.laws for one in self.errors[law]))

    def of(self, key: Key) -> tuple[CouplingError, ...]:
        """Runs over the communication step."""
        law, scheme, order = key
        return tuple(one for one in self.errors[law] if (one.scheme, one.order) == (scheme, order))

    def lost(self, one: CouplingError) -> bool:
        """Whether a run failed, or ended far from the monolithic one."""
        return not one.error <= self.large

    def rows(self) -> list[dict[str, Any]]:
        """One row for each run."""
        return [
            {
                "law": law,
                "coupled": SCHEMES[one.scheme],
                "derivatives": one.order,
                "step, s": one.communication_step,
                "largest distance, m": one.error if math.isfinite(one.error) else None,
                "lost": self.lost(one),
                "predicted limit, s": plain(self.limits.get((law, one.scheme, one.order))),
            }
            for law in self.laws
            for one in self.errors[law]
        ]

    def summary_rows(self) -> list[dict[str, Any]]:
        """One row for each law and step, a column for each coupling; then orders and limits."""
        rows: list[dict[str, Any]] = []
        for law in self.laws:
            keys = [key for key in self.keys if key[0] == law]
            steps = dict.fromkeys(one.communication_step for one in self.errors[law])
            for step in steps:
                cells = {_column(key): self._cell(key, step) for key in keys}
                rows.append({"law": law, "step": f"{1e3 * step:g} ms", **cells})
            rows.append({"law": law, "step": "order", **{_column(key): self._measured_order(key) for key in keys}})
            limits = {_column(key): self.limits.get(key) for key in keys}
            told = {name: None if one is None else f"{1e3 * one:.2f} ms" for name, one in limits.items()}
            rows.append({"law": law, "step": "predicted limit", **told})
        return rows

    def _cell(self, key: Key, step: float) -> float | str:
        found = next(one.error for one in self.of(key) if one.communication_step == step)
        return found if math.isfinite(found) else "fails"

    def _measured_order(self, key: Key) -> float | None:
        try:
            return measured_order(self.of(key), self.small)
        except ParameterError:
            return None

    def as_dict(self) -> dict[str, Any]:
        """The same as plain data, for JSON."""
        errors = {law: plain(list(found)) for law, found in self.errors.items()}
        return {"errors": errors, "rows": plain(self.rows()), "findings": self.findings()}

    def findings(self) -> list[str]:
        """Sentences that follow from the numbers; the last one sums up."""
        told = [
            f"Under “{law}” {joined([self._order(key) for key in self.keys if key[0] == law])}." for law in self.laws
        ]
        known = [key for key in self.keys if key in self.limits]
        if not known:
            return told
        wrong = [key for key in known if not self._agrees(key)]
        text = (
            f"For {len(known) - len(wrong)} of {len(known)} couplings the error grows beyond {number(self.large)} m "
            "only at steps above the predicted limit of stability, and at all such steps that were tried"
        )
        if wrong:
            text += (
                f"; not so for {joined([f'“{law}” {coupling_name(scheme, order)}' for law, scheme, order in wrong])}"
            )
        return [*told, f"{text}."]

    def _order(self, key: Key) -> str:
        _, scheme, order = key
        found = self._measured_order(key)
        if found is None:
            return f"{coupling_name(scheme, order)} the order cannot be told"
        return f"{coupling_name(scheme, order)} the error falls with order {number(found)} of the step"

    def _agrees(self, key: Key) -> bool:
        return all(self.lost(one) == (one.communication_step > self.limits[key]) for one in self.of(key))


def coupling_of(
    errors: Mapping[str, Sequence[CouplingError]], limits: Mapping[Key, float], *, large: float, small: float
) -> Coupling:
    """Result of the protocol; see :class:`Coupling`."""
    return Coupling({law: tuple(found) for law, found in errors.items()}, dict(limits), large, small)


def _column(key: Key) -> str:
    """Heading of a column, with the unit of its errors."""
    return f"{SCHEMES[key[1]]}, {key[2]} derivative{'s' * (key[2] != 1)}, m"


def coupling_name(scheme: str, order: int) -> str:
    """A coupling in a sentence."""
    continued = "inputs held" if order == 0 else f"{order} derivative{'s' * (order > 1)} exchanged"
    return f"{SCHEMES[scheme]} with {continued}"
