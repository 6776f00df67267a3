"""Zero dynamics: what is left to move while the outputs are kept constant."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from brunovsky.errors import LinearizationError
from brunovsky.linearization.affine import AffineSystem
from brunovsky.linearization.lie import lie_derivative
from brunovsky.linearization.normal_form import NormalForm
from brunovsky.linearization.numeric import evaluate, point_of
from brunovsky.linearization.simplify import tidy

_AT_REST = 1e-9
_CRITICAL = 1e-9
_NEWTON_STEPS = 50


@dataclass(frozen=True)
class ZeroDynamics:
    """The dynamics on the manifold where the outputs are constant, y_i = c_i, and their derivatives zero.

    The c_i are zero in the textbooks; a motor has no flux there, so they are left open. A chain keeps its constant
    under the linearising law with v = 0, which leaves the manifold invariant.

    Parameters
    ----------
    system : AffineSystem
        The extended system (n states).
    normal_form : NormalForm
        Its coordinates; the n - sum r_i of `complement` are the coordinates of the zero dynamics.
    constants : tuple of sympy.Symbol
        The constants c_i at which the outputs are kept, which are the first coordinates of the chains.
    field : sympy.ImmutableDenseMatrix, shape (n - sum r_i, 1), or None
        The right-hand sides eta' in eta, the c_i and parameters; None where the map has no inverse in closed form, or
        it is singular on the manifold.
    closed_loop : sympy.ImmutableDenseMatrix, shape (n, 1)
        The extended system under the law with v = 0, in its states.
    locus : sympy.Expr
        Where it vanishes the law does not exist, and with it the zero dynamics; 1 where there is no such place.

    References
    ----------
    C. I. Byrnes and A. Isidori, "Asymptotic stabilization of minimum phase nonlinear systems", *IEEE Trans. Autom.
    Control* 36 (1991) 1122-1137; A. Isidori, *Nonlinear Control Systems*, 3rd ed., 1995,
    sections 4.3 and 6.1, doi:10.1007/978-1-84628-615-5.
    """

    system: AffineSystem
    normal_form: NormalForm
    constants: tuple[sp.Symbol, ...]
    field: sp.ImmutableDenseMatrix | None
    closed_loop: sp.ImmutableDenseMatrix
    locus: sp.Expr

    @property
    def coordinates(self) -> dict[sp.Symbol, sp.Expr]:
        """The coordinates eta as functions of the states of the extended system."""
        return {eta: self.normal_form.map[eta] for eta in self.normal_form.complement}

    @property
    def input_free(self) -> bool:
        """Whether no input appears in the derivatives of the coordinates themselves, L_g eta = 0."""
        return self.normal_form.input_free

    def equilibrium(self, near: Mapping[sp.Symbol | str, Any]) -> dict[sp.Symbol, float]:
        """Find an equilibrium of the zero dynamics, with Newton's method.

        Parameters
        ----------
        near : mapping of sympy.Symbol or str to number
            Where to begin: values of all states of the extended system and of all parameters. The outputs keep the
            constants they have here.

        Returns
        -------
        dict of sympy.Symbol to float
            The states at the equilibrium, in their units.

        Raises
        ------
        LinearizationError
            If the method does not converge, or to a point where the law does not exist.
        ParameterError
            If a value is missing.
        """
        point = point_of(self.system, near)
        states = sp.Matrix(self.system.states)
        heads = [chain[0] for chain in self.normal_form.chains]
        functions = self.normal_form.map
        targets = {head: evaluate(sp.Matrix([functions[head]]), point)[0, 0] for head in heads}
        chains = [functions[one] - targets.get(one, 0.0) for chain in self.normal_form.chains for one in chain]
        rates = [lie_derivative(eta, self.closed_loop, self.system.states) for eta in self.coordinates.values()]
        residual = sp.Matrix([*chains, *rates])
        slope = residual.jacobian(states)
        for _ in range(_NEWTON_STEPS):
            values = evaluate(residual, point)
            if not np.all(np.isfinite(values)):
                break
            if np.max(np.abs(values)) < _AT_REST:
                self._check_regular(point)
                return {state: float(point[state]) for state in self.system.states}
            step, *_ = np.linalg.lstsq(evaluate(slope, point), values, rcond=None)
            point |= {s: sp.Float(float(point[s]) - d) for s, d in zip(states, step[:, 0], strict=True)}
        raise LinearizationError(f"no equilibrium of the zero dynamics was found near {_shown(near)}; begin elsewhere")

    def _check_regular(self, point: Mapping[sp.Symbol, Any]) -> None:
        symbols = sorted(self.locus.free_symbols, key=str)
        slopes = sp.Matrix([self.locus]).jacobian(symbols) if symbols else sp.zeros(1, 0)
        reach = sum(abs(evaluate(slopes, point)[0]) * [1 + abs(float(point[s])) for s in symbols]) if symbols else 0.0
        if not abs(evaluate(sp.Matrix([self.locus]), point)[0, 0]) > _AT_REST * reach:
            raise LinearizationError(
                f"at {_shown({s: float(point[s]) for s in symbols})} the law does not exist, as {self.locus} = 0 "
                "there, and neither do zero dynamics; choose a point off the singular locus"
            )

    def eigenvalues(self, point: Mapping[sp.Symbol | str, Any]) -> NDArray[np.complex128]:
        """Eigenvalues of the linearised zero dynamics at an equilibrium: the transmission zeros there.

        The closed loop is linearised in the states and restricted to the tangent space of the manifold, so no inverse
        of the coordinate map is needed and the answer does not depend on the choice of eta.

        Parameters
        ----------
        point : mapping of sympy.Symbol or str to number
            Values of the states of the extended system and of the parameters.

        Returns
        -------
        ndarray of complex, shape (n - sum r_i,)
            In 1/s, by real part, largest first.

        Raises
        ------
        LinearizationError
            If the point is no equilibrium of the zero dynamics, or the law does not exist there.
        ParameterError
            If a value is missing.
        """
        values = point_of(self.system, point)
        self._check_regular(values)
        states = sp.Matrix(self.system.states)
        moving = evaluate(self.closed_loop, values)[:, 0]
        for state, rate in zip(self.system.states, moving, strict=True):
            if not abs(rate) < _AT_REST * (1 + abs(float(values.get(state, 0)))):
                raise LinearizationError(
                    f"at {_shown(point)} the zero dynamics are not at rest: d{state}/dt = {rate:.6g}; eigenvalues say "
                    "something about stability at an equilibrium only: `equilibrium` finds one"
                )
        gradients = sp.Matrix([self.normal_form.map[one] for chain in self.normal_form.chains for one in chain])
        *_, right = np.linalg.svd(evaluate(gradients.jacobian(states), values))
        tangent = right[gradients.rows :].T
        found = np.linalg.eigvals(tangent.T @ evaluate(self.closed_loop.jacobian(states), values) @ tangent)
        return np.asarray(sorted(found, key=lambda value: (-value.real, value.imag)), dtype=complex)

    def is_minimum_phase(self, point: Mapping[sp.Symbol | str, Any]) -> bool:
        """Whether the zero dynamics are asymptotically stable in first approximation at an equilibrium.

        Parameters
        ----------
        point : mapping of sympy.Symbol or str to number
            As for `eigenvalues`, which also says what is raised.

        Returns
        -------
        bool
            False also where an eigenvalue lies on the imaginary axis, so that the first approximation decides nothing.
        """
        return bool(np.all(self.eigenvalues(point).real < -_CRITICAL))


def find_zero_dynamics(
    system: AffineSystem, normal_form: NormalForm, law: Mapping[sp.Symbol, sp.Expr], locus: sp.Expr
) -> ZeroDynamics:
    """Derive the zero dynamics of a system under its law with v = 0."""
    inputs = sp.Matrix([law[symbol] for symbol in system.inputs])
    closed_loop = (system.drift + system.input_matrix * inputs).applyfunc(tidy)
    return ZeroDynamics(
        system=system,
        normal_form=normal_form,
        constants=tuple(chain[0] for chain in normal_form.chains),
        field=_field(system, normal_form, closed_loop),
        closed_loop=sp.ImmutableDenseMatrix(closed_loop),
        locus=locus,
    )


def _field(system: AffineSystem, normal_form: NormalForm, closed_loop: sp.Matrix) -> sp.ImmutableDenseMatrix | None:
    if normal_form.inverse is None:
        return None
    still = {one: sp.S.Zero for chain in normal_form.chains for one in chain[1:]}
    states = {state: value.subs(still) for state, value in normal_form.inverse.items()}
    rates = [lie_derivative(normal_form.map[eta], closed_loop, system.states) for eta in normal_form.complement]
    field = sp.ImmutableDenseMatrix([tidy(tidy(rate).subs(states)) for rate in rates])
    return None if field.has(sp.nan, sp.zoo, sp.oo, -sp.oo) else field


def _shown(point: Mapping[sp.Symbol | str, Any]) -> str:
    return ", ".join(f"{name} = {value}" for name, value in point.items())
