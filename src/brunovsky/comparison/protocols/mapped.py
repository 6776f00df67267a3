"""A map: metrics of each law over one or two swept keys, such as the heading at the start."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from brunovsky.comparison.facts import CONVERGED
from brunovsky.comparison.output import plain
from brunovsky.comparison.protocols.evaluation import (
    Evaluate,
    Trial,
    attempt,
    check_laws,
    unit,
)
from brunovsky.comparison.protocols.explanation import MAP, Explanation
from brunovsky.comparison.protocols.mapped_findings import map_findings, map_headline
from brunovsky.comparison.symbols import setting, symbol
from brunovsky.errors import ParameterError

Array = np.ndarray[Any, np.dtype[np.float64]]
Truths = np.ndarray[Any, np.dtype[np.bool_]]


@dataclass(frozen=True)
class Axis:
    """A key that is swept, and its values."""

    key: str
    values: tuple[float, ...]


@dataclass(frozen=True)
class Map:
    """Runs of all laws over the grid of one or two keys.

    Attributes
    ----------
    across : Axis
        What varies along a row.
    up : Axis or None
        What varies from row to row; None for one row.
    metrics : tuple of str
        Metrics that are told.
    trials : tuple of Trial
        Law by law, row by row.
    step_sensitive : frozenset of str
        Metrics that depend on the step.
    finer : tuple of Trial
        The same runs at half the step; empty where these were not made.
    explanation : Explanation
        The map in words.
    """

    across: Axis
    up: Axis | None
    metrics: tuple[str, ...]
    trials: tuple[Trial, ...]
    step_sensitive: frozenset[str] = frozenset()
    finer: tuple[Trial, ...] = ()
    explanation: Explanation = MAP

    @property
    def laws(self) -> tuple[str, ...]:
        """Names of the laws."""
        return tuple(dict.fromkeys(one.law for one in self.trials))

    @property
    def shape(self) -> tuple[int, int]:
        """Number of rows and columns."""
        return (len(self.up.values) if self.up else 1), len(self.across.values)

    def grid(self, law: str, metric: str) -> Array:
        """A metric of a law, shape of the map; not a number where it is undefined or the run failed."""
        return self._values(self.trials, law, metric)

    def converged(self, law: str, metric: str) -> Truths:
        """Where a metric is known, and no mapped metric of that run changes by more than one per cent at half the step.

        One number of a run may agree by chance where the step decides on the run. Shape of the map.
        """
        return np.isfinite(self.grid(law, metric)) & self.alike(law)

    def alike(self, law: str) -> Truths:
        """Where all mapped metrics of a run are the same within one per cent at half the step, shape of the map."""
        found = ~self.failed(law)
        for metric in self.metrics if self.finer else ():
            values, finer = self.grid(law, metric), self._values(self.finer, law, metric)
            same = np.abs(finer - values) <= CONVERGED * np.abs(values)
            found &= same | (np.isnan(values) & np.isnan(finer))
        return np.asarray(found & ~self.failed_finer(law))

    def sure(self, law: str, metric: str) -> Array:
        """The metric where it is converged; not a number elsewhere."""
        return np.where(self.converged(law, metric), self.grid(law, metric), math.nan)

    def _values(self, trials: Sequence[Trial], law: str, metric: str) -> Array:
        found = [one.value(metric) for one in trials if one.law == law]
        return np.array([math.nan if one is None else one for one in found]).reshape(self.shape)

    def failed(self, law: str) -> Truths:
        """Where the runs of a law failed, shape of the map."""
        return self._failed(self.trials, law)

    def failed_finer(self, law: str) -> Truths:
        """Where they failed at half the step, shape of the map; nowhere if these runs were not made."""
        return self._failed(self.finer, law) if self.finer else np.zeros(self.shape, dtype=bool)

    def _failed(self, trials: Sequence[Trial], law: str) -> Truths:
        return np.array([one.failure is not None for one in trials if one.law == law]).reshape(self.shape)

    def rows(self) -> list[dict[str, Any]]:
        """One row for each run."""
        keys = [self.across.key, *([self.up.key] if self.up else [])]
        return [one.row(keys, self.metrics) for one in self.trials]

    def summary_rows(self) -> list[dict[str, Any]]:
        """One row for each law and metric: its extremes over the map, and where they are."""
        found = []
        for metric, law in itertools.product(self.metrics, self.laws):
            values, sure = self.grid(law, metric), self.sure(law, metric)
            row: dict[str, Any] = {"law": law, "metric": metric, "unit": unit(metric)}
            row |= {"runs": values.size, "failed": int(self.failed(law).sum())}
            if self.finer:
                row["failed at half the step"] = int(self.failed_finer(law).sum())
            row["undefined"] = int(np.isnan(values).sum()) - row["failed"]
            row["not converged"] = int(np.sum(np.isfinite(values) & ~np.isfinite(sure)))
            if np.isfinite(sure).any():
                low, high = np.nanargmin(sure), np.nanargmax(sure)
                row |= {"least": float(sure.flat[low]), "at": self.place(int(low))}
                row |= {"median": float(np.nanmedian(sure))}
                row |= {"largest": float(sure.flat[high]), "there": self.place(int(high))}
            found.append(row)
        return found

    def as_dict(self) -> dict[str, Any]:
        """The same as plain data, for JSON."""
        found: dict[str, Any] = plain(self)
        return found | {"step_sensitive": sorted(self.step_sensitive), "findings": self.findings()}

    def findings(self) -> list[str]:
        """Sentences that follow from the numbers: failures, the range of each metric, how the laws differ."""
        return map_findings(self)

    def headline(self) -> str:
        """The one sentence for a verdict: by what factor each metric varies under the first law, by row and in all."""
        return map_headline(self)

    @property
    def keys(self) -> str:
        """What is swept, in words."""
        return " and ".join(symbol(one.key) for one in (self.across, self.up) if one is not None)

    def place(self, index: int) -> str:
        """Where a point of the grid is, in words."""
        row, column = np.unravel_index(index, self.shape)
        text = setting(self.across.key, self.across.values[int(column)])
        return text if self.up is None else f"{text}, {setting(self.up.key, self.up.values[int(row)])}"


def mapped(
    evaluate: Evaluate,
    laws: Mapping[str, Mapping[str, float]],
    across: Axis,
    up: Axis | None = None,
    *,
    metrics: Sequence[str],
    case: int = 0,
    step_sensitive: Collection[str] = (),
    finer: Evaluate | None = None,
) -> Map:
    """Run every law at every point of a grid, all else as it is.

    Parameters
    ----------
    evaluate : Evaluate
        Makes one run.
    laws : mapping of str to mapping
        For each law the parameters that stay.
    across, up : Axis
        The keys that are swept; `up` may be None.
    metrics : sequence of str
        Metrics to tell.
    case : int
        Number of the case.
    step_sensitive : collection of str
        Metrics by which no law may be ranked, unless each run is held against one at half the step.
    finer : Evaluate, optional
        Makes the same run at half the step; what changes by more than one per cent then is in no sentence.

    Raises
    ------
    ParameterError
        If there is no law, an axis has fewer than two values that ascend, or both are of one key.
    """
    check_laws("mapped", laws)
    for axis in filter(None, (across, up)):
        steps = np.diff(axis.values)
        if len(axis.values) < 2 or not np.isfinite(axis.values).all() or not np.all(steps > 0.0):
            raise ParameterError(f"mapped: {axis.key} over {list(axis.values)}; give two or more ascending values")
    if up is not None and up.key == across.key:
        raise ParameterError(f"mapped: both axes are {up.key}; give two keys, or one axis")
    rows: list[dict[str, float]] = [{}] if up is None else [{up.key: value} for value in up.values]
    points = [{**row, across.key: value} for row in rows for value in across.values]

    def run(one: Evaluate) -> tuple[Trial, ...]:
        return tuple(attempt(one, law, {**fixed, **point}, case) for law, fixed in laws.items() for point in points)

    halved = () if finer is None else run(finer)
    return Map(across, up, tuple(metrics), run(evaluate), frozenset(step_sensitive), halved)
