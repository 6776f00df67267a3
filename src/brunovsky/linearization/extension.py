"""Dynamic extension: integrators on inputs that appear too early, until the decoupling matrix is regular.

`choose_inputs` is the rule, the rest does not know it. Why the rounds end: with n states and relative degrees r_i the
y_i^(k), k < r_i, are sum(r_i) functions of the state. Each round appends as many states as the dependent rows of the
decoupling matrix have rank and adds at least one to each of their outputs' degrees, so n - sum(r_i) falls. Once it is
negative, or the functions' differentials are dependent, the outputs satisfy a differential equation whatever the
inputs are: the system is not right-invertible and no extension helps.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from brunovsky._frozen import FrozenMapping
from brunovsky.errors import LinearizationError, ModelError
from brunovsky.linearization.affine import AffineSystem
from brunovsky.linearization.input_transformation import InputTransformation, find_transformation
from brunovsky.linearization.naming import integrator_input
from brunovsky.linearization.rank import confirms_rank, generic_rank
from brunovsky.linearization.relative_degree import OutputDerivatives, differentiate_outputs
from brunovsky.linearization.simplify import tidy


@dataclass(frozen=True)
class ExtensionStep:
    """One round of dynamic extension: what was singular and which inputs were delayed.

    Parameters
    ----------
    system : AffineSystem
        The system before the round.
    derivatives : OutputDerivatives
        Its relative degree, F and singular G.
    rank : int
        The generic rank of G.
    is_confirmed : bool
        Whether symbolic elimination confirms that rank, which random points gave.
    outputs : tuple of int
        The outputs (counted from 0) whose rows of G depend on each other.
    delayed : tuple of sympy.Symbol
        The inputs that become states.
    inputs : tuple of sympy.Symbol
        Their derivatives, the new inputs, in the same order.
    transformation : InputTransformation, optional
        The transformation of the inputs that went before, so that `delayed` are its new inputs.
    """

    system: AffineSystem
    derivatives: OutputDerivatives
    rank: int
    is_confirmed: bool
    outputs: tuple[int, ...]
    delayed: tuple[sp.Symbol, ...]
    inputs: tuple[sp.Symbol, ...]
    transformation: InputTransformation | None = None


@dataclass(frozen=True)
class Extension:
    """A system with the integrators that make its decoupling matrix regular, and how they were found.

    Parameters
    ----------
    original : AffineSystem
        The system before the extension.
    steps : tuple of ExtensionStep
        The rounds; none where static feedback is enough.
    system : AffineSystem
        The system with the integrators: states (old states, delayed inputs), inputs (remaining inputs, new inputs).
    derivatives : OutputDerivatives
        Its relative degree, F and regular G.
    """

    original: AffineSystem
    steps: tuple[ExtensionStep, ...]
    system: AffineSystem
    derivatives: OutputDerivatives

    @property
    def states(self) -> tuple[sp.Symbol, ...]:
        """The new states, which are the delayed inputs, in the order in which they were appended."""
        return self.system.states[len(self.original.states) :]

    @property
    def inputs(self) -> tuple[sp.Symbol, ...]:
        """The inputs of the extended system that the original system does not have."""
        return tuple(symbol for symbol in self.system.inputs if symbol not in self.original.inputs)

    @property
    def integrators(self) -> FrozenMapping[sp.Symbol, int]:
        """Number of integrators in front of each input, original or new by a transformation, that has any."""
        origin: dict[sp.Symbol, sp.Symbol] = {}
        count: Counter[sp.Symbol] = Counter()
        for step in self.steps:
            for old, new in zip(step.delayed, step.inputs, strict=True):
                origin[new] = origin.get(old, old)
                count[origin[new]] += 1
        return FrozenMapping(count)

    @property
    def transformations(self) -> tuple[InputTransformation, ...]:
        """The transformations of the inputs, in order; none where inputs themselves could be delayed."""
        return tuple(step.transformation for step in self.steps if step.transformation)

    @property
    def input_map(self) -> FrozenMapping[sp.Symbol, sp.Expr]:
        """Every input of the original system in the states and inputs of the extended one.

        An input that was delayed is a state; one that a transformation replaced is an expression.
        """
        inputs: dict[sp.Symbol, sp.Expr] = {symbol: symbol for symbol in self.original.inputs}
        for transformation in self.transformations:
            inputs = {symbol: tidy(u.xreplace(dict(transformation.replaced))) for symbol, u in inputs.items()}
        return FrozenMapping(inputs)


def add_integrators(system: AffineSystem, inputs: Sequence[sp.Symbol]) -> AffineSystem:
    """Put one integrator in front of each given input: the input becomes a state, its derivative an input.

    Parameters
    ----------
    system : AffineSystem
        The system (n states, m inputs).
    inputs : sequence of sympy.Symbol
        The k inputs to delay.

    Returns
    -------
    AffineSystem
        States (old states, delayed inputs), shape (n + k,); inputs (remaining inputs, new inputs), shape (m,). The
        new input of u1 is w1, unless that name is taken.

    Raises
    ------
    ModelError
        If a symbol is not an input of the system.
    """
    delayed = tuple(inputs)
    for symbol in delayed:
        if symbol not in system.inputs:
            raise ModelError(f"{symbol} is not an input; an integrator can go to {', '.join(map(str, system.inputs))}")
    n, k = len(system.states), len(delayed)
    kept = [symbol for symbol in system.inputs if symbol not in delayed]
    taken = {symbol.name for symbol in (*system.states, *system.inputs, *system.parameters, *system.disturbances)}
    new: list[sp.Symbol] = []
    for symbol in delayed:
        new.append(integrator_input(symbol, taken | {other.name for other in new}))

    def columns(symbols: Sequence[sp.Symbol]) -> sp.Matrix:
        return system.input_matrix.extract(list(range(n)), [system.inputs.index(symbol) for symbol in symbols])

    zeros = sp.zeros(k, 1)
    return replace(
        system,
        states=system.states + delayed,
        inputs=(*kept, *new),
        drift=(system.drift + columns(delayed) * sp.Matrix(delayed)).col_join(zeros),
        input_matrix=sp.diag(columns(kept), sp.eye(k)),
        disturbances={symbol: entries.col_join(zeros) for symbol, entries in system.disturbances.items()},
    )


def dependent_rows(matrix: sp.Matrix) -> tuple[int, ...]:
    """Rows that stand in a linear relation with others: those whose removal leaves the generic rank as it is."""
    rank = generic_rank(matrix)

    def without(row: int) -> sp.Matrix:
        return matrix.extract([i for i in range(matrix.rows) if i != row], list(range(matrix.cols)))

    return tuple(row for row in range(matrix.rows) if matrix.rows > 1 and generic_rank(without(row)) == rank)


def choose_inputs(
    system: AffineSystem, derivatives: OutputDerivatives, operating_point: Mapping[str, Any]
) -> tuple[tuple[int, ...], tuple[sp.Symbol, ...], InputTransformation | None]:
    """Say which outputs are in conflict and which inputs to delay, if need be after a transformation.

    The rows of G that depend on each other show all there is of some outputs' dependence on the inputs: as many
    independent combinations of inputs as these rows have rank. Those combinations appear too early and get an
    integrator each, so that the dependent outputs can be differentiated further, until another input appears. Where
    the rows contain just as many inputs as they have rank, the combinations are these inputs.

    Parameters
    ----------
    system : AffineSystem
        The system.
    derivatives : OutputDerivatives
        Its relative degree and singular decoupling matrix.
    operating_point : mapping of str to number
        Where a transformation of the inputs must be regular if it can.

    Returns
    -------
    outputs : tuple of int
        The outputs, counted from 0, whose rows are dependent.
    inputs : tuple of sympy.Symbol
        The inputs to delay, of the system or of the transformation.
    transformation : InputTransformation or None
        Of the inputs, where the rows contain more inputs than they have rank.

    Raises
    ------
    LinearizationError
        If the system is not right-invertible.

    References
    ----------
    A. Isidori, *Nonlinear Control Systems*, 3rd ed., 1995, section 5.4, doi:10.1007/978-1-84628-615-5;
    J. Descusse and C. H. Moog, "Decoupling with dynamic compensation for strong invertible affine non-linear
    systems", *Int. J. Control* 42 (1985) 1387-1398.
    """
    gains = derivatives.decoupling_matrix
    outputs = dependent_rows(gains)
    rows = gains.extract(list(outputs), list(range(gains.cols)))
    rank = generic_rank(rows)
    _check_invertible(system, derivatives, outputs, rank)
    inputs = tuple(symbol for j, symbol in enumerate(system.inputs) if any(entry != 0 for entry in rows.col(j)))
    if len(inputs) == rank:
        return outputs, inputs, None
    delayed, transformation = find_transformation(system, rows, operating_point)
    return outputs, delayed, transformation


def _check_invertible(
    system: AffineSystem, derivatives: OutputDerivatives, outputs: tuple[int, ...], rank: int
) -> None:
    """Refuse outputs between which a differential equation holds whatever the inputs (see the top of this file)."""
    total = sum(derivatives.relative_degree)
    spare = len(system.states) - total - (len(outputs) - rank)
    functions = sp.Matrix([function for chain in derivatives.chains for function in chain])
    if spare < 0 or generic_rank(functions.jacobian(sp.Matrix(system.states))) < total:
        raise LinearizationError(
            f"the system is not right-invertible: its rank is less than its number of outputs ({len(system.outputs)}), "
            f"that is, the outputs {_numbers(outputs)} satisfy a differential equation whatever the inputs are, and no "
            "dynamic extension makes the decoupling matrix regular; choose other outputs"
        )


def extend(system: AffineSystem, max_extensions: int, operating_point: Mapping[str, Any] | None = None) -> Extension:
    """Add integrators round by round until the decoupling matrix is generically nonsingular.

    Parameters
    ----------
    system : AffineSystem
        A system with as many outputs as inputs.
    max_extensions : int
        The most rounds to try.
    operating_point : mapping of str to number, optional
        Values of states and parameters by name, where transformations of inputs should be regular.

    Returns
    -------
    Extension
        The extended system, its derivatives and the rounds.

    Raises
    ------
    LinearizationError
        If an output has no finite relative degree, the system is not right-invertible, or the matrix is still
        singular after the last round; the message says at which round.
    """
    original = system
    steps: list[ExtensionStep] = []
    while True:
        try:
            derivatives = differentiate_outputs(system)
            rank = generic_rank(derivatives.decoupling_matrix)
            if rank == len(system.outputs):
                return Extension(original, tuple(steps), system, derivatives)
            outputs, delayed, transformation = choose_inputs(system, derivatives, operating_point or {})
            if len(steps) == max_extensions:
                rounds = len(system.states) - sum(derivatives.relative_degree)
                raise LinearizationError(
                    f"the decoupling matrix is still singular (rank {rank} of {len(system.outputs)}); raise "
                    f"max_extensions: at most {rounds} more can be needed"
                )
        except LinearizationError as error:
            raise LinearizationError(f"{_place(steps)}: {error}") from None
        extended = add_integrators(transformation.apply(system) if transformation else system, delayed)
        inputs = extended.inputs[len(system.inputs) - len(delayed) :]
        confirmed = confirms_rank(derivatives.decoupling_matrix, rank)
        steps.append(ExtensionStep(system, derivatives, rank, confirmed, outputs, delayed, inputs, transformation))
        system = extended


def _numbers(outputs: Sequence[int]) -> str:
    return ", ".join(str(index + 1) for index in outputs)


def _place(steps: Sequence[ExtensionStep]) -> str:
    if not steps:
        return "before any dynamic extension"
    delayed = "; ".join(", ".join(map(str, step.delayed)) for step in steps)
    return f"after {len(steps)} extension(s) (integrators on {delayed})"
