"""How strongly the plant's own inputs answer the outer loop: du/dv of a linearising law, G^-1 with its norms.

For the robot u2 = (...) / eta1: effort, noise and the chatter of a relay at v arrive at u2 multiplied by 1/abs(eta1).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import control
import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from brunovsky.analysis._checks import finite_vector
from brunovsky.analysis._drawing import control_plot, line_style, new_axes
from brunovsky.errors import ParameterError
from brunovsky.linearization import Linearization
from brunovsky.linearization.numeric import evaluate, point_of
from brunovsky.linearization.simplify import tidy


@dataclass(frozen=True, eq=False)
class InputSensitivity:
    """Sensitivity of the inputs to the outer loop at one point; see `input_sensitivity`.

    Attributes
    ----------
    inputs : tuple of str, shape (m,)
        The inputs of the extended system, in the order of the rows; one behind an integrator is that integrator's rate.
    outer_inputs : tuple of str, shape (m,)
        The outer inputs v, in the order of the columns.
    matrix : ndarray, shape (m, m)
        du/dv, in the unit of u_j per unit of v_i.
    norms : ndarray, shape (m,)
        Euclidean norm of each row: the largest abs(du_j) for a change of v of length 1 in any direction.
    largest : float
        Largest singular value of the matrix.
    condition : float
        Ratio of the largest to the smallest singular value.
    """

    inputs: tuple[str, ...]
    outer_inputs: tuple[str, ...]
    matrix: NDArray[np.float64]
    norms: NDArray[np.float64]
    largest: float
    condition: float

    def worst_case(self, amplitudes: ArrayLike) -> NDArray[np.float64]:
        """Largest abs(du_j) for abs(dv_i) <= amplitudes[i], each axis by itself: chatter for P_i/abs(c_n) of a relay.

        Parameters
        ----------
        amplitudes : array_like, shape (m,)
            Non-negative, in the units of v.

        Returns
        -------
        ndarray, shape (m,)
            In the units of the inputs; between `norms` and sqrt(m) times that for equal amplitudes of 1.

        Raises
        ------
        ParameterError
            If there is not one finite, non-negative number for each outer input.
        """
        sizes = finite_vector(amplitudes, "amplitudes", "InputSensitivity.worst_case")
        if sizes.size != len(self.outer_inputs) or np.any(sizes < 0.0):
            raise ParameterError(
                f"InputSensitivity.worst_case: amplitudes = {sizes.tolist()}; pass {len(self.outer_inputs)} numbers >= "
                f"0, one for each of {', '.join(self.outer_inputs)}"
            )
        return np.asarray(np.abs(self.matrix) @ sizes)


def input_gain(linearization: Linearization) -> sp.ImmutableDenseMatrix:
    """Derivative du/dv of a linearising law, which is the inverse of its decoupling matrix, in SymPy.

    Parameters
    ----------
    linearization : Linearization
        Of any plant.

    Returns
    -------
    sympy.ImmutableDenseMatrix, shape (m, m)
        Rows: inputs of the extended system; columns: outer inputs v. For the robot the row of u2 has the norm
        1/abs(eta1).

    Raises
    ------
    ParameterError
        If `linearization` is none.

    References
    ----------
    The paper's eq. (16), u = G^-1 (v - F), corrected; A. Isidori, *Nonlinear Control Systems*, 3rd ed., 1995, section
    5.3, doi:10.1007/978-1-84628-615-5.
    """
    if not isinstance(linearization, Linearization):
        raise ParameterError(
            f"input_gain: {linearization!r} is no Linearization; pass what brunovsky.linearize returns"
        )
    law = sp.Matrix(list(linearization.law.values()))
    return sp.ImmutableDenseMatrix(law.jacobian(sp.Matrix(linearization.outer_inputs)).applyfunc(tidy))


def input_sensitivity(linearization: Linearization, point: Mapping[sp.Symbol | str, Any]) -> InputSensitivity:
    """Matrix du/dv of a linearising law at a point, with its norms.

    Parameters
    ----------
    linearization : Linearization
        Of any plant, such as `brunovsky.blocks.robot_linearization`.
    point : mapping of sympy.Symbol or str to number
        Values of the states of the extended system and of the parameters that it depends on, in their units.

    Returns
    -------
    InputSensitivity
        Matrix, norms and condition.

    Raises
    ------
    ParameterError
        If a value is missing, unknown or not finite, or the law is singular at the point.

    References
    ----------
    The paper's eq. (16), corrected; see `input_gain`.
    """
    return _at(linearization, input_gain(linearization), point)


def input_sensitivity_plot(
    linearization: Linearization,
    state: sp.Symbol | str,
    values: ArrayLike,
    point: Mapping[sp.Symbol | str, Any],
    *,
    ax: Any = None,
) -> control.ControlPlot:
    """Draw the norms of du/dv over one state, on logarithmic axes: straight lines of slope -1 are 1/state.

    Parameters
    ----------
    linearization : Linearization
        Of any plant.
    state : sympy.Symbol or str
        The state or parameter along which to draw.
    values : array_like, shape (N,)
        Its values, N >= 2, positive and ascending.
    point : mapping of sympy.Symbol or str to number
        Values of the others.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure if left out.

    Returns
    -------
    control.ControlPlot
        Lines, axes and figure, as python-control's own plots return them.

    Raises
    ------
    ParameterError
        As `input_sensitivity`, or if the values are not positive and ascending.
    """
    where = "input_sensitivity_plot"
    along = finite_vector(values, "values", where, minimum_size=2)
    if along[0] <= 0.0 or np.any(np.diff(along) <= 0.0):
        raise ParameterError(f"{where}: the values of {state} must be positive and ascending, for a logarithmic axis")
    others = {name: value for name, value in point.items() if str(name) != str(state)}
    gain = input_gain(linearization)
    found = [_at(linearization, gain, {**others, state: float(one)}) for one in along]
    grid = new_axes(ax)
    axes = grid[0, 0]
    names = zip(found[0].inputs, np.array([one.norms for one in found]).T, strict=True)
    lines = [
        axes.loglog(along, norms, label=f"d {name} / dv", **line_style(k))[0] for k, (name, norms) in enumerate(names)
    ]
    axes.set(xlabel=f"{state} (SI unit)", ylabel="norm of du/dv (SI units)", title="sensitivity of the inputs to v")
    axes.grid(True, which="both", color="0.85")
    axes.legend()
    return control_plot(grid, [lines])


def _at(
    linearization: Linearization, gain: sp.ImmutableDenseMatrix, point: Mapping[sp.Symbol | str, Any]
) -> InputSensitivity:
    where = point_of(linearization.extended_system, point)
    try:
        matrix = evaluate(sp.Matrix(gain), where)
    except ZeroDivisionError:
        matrix = np.full(gain.shape, np.inf)
    if not np.all(np.isfinite(matrix)):
        shown = ", ".join(f"{name} = {value}" for name, value in point.items())
        raise ParameterError(
            f"input_sensitivity: at {shown} the law is singular ({linearization.singular_locus}), so du/dv is not "
            "finite; move the point off that"
        )
    singular_values = np.linalg.svd(matrix, compute_uv=False)
    return InputSensitivity(
        tuple(str(one) for one in linearization.law),
        tuple(str(one) for one in linearization.outer_inputs),
        matrix,
        np.linalg.norm(matrix, axis=1),
        float(singular_values[0]),
        float(singular_values[0] / singular_values[-1]),
    )
