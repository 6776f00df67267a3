"""The switching part P f(S) of sliding-mode laws: sign, saturation or tanh, and the disturbance it is to outweigh."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, get_args

import sympy as sp
from numpy.typing import ArrayLike

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import Chains
from brunovsky.blocks.library.gains import Gains, scalar_gains
from brunovsky.blocks.library.outer_loops.surface import surface_unit
from brunovsky.blocks.variables import Check, Parameter
from brunovsky.errors import ModelError, ParameterError

SwitchingFunction = Literal["saturation", "sign", "tanh"]
_DEFAULT_WIDTH = 0.05
_ALTERNATIVES = "or use co-simulation, which samples it once an internal step"


def saturation(value: sp.Expr, half_width: sp.Expr) -> sp.Expr:
    """sat(value/half_width): -1 to 1, linear within; the sign function for half_width = 0."""
    return sp.Piecewise(
        (1, value > half_width), (-1, value < -half_width), (value / half_width, half_width > 0), (0, True)
    )


@dataclass(frozen=True)
class Switching:
    """Gain P and smoothed sign f(S) of each chain.

    Parameters
    ----------
    kind : {"saturation", "sign", "tanh"}
        f(S) = sat(S/phi), sign(S) or tanh(S/phi).
    gain, width : Gains
        P, and phi where ``kind`` has it.
    """

    kind: SwitchingFunction
    gain: Gains
    width: Gains | None

    @classmethod
    def of(cls, chains: Chains, kind: SwitchingFunction, P: ArrayLike, phi: ArrayLike | None) -> Switching:
        """Parameters ``P`` and ``phi``, or ``P[i]`` and ``phi[i]``.

        Raises
        ------
        ModelError
            If ``kind`` is unknown or has no width, or the numbers do not fit the chains.
        """
        known_option("switching", kind, get_args(SwitchingFunction))
        if kind == "sign":
            if phi is not None:
                raise ModelError("switching='sign' has no phi; leave phi out, or choose 'saturation' or 'tanh'")
            return cls(kind, gain_of_switching(chains, P), None)
        what = "half-width of the boundary layer; 0: sign function" if kind == "saturation" else "width of tanh(S/phi)"
        width = _DEFAULT_WIDTH if phi is None else phi
        widths = scalar_gains(chains, "phi", width, lambda i: surface_unit(chains, i), what, 0.0)
        return cls(kind, gain_of_switching(chains, P), widths)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Each declaration once."""
        return (*self.gain.parameters, *(self.width.parameters if self.width else ()))

    def force(self, i: int, s: sp.Expr) -> sp.Expr:
        """P f(S) of a chain."""
        (gain,) = self.gain[i]
        if self.width is None:
            return gain * sp.sign(s)
        (phi,) = self.width[i]
        return gain * (saturation(s, phi) if self.kind == "saturation" else sp.tanh(s / phi))

    @property
    def checks(self) -> tuple[Check, ...]:
        """A sign function cannot run in model exchange; tanh needs a width."""
        if self.width is None:
            return tuple(_endless_check(gain) for (gain,) in dict.fromkeys(self.gain.rows))
        pairs = dict.fromkeys(zip(self.width.rows, self.gain.rows, strict=True))
        if self.kind == "saturation":
            return tuple(_thin_layer_check(phi, gain) for (phi,), (gain,) in pairs)
        return tuple(
            Check(
                "width of tanh",
                phi.symbol > 0,
                f"{phi.name} = 0 leaves tanh(S/{phi.name}) undefined; set {phi.name} > 0, or choose switching='sign'",
            )
            for (phi,) in dict.fromkeys(self.width.rows)
        )


def gain_of_switching(chains: Chains, P: ArrayLike) -> Gains:
    """Parameters ``P``, or ``P[i]``."""
    return scalar_gains(
        chains,
        "P",
        P,
        lambda i: chains.unit(i, chains.orders[i - 1]),
        "gain of the switching part of the reaching law",
        0.0,
    )


def bound_of(chains: Chains, disturbance: ArrayLike | None) -> Gains | None:
    """Parameters ``D``, or ``D[i]``: stated bounds of the disturbances at the level of v; None where none is stated."""
    if disturbance is None:
        return None
    return scalar_gains(
        chains,
        "D",
        disturbance,
        lambda i: chains.unit(i, chains.orders[i - 1]),
        "stated bound of the disturbance at the level of v",
        0.0,
    )


def bound_checks(gain: Gains, bound: Gains | None, leading: Mapping[int, Parameter]) -> tuple[Check, ...]:
    """P > abs(c_r) D on each chain, with ``leading`` the last coefficients of the surfaces (1 where there is none)."""
    if bound is None:
        return ()
    checks = {}
    for i, ((p,), (d,)) in enumerate(zip(gain.rows, bound.rows, strict=True), 1):
        needed = f"abs({leading[i].name}) {d.name}" if i in leading else d.name
        factor = sp.Abs(leading[i].symbol) if i in leading else sp.S.One
        checks[p, d, needed] = Check(
            "switching gain",
            p.symbol > factor * d.symbol,
            f"{p.name} does not exceed {needed}, so that a disturbance within its stated bound drives S away; raise "
            f"{p.name} above {needed}, or state a smaller {d.name}",
        )
    return tuple(checks.values())


def known_option(name: str, value: str, known: tuple[str, ...]) -> None:
    """Refuse an option that is not in the list with a ModelError that has the list."""
    if value not in known:
        listed = ", ".join(f"'{one}'" for one in known)
        raise ModelError(f"there is no {name} = {value!r}; choose one of {listed}")


def with_sound_defaults(block: Block) -> Block:
    """The block, refused with a ParameterError where its default values fail a check of its own."""
    for check in block.failed_checks(block.parameter_values(), "start"):
        raise ParameterError(f"{block.name}: {check.message}")
    return block


def _thin_layer_check(phi: Parameter, gain: Parameter) -> Check:
    return Check(
        "sign function",
        sp.Or(phi.symbol > 0, sp.Eq(gain.symbol, 0)),
        f"{phi.name} = 0 (sign function) has no end of events in model exchange; set {phi.name} > 0, or "
        f"{gain.name} = 0, {_ALTERNATIVES}",
        when="model exchange",
    )


def _endless_check(gain: Parameter) -> Check:
    return Check(
        "sign function",
        sp.Eq(gain.symbol, 0),
        "the sign function has no end of events in model exchange; choose switching='saturation' or 'tanh', "
        f"sliding_mode_relay with its hysteresis, {gain.name} = 0, {_ALTERNATIVES}",
        when="model exchange",
    )
