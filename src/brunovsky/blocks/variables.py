"""What a block is made of: named variables, events and checks, all frozen descriptions.

Names follow FMI's structured naming (``eta[1]``, ``robot.x``); the symbol a name has in expressions is
:func:`symbol` of it. Angles are in rad, everything else in SI units.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, Literal

import numpy as np
import sympy as sp

from brunovsky._frozen import FrozenMapping
from brunovsky.errors import ParameterError

TIME = sp.Symbol("t", real=True)
"""Time in s, the independent variable of every expression."""

NAME = re.compile(r"[A-Za-z_]\w*(\[[1-9]\d*(,[1-9]\d*)*\])?(\.[A-Za-z_]\w*(\[[1-9]\d*(,[1-9]\d*)*\])?)*", re.ASCII)


@lru_cache(maxsize=4096)
def symbol(name: str) -> sp.Symbol:
    """Symbol that stands for the variable of this name in expressions: ``eta[1]`` becomes ``eta_1``."""
    return sp.Symbol(re.sub(r"\[([\d,]+)\]", lambda match: "_" + match[1].replace(",", "_"), name), real=True)


def symbols(*names: str) -> tuple[sp.Symbol, ...]:
    """Symbols of several variables, in order."""
    return tuple(symbol(name) for name in names)


@dataclass(frozen=True)
class Variable:
    """A named quantity with a unit.

    Parameters
    ----------
    name : str
        Structured name, unique in its block.
    unit : str
        Product of SI base units and rad with integer exponents, ``"1"`` if it has none.
    description : str
        One line for people.
    nominal : float, keyword
        Magnitude that is typical of a real variable, in its unit; absolute tolerances of solvers refer to it.
    """

    name: str
    unit: str = "1"
    description: str = ""
    nominal: float = field(default=1.0, kw_only=True)

    @property
    def symbol(self) -> sp.Symbol:
        """Symbol of the variable in expressions."""
        return symbol(self.name)


def described(one: Variable) -> dict[str, Any]:
    """What all variables have in common, as keywords for another one that stands for the same quantity."""
    return {item.name: getattr(one, item.name) for item in dataclasses.fields(Variable)}


@dataclass(frozen=True)
class Input(Variable):
    """A value set from outside, held between two settings; ``start`` is its value before the first one."""

    start: float = 0.0


@dataclass(frozen=True)
class Parameter(Variable):
    """A constant with a default value and a closed range; ``tunable`` ones may change between steps."""

    value: float = 0.0
    minimum: float = -float("inf")
    maximum: float = float("inf")
    tunable: bool = False


@dataclass(frozen=True)
class State(Variable):
    """A continuous state: ``derivative`` in time, ``start`` as a function of parameters."""

    derivative: sp.Expr = sp.S.Zero
    start: sp.Expr = sp.S.Zero


@dataclass(frozen=True)
class Clock:
    """What makes samples happen: every ``period`` seconds, unless an importer of the FMU ticks it at other instants.

    Parameters
    ----------
    name : str
        Structured name, unique in its block.
    description : str
        One line for people.
    period : sympy.Expr
        A positive number, or the symbol of a parameter that is not tunable, s.
    """

    name: str
    description: str = ""
    period: sp.Expr = sp.S.One

    @property
    def symbol(self) -> sp.Symbol:
        """Symbol that no other variable may have; expressions do not use it."""
        return symbol(self.name)

    @property
    def unit(self) -> str:
        """Unit of the period."""
        return "s"


@dataclass(frozen=True)
class Sample(Variable):
    """A discrete state, updated every ``period`` seconds or when its ``clock`` ticks, and held between.

    ``clock`` is the name of a clock of the block, whose period the block then fills in; without either the period is
    1 s. ``update`` and all other updates of the same block see the values from before the instant. ``rank`` orders
    the samples of a diagram: those of a lower rank are updated first and seen by the higher ones. A sample with the
    period ``oo`` is never due: :func:`held` makes such values, which transitions alone change.
    """

    update: sp.Expr = sp.S.Zero
    start: sp.Expr = sp.S.Zero
    period: sp.Expr = None
    rank: int = 0
    clock: str = ""

    @property
    def is_held(self) -> bool:
        """Whether transitions alone change it."""
        return self.period is sp.oo


def held(name: str, unit: str = "1", description: str = "", start: sp.Expr | float = 0.0) -> Sample:
    """A value that transitions alone change, such as the plan that a supervisor follows.

    Parameters
    ----------
    name, unit, description : str
        As for a variable.
    start : Expr or float
        Its value before the first change, a function of parameters.
    """
    return Sample(name, unit, description, update=symbol(name), start=sp.sympify(start), period=sp.oo)


@dataclass(frozen=True)
class Mode(Variable):
    """An integer state that only transitions change; ``start`` is its value at the beginning."""

    start: int = 0


@dataclass(frozen=True)
class Output(Variable):
    """A value computed from the others: a real expression, or a Boolean one, which the block finds out."""

    expression: sp.Expr | sp.logic.boolalg.Boolean = sp.S.Zero
    is_boolean: bool = False


@dataclass(frozen=True)
class Relation:
    """A named switching condition, true where ``expression > 0``, frozen between events.

    ``indicator`` is the function whose zero crossing is watched, where it isn't the expression itself
    (its negative, say, which crosses zero at the same place).
    """

    name: str
    expression: sp.Expr
    indicator: sp.Expr | None = None

    @property
    def symbol(self) -> sp.Symbol:
        """Boolean symbol of the relation in expressions."""
        return sp.Symbol(self.name)


@dataclass(frozen=True)
class Transition:
    """At an event where ``guard`` holds, ``assign`` modes, states and samples, from the values before.

    Where two transitions of one instant assign the same variable, the one declared first wins.
    """

    name: str
    guard: sp.logic.boolalg.Boolean
    assign: Mapping[sp.Symbol, sp.Expr] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Freeze the assignments."""
        object.__setattr__(self, "assign", FrozenMapping(self.assign))


@dataclass(frozen=True)
class Check:
    """A condition with the message that is due where it does not hold.

    ``when`` is ``"start"`` (on leaving initialisation and after a parameter changed), ``"model exchange"``
    (the same, for that interface alone) or ``"failure"`` (explains a step that failed while the condition
    did not hold; ``name`` is then the reason, ``"singular"`` for example).
    """

    name: str
    condition: sp.logic.boolalg.Boolean
    message: str
    when: Literal["start", "model exchange", "failure"] = "start"


def check_nominal(block: str, variable: Variable) -> None:
    """Error if the nominal value of a variable is not positive and finite; ``block`` is the name for messages.

    Raises
    ------
    ParameterError
        If so.
    """
    value = variable.nominal
    number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
    if not number or not 0 < value < float("inf"):
        raise ParameterError(
            f"{block}: the nominal value of '{variable.name}' is {value!r}; it is the magnitude that is typical of the "
            "variable, a positive finite number"
        )
