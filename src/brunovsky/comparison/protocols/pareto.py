"""The third protocol: fronts of two metrics, every law searched with the same budget."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

from brunovsky._frozen import FrozenMapping
from brunovsky.comparison.facts import joined, number, percent
from brunovsky.comparison.output import plain
from brunovsky.comparison.protocols.designs import Space, designs
from brunovsky.comparison.protocols.evaluation import (
    Evaluate,
    Trial,
    attempt,
    check_laws,
    failures_told,
    phrase,
    unit,
)
from brunovsky.comparison.protocols.explanation import PARETO, Explanation
from brunovsky.comparison.protocols.front import Point, dominance_told, hypervolume, nondominated, territories
from brunovsky.errors import ParameterError

_MOST = 5  # stretches of the combined front that are told one by one
BEYOND = 1.1  # how far the reference point lies beyond the worst of all fronts, unless it is given


@dataclass(frozen=True)
class Pareto:
    """Designs of all laws and their fronts.

    Attributes
    ----------
    objectives : tuple of str
        Two metrics, both to be small.
    budget : int
        Designs that each law was tried at; one for a law without knobs.
    seed : int
        Of the sequences.
    spaces : mapping of str to mapping
        For each law its knobs with their ranges.
    trials : tuple of Trial
        All runs, law by law.
    given_reference : tuple of float or None
        Reference point of the hypervolumes, if it was given.
    step_sensitive : frozenset of str
        Metrics that depend on the step.
    explanation : Explanation
        The protocol in words.
    """

    objectives: tuple[str, str]
    budget: int
    seed: int
    spaces: Mapping[str, Mapping[str, tuple[float, float]]]
    trials: tuple[Trial, ...]
    given_reference: Point | None = None
    step_sensitive: frozenset[str] = frozenset()
    explanation: Explanation = PARETO

    @property
    def laws(self) -> tuple[str, ...]:
        """Names of the laws."""
        return tuple(dict.fromkeys(one.law for one in self.trials))

    def designs(self, law: str) -> list[tuple[Point, Trial]]:
        """Designs of a law for which both objectives are defined."""
        found = []
        for one in self.trials:
            first, second = (one.value(name) for name in self.objectives)
            if one.law == law and first is not None and second is not None:
                found.append(((first, second), one))
        return found

    def front(self, law: str) -> list[tuple[Point, Trial]]:
        """Those that no other of the law dominates, in ascending order of the first objective."""
        found = self.designs(law)
        return [found[k] for k in nondominated([point for point, _ in found])]

    @property
    def fronts(self) -> dict[str, list[Point]]:
        """Points of each front, by law."""
        return {law: [point for point, _ in self.front(law)] for law in self.laws}

    @property
    def reference(self) -> Point | None:
        """Reference point of the hypervolumes; None where there is no design."""
        if self.given_reference is not None:
            return self.given_reference
        points = [point for front in self.fronts.values() for point in front]
        return (BEYOND * max(x for x, _ in points), BEYOND * max(y for _, y in points)) if points else None

    @property
    def hypervolumes(self) -> dict[str, float]:
        """Area between each front and the reference point, by law."""
        reference = self.reference
        if reference is None:
            return {}
        return {law: hypervolume(points, reference) for law, points in self.fronts.items()}

    def rows(self) -> list[dict[str, Any]]:
        """One row for each run, with whether it is on its law's front."""
        knobs = list(dict.fromkeys(name for space in self.spaces.values() for name in space))
        kept = {id(trial) for law in self.laws for _, trial in self.front(law)}
        return [one.row(knobs, self.objectives) | {"on_front": id(one) in kept} for one in self.trials]

    def as_dict(self) -> dict[str, Any]:
        """The same as plain data, for JSON."""
        found: dict[str, Any] = plain(self)
        return found | {
            "step_sensitive": sorted(self.step_sensitive),
            "fronts": plain(self.fronts),
            "reference": plain(self.reference),
            "hypervolumes": plain(self.hypervolumes),
            "territories": plain(territories(self.fronts)),
            "findings": self.findings(),
        }

    def findings(self) -> list[str]:
        """Sentences that follow from the numbers."""
        told = failures_told(self.trials) + [self._front(law) for law in self.laws]
        unsure = [phrase(name) for name in self.objectives if name in self.step_sensitive]
        if unsure:
            verb = "depends" if len(unsure) == 1 else "depend"
            return [*told, f"The {joined(unsure)} {verb} on the step of the simulation: the fronts rank no law."]
        fronts = {law: front for law, front in self.fronts.items() if front}
        if len(fronts) < 2:
            return told
        told.append(self._territories(fronts))
        told += [dominance_told(one, other, fronts) for one, other in itertools.combinations(fronts, 2)]
        reference = self.reference
        if reference is not None:
            sizes = joined([f"{number(value)} ({law})" for law, value in self.hypervolumes.items()])
            told.append(
                f"With the reference point ({number(reference[0])}, {number(reference[1])}) the hypervolumes are "
                f"{sizes}; another reference point gives others."
            )
        return told

    def _front(self, law: str) -> str:
        front, count = self.front(law), sum(one.law == law for one in self.trials)
        if not front:
            return f"No design of “{law}” has both metrics, so that it has no front."
        (first, _), (last, _) = front[0], front[-1]
        of = f"{len(front)} of {count} designs of “{law}”" if count > 1 else f"The one design of “{law}”"
        if len(front) == 1:
            x, y = (f"{phrase(name)} = {self._told(value, k)}" for k, (name, value) in self._pairs(first))
            return f"{of} {'is' if count == 1 else 'makes'} its front, at {x} and {y}."
        x, y = (
            f"{phrase(name)} from {number(first[k])} to {self._told(last[k], k)}"
            for k, name in enumerate(self.objectives)
        )
        return f"{of} are on its front, with {x} and {y}."

    def _pairs(self, point: Point) -> list[tuple[int, tuple[str, float]]]:
        return list(enumerate(zip(self.objectives, point, strict=True)))

    def _told(self, value: float, index: int) -> str:
        return f"{number(value)}\u00a0{unit(self.objectives[index])}".rstrip()

    def _territories(self, fronts: Mapping[str, list[Point]]) -> str:
        stretches, parts = territories(fronts), []
        name = self.objectives[0]
        if len(stretches) > _MOST:
            total = sum(one.designs for one in stretches)
            shares = [
                f"{percent(sum(one.designs for one in stretches if one.law == law) / total)} ({law})" for law in fronts
            ]
            return (
                f"The front of all designs together has {total} designs, {joined(shares)}; along it the laws change "
                f"{len(stretches) - 1} times, so that none has a stretch to itself."
            )
        for one in stretches:
            low, high = number(one.first[0]), number(one.last[0])
            where = f"at {low}" if low == high else f"from {low} to {high}"
            parts.append(f"“{one.law}” {where}")
        return f"The front of all designs together belongs, in ascending order of {phrase(name)}, to {joined(parts)}."


