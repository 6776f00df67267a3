"""Guard of a law against its singularity: only a denominator that vanishes is regularised.

``1/d`` becomes ``d/d_min**2`` where ``abs(d) <= d_min``, which is continuous at the limit and zero at ``d = 0``.
``d_min = 0`` leaves the plain law.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass

import sympy as sp

from brunovsky.blocks.variables import Check, Parameter, Relation


@dataclass(frozen=True)
class Guard:
    """One denominator with the parameter that is the limit of its absolute value.

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
    limits: Mapping[sp.Expr, Parameter],
    names: Mapping[sp.Symbol, str],
) -> tuple[Guard, ...]:
    """Guards for what vanishes in the denominators of some expressions, each once, signs apart.

    Parameters
    ----------
    expressions : collection of Expr
        The law and the compensator.
    locus : Eq(product, 0) or false
        Where the law does not exist; a denominator that has no factor of it cannot vanish and is not guarded.
    limits : mapping of Expr to Parameter
        Limit of each denominator; one that is missing is ``singular_min[k]`` with default 0.
    names : mapping of Symbol to str
        Names people read.
    """
    guards: dict[sp.Expr, Guard] = {}
    shown = {one: sp.Symbol(name) for one, name in names.items()}
    for expression in expressions:
        denominator = _vanishing(sp.fraction(sp.together(expression))[1], locus)
        if denominator == 1 or {denominator, -denominator} & set(guards):
            continue
        if -denominator in limits:
            denominator = -denominator
        text = str(denominator.xreplace(shown))
        default = Parameter(
            f"singular_min[{len(guards) + 1}]", "1", f"guards {text} against zero", 0.0, 0.0, tunable=True
        )
        guards[denominator] = Guard(denominator, limits.get(denominator, default), text)
    return tuple(guards.values())


def guarded(expression: sp.Expr, locus: sp.Basic, guards: Collection[Guard]) -> sp.Expr:
    """Expression with what vanishes in its denominator, if anything does, replaced by the guarded reciprocal."""
    numerator, denominator = sp.fraction(sp.together(expression))
    vanishing = _vanishing(denominator, locus)
    for guard in guards:
        if vanishing in (guard.denominator, -guard.denominator):
            return numerator * sp.cancel(guard.denominator / denominator) * guard.reciprocal
    return expression


def _vanishing(denominator: sp.Expr, locus: sp.Basic) -> sp.Expr:
    """Product of the factors that a denominator shares with the singular locus, with their powers; 1 if none."""
    if locus == sp.false or not denominator.free_symbols:
        return sp.S.One
    zeros = {factor for factor, _ in sp.factor_list(locus.lhs)[1]}
    shared = [one**power for one, power in sp.factor_list(denominator)[1] if {one, -one} & zeros]
    return sp.Mul(*shared)
