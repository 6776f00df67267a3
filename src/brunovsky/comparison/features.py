"""Which imperfections of a real robot the runs of a study have, so that nothing is said to be missing that is there."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any, Literal

from brunovsky.comparison.study import PlannedRun, Study

Feature = Literal["noise", "lag", "delay", "limits", "sampling", "disturbance", "uncertainty"]

# What the words of a key begin with, in a study file or among the parameters of its model.
_WORDS: dict[Feature, tuple[str, ...]] = {
    "noise": ("noise",),
    "lag": ("lag",),
    "delay": ("delay",),
    "limits": ("limit", "saturation"),
    "sampling": ("sampling", "sample"),
}


def features(study: Study) -> frozenset[Feature]:
    """Imperfections that at least one scenario of a study has."""
    return frozenset().union(*(scenario_features(study, one.name) for one in study.scenarios))


def scenario_features(study: Study, scenario: str) -> frozenset[Feature]:
    """Imperfections of one scenario, by what its tables and the parameters of its runs set to another value than 0."""
    found: set[Feature] = set()
    runs = [run for run in study.plan() if run.scenario == scenario]
    table = next(one for one in study.scenarios if one.name == scenario).model_dump()
    for words in [*_set_keys(table), *(words for run in runs for words in _set_keys(run.resolved()))]:
        found |= {name for name, begins in _WORDS.items() if any(word.startswith(begins) for word in words)}
    if any(_is_disturbed(run) for run in runs):
        found.add("disturbance")
    if any(run.parameters.get(f"rho[{k}]", 1.0) != 1.0 for run in runs for k in (1, 2)):
        found.add("uncertainty")
    return frozenset(found)


def _is_disturbed(run: PlannedRun) -> bool:
    return any(bool(value) for name, value in run.inputs.items() if name.startswith("d["))


def _set_keys(value: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    """Words of the keys that lead to each number other than 0."""
    if isinstance(value, Mapping):
        for key, one in value.items():
            yield from _set_keys(one, (*path, *re.split(r"[^a-z]+", str(key).lower())))
    elif isinstance(value, list | tuple):
        for one in value:
            yield from _set_keys(one, path)
    elif isinstance(value, int | float) and not isinstance(value, bool) and value:
        yield path
