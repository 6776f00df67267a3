"""A variant of a system: a name, and the values and duration that belong to it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from brunovsky._frozen import FrozenMapping
from brunovsky.errors import ParameterError
from brunovsky.fmi.definitions import STOP_TIME


@dataclass(frozen=True)
class Variant:
    """What one system structure description of a package sets: a parameter set and the default experiment.

    Parameters
    ----------
    name : str
        Of the parameter set and its file; letters, digits, ``_`` and ``-``.
    parameters : mapping of str to float
        Values that replace the diagram's defaults, by their names in the diagram.
    stop_time : float
        Of the default experiment, s.
    description : str
        One line for people.

    Raises
    ------
    ParameterError
        If the name cannot be that of a file, or the stop time is not positive and finite.
    """

    name: str
    parameters: Mapping[str, float] = field(default_factory=dict)
    stop_time: float = STOP_TIME
    description: str = ""

    def __post_init__(self) -> None:
        """Freeze the values and check name and stop time."""
        if not isinstance(self.name, str) or not re.fullmatch(r"[A-Za-z0-9_][\w-]*", self.name, re.ASCII):
            raise ParameterError(f"a variant cannot be called {self.name!r}; use letters, digits, '_' and '-'")
        if not isinstance(self.stop_time, int | float) or not 0 < self.stop_time < float("inf"):
            raise ParameterError(
                f"variant '{self.name}': stop_time = {self.stop_time!r} is not a positive finite number of seconds"
            )
        object.__setattr__(self, "parameters", FrozenMapping(self.parameters))
