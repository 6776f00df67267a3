"""The affine system x' = f(x) + G(x) u + sum_k d_k p_k(x), y = h(x)."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import sympy as sp

from brunovsky._frozen import FrozenMapping
from brunovsky.errors import ModelError
from brunovsky.linearization.validation import (
    as_expressions,
    as_matrix,
    as_symbols,
    check_distinct,
    check_expression,
    resolve,
)


@dataclass(frozen=True)
class AffineSystem:
    """A smooth plant, affine in its inputs and disturbances: x' = f(x) + G(x) u + sum_k d_k p_k(x), y = h(x).

    Units are the caller's (SI throughout this package). Sequences and matrices of any SymPy or NumPy kind are
    accepted and normalised; floating-point numbers become the rationals they print as (9.81 is 981/100), so that
    zero and rank tests are exact.

    Parameters
    ----------
    states : tuple of sympy.Symbol, shape (n,)
        The state x.
    inputs : tuple of sympy.Symbol, shape (m,)
        The input u.
    drift : sympy.ImmutableDenseMatrix, shape (n, 1)
        The drift f(x).
    input_matrix : sympy.ImmutableDenseMatrix, shape (n, m)
        The input vector fields, the columns of G(x).
    outputs : tuple of sympy.Expr, shape (m,)
        The outputs h(x), as many as inputs.
    parameters : tuple of sympy.Symbol
        Constants that may occur in all of these.
    disturbances : mapping of sympy.Symbol to sympy.ImmutableDenseMatrix, shape (n, 1)
        The disturbances d_k with their vector fields p_k(x). A linearising law takes them as zero.

    Raises
    ------
    ModelError
        If shapes do not fit, there are not as many outputs as inputs, a name stands twice, or an expression contains an
        unknown symbol, an input, a disturbance, or something that is not smooth, finite and explicit. The message names
        the term and the place.

    References
    ----------
    A. Isidori, *Nonlinear Control Systems*, 3rd ed., 1995, section 5.1, doi:10.1007/978-1-84628-615-5.

    Examples
    --------
    >>> import sympy as sp
    >>> angle, rate, torque = sp.symbols("angle rate torque", real=True)
    >>> pendulum = AffineSystem((angle, rate), (torque,), [rate, -sp.sin(angle)], [0, 1], (angle,))
    >>> pendulum.dynamics
    Matrix([
    [               rate],
    [torque - sin(angle)]])
    """

    states: tuple[sp.Symbol, ...]
    inputs: tuple[sp.Symbol, ...]
    drift: sp.ImmutableDenseMatrix
    input_matrix: sp.ImmutableDenseMatrix
    outputs: tuple[sp.Expr, ...]
    parameters: tuple[sp.Symbol, ...] = ()
    disturbances: Mapping[sp.Symbol, sp.ImmutableDenseMatrix] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Normalise the types, then check everything."""
        for name in ("states", "inputs", "parameters"):
            self._set(name, as_symbols(getattr(self, name), name))
        n, m = len(self.states), len(self.inputs)
        self._set("outputs", as_expressions(self.outputs, "outputs"))
        for name in ("states", "inputs", "outputs"):
            if not getattr(self, name):
                raise ModelError(f"{name}: there are none; a system has at least one state, one input and one output")
        if len(self.outputs) != m:
            raise ModelError(
                f"outputs: {len(self.outputs)} output(s) ({', '.join(map(str, self.outputs))}) for {m} input(s); the "
                "law inverts a square matrix, so choose as many outputs as inputs"
            )
        per_state = f"one expression per state ({n})"
        self._set("drift", as_matrix(self.drift, (n, 1), "drift", per_state))
        columns = f"a row per state ({n}) and a column per input ({m})"
        self._set("input_matrix", as_matrix(self.input_matrix, (n, m), "input_matrix", columns))
        if not isinstance(self.disturbances, Mapping):
            raise ModelError("disturbances: not a mapping; give {symbol: vector field}")
        as_symbols(self.disturbances, "disturbances")
        fields = {
            symbol: as_matrix(entries, (n, 1), f"disturbances[{symbol}]", per_state)
            for symbol, entries in self.disturbances.items()
        }
        self._set("disturbances", FrozenMapping(fields))
        self._check_symbols()

    def _set(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)

    def _check_symbols(self) -> None:
        roles = ("states", "inputs", "parameters", "disturbances")
        check_distinct([(role, tuple(getattr(self, role))) for role in roles])
        for where, expression in self._expressions():
            check_expression(expression, where, self.states + self.parameters, self.inputs, self.disturbances)

    def _expressions(self) -> Iterator[tuple[str, sp.Expr]]:
        """Every expression, with the place it stands at."""
        for i, state in enumerate(self.states):
            yield f"drift, row of {state}", self.drift[i]
            for j, symbol in enumerate(self.inputs):
                yield f"input_matrix, row of {state}, column of {symbol}", self.input_matrix[i, j]
            for symbol, entries in self.disturbances.items():
                yield f"disturbances[{symbol}], row of {state}", entries[i]
        for i, output in enumerate(self.outputs, start=1):
            yield f"output {i}", output

    @property
    def dynamics(self) -> sp.ImmutableDenseMatrix:
        """The whole right-hand side f + G u + sum_k d_k p_k, shape (n, 1), in the units of the states per second."""
        result = self.drift + self.input_matrix * sp.Matrix(self.inputs)
        for symbol, entries in self.disturbances.items():
            result += symbol * entries
        return sp.ImmutableDenseMatrix(result)

    def with_parameters(self, values: Mapping[sp.Symbol | str, Any]) -> "AffineSystem":
        """Replace some parameters by values, as for the nominal plant.

        Parameters
        ----------
        values : mapping of sympy.Symbol or str to number or sympy.Expr
            Parameters, by symbol or by name, with their values; expressions in the parameters that remain are
            allowed.

        Returns
        -------
        AffineSystem
            The system without those parameters.

        Raises
        ------
        ParameterError
            If a key is no parameter of the system or a value is not finite.
        ModelError
            If a value contains an unknown symbol.
        """
        replacements = resolve(values, self.parameters, "parameter")

        def insert(expressions: Any) -> Any:
            return expressions.subs(replacements, simultaneous=True)

        return replace(
            self,
            drift=insert(self.drift),
            input_matrix=insert(self.input_matrix),
            outputs=tuple(insert(output) for output in self.outputs),
            parameters=tuple(symbol for symbol in self.parameters if symbol not in replacements),
            disturbances={symbol: insert(entries) for symbol, entries in self.disturbances.items()},
        )
