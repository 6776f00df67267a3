"""Where disturbances and parameter errors enter the chains, and what a switching gain must exceed for them."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import sympy as sp

from brunovsky._frozen import FrozenMapping
from brunovsky.errors import LinearizationError, ModelError
from brunovsky.linearization.affine import AffineSystem
from brunovsky.linearization.board import Equation, Explained, Formula, Heading, Line, Sentence
from brunovsky.linearization.naming import rate
from brunovsky.linearization.simplify import tidy

if TYPE_CHECKING:
    from brunovsky.linearization.linearize import Linearization


@dataclass(frozen=True)
class DisturbanceMap(Explained):
    """What disturbances and parameter errors add to each link of each chain under the nominal law.

    Parameters
    ----------
    sources : tuple of sympy.Symbol
        The disturbances and the uncertain parameters.
    model : tuple of tuples of sympy.Expr
        With chain coordinates computed from the nominal model: z_k' = z_(k+1) + model[i][k - 1] for k < r_i, and
        z_r' = v_i + model[i][-1]; in the unit of z_k per second.
    measured : tuple of sympy.Expr
        With the derivatives of the outputs measured instead: y_i^(r_i) = v_i + measured[i]. Everything is matched
        then, and the disturbances' rates appear.
    rates : mapping of sympy.Symbol to sympy.Symbol
        What stands for the rates of disturbances and inputs in `measured`, and for the rates of these: d1 to d1_dot,
        d1_dot to d1_ddot, ...
    inputs : tuple of sympy.Symbol
        The inputs of the extended system.
    """

    sources: tuple[sp.Symbol, ...]
    model: tuple[tuple[sp.Expr, ...], ...]
    measured: tuple[sp.Expr, ...]
    rates: Mapping[sp.Symbol, sp.Symbol]
    inputs: tuple[sp.Symbol, ...]

    def orders(self, source: sp.Symbol) -> tuple[tuple[int, ...], ...]:
        """Per chain, the derivatives of the output (1, ..., r_i) in which a disturbance or parameter appears."""
        return tuple(tuple(k for k, part in enumerate(chain, start=1) if part.has(source)) for chain in self.model)

    def is_matched(self, source: sp.Symbol) -> bool:
        """Whether a disturbance or parameter appears in no derivative but the last of each chain, where v does."""
        found = zip(self.model, self.orders(source), strict=True)
        return all(order == len(chain) for chain, orders in found for order in orders)

    @property
    def gain_errors(self) -> tuple[sp.Symbol, ...]:
        """Sources that multiply an input, which the outer loop drives: no constant switching gain bounds them."""
        parts = [part for chain in self.model for part in chain]
        return tuple(one for one in self.sources if any(sp.diff(part, one).has(*self.inputs) for part in parts))

    def lines(self) -> Iterator[Line]:
        """Yield the lines that `explain`, `latex` and notebooks show."""
        yield Heading("Disturbances")
        yield Sentence("Under the law, with chains computed from the nominal model, these are added:")
        for i, chain in enumerate(self.model, 1):
            for k, part in enumerate(chain, 1):
                if part != 0:
                    yield Equation(_excess(i, k, len(chain)), part)
        for source in self.sources:
            orders = self.orders(source)
            if not any(orders):
                yield Sentence("{} does not reach the chains.", (source,))
                continue
            places = ", ".join(f"{'/'.join(map(str, one))} of output {i}" for i, one in enumerate(orders, 1) if one)
            verdict = "matched" if self.is_matched(source) else "not matched"
            bound = "; no constant gain bounds it" if source in self.gain_errors else ""
            yield Sentence(f"{{}} enters in derivative {places}: {verdict}{bound}.", (source,))
        if any(part != 0 for part in self.measured):
            yield Sentence("With the derivatives of the outputs measured instead, all of it is matched:")
        for i, (part, chain) in enumerate(zip(self.measured, self.model, strict=True), 1):
            if part != 0:
                r = len(chain)
                yield Equation(Formula(f"y{i}^({r}) - v{i}", rf"y_{{{i}}}^{{({r})}} - v_{{{i}}}"), part)

    def switching_gain_bounds(
        self,
        surface: Sequence[Sequence[sp.Expr | float]],
        amplitudes: Mapping[sp.Symbol, sp.Expr | float],
        *,
        measured: bool = False,
        worst_angles: Sequence[sp.Symbol] = (),
    ) -> tuple[sp.Expr, ...]:
        """Bounds that the switching gain P_i must exceed for S_i = C_i e_i to reach and keep zero.

        With v_i = (-Q_i S_i - P_i sign(S_i) - c_1 e_i2 - ... - c_(r-1) e_ir) / c_r + y_d^(r) the surface obeys
        S_i' = -Q_i S_i - P_i sign(S_i) + sum_k c_k model[i][k - 1].

        Parameters
        ----------
        surface : sequence of sequences
            Per chain c_1, ..., c_r, numbers or expressions; taken as positive.
        amplitudes : mapping of sympy.Symbol to number or sympy.Expr
            Bound of abs(d) for a disturbance, of abs(p - nominal) for a parameter; a source that is left out counts as
            zero. With `measured`, also of each rate of these disturbances that occurs, by the symbol of the rate.
        measured : bool
            Whether the chain coordinates are measured rather than computed from the nominal model.
        worst_angles : sequence of sympy.Symbol
            Angles over which to take the largest value, where they occur as a sin + b cos alone.

        Returns
        -------
        tuple of sympy.Expr
            Per chain, in the unit of S_i per second; sums of absolute values, in the states that remain.

        Raises
        ------
        LinearizationError
            If a source enters nonlinearly, or a worst angle otherwise than as a sin + b cos.
        ModelError
            If the surface does not fit the chains, or a rate that occurs has no bound.
        """
        if len(surface) != len(self.model):
            raise ModelError(f"the surface has {len(surface)} rows for {len(self.model)} chains; give one per chain")
        bounds = []
        for weights, chain, highest in zip(surface, self.model, self.measured, strict=True):
            if len(weights) != len(chain):
                raise ModelError(f"{tuple(weights)} has {len(weights)} weights for a chain of length {len(chain)}")
            links = (*(sp.S.Zero,) * (len(chain) - 1), highest) if measured else chain
            total = sp.Add(*(sp.sympify(weight) * part for weight, part in zip(weights, links, strict=True)))
            self._check_rates(total, amplitudes)
            bounds.append(_bound(total, (*self.sources, *self.rates.values()), amplitudes, worst_angles))
        return tuple(bounds)

    def _check_rates(self, total: sp.Expr, amplitudes: Mapping[sp.Symbol, Any]) -> None:
        for source in self.sources:
            one = source
            while source in amplitudes and one in self.rates:
                one = self.rates[one]
                if total.has(one) and one not in amplitudes:
                    raise ModelError(
                        f"amplitudes: {source} is bounded, but with measured chains its derivative {one} enters too; "
                        f"give a bound of {one} as well, or use the chains computed from the model"
                    )


def disturbance_map(linearization: Linearization, plant: AffineSystem | None = None) -> DisturbanceMap:
    """Derive where the disturbances and parameter errors of a plant enter the chains of its nominal linearisation.

    Parameters
    ----------
    linearization : Linearization
        Of the nominal plant; its law and chains know nothing of the errors.
    plant : AffineSystem, optional
        The true plant, with the same states and inputs; what it has beyond the nominal one, in disturbances and
        parameters, are the sources. The nominal plant with its disturbances where it is left out.

    Returns
    -------
    DisturbanceMap
        What they add to each link.

    Raises
    ------
    ModelError
        If states or inputs differ.

    References
    ----------
    A. Isidori, *Nonlinear Control Systems*, 3rd ed., 1995, section 4.6 (decoupling of disturbances),
    doi:10.1007/978-1-84628-615-5; B. Drazenovic, "The invariance conditions in variable structure systems",
    *Automatica* 5 (1969) 287-295, doi:10.1016/0005-1098(69)90071-5 (matching).
    """
    nominal, extended = linearization.system, linearization.extended_system
    plant = plant or nominal
    error = _error(linearization, plant)
    states = sp.Matrix(extended.states)

    def added(function: sp.Expr) -> sp.Expr:
        return tidy((sp.Matrix([function]).jacobian(states) * error)[0])

    model = tuple(tuple(added(function) for function in chain) for chain in linearization.chains)
    sources = (*plant.disturbances, *(one for one in plant.parameters if one not in nominal.parameters))
    taken = {str(one) for one in (*states, *extended.inputs, *plant.parameters, *plant.disturbances)}
    rates = _rates((*plant.disturbances, *extended.inputs), taken, max(linearization.relative_degree) - 1)
    moving = extended.drift + extended.input_matrix * sp.Matrix(extended.inputs) + error
    measured = []
    for chain in model:
        total: sp.Expr = sp.S.Zero
        for part in chain:
            along = (sp.Matrix([total]).jacobian(states) * moving)[0]
            total = along + sum(sp.diff(total, one) * name for one, name in rates.items()) + part
        measured.append(tidy(total))
    used = [name for name in rates.values() if any(part.has(name) for part in measured)]
    needed = {one: name for one, name in rates.items() if {name, *_following(name, rates)} & set(used)}
    return DisturbanceMap(sources, model, tuple(measured), FrozenMapping(needed), extended.inputs)


def _rates(symbols: Sequence[sp.Symbol], taken: set[str], order: int) -> dict[sp.Symbol, sp.Symbol]:
    """Each symbol with the symbol of its rate, that with the next, up to an order."""
    rates: dict[sp.Symbol, sp.Symbol] = {}
    for symbol in symbols:
        derivatives = [symbol, *(rate(symbol, taken, k) for k in range(1, order + 1))]
        rates |= dict(itertools.pairwise(derivatives))
    return rates


def _following(symbol: sp.Symbol, rates: Mapping[sp.Symbol, sp.Symbol]) -> Iterator[sp.Symbol]:
    while symbol in rates:
        symbol = rates[symbol]
        yield symbol


def _excess(i: int, k: int, order: int) -> Formula:
    """What the rate of an element of a chain has beyond the next element, or beyond v."""
    plain, latex = (f"v{i}", f"v_{{{i}}}") if k == order else (f"Z{i}_{k + 1}", f"Z_{{{i},{k + 1}}}")
    return Formula(f"dZ{i}_{k}/dt - {plain}", rf"\dot{{Z}}_{{{i},{k}}} - {latex}")


def measured_chains(linearization: Linearization, plant: AffineSystem | None = None) -> tuple[tuple[sp.Expr, ...], ...]:
    """Derive what sensors of the outputs' derivatives show: those along the true plant, disturbances included.

    With them in place of chain coordinates computed from the nominal model every disturbance is matched, as
    :class:`DisturbanceMap` has it under ``measured``.

    Parameters
    ----------
    linearization : Linearization
        Of the nominal plant.
    plant : AffineSystem, optional
        The true plant, with the same states and inputs; the nominal one with its disturbances where it is left out.

    Returns
    -------
    tuple of tuples of sympy.Expr
        Per output y, y', ..., y^(r_i - 1) in the states of the extended system, disturbances and parameters.

    Raises
    ------
    ModelError
        If states or inputs differ.
    LinearizationError
        If a derivative contains the rate of a disturbance, which no input of a block has, or an input, which would
        close an algebraic loop through the law.
    """
    extended, plant = linearization.extended_system, plant or linearization.system
    moving = extended.drift + extended.input_matrix * sp.Matrix(extended.inputs) + _error(linearization, plant)
    states = sp.Matrix(extended.states)
    chains = []
    for i, (output, degree) in enumerate(
        zip(linearization.system.outputs, linearization.relative_degree, strict=True), 1
    ):
        chain = [output]
        for order in range(1, degree):
            below = chain[-1]
            if rated := sorted(str(one) for one in plant.disturbances if below.has(one)):
                raise LinearizationError(
                    f"derivative {order} of output {i} contains the rate of {', '.join(rated)}, which is not known; "
                    "leave the disturbance out of the plant, or use the chains computed from the model"
                )
            chain.append(tidy((sp.Matrix([below]).jacobian(states) * moving)[0]))
            if chain[-1].has(*extended.inputs):
                raise LinearizationError(
                    f"derivative {order} of output {i} contains an input of the true plant, so that its measurement "
                    "would close an algebraic loop through the law; use the chains computed from the model"
                )
        chains.append(tuple(chain))
    return tuple(chains)


def _error(linearization: Linearization, plant: AffineSystem) -> sp.Matrix:
    """What the true plant adds to x' of the extended system."""
    nominal, extended = linearization.system, linearization.extended_system
    if plant.states != nominal.states or plant.inputs != nominal.inputs:
        raise ModelError(
            f"the plant has states {plant.states} and inputs {plant.inputs}, the linearised one {nominal.states} and "
            f"{nominal.inputs}; give a plant with the same"
        )
    undisturbed = nominal.drift + nominal.input_matrix * sp.Matrix(nominal.inputs)
    error = (plant.dynamics - undisturbed).xreplace(dict(linearization.input_map))
    return error.col_join(sp.zeros(len(extended.states) - len(nominal.states), 1))


