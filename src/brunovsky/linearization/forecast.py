"""Forecast of singularities: the chains are linear, so where a closed loop goes is known before it is simulated."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from brunovsky.errors import LinearizationError, ModelError, ParameterError
from brunovsky.linearization.linearize import Linearization
from brunovsky.linearization.numeric import evaluate, numeric_function, point_of

Floats = NDArray[np.float64]
Reference = Callable[[float], Sequence[ArrayLike]]


@dataclass(frozen=True, eq=False)
class Forecast:
    """Chains, inputs and distance to the singular locus along a closed loop that is linear between v and the outputs.

    Parameters
    ----------
    times : ndarray, shape (N,)
        In s.
    chains : ndarray, shape (N, sum r_i)
        The chains one after the other, y_i, ..., y_i^(r_i - 1).
    distances : ndarray, shape (N,)
        Absolute value of the left side of `singular_locus`, in its unit.
    inputs : mapping of sympy.Symbol to ndarray, shape (N,)
        The inputs of the extended system; not finite on the locus.
    closest_time, closest_distance : float
        Where the distance is smallest, refined between the instants.
    """

    times: Floats
    chains: Floats
    distances: Floats
    inputs: Mapping[sp.Symbol, Floats]
    closest_time: float
    closest_distance: float

    @property
    def peaks(self) -> dict[sp.Symbol, float]:
        """Largest absolute value of each input at the instants; infinite where the law does not exist."""
        return {symbol: float(np.max(np.nan_to_num(np.abs(u), nan=np.inf))) for symbol, u in self.inputs.items()}


def chain_values(linearization: Linearization, point: Mapping[sp.Symbol | str, Any]) -> tuple[Floats, ...]:
    """Values of the chains y_i, ..., y_i^(r_i - 1) at a point.

    Parameters
    ----------
    linearization : Linearization
        Whose chains.
    point : mapping of sympy.Symbol or str to number
        States of the extended system and parameters, in their units.

    Returns
    -------
    tuple of ndarray, shapes (r_i,)
        One array per chain.

    Raises
    ------
    ParameterError
        If a value is missing.
    """
    values = point_of(linearization.extended_system, point)
    return tuple(evaluate(sp.Matrix(chain), values)[:, 0] for chain in linearization.chains)


def forecast(
    linearization: Linearization,
    gains: Sequence[ArrayLike],
    initial: Sequence[ArrayLike],
    reference: Reference,
    t_end: float,
    *,
    parameters: Mapping[sp.Symbol | str, Any] | None = None,
    samples: int = 2001,
) -> Forecast:
    """Say how near a linear outer loop will bring the plant to the singularity of its law.

    Under v_i = y_d^(r_i) - K_i e_i, with e_i the error of chain i, the chains are the reference plus the solution of a
    linear differential equation. The states follow from the inverse of the coordinate map, on the branch that it takes;
    the distance and the absolute values of the inputs of the plants that ship do not depend on the branch.

    Parameters
    ----------
    linearization : Linearization
        Of the plant.
    gains : sequence of array_like, shapes (r_i,)
        Per chain K_i = (k_1, ..., k_r), in 1/s^r, ..., 1/s.
    initial : sequence of array_like, shapes (r_i,)
        The chains at the time 0; `chain_values` gives them at a state.
    reference : callable
        From the time to a sequence of arrays of shapes (r_i + 1,): y_d, y_d', ..., y_d^(r_i) of each output.
    t_end : float
        How far to look, in s.
    parameters : mapping of sympy.Symbol or str to number, optional
        Values of the parameters.
    samples : int
        Instants at which to look first, N >= 3.

    Returns
    -------
    Forecast
        The smallest distance with its time, and what it was found from.

    Raises
    ------
    LinearizationError
        If the law has no singularity, or the locus is not a function of the chains in closed form.
    ModelError
        If shapes do not fit.
    ParameterError
        If a parameter has no value.
    """
    from scipy.linalg import block_diag, expm  # they take as long as all of this package
    from scipy.optimize import minimize_scalar

    sizes = linearization.relative_degree
    feedback = [np.asarray(one, dtype=float) for one in gains]
    start = [np.asarray(one, dtype=float) for one in initial]
    desired = [np.asarray(one, dtype=float) for one in reference(0.0)]
    for what, arrays, extra in (("gains", feedback, 0), ("initial", start, 0), ("reference", desired, 1)):
        shapes, needed = [one.shape for one in arrays], [(size + extra,) for size in sizes]
        if shapes != needed:
            raise ModelError(f"{what}: shapes {shapes} where {needed} are needed, one array per chain")
    if not t_end > 0 or samples < 3:
        raise ParameterError(f"t_end = {t_end} and samples = {samples}; give t_end > 0 and at least 3 samples")
    look = _observer(linearization, parameters or {})
    error_field = block_diag(*(_companion(one) for one in feedback))
    first_error = np.concatenate(start) - np.concatenate([one[:-1] for one in desired])

    def chains_and_inputs(time: float, error: Floats) -> tuple[Floats, Floats]:
        wanted = [np.asarray(one, dtype=float) for one in reference(time)]
        parts = np.split(error, np.cumsum(sizes)[:-1])
        outer = [one[-1] - k @ e for one, k, e in zip(wanted, feedback, parts, strict=True)]
        return np.concatenate([one[:-1] for one in wanted]) + error, np.array(outer)

    def distance(time: float) -> float:
        return float(look(*chains_and_inputs(time, expm(error_field * time) @ first_error))[0])

    times = np.linspace(0.0, t_end, samples)
    step = expm(error_field * times[1])
    error, rows, seen = first_error, [], []
    for time in times:
        chain, outer = chains_and_inputs(float(time), error)
        rows.append(chain)
        seen.append(look(chain, outer))
        error = step @ error
    found = np.array(seen)
    nearest = int(np.argmin(found[:, 0]))
    bounds = times[max(nearest - 1, 0)], times[min(nearest + 1, samples - 1)]
    refined = minimize_scalar(distance, bounds=bounds, method="bounded", options={"xatol": 1e-9 * t_end})
    closest = min((float(refined.fun), float(refined.x)), (float(found[nearest, 0]), float(times[nearest])))
    names = linearization.extended_system.inputs
    inputs = {symbol: found[:, 1 + i] for i, symbol in enumerate(names)}
    return Forecast(times, np.array(rows), found[:, 0], inputs, closest[1], closest[0])


def _companion(gains: Floats) -> Floats:
    field = np.diag(np.ones(len(gains) - 1), 1)
    field[-1] -= gains
    return field


def _observer(
    linearization: Linearization, parameters: Mapping[sp.Symbol | str, Any]
) -> Callable[[Floats, Floats], Floats]:
    """From chains and v to the distance to the locus and the inputs."""
    system, locus, normal_form = linearization.extended_system, linearization.singular_locus, linearization.normal_form
    if locus == sp.false:
        raise LinearizationError("the law exists wherever the model does: there is no singularity to come near to")
    if normal_form.inverse is None:
        raise LinearizationError(
            "the coordinate map has no inverse in closed form, so the chains do not give the locus"
        )
    values = point_of(system, parameters)
    needed = locus.lhs.free_symbols | sp.Matrix(list(linearization.law.values())).free_symbols
    missing = [one for one in system.parameters if one in needed and one not in values]
    if missing:
        raise ParameterError(f"parameters: no value for {', '.join(map(str, missing))}; give one")
    used = [state for state in system.states if state in needed]
    inverse = [normal_form.inverse[state].subs(values) for state in used]
    internal = [one for one in normal_form.complement if any(value.has(one) for value in inverse)]
    if internal:
        raise LinearizationError(
            f"the locus and the law depend on the internal dynamics ({', '.join(map(str, internal))}), which the "
            "chains do not determine; simulate the plant"
        )
    to_states = numeric_function([name for names in normal_form.chains for name in names], inverse)
    outputs = [sp.Abs(locus.lhs), *linearization.law.values()]
    at = numeric_function([*used, *linearization.outer_inputs], [one.subs(values) for one in outputs])

    def look(chains: Floats, outer: Floats) -> Floats:
        with np.errstate(all="ignore"):
            return np.array(at(*to_states(*chains), *outer), dtype=float)

    return look
