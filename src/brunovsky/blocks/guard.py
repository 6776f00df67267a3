"""Guard of a law against its singularity: only the factors of denominators that vanish are regularised, each by itself.

``1/d`` becomes ``d/d_min**2`` where ``abs(d) <= d_min``, which is continuous at the limit and zero at ``d = 0``.
``d_min = 0`` leaves the plain law.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass

import sympy as sp

from brunovsky.blocks.variables import Check, Parameter, Relation, Variable
from brunovsky.errors import ModelError
from brunovsky.linearization.simplify import factors


@dataclass(frozen=True)
class Guard:
    """One factor of denominators with the parameter that is the limit of its absolute value.

    Parameters
    ----------
    denominator : Expr
        What vanishes, in symbols of the block.
    limit : Parameter
        ``d_min``, in the unit of the denominator.
    shown : str
        The denominator as people read it, in names of variables.
    """

    denominator: sp.Expr
    limit: Parameter
    shown: str

    @property
    def relations(self) -> tuple[Relation, Relation]:
        """``d > d_min`` and ``d < -d_min``; their indicators are ``d - d_min`` and ``d + d_min``."""
        stem = re.sub(r"\W", "_", self.limit.name)
        limit = self.limit.symbol
        return (
            Relation(f"above_{stem}", self.denominator - limit),
            Relation(f"below_minus_{stem}", -self.denominator - limit, indicator=self.denominator + limit),
        )

    @property
    def regular(self) -> sp.logic.boolalg.Boolean:
        """Condition under which the law is exact."""
        return sp.Or(*(one.symbol for one in self.relations))

    @property
    def reciprocal(self) -> sp.Expr:
        """Guarded ``1/d``."""
        return sp.Piecewise((1 / self.denominator, self.regular), (self.denominator / self.limit.symbol**2, True))

    @property
    def check(self) -> Check:
        """What explains a step that fails at the singularity."""
        return Check(
            "singular",
            sp.Or(self.limit.symbol > 0, sp.Ne(self.denominator, 0)),
            f"the linearising law is singular at {self.shown} = 0; start away from it or set {self.limit.name} > 0",
            when="failure",
        )


def find_guards(
    expressions: Collection[sp.Expr],
    locus: sp.Basic,
    limits: Mapping[sp.Expr, Parameter | float],
    labels: Mapping[sp.Symbol, Variable],
) -> tuple[Guard, ...]:
    """Guards for the factors of the singular locus that occur in the denominators of some expressions.

    Parameters
    ----------
    expressions : collection of Expr
        The law and the compensator.
    locus : Eq(product, 0) or false
        Where the law does not exist; what is no factor of it cannot vanish in a denominator and is not guarded.
    limits : mapping of Expr to Parameter or float
        Limit of a factor, or its default value. Without a declaration the limit of a variable ``v`` is ``v_min``, that
        of another factor ``singular_min[k]``; without a value it is 0, the law as it is.
    labels : mapping of Symbol to Variable
        Names and units people read.

    Raises
    ------
    ModelError
        If a limit is given for something that is no factor of the locus.
    """
    vanishing = _factors(locus)
    for key in limits:
        if not {key, -key} & set(vanishing):
            there = ", ".join(map(str, vanishing)) or "none, the law has no singularity"
            raise ModelError(f"guards: {key} is no factor of the singular locus; its factors are: {there}")
    denominators = [sp.fraction(sp.together(expression))[1] for expression in expressions]
    found = [one for one in vanishing if any(_power(denominator, one) for denominator in denominators)]
    guards: list[Guard] = []
    for k, factor in enumerate(found, 1):
        denominator = -factor if -factor in limits else factor
        text = str(denominator.xreplace({one: sp.Symbol(label.name) for one, label in labels.items()}))
        limit = limits.get(denominator, 0.0)
        guards.append(
            Guard(
                denominator,
                limit if isinstance(limit, Parameter) else _limit(labels.get(denominator), float(limit), k, text),
                text,
            )
        )
    return tuple(guards)


def guarded(expression: sp.Expr, guards: Collection[Guard]) -> sp.Expr:
    """Expression with each factor of its denominator that vanishes replaced by the guarded reciprocal."""
    numerator, denominator = sp.fraction(sp.together(expression))
    reciprocals = sp.S.One
    for guard in guards:
        if power := _power(denominator, guard.denominator):
            denominator = sp.cancel(denominator / guard.denominator**power)
            reciprocals *= guard.reciprocal**power
    return expression if reciprocals == 1 else numerator / denominator * reciprocals


def _limit(label: Variable | None, value: float, number: int, shown: str) -> Parameter:
    stem, bracket, indices = label.name.partition("[") if label else ("singular", "[", f"{number}]")
    unit = label.unit if label else "1"
    return Parameter(f"{stem}_min{bracket}{indices}", unit, f"guards {shown} against zero", value, 0.0, tunable=True)


def _factors(locus: sp.Basic) -> list[sp.Expr]:
    return [] if locus == sp.false else [factor for factor, _ in factors(locus.lhs)]


def _power(denominator: sp.Expr, factor: sp.Expr) -> int:
    """Power with which a factor occurs in a denominator, signs apart."""
    if not denominator.free_symbols:
        return 0
    return sum(int(power) for one, power in factors(denominator) if one in (factor, -factor))
