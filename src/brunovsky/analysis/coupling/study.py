"""The coupling error over communication steps: coupled components against the same diagram as one system."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from brunovsky.analysis._drawing import control_plot, line_style, new_axes
from brunovsky.analysis.coupling.scheme import ORDERS, SCHEMES, Scheme
from brunovsky.analysis.coupling.simulated import coupled_simulation
from brunovsky.blocks import Diagram
from brunovsky.errors import ParameterError, SimulationError
from brunovsky.native import simulate

if TYPE_CHECKING:
    import xarray as xr

REFERENCE_TOLERANCE = 1e-11
_NAMES = {"jacobi": "Jacobi", "gauss_seidel": "Gauss-Seidel"}


@dataclass(frozen=True)
class CouplingError:
    """Coupling error of one run.

    Parameters
    ----------
    scheme : {"jacobi", "gauss_seidel"}
        How components were coupled.
    order : int
        How many derivatives continued each signal over a step.
    communication_step : float
        s.
    error : float
        Largest distance from the monolithic run over all communication points, in the unit of the outputs; infinite
        where the run failed.
    band, monolithic_band : float, optional
        Largest absolute value of what was watched over the last quarter of the run, and the same of the monolithic run;
        None where nothing was, infinite where the run failed.
    """

    scheme: Scheme
    order: int
    communication_step: float
    error: float
    band: float | None = None
    monolithic_band: float | None = None


def coupling_errors(
    diagram: Diagram,
    t_end: float,
    communication_steps: Sequence[float],
    *,
    schemes: Sequence[Scheme] = SCHEMES,
    orders: Sequence[int] = (0, 1),
    outputs: Sequence[str] = ("x", "y"),
    watched: Sequence[str] = (),
    step_size: float = 1e-3,
    parameters: Mapping[str, float] | None = None,
) -> tuple[CouplingError, ...]:
    """Coupling errors against the diagram as one system, solved by Dormand-Prince with a tolerance of 1e-11.

    Parameters
    ----------
    diagram : Diagram
        What is coupled.
    t_end : float
        Duration of each run, s.
    communication_steps : sequence of float, shape (k,)
        s.
    schemes, orders : sequences
        Every scheme is run with every order and step.
    outputs : sequence of str
        Outputs of the diagram of one unit; the error is the Euclidean norm of their differences.
    watched : sequence of str
        Outputs of one unit, such as sliding variables, whose largest absolute value over the last quarter is told.
    step_size, parameters
        As those of :func:`coupled_simulation`.

    Returns
    -------
    tuple of CouplingError
        In the order of schemes, orders and steps.

    Raises
    ------
    ParameterError
        For an output that the diagram doesn't have, and as :func:`coupled_simulation`.
    ModelError
        As :func:`coupled_simulation`.
    SimulationError
        If the monolithic run fails.
    """
    known = {one.name for one in diagram.outputs}
    if not outputs or {*outputs, *watched} - known:
        named = [*outputs, *watched]
        raise ParameterError(f"coupling_errors: outputs {named} are not all outputs of {diagram.name}")
    references = {
        step: simulate(
            diagram,
            t_end,
            step_size=step,
            parameters=parameters,
            record=list(dict.fromkeys([*outputs, *watched])),
            solver="dormand_prince",
            tolerance=REFERENCE_TOLERANCE,
        )
        for step in dict.fromkeys(communication_steps)
    }
    found = []
    for scheme in schemes:
        for order in orders:
            for step, reference in references.items():
                try:
                    run = coupled_simulation(
                        diagram, t_end, step, scheme=scheme, order=order, step_size=step_size, parameters=parameters
                    )
                    apart = np.array([(run[name] - reference[name]).values for name in outputs])
                    error, band = float(np.max(np.linalg.norm(apart, axis=0))), _band(run, watched)
                except SimulationError:
                    error, band = math.inf, math.inf if watched else None
                found.append(CouplingError(scheme, order, float(step), error, band, _band(reference, watched)))
    return tuple(found)


def _band(run: xr.Dataset, watched: Sequence[str]) -> float | None:
    """Largest absolute value over the last quarter of a run; None for nothing."""
    if not watched:
        return None
    late = run["time"].values >= (0.75 - 1e-9) * float(run["time"][-1])
    return max(float(np.max(np.abs(run[name].values[late]))) for name in watched)


def measured_order(errors: Sequence[CouplingError], below: float) -> float:
    """Order of convergence: slope of log(error) over log(communication step), by least squares.

    Parameters
    ----------
    errors : sequence of CouplingError
        Of one scheme and order.
    below : float
        Longest communication step that counts, s.

    Raises
    ------
    ParameterError
        If fewer than two runs with a positive finite error have such a step.
    """
    rows = [one for one in errors if one.communication_step <= below and 0 < one.error < math.inf]
    steps = np.log([one.communication_step for one in rows])
    if len(set(steps)) < 2:
        raise ParameterError(f"measured_order: fewer than two runs have a step of at most {below:g} s; pass more")
    return float(np.polyfit(steps, np.log([one.error for one in rows]), 1)[0])


def coupling_error_plot(
    errors: Sequence[CouplingError], *, limits: Mapping[str, float] | None = None, ax: Any = None
) -> Any:
    """Coupling error over the communication step, both logarithmic, a line for each scheme and order.

    Parameters
    ----------
    errors : sequence of CouplingError
        From :func:`coupling_errors`; failed runs are left out.
    limits : mapping of str to float, optional
        Largest communication steps by label, s; drawn as vertical lines.
    ax : matplotlib axes, optional
        Where to draw; by default a new figure.

    Returns
    -------
    control.ControlPlot
        Lines, axes and figure.
    """
    axes = new_axes(ax)
    axis = axes[0, 0]
    drawn = []
    for scheme in dict.fromkeys(one.scheme for one in errors):
        for order in dict.fromkeys(one.order for one in errors):
            rows = [one for one in errors if (one.scheme, one.order) == (scheme, order) and one.error < math.inf]
            if rows:
                label = f"{ORDERS[scheme]} ({_NAMES[scheme]}), {_continued(order)}"
                style = line_style(SCHEMES.index(scheme)) | {"marker": "os^D"[order], "markersize": 4}
                points = ([1e3 * one.communication_step for one in rows], [one.error for one in rows])
                drawn += axis.loglog(*points, label=label, fillstyle="none" if order else "full", **style)
    for label, limit in (limits or {}).items():
        axis.axvline(1e3 * limit, color="0.45", linewidth=0.9, linestyle=":")
        place = (1e3 * limit, 0.02)
        axis.annotate(label, place, xycoords=("data", "axes fraction"), rotation=90, fontsize=8, ha="right")
    axis.set(xlabel="communication step in ms", ylabel="largest distance from the monolithic run in m")
    axis.xaxis.set_major_formatter("{x:g}")
    axis.xaxis.set_minor_formatter("")
    axis.legend(fontsize=8)
    return control_plot(axes, [drawn])


def _continued(order: int) -> str:
    return "inputs held" if order == 0 else f"{order} derivative{'s' if order > 1 else ''}"
