"""Keys of a study file: the name of a variable of the model with its unit at the end.

``eta_start[1]`` in m/s is written ``eta_start_1_m_per_s``, ``C[1]`` in 1/s2 ``C_1_per_s2``; what has no unit has no
suffix. The keys follow from the block, so that a study can never name a variable or a unit that the model doesn't have.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

from pydantic import ValidationInfo

import brunovsky.blocks.library as library
from brunovsky.blocks import Block, Input, Parameter, Variable
from brunovsky.comparison.study.loops import KINDS, LawKind, Loop, loop_of


@dataclass(frozen=True)
class Key:
    """How one variable is written in a study file.

    Attributes
    ----------
    stem, suffix : str
        Name without brackets, and the unit, such as ``"eta_min"`` and ``"_m_per_s"``.
    variable : Variable
        What it sets.
    """

    stem: str
    suffix: str
    variable: Variable

    @property
    def text(self) -> str:
        """The key as it stands in the file."""
        return self.stem + self.suffix


def unit_suffix(unit: str) -> str:
    """Suffix of a key for a unit: ``"m/s2"`` gives ``"_m_per_s2"``, ``"1/s"`` ``"_per_s"``, ``"1"`` nothing."""
    parts = ["per_" + part[1:] if part[0] == "/" else part.lstrip(".") for part in re.findall(r"[./]?[^./]+", unit)]
    return "".join(f"_{part}" for part in parts if part != "1")


def keys_of(variables: Iterable[Variable]) -> dict[str, Key]:
    """Keys of several variables by their text, in order."""
    found = (Key(str(one.symbol), unit_suffix(one.unit), one) for one in variables)
    return {key.text: key for key in found}


@lru_cache
def study_block() -> Block:
    """The block that most studies run: reference, sliding-mode outer loop and linearised robot."""
    return loop_of("saturation").block


@lru_cache
def parameter_keys() -> Mapping[str, Key]:
    """Keys of the parameters of :func:`study_block`."""
    return keys_of(study_block().parameters)


@lru_cache
def input_keys() -> Mapping[str, Key]:
    """Keys of the inputs of :func:`study_block`, its disturbances, and of those at v."""
    matched = [one for one in library.outer_inputs().inputs if one.name.startswith("dv")]
    return keys_of((*study_block().inputs, *matched))


@lru_cache
def loop_keys(loop: Loop) -> Mapping[str, Key]:
    """Keys of the parameters of a loop."""
    return keys_of(loop.block.parameters)


def known_parameter(text: str, kinds: Sequence[LawKind]) -> Key:
    """Key of a parameter of loops of these kinds of laws, or ValueError with what to write instead."""
    found: dict[str, Key] = dict(parameter_keys())
    for kind in kinds:
        if text not in found:
            found |= {key: one for key, one in loop_keys(loop_of(kind)).items() if key not in found}
    if text not in found:
        found |= _hardware_keys()
    if text in found:
        return found[text]
    raise ValueError(f"unknown parameter or unit; {remedy(text, found.values())}")


@lru_cache
def _hardware_keys() -> Mapping[str, Key]:
    return keys_of(library.robot_with_hardware(lags=0.01, delays=0.01, limits=1.0, period=0.01).parameters)


def all_parameter_keys() -> Mapping[str, Key]:
    """Keys of the parameters of all loops, whatever the law and the hardware; it takes seconds to make them all."""
    found = dict(parameter_keys())
    for more in (_hardware_keys(), *(loop_keys(loop_of(kind)) for kind in KINDS)):
        found |= {text: key for text, key in more.items() if text not in found}
    return found


def kinds_of(info: ValidationInfo) -> Sequence[LawKind]:
    """Kinds of the laws of the study that is being read; all where that isn't known."""
    kinds: Sequence[LawKind] = (info.context or {}).get("kinds", KINDS)
    return kinds


def remedy(wrong: str, known: Iterable[Key] | Iterable[str]) -> str:
    """What to write in place of a key that isn't known: the right unit, a similar key, or the list of all."""
    keys = [one if isinstance(one, Key) else _plain(one) for one in known]
    same = [key for key in keys if key.suffix and re.fullmatch(re.escape(key.stem) + r"(_.*)?", wrong)]
    if same:
        best = max(same, key=lambda key: len(key.stem))
        return f"'{best.stem}' is in {_unit(best)}: write {best.text}"
    texts = [key.text for key in keys]
    close = difflib.get_close_matches(wrong, texts, n=1, cutoff=0.6)
    return f"did you mean {close[0]}?" if close else f"known are {', '.join(texts)}"


def _plain(text: str) -> Key:
    """Key of the study's own structure; only a trailing ``_s`` is a unit there."""
    stem, suffix = (text[:-2], "_s") if text.endswith("_s") else (text, "")
    return Key(stem, suffix, Variable(stem or text, "s" if suffix else "1"))


def _unit(key: Key) -> str:
    return key.variable.unit if key.variable.unit != "1" else "no unit"


def bounds(key: Key) -> tuple[float, float]:
    """Smallest and largest value that the variable of a key takes."""
    variable = key.variable
    if isinstance(variable, Parameter):
        return variable.minimum, variable.maximum
    assert isinstance(variable, Input)
    return -float("inf"), float("inf")
