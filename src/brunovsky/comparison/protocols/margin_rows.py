"""What is measured of each law's margins: the quantities, and one margin beside what is predicted of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from brunovsky.comparison.facts import number
from brunovsky.comparison.measured_margins import MeasuredMargin


@dataclass(frozen=True)
class Quantity:
    """What is changed about a loop.

    Attributes
    ----------
    name : str
        In rows.
    title, unit : str
        For people.
    change : str
        Key of the study.
    falling : bool
        Whether it is made smaller; the others are made larger.
    """

    name: str
    title: str
    unit: str
    change: str
    falling: bool = False


QUANTITIES = (
    Quantity("gain_lower", "lower gain margin (factor)", "1", "gain", falling=True),
    Quantity("gain_upper", "upper gain margin (factor)", "1", "gain"),
    Quantity("delay", "delay", "s", "delay"),
    Quantity("lag", "one lag", "s", "lag"),
    Quantity("two_lags", "each of two equal lags", "s", "two_lags"),
    Quantity("sampling", "sampling period", "s", "sampling"),
)
CUTS = {"u1": "at u₁", "u2": "at u₂", "both": "at both"}


@dataclass(frozen=True)
class MarginRow:
    """One margin of one law.

    Attributes
    ----------
    law, cut : str
        Of which law, and where.
    quantity : Quantity
        What is changed.
    measured : MeasuredMargin
        What was found by simulation.
    predicted : float or None
        For the linear part (P = 0) along the scenario's motion; infinite where nothing limits it, None where there is
        no prediction.
    within_layer : float or None
        The same within the boundary layer; None for a law without.
    """

    law: str
    cut: str
    quantity: Quantity
    measured: MeasuredMargin
    predicted: float | None
    within_layer: float | None

    @property
    def difference(self) -> float | None:
        """Measured over predicted, less 1; None where either is missing, or what was measured is the step's."""
        found = self.of_law
        if found is None or not self.predicted or self.predicted == float("inf"):
            return None
        return found / self.predicted - 1.0

    @property
    def of_law(self) -> float | None:
        """The margin where it is the law's; None where there is none or the step of the simulation decides on it."""
        return None if self.bound or self.regained else self.measured.value

    @property
    def regained(self) -> bool:
        """Whether stability is lost, and regained beyond, so that there is no margin."""
        return self.measured.stands_again_to is not None

    @property
    def bound(self) -> str:
        """How a margin on which the step decides is told, such as "at least"; empty for one of the law or none."""
        if self.regained:
            return ""
        words = {"lost later": ("at least", "at most"), "lost earlier": ("less than", "more than")}
        pair = words.get(self.measured.at_half_step)
        return "" if pair is None else pair[self.quantity.falling]

    @property
    def limited(self) -> bool:
        """Whether there is a limit, measured or predicted."""
        predicted = (self.predicted, self.within_layer)
        return self.measured.value is not None or any(one not in (None, 0.0, float("inf")) for one in predicted)

    def as_row(self) -> dict[str, Any]:
        """Cells of a table, times in ms."""
        scale = 1.0 if self.quantity.unit == "1" else 1e3
        lost, again = self.measured.unstable_from, self.measured.stands_again_to
        return {
            "law": self.law,
            "at": self.cut,
            "margin": self.quantity.title + ("" if scale == 1.0 else ", ms"),
            "measured": self._cell(scale),
            "lost at": None if lost is None else scale * lost,
            "stands again to": None if again is None else scale * again,
            "at half the step": self.measured.at_half_step or None,
            "predicted, P = 0": _shown(self.predicted, scale),
            "predicted within the layer": _shown(self.within_layer, scale),
            "measured over predicted": None if self.difference is None else 1.0 + self.difference,
        }

    def _cell(self, scale: float) -> float | str:
        if self.measured.value is None:
            return self.measured.reason
        if self.regained:
            return f"none: lost {'below' if self.quantity.falling else 'above'} {number(scale * self.measured.value)}"
        return f"{self.bound} {number(scale * self.measured.value)}" if self.bound else scale * self.measured.value


def value_told(value: float | None, quantity: Quantity) -> str:
    """A size of a change with its unit, for people."""
    if value is None or quantity.unit == "1":
        return number(value)
    return f"{number(1e3 * value)} ms"


def _shown(value: float | None, scale: float) -> float | str | None:
    return "none" if value in (0.0, float("inf")) else None if value is None else scale * value


__all__ = ["CUTS", "QUANTITIES", "MarginRow", "Quantity", "value_told"]
