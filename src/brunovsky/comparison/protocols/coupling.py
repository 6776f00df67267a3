"""The sixth protocol: what it costs to couple a loop's components at communication points."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from brunovsky.analysis import CouplingError, measured_order
from brunovsky.analysis.coupling.scheme import ORDERS
from brunovsky.comparison.facts import given, joined, number
from brunovsky.comparison.output import plain
from brunovsky.comparison.protocols.explanation import COUPLING, Explanation
from brunovsky.errors import ParameterError

Key = tuple[str, str, int]
"""Law, scheme, and how many derivatives are exchanged."""


@dataclass(frozen=True)
class Layer:
    """Boundary layer of a law, and what it stands.

    Attributes
    ----------
    width : float
        phi, the half-width in the unit of S (m/s2).
    limits : mapping of (str, int) to float
        By scheme and derivatives, the communication step (s) at which the linear loop within it loses stability.
    """

    width: float
    limits: Mapping[tuple[str, int], float]


@dataclass(frozen=True)
class Coupling:
    """Coupling errors of all laws.

    Attributes
    ----------
    errors : mapping of str to tuple of CouplingError
        By law.
    limits : mapping of Key to float
        Communication steps (s) at which the coupled linear part (P = 0) loses stability, where it is known.
    layers : mapping of str to Layer
        By law, where it has a boundary layer, within which small deviations see Q + P/phi in place of Q.
    large : float
        Error from which a run counts as lost (m).
    small : float
        Longest step from which the order of convergence is taken (s).
    explanation : Explanation
        The protocol in words.
    """

    errors: Mapping[str, tuple[CouplingError, ...]]
    limits: Mapping[Key, float]
    layers: Mapping[str, Layer]
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

    def layer_limit(self, key: Key) -> float | None:
        """Step (s) at which the loop within the boundary layer loses stability; None for a law that has none."""
        layer = self.layers.get(key[0])
        return None if layer is None else layer.limits.get(key[1:])

    def leaves_layer(self, law: str, one: CouplingError) -> bool | None:
        """Whether S is beyond the layer at the end of a run in which the loop as one system rests within it.

        None where the law has no layer, or the loop as one system is not within it.
        """
        layer = self.layers.get(law)
        if layer is None or one.band is None or one.monolithic_band is None or one.monolithic_band > layer.width:
            return None
        return not one.band <= layer.width

    def rows(self) -> list[dict[str, Any]]:
        """One row for each run."""
        return [
            {
                "law": law,
                "coupled": ORDERS[one.scheme],
                "derivatives": one.order,
                "step, s": one.communication_step,
                "largest distance, m": one.error if math.isfinite(one.error) else None,
                "lost": self.lost(one),
                "predicted limit, s": plain(self.limits.get((law, one.scheme, one.order))),
                "predicted limit within the layer, s": plain(self.layer_limit((law, one.scheme, one.order))),
                "largest |S| of the last quarter, m/s²": plain(one.band),
                "beyond the layer": self.leaves_layer(law, one),
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
            rows.append(self._limit_row(law, "predicted limit (P = 0)", self.limits.get))
            if law in self.layers:
                rows.append(self._limit_row(law, "predicted limit within the layer", self.layer_limit))
        return rows

    def _limit_row(self, law: str, name: str, limit: Callable[[Key], float | None]) -> dict[str, Any]:
        found = {_column(key): limit(key) for key in self.keys if key[0] == law}
        told = {column: None if one is None else f"{1e3 * one:.2f} ms" for column, one in found.items()}
        return {"law": law, "step": name, **told}

    def _cell(self, key: Key, step: float) -> float | str:
        found = next(one for one in self.of(key) if one.communication_step == step)
        if not math.isfinite(found.error):
            return "fails"
        beyond = self.leaves_layer(key[0], found) and not self.lost(found)
        return f"{number(found.error)} (|S| > φ)" if beyond else found.error

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
        return [*told, *self._on_limits(), *self._on_layers()]

    def headline(self) -> str:
        """Size, order and limits of the coupling error: what the verdict says."""
        sizes = [text for order in dict.fromkeys(key[2] for key in self.keys) for text in [self._size(order)] if text]
        first = [f"The coupling error {joined(sizes)}."] if sizes else []
        layered = [
            f"Within the boundary layer of “{law}” it is predicted to be unstable "
            f"{self._steps([key for key in self.keys if key[0] == law], self.layer_limit)}."
            for law in self.layers
        ]
        return " ".join([*first, *self._on_limits(), *layered])

    def _size(self, order: int) -> str:
        """Order of convergence and error at the longest step that counts as small, over laws and schemes."""
        keys = [key for key in self.keys if key[2] == order]
        orders = [one for one in map(self._measured_order, keys) if one is not None]
        steps = [one.communication_step for key in keys for one in self.of(key) if one.communication_step <= self.small]
        if not orders or not steps:
            return ""
        found = [one.error for key in keys for one in self.of(key) if one.communication_step == max(steps)]
        return (
            f"with {_continued(order)} falls with order {_span(orders)} of the communication step and is "
            f"{_span(found)} m at {given(1e3 * max(steps))} ms"
        )

    def _on_limits(self) -> list[str]:
        """Whether the path is lost where the linear part is predicted to lose stability."""
        known = [key for key in self.keys if key in self.limits]
        if not known:
            return []
        sides = {key: {one.communication_step > self.limits[key] for one in self.of(key)} for key in known}
        tried = [key for key in known if len(sides[key]) == 2]
        text = f"Without the switching term (P = 0) the loop is predicted to be unstable {self._steps(known)}"
        if tried:
            wrong = [
                key
                for key in tried
                if any(self.lost(one) != (one.communication_step > self.limits[key]) for one in self.of(key))
            ]
            text += (
                f"; in {len(tried) - len(wrong)} of {len(tried)} couplings with steps tried on both sides the error "
                f"exceeds {given(self.large)} m at every step above its limit and at none below"
            )
            text += f" (not so for {joined([_named(key) for key in wrong])})" if wrong else ""
        if len(tried) < len(known):
            left = joined([_named(key) for key in known if key not in tried])
            text += f"; for {left} no step was tried on one of the sides, which examines nothing"
        return [f"{text}."]

    def _on_layers(self) -> list[str]:
        """Whether S leaves its layer where the loop within it is predicted to lose stability."""
        found = []
        for law, layer in self.layers.items():
            keys = [key for key in self.keys if key[0] == law and self.layer_limit(key) is not None]
            text = (
                f"Within the boundary layer of “{law}” small deviations see Q + P/φ in place of Q, and the loop is "
                f"predicted to be unstable {self._steps(keys, self.layer_limit)}; a run beyond that limit but not "
                "beyond the other chatters about S = 0 without leaving the path"
            )
            judged = {
                key: [(one, out) for one in self.of(key) for out in [self.leaves_layer(law, one)] if out is not None]
                for key in keys
            }
            if not any(judged.values()):
                found.append(f"{text}. The runs end before S is in the layer, so that this limit is not examined.")
                continue
            tried = {
                key: pairs
                for key, pairs in judged.items()
                if len({one.communication_step > self._lowest(key) for one, _ in pairs}) == 2
            }
            wrong = [
                key
                for key, pairs in tried.items()
                if any(out != (one.communication_step > self._lowest(key)) for one, out in pairs)
            ]
            text += (
                f". In {len(tried) - len(wrong)} of {len(tried)} couplings with steps tried on both sides |S| exceeds "
                f"φ = {given(layer.width)} m/s² over the last quarter at every step above the smaller of the two "
                "limits and at none below"
            )
            if wrong:
                text += f" (not so {joined([self._beyond_from(judged[key], key) for key in wrong])}"
                text += "; a run that decays slowly is not in the layer yet either)"
            found.append(f"{text}. The loop as one system stays within the layer then.")
        return found

    def _beyond_from(self, pairs: Sequence[tuple[CouplingError, bool]], key: Key) -> str:
        """From which of the steps tried S is beyond the layer."""
        beyond = [one.communication_step for one, out in pairs if out]
        begin = f"from {given(1e3 * min(beyond))} ms on" if beyond else "at no step"
        return f"{coupling_name(*key[1:])}, {begin}"

    def _lowest(self, key: Key) -> float:
        return min(self.limits.get(key, math.inf), self.layer_limit(key) or math.inf)

    def _steps(self, keys: Sequence[Key], limit: Callable[[Key], float | None] | None = None) -> str:
        """Limits of couplings in a sentence, those of several laws once where they are the same."""
        limit = limit or self.limits.get
        by_coupling: dict[str, list[float]] = {}
        for key in keys:
            by_coupling.setdefault(coupling_name(*key[1:]), []).append(1e3 * (limit(key) or math.nan))
        return "from " + joined([f"{_span(found)} ms ({name})" for name, found in by_coupling.items()]) + " on"

    def _order(self, key: Key) -> str:
        _, scheme, order = key
        found = self._measured_order(key)
        if found is None:
            return f"{coupling_name(scheme, order)} the order cannot be told"
        return f"{coupling_name(scheme, order)} the error falls with order {number(found)} of the step"


def coupling_of(
    errors: Mapping[str, Sequence[CouplingError]],
    limits: Mapping[Key, float],
    layers: Mapping[str, Layer] | None = None,
    *,
    large: float,
    small: float,
) -> Coupling:
    """Result of the protocol; see :class:`Coupling`."""
    return Coupling(
        {law: tuple(found) for law, found in errors.items()}, dict(limits), dict(layers or {}), large, small
    )


def _column(key: Key) -> str:
    """Heading of a column, with the unit of its errors."""
    return f"{ORDERS[key[1]]}, {key[2]} derivative{'s' * (key[2] != 1)}, m"


def coupling_name(scheme: str, order: int) -> str:
    """A coupling in a sentence."""
    return f"{ORDERS[scheme]} with {_continued(order)}"


def _continued(order: int) -> str:
    return "inputs held" if order == 0 else f"{order} derivative{'s' * (order > 1)} exchanged"


def _named(key: Key) -> str:
    return f"“{key[0]}” {coupling_name(*key[1:])}"


def _span(values: Sequence[float]) -> str:
    low, high = number(min(values)), number(max(values))
    return low if low == high else f"{low} to {high}"