def _bound(
    total: sp.Expr,
    sources: Sequence[sp.Symbol],
    amplitudes: Mapping[sp.Symbol, sp.Expr | float],
    worst_angles: Sequence[sp.Symbol],
) -> sp.Expr:
    parts = []
    for source in sources:
        gain = tidy(sp.diff(total, source))
        if source in amplitudes and gain != 0:
            if gain.has(*sources):
                raise LinearizationError(
                    f"{source} enters with the gain {gain}, not linearly: there is no simple bound"
                )
            parts.append(_largest(gain, worst_angles) * sp.sympify(amplitudes[source]))
    return sp.Add(*parts)


def _largest(gain: sp.Expr, angles: Sequence[sp.Symbol]) -> sp.Expr:
    for angle in angles:
        if not gain.has(angle):
            continue
        sine, cosine = sp.Dummy(), sp.Dummy()
        replaced = sp.expand_trig(gain).xreplace({sp.sin(angle): sine, sp.cos(angle): cosine})
        polynomial = sp.Poly(replaced, sine, cosine) if not replaced.has(angle) else None
        if polynomial is None or polynomial.monoms() != [m for m in polynomial.monoms() if sum(m) == 1]:
            raise LinearizationError(f"{gain} is not of the form a sin({angle}) + b cos({angle}); leave {angle} out")
        a, b = (polynomial.coeff_monomial(one) for one in (sine, cosine))
        gain = b if a == 0 else a if b == 0 else sp.sqrt(tidy(a**2 + b**2))
    return sp.Abs(gain)