def pareto(
    evaluate: Evaluate,
    laws: Mapping[str, Mapping[str, float]],
    spaces: Mapping[str, Space],
    *,
    objectives: tuple[str, str] = ("iae", "total_variation_u2"),
    budget: int = 64,
    seed: int = 0,
    case: int = 0,
    reference: Point | None = None,
    step_sensitive: Collection[str] = (),
) -> Pareto:
    """Try every law at the same number of designs, and find its front: what improves one metric at the other's cost.

    Parameters
    ----------
    evaluate : Evaluate
        Makes one run.
    laws : mapping of str to mapping
        For each law the parameters that stay.
    spaces : mapping of str to mapping
        For each law its knobs with their ranges, 0 < low < high, searched over the logarithm. A law without knobs has
        one design.
    objectives : tuple of str
        Two metrics, both to be small.
    budget : int
        Designs of each law, a power of two, as Sobol's sequence needs for its balance.
    seed : int
        Of the scrambling; each law has its own sequence, whatever other laws there are.
    case : int
        Number of the case.
    reference : tuple of float, optional
        Reference point of the hypervolumes; by default 1.1 times the worst of all fronts in each objective.
    step_sensitive : collection of str
        Metrics by which no law may be ranked.

    Raises
    ------
    ParameterError
        If the budget is no power of two, a range is not usable, the objectives are not two, or a law has no space.

    References
    ----------
    S. Joe and F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional projections", SIAM Journal on
    Scientific Computing 30(5), 2635-2654, 2008, doi:10.1137/070709359.
    """
    check_laws("pareto", laws)
    if budget < 2 or budget & (budget - 1):
        raise ParameterError(f"pareto: budget = {budget} is no power of two; give 32, 64 or 128, for instance")
    if len(set(objectives)) != 2:
        raise ParameterError(f"pareto: objectives = {objectives}; give two metrics that differ")
    missing = [law for law in laws if law not in spaces]
    if missing:
        raise ParameterError(f"pareto: there is no space for {', '.join(missing)}; give one, empty for no knobs")
    trials = [
        attempt(evaluate, law, {**fixed, **design}, case)
        for law, fixed in laws.items()
        for design in designs(spaces[law], budget, seed, law)
    ]
    frozen = FrozenMapping({law: FrozenMapping(dict(spaces[law])) for law in laws})
    first, second = objectives
    return Pareto((first, second), budget, seed, frozen, tuple(trials), reference, frozenset(step_sensitive))
