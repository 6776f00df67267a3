"""Chatter tables of a study file: grids of switching loops behind lags, a delay or a sampled law."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Protocol

from pydantic import AfterValidator, BeforeValidator, Field, FiniteFloat, PlainSerializer

from brunovsky._frozen import FrozenMapping
from brunovsky.analysis import SwitchingLoop
from brunovsky.comparison.study.keys import parameter_keys, remedy
from brunovsky.comparison.study.table import StudyTable, check_range, known_key
from brunovsky.errors import ParameterError

MOST_POINTS = 2000  # of all grids of a study
MOST_LAGS = 4  # in series
SHORTEST, LONGEST = 1e-6, 100.0  # s; of a lag, delay or sampling period that is not zero
LARGEST = 1e9  # of a parameter; its inverse is the smallest that is not zero
AXES = ("C[1]", "C[2]", "C[3]", "Q", "P", "phi")


class Switching(Protocol):
    """What a grid needs to know of a law."""

    name: str

    @property
    def values(self) -> dict[str, float]:
        """P and phi."""


@dataclass(frozen=True)
class ChatterGrid:
    """Switching loops of one chatter table.

    Attributes
    ----------
    title : str
        What they are.
    loops : tuple of SwitchingLoop
        Its points, the lags varying fastest.
    """

    title: str
    loops: tuple[SwitchingLoop, ...]


def _parameter(text: str) -> str:
    known = {key: one for key, one in parameter_keys().items() if one.variable.name in AXES}
    return known_key(text, known, "parameter of the sliding law, or unit")


def _listed(value: Any) -> Any:
    """One number is a list of one."""
    return value if isinstance(value, list | tuple) else [value]


def _lists(value: Any) -> Any:
    if isinstance(value, list | tuple) and all(isinstance(one, list | tuple) for one in value):
        return value
    raise ValueError("is no list of lists; give the lags of each loop, such as [[0.005, 0.005], [0.01], []]")


def _in_range(table: Mapping[str, Sequence[float]]) -> Mapping[str, Sequence[float]]:
    for text, values in table.items():
        for value in values:
            check_range(text, value)
            if value and not 1.0 / LARGEST <= abs(value) <= LARGEST:
                raise ValueError(f"{text} = {value:g} is beyond all scales; give {1.0 / LARGEST:g} to {LARGEST:g}")
    return FrozenMapping(table)


def _duration(value: float) -> float:
    if value and not SHORTEST <= value <= LONGEST:
        raise ValueError(f"{value:g} s is out of range; give 0 or {SHORTEST:g} to {LONGEST:g}")
    return value


Seconds = Annotated[FiniteFloat, AfterValidator(_duration)]
Numbers = Annotated[tuple[FiniteFloat, ...], BeforeValidator(_listed), Field(min_length=1, strict=False)]
Lags = Annotated[tuple[Seconds, ...], Field(max_length=MOST_LAGS, strict=False)]
GridTable = Annotated[
    Mapping[Annotated[str, AfterValidator(_parameter)], Numbers], AfterValidator(_in_range), PlainSerializer(dict)
]


class ChatterTable(StudyTable):
    """A grid of switching loops whose chatter ``brunovsky analyze`` predicts and measures; ``compare`` ignores it.

    Every combination is a point: of the lists of lags in ``lags_s``, of ``delay_s``, and of the ``parameters``, each a
    number or a list of them. What is not given is the study's C and Q, and P and phi of its law ``law``, by default
    its first law with a switching term. ``sampling_s`` is the period of a sampled law; by default it is continuous.
    """

    title: str
    lags_s: Annotated[tuple[Lags, ...], BeforeValidator(_lists)] = Field(min_length=1, strict=False)
    delay_s: Annotated[tuple[Seconds, ...], BeforeValidator(_listed), Field(min_length=1, strict=False)] = (0.0,)
    sampling_s: Annotated[Seconds, Field(gt=0.0)] | None = None
    law: str | None = None
    parameters: GridTable = Field(default_factory=lambda: FrozenMapping({}))

    def grid(self, number: int, shared: Mapping[str, float], laws: Sequence[Switching]) -> ChatterGrid:
        """Points of the table, everything resolved.

        Parameters
        ----------
        number : int
            Which table it is in the file, from 1, for messages.
        shared : mapping of str to float
            Values of the study by the names of the model.
        laws : sequence of Law
            Laws of the study with a switching term.
        """
        where = f"chatter[{number}] ('{self.title}')"
        given = {parameter_keys()[text].variable.name: values for text, values in self.parameters.items()}
        axes = {name: given.get(name, (shared[name],)) for name in AXES[:4]}
        axes |= {name: given[name] for name in AXES[4:] if name in given}
        if len(axes) < len(AXES) or self.law is not None:
            chosen = self._law(where, laws)
            axes = {name: axes[name] if name in axes else (chosen.values[name],) for name in AXES}
        if min(axes["P"]) <= 0.0:
            raise ValueError(f"{where}: P_m_per_s3 = 0 has no chatter; give P_m_per_s3 > 0")
        choices: list[tuple[Any, ...]] = [*(axes[name] for name in AXES), self.delay_s, self.lags_s]
        points = math.prod(map(len, choices))
        if points > MOST_POINTS:
            raise ValueError(f"{where}: {points} points; give at most {MOST_POINTS}")
        try:
            loops = [
                SwitchingLoop((c1, c2, c3), Q, P, phi, lags=lags, delay=delay, sampling=self.sampling_s)
                for c1, c2, c3, Q, P, phi, delay, lags in itertools.product(*choices)
            ]
        except ParameterError as error:
            raise ValueError(f"{where}: {error}") from None
        return ChatterGrid(self.title, tuple(loops))

    def _law(self, where: str, laws: Sequence[Switching]) -> Switching:
        if self.law is None:
            if laws:
                return laws[0]
            raise ValueError(
                f"{where}: no law has a switching term; give P_m_per_s3 and phi_m_per_s2 in its parameters"
            )
        known = [one.name for one in laws]
        if self.law not in known:
            hint = remedy(self.law, known) if known else "the study has none"
            raise ValueError(f"{where}: there is no law '{self.law}' with a switching term; {hint}")
        return laws[known.index(self.law)]
