"""Reaching laws: the derivative that a sliding-mode law gives to S."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Literal, get_args

import sympy as sp
from numpy.typing import ArrayLike

from brunovsky.blocks.library.chains import Chains
from brunovsky.blocks.library.gains import Gains, scalar_gains
from brunovsky.blocks.library.outer_loops.switching import Switching, known_option
from brunovsky.blocks.variables import Check, Parameter
from brunovsky.errors import ModelError

ReachingLaw = Literal["exponential", "constant rate", "power rate"]
_DEFAULT_Q = {"exponential": 5.0, "power rate": 0.0}
_DEFAULT_EXPONENT = 0.5
_RESOLUTION = sp.Rational(1, 10**12)  # of abs(S) in the power rate: no power of a negative number within a frozen step


@dataclass(frozen=True)
class Reaching:
    """S' = -Q S - P abs(S)^a f(S), with Q and a where the law has them.

    Parameters
    ----------
    part : Switching
        P f(S).
    exponential, exponent : Gains or None
        Q and a.
    """

    part: Switching
    exponential: Gains | None
    exponent: Gains | None

    @classmethod
    def of(
        cls, chains: Chains, kind: ReachingLaw, Q: ArrayLike | None, exponent: ArrayLike | None, part: Switching
    ) -> Reaching:
        """Parameters ``Q`` and ``exponent``, those of the law.

        Raises
        ------
        ModelError
            If the law is unknown or has no Q or exponent, or the numbers do not fit the chains.
        """
        known_option("reaching", kind, get_args(ReachingLaw))
        if kind != "power rate" and exponent is not None:
            raise ModelError(f"reaching={kind!r} has no exponent; leave exponent out, or choose 'power rate'")
        if kind == "constant rate":
            if Q is not None:
                raise ModelError("reaching='constant rate' has no Q; leave Q out, or choose 'exponential'")
            return cls(part, None, None)
        q = exponential_gain(chains, _DEFAULT_Q[kind] if Q is None else Q)
        if kind == "exponential":
            return cls(part, q, None)
        power = _DEFAULT_EXPONENT if exponent is None else exponent
        return cls(part, q, scalar_gains(chains, "exponent", power, lambda i: "1", "exponent of the power rate"))

    def rate(self, i: int, s: sp.Expr) -> sp.Expr:
        """S_i' of a chain without disturbance."""
        force = self.part.force(i, s)
        if self.exponent:
            (a,) = self.exponent[i]
            (phi,) = self.part.width[i] if self.part.width else (sp.S.Zero,)
            force *= (s**2 + phi**2 + _RESOLUTION**2) ** (a / 2)
        return -force if self.exponential is None else -self.exponential[i][0] * s - force

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Each declaration once: Q, P, phi, a."""
        groups = (self.exponential, self.part, self.exponent)
        return tuple(one for group in groups if group for one in group.parameters)

    @property
    def checks(self) -> tuple[Check, ...]:
        """Those of the switching part, and 0 < a < 1."""
        return (
            *self.part.checks,
            *(
                Check(
                    "exponent",
                    sp.And(one.symbol > 0, one.symbol < 1),
                    f"{one.name} must lie between 0 and 1, both excluded: 0 is reaching='constant rate', and from 1 on "
                    "the surface is not reached in finite time",
                )
                for one in (self.exponent.parameters if self.exponent else ())
            ),
        )


def exponential_gain(chains: Chains, Q: ArrayLike) -> Gains:
    """Parameters ``Q``, or ``Q[i]``, with a warning where a default drives S away: a class may want to see it."""
    gains = scalar_gains(chains, "Q", Q, lambda i: "1/s", "gain of the exponential part of the reaching law")
    if negative := [one for one in gains.parameters if one.value < 0.0]:
        name, value = negative[0].name, negative[0].value
        warnings.warn(f"{name} = {value:g} drives S away from the surface where abs(S) > P/{-value:g}", stacklevel=3)
    return gains
