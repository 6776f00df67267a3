"""Pareto fronts of two objectives, both to be small."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from brunovsky.comparison.facts import percent

Point = tuple[float, float]


@dataclass(frozen=True)
class Territory:
    """A stretch of the combined front that belongs to one law.

    Attributes
    ----------
    law : str
        Whose designs lie there.
    first, last : tuple of float
        Its ends, both objectives each, in ascending order of the first objective.
    designs : int
        How many of them.
    """

    law: str
    first: Point
    last: Point
    designs: int


def dominates(one: Point, other: Point) -> bool:
    """Whether one point is at least as good in both objectives, and better in one."""
    return one[0] <= other[0] and one[1] <= other[1] and one != other


def nondominated(points: Sequence[Point]) -> list[int]:
    """Indices of the points that no other dominates, in ascending order of the first objective; of equals the first."""
    order = sorted(range(len(points)), key=lambda k: (points[k], k))
    kept: list[int] = []
    for k in order:
        if not kept or points[k][1] < points[kept[-1]][1]:
            kept.append(k)
    return kept


def hypervolume(points: Sequence[Point], reference: Point) -> float:
    """Area between a front and a reference point, in the product of the objectives' units.

    Points that are not better than the reference in both objectives add nothing.

    References
    ----------
    E. Zitzler and L. Thiele, "Multiobjective evolutionary algorithms: a comparative case study and the strength Pareto
    approach", IEEE Transactions on Evolutionary Computation 3(4), 257-271, 1999, doi:10.1109/4235.797969.
    """
    inside = [one for one in points if one[0] < reference[0] and one[1] < reference[1]]
    area, ceiling = 0.0, reference[1]
    for k in nondominated(inside):
        area += (reference[0] - inside[k][0]) * (ceiling - inside[k][1])
        ceiling = inside[k][1]
    return area


def coverage(one: Sequence[Point], other: Sequence[Point]) -> float | None:
    """Share of the other front that is dominated by the one; None where there is no other."""
    if not other:
        return None
    return sum(any(dominates(a, b) for a in one) for b in other) / len(other)


def territories(fronts: Mapping[str, Sequence[Point]]) -> list[Territory]:
    """Stretches of the combined front by the law that they belong to, in ascending order of the first objective."""
    pairs = [(point, law) for law, points in fronts.items() for point in points]
    found: list[Territory] = []
    for k in nondominated([point for point, _ in pairs]):
        point, law = pairs[k]
        if found and found[-1].law == law:
            found[-1] = Territory(law, found[-1].first, point, found[-1].designs + 1)
        else:
            found.append(Territory(law, point, point, 1))
    return found


def dominance_told(one: str, other: str, fronts: Mapping[str, list[Point]]) -> str:
    """What share of each of two fronts the other dominates."""
    forward, backward = coverage(fronts[one], fronts[other]) or 0.0, coverage(fronts[other], fronts[one]) or 0.0
    for winner, loser, share in ((one, other, forward), (other, one, backward)):
        if share == 1.0:
            return f"Every design on the front of “{loser}” is dominated by one of “{winner}”."
    if not forward and not backward:
        return f"No design on the front of “{one}” or “{other}” is dominated by one of the other."
    return (
        f"“{one}” dominates {percent(forward)} of the front of “{other}”, “{other}” {percent(backward)} of that of "
        f"“{one}”: neither is better throughout."
    )
