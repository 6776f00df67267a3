"""What the tables of a study file share: strictness, and numbers under the keys of the model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from pydantic import BaseModel, ConfigDict, ValidationInfo

from brunovsky._frozen import FrozenMapping
from brunovsky.comparison.study.keys import Key, bounds, input_keys, kinds_of, known_parameter, remedy
from brunovsky.comparison.study.loops import FAMILY, LawKind


class StudyTable(BaseModel):
    """A table of a study file: no other keys than these, no conversions, frozen."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, str_strip_whitespace=True)


def known_key(text: str, keys: Mapping[str, Key], what: str) -> str:
    """Return a key of the model as it is, or say what to write instead."""
    if text not in keys:
        raise ValueError(f"unknown {what}; {remedy(text, keys.values())}")
    return text


def check_range(text: str, value: float, kinds: Sequence[LawKind] = FAMILY) -> None:
    """Refuse a number outside the range of what its key sets, under laws of these kinds."""
    lowest, highest = bounds(input_keys()[text] if text in input_keys() else known_parameter(text, kinds))
    if not lowest <= value <= highest:
        allowed = f"{lowest:g} or more" if highest == float("inf") else f"{lowest:g} to {highest:g}"
        raise ValueError(f"{text} = {value:g} is out of range; give {allowed}")


def in_range(table: Mapping[str, float], info: ValidationInfo) -> Mapping[str, float]:
    """Freeze a table of numbers, all in their ranges."""
    for text, value in table.items():
        check_range(text, value, kinds_of(info))
    return FrozenMapping(table)


def by_name(table: Mapping[str, float], keys: Mapping[str, Key]) -> dict[str, float]:
    """Values by the names of the model."""
    return {keys[text].variable.name: float(value) for text, value in table.items()}
