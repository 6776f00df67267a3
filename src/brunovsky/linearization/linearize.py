"""The linearising law: u = G^-1 (v - F), after dynamic extension where it is needed."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import sympy as sp

from brunovsky._frozen import FrozenMapping
from brunovsky.errors import LinearizationError, ModelError
from brunovsky.linearization.affine import AffineSystem
from brunovsky.linearization.board import Explained, Line
from brunovsky.linearization.explain import derivation
from brunovsky.linearization.extension import Extension, extend
from brunovsky.linearization.naming import outer_inputs
from brunovsky.linearization.normal_form import NormalForm, find_normal_form
from brunovsky.linearization.numeric import point_of
from brunovsky.linearization.rank import generic_rank
from brunovsky.linearization.regular_start import RegularStart, regular_start
from brunovsky.linearization.simplify import factored, tidy, vanishes, vanishing_factors
from brunovsky.linearization.singularity import Measure, distance_to_singularity
from brunovsky.linearization.zero_dynamics import ZeroDynamics, find_zero_dynamics


@dataclass(frozen=True, repr=False)
class Linearization(Explained):
    """A plant, its dynamic extension and the law that turns it into chains of integrators y_i^(r_i) = v_i.

    With y^(r) = F(x) + G(x) u of the extended system, the law is u = G(x)^-1 (v - F(x)).

    Parameters
    ----------
    system : AffineSystem
        The plant as given (n states, m inputs, m outputs).
    extension : Extension
        The integrators in front of its inputs (`states`, `inputs`, `integrators`) and the rounds that led to them
        (`steps`).
    relative_degree : tuple of int, shape (m,)
        The lengths r_i of the chains.
    chains : tuple of tuples of sympy.Expr
        The coordinate map: per output y, y', ..., y^(r_i - 1) in the states of the extended system.
    drift_term : sympy.ImmutableDenseMatrix, shape (m, 1)
        The vector F, in the units of y_i / s^(r_i).
    decoupling_matrix : sympy.ImmutableDenseMatrix, shape (m, m)
        The matrix G; columns in the order of the extended system's inputs.
    determinant : sympy.Expr
        det G, simplified and factored.
    outer_inputs : tuple of sympy.Symbol, shape (m,)
        The symbols v.
    law : mapping of sympy.Symbol to sympy.Expr
        Every input of the extended system, in their order, as a quotient in lowest terms in the extended states and v.
    """

    system: AffineSystem
    extension: Extension
    relative_degree: tuple[int, ...]
    chains: tuple[tuple[sp.Expr, ...], ...]
    drift_term: sp.ImmutableDenseMatrix
    decoupling_matrix: sp.ImmutableDenseMatrix
    determinant: sp.Expr
    outer_inputs: tuple[sp.Symbol, ...]
    law: Mapping[sp.Symbol, sp.Expr]

    @property
    def extended_system(self) -> AffineSystem:
        """The plant with the integrators in front of its inputs; the plant itself where there are none."""
        return self.extension.system

    @property
    def is_full(self) -> bool:
        """Whether the total relative degree is the number of states of the extended system.

        Where it is not, the law leaves internal dynamics unobservable from the outputs.
        """
        return sum(self.relative_degree) == len(self.extended_system.states)

    @property
    def input_map(self) -> FrozenMapping[sp.Symbol, sp.Expr]:
        """Every input of the plant in the states and inputs of the extended system."""
        return self.extension.input_map

    @property
    def singular_locus(self) -> Any:
        """Where the law does not exist, as Eq(product of the factors of its determinants that may vanish, 0), or false.

        The determinants are that of G and those of the transformations of the inputs.
        """
        determinants = (self.determinant, *(one.determinant for one in self.extension.transformations))
        found = dict.fromkeys(factor for one in determinants for factor in vanishing_factors(one))
        return sp.Eq(sp.Mul(*found), 0) if found else sp.false

    @cached_property
    def normal_form(self) -> NormalForm:
        """The chains as coordinates, with a complement where they are not all, and the inverse where it is found."""
        return find_normal_form(self.extended_system, self.chains)

    @cached_property
    def zero_dynamics(self) -> ZeroDynamics | None:
        """What moves while the outputs are constant; None where the linearisation is full."""
        if self.is_full:
            return None
        law = {symbol: part.subs(dict.fromkeys(self.outer_inputs, 0)) for symbol, part in self.law.items()}
        locus = sp.S.One if self.singular_locus == sp.false else self.singular_locus.lhs
        return find_zero_dynamics(self.extended_system, self.normal_form, law, locus)

    def is_minimum_phase(self, point: Mapping[sp.Symbol | str, Any]) -> bool:
        """Whether the zero dynamics are stable in first approximation at an equilibrium; true where there are none.

        Parameters
        ----------
        point : mapping of sympy.Symbol or str to number
            Values of the states of the extended system and of the parameters, in their units.

        Returns
        -------
        bool
            False also where an eigenvalue lies on the imaginary axis.

        Raises
        ------
        LinearizationError
            If the point is no equilibrium of the zero dynamics.
        """
        return self.zero_dynamics is None or self.zero_dynamics.is_minimum_phase(point)

    def distance_to_singularity(self, point: Mapping[sp.Symbol | str, Any], measure: Measure = "locus") -> float:
        """How far a point is from the singular locus; see `distance_to_singularity` of this package."""
        return distance_to_singularity(self, point, measure)

    def regular_start(self, point: Mapping[sp.Symbol | str, Any]) -> RegularStart:
        """What a trajectory needs to pass a singular point smoothly; see `regular_start` of this package."""
        return regular_start(self, point)

    def __repr__(self) -> str:
        full = "full" if self.is_full else "not full"
        return f"<Linearization: relative degree {self.relative_degree}, det G = {self.determinant}, {full}>"

    def lines(self) -> Iterable[Line]:
        """Yield the lines that `explain`, `latex` and notebooks show."""
        return derivation(self)


def linearize(
    system: AffineSystem,
    *,
    operating_point: Mapping[sp.Symbol | str, Any] | None = None,
    max_extensions: int = 8,
) -> Linearization:
    """Derive the input-output linearising feedback of a plant, with dynamic extension where static is not enough.

    Parameters
    ----------
    system : AffineSystem
        The plant. Its disturbances are taken as zero; uncertain parameters should be
        set to their nominal values first (`AffineSystem.with_parameters`).
    operating_point : mapping of sympy.Symbol or str to number, optional
        Values of states of the extended system and of parameters, in their units. If given, the law must exist
        there; states that are left out are taken as generic.
    max_extensions : int
        The most rounds of dynamic extension to try.

    Returns
    -------
    Linearization
        Law, chains and derivation.

    Raises
    ------
    LinearizationError
        If an output has no finite relative degree, the decoupling matrix stays singular, or
        it is singular at the operating point. The message says why and after which step.
    ParameterError
        If the operating point names something else than a state or parameter, or a value is not finite.
    ModelError
        If `system` is not an AffineSystem, `max_extensions` no number 0, 1, 2, …, or the operating point no mapping.

    References
    ----------
    A. Isidori, *Nonlinear Control Systems*, 3rd ed., 1995, sections 5.2 to 5.4, doi:10.1007/978-1-84628-615-5.

    Examples
    --------
    >>> import sympy as sp
    >>> angle, rate, torque = sp.symbols("angle rate torque", real=True)
    >>> pendulum = AffineSystem((angle, rate), (torque,), [rate, -sp.sin(angle)], [0, 1], (angle,))
    >>> linearize(pendulum).law
    {torque: v1 + sin(angle)}
    """
    _check_arguments(system, max_extensions, operating_point)
    names = {str(key): value for key, value in (operating_point or {}).items()}
    extension = extend(system, max_extensions, names)
    extended, derivatives = extension.system, extension.derivatives
    gains, drift_term = derivatives.decoupling_matrix, derivatives.drift_term
    determinant = factored(gains.det(method="berkowitz"))
    taken = {str(s) for s in (*extended.states, *extended.inputs, *extended.parameters, *extended.disturbances)}
    outer = outer_inputs(extended.inputs, len(extended.outputs), taken)
    numerators = gains.adjugate() * (sp.Matrix(outer) - drift_term)
    law = {symbol: tidy(part / determinant) for symbol, part in zip(extended.inputs, numerators, strict=True)}
    result = Linearization(
        system=system,
        extension=extension,
        relative_degree=derivatives.relative_degree,
        chains=derivatives.chains,
        drift_term=drift_term,
        decoupling_matrix=gains,
        determinant=determinant,
        outer_inputs=outer,
        law=FrozenMapping(law),
    )
    if operating_point is not None:
        _check_operating_point(result, operating_point)
    return result


def _check_arguments(system: AffineSystem, max_extensions: int, operating_point: Any) -> None:
    if not isinstance(system, AffineSystem):
        raise ModelError(f"{system!r} is not an AffineSystem; make one of states, inputs, drift, input_matrix, outputs")
    if operating_point is not None and not isinstance(operating_point, Mapping):
        raise ModelError(f"operating_point is {operating_point!r}; give a mapping of states and parameters to values")
    if not isinstance(max_extensions, int) or max_extensions < 0:
        raise ModelError(f"max_extensions is {max_extensions!r}; give 0, 1, 2, …")


def _check_operating_point(linearization: Linearization, operating_point: Mapping[sp.Symbol | str, Any]) -> None:
    point = point_of(linearization.extended_system, operating_point)
    place = f"at the operating point ({', '.join(f'{symbol} = {value}' for symbol, value in point.items())})"
    transformations = linearization.extension.transformations
    for determinant in (one.determinant for one in transformations):
        if vanishes(determinant, point):
            raise LinearizationError(
                f"{place}: the transformation of the inputs is singular there, its determinant {determinant} vanishes; "
                f"move the operating point off {linearization.singular_locus.lhs} = 0"
            )
    gains = linearization.decoupling_matrix
    for expression in (linearization.determinant, *linearization.drift_term, *gains):
        if expression.subs(point).has(sp.nan, sp.zoo, sp.oo, -sp.oo):
            raise LinearizationError(f"{place}: {expression} is not finite there; move it")
        if expression.subs(point).is_real is False:
            raise LinearizationError(f"{place}: {expression} is not real there; move it")
    if vanishes(linearization.determinant, point):
        there = gains.applyfunc(lambda entry: sp.S.Zero if vanishes(entry, point) else entry.subs(point))
        rank = min(generic_rank(there), gains.rows - 1)
        raise LinearizationError(
            f"{place}: the decoupling matrix is singular there, its determinant {linearization.determinant} vanishes "
            f"and its rank is {rank} instead of {gains.rows} as almost everywhere. So the relative degree "
            f"{linearization.relative_degree} is not well defined at that point and the law does not exist; "
            f"move the operating point off {linearization.singular_locus.lhs} = 0"
        )
