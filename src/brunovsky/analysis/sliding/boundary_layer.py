"""What the width of the boundary layer trades: accuracy under a matched disturbance against robustness to lag.

For v = (-Q S - P sat(S/phi) - ...)/cn and a constant disturbance D at the level of v, S' = -Q S - P sat(S/phi) + cn D.
Within the layer S settles at cn D / (Q + P/phi), which needs abs(cn D) <= P + Q phi; beyond, at (cn D - sign P)/Q. The
position then settles at S/c1, and the loop within the layer is linear with the gain of `boundary_layer_gain`.
"""

from typing import Any

import control
import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from brunovsky.analysis._checks import finite_scalar, finite_vector, surface_coefficients
from brunovsky.analysis._drawing import control_plot, line_style, new_axes
from brunovsky.analysis.linear.design import boundary_layer_gain
from brunovsky.analysis.linear.robustness import margins
from brunovsky.errors import ParameterError


def boundary_layer_trade_off(
    surface: ArrayLike,
    reaching_rate: float,
    switching_gain: float,
    disturbance: float,
    widths: ArrayLike,
) -> xr.Dataset:
    """Accuracy and margins of the saturated sliding law over the half-width phi of its boundary layer.

    Parameters
    ----------
    surface : array_like, shape (n,)
        C = [c1, ..., cn], n >= 2, cn != 0, all poles on the surface stable (1/s2, 1/s, 1 for n = 3).
    reaching_rate, switching_gain : float
        Q > 0 (1/s) and P >= 0 (m/s3 for n = 3).
    disturbance : float
        D, constant and matched, at the level of v (m/s3 for n = 3), of either sign.
    widths : array_like, shape (N,)
        Values of phi > 0 (m/s2 for n = 3).

    Returns
    -------
    xarray.Dataset
        Over ``phi``, each with ``units`` and ``long_name`` (for n = 3): ``sliding_variable``, the S that D leaves
        (m/s2); ``position_error`` (m); ``inside``, whether S stays in the layer; ``bandwidth``, Q + P/phi of S within
        it (rad/s); and of the loop at v there, ``lag_margin`` and ``delay_margin`` (s), ``gain_lower`` and
        ``max_sensitivity`` (1).

    Raises
    ------
    ParameterError
        If a number is not finite or out of range, or the surface is not stable.

    See Also
    --------
    boundary_layer_plot : the figure.

    References
    ----------
    J.-J. Slotine and S. S. Sastry, "Tracking control of non-linear systems using sliding surfaces, with application
    to robot manipulators", Int. J. Control 38(2), 465-492, 1983, doi:10.1080/00207178308933088.
    """
    where = "boundary_layer_trade_off"
    C = surface_coefficients(surface, where, minimum_size=2)
    Q = finite_scalar(reaching_rate, "Q", where, minimum=0.0, strict=True)
    P = finite_scalar(switching_gain, "P", where, minimum=0.0)
    D = finite_scalar(disturbance, "disturbance", where)
    phi = finite_vector(widths, "widths", where)
    if np.any(phi <= 0.0):
        raise ParameterError(
            f"{where}: the width {np.min(phi):g} is not positive; pass phi > 0 (the sign function is no "
            "layer: see matched_disturbance_bound)"
        )
    push = abs(C[-1] * D)
    inside = push <= P + Q * phi
    size = np.where(inside, push / (Q + P / phi), (push - P) / Q)
    S = np.sign(C[-1] * D) * size
    loops = [margins(boundary_layer_gain(C, Q, P, float(one))) for one in phi]
    order = C.size

    def over_phi(values: Any, units: str, name: str) -> tuple[str, Any, dict[str, str]]:
        return "phi", values, {"units": units, "long_name": name}

    layer = "of the loop within the boundary layer"
    return xr.Dataset(
        {
            "sliding_variable": over_phi(S, _unit(order - 1), "sliding variable that the disturbance leaves"),
            "position_error": over_phi(S / C[0], "m", "position error that the disturbance leaves"),
            "inside": over_phi(inside, "1", "whether the sliding variable stays within the boundary layer"),
            "bandwidth": over_phi(Q + P / phi, "rad/s", "bandwidth of the sliding variable within the boundary layer"),
            "lag_margin": over_phi([one.lag for one in loops], "s", f"largest first-order lag at v {layer}"),
            "delay_margin": over_phi([one.delay for one in loops], "s", f"largest delay at v {layer}"),
            "gain_lower": over_phi([one.gain_lower for one in loops], "1", f"lower gain margin {layer}"),
            "max_sensitivity": over_phi([one.max_sensitivity for one in loops], "1", f"peak sensitivity Ms {layer}"),
        },
        coords={"phi": ("phi", phi, {"units": _unit(order - 1), "long_name": "half-width of the boundary layer"})},
        attrs={"C": C.tolist(), "Q": Q, "P": P, "disturbance": D},
    )


def boundary_layer_plot(trade_off: xr.Dataset, *, ax: Any = None) -> control.ControlPlot:
    """Draw accuracy above and margins below, over the half-width of the boundary layer.

    Parameters
    ----------
    trade_off : xarray.Dataset
        From `boundary_layer_trade_off`.
    ax : array_like of two matplotlib.axes.Axes, optional
        Where to draw; a new figure if left out.

    Returns
    -------
    control.ControlPlot
        Lines, axes of shape (2, 1) and figure, as python-control's own plots return them.

    Raises
    ------
    ParameterError
        If the data set is another one.
    """
    needed = {"position_error", "inside", "lag_margin", "delay_margin"}
    if not isinstance(trade_off, xr.Dataset) or not needed <= set(trade_off):
        raise ParameterError("boundary_layer_plot: pass the data set that boundary_layer_trade_off returns")
    axes = new_axes(ax, 2, size=(6.4, 5.6))
    upper, lower = axes[:, 0]
    data = trade_off.sortby("phi")
    phi = data["phi"].values
    error = upper.loglog(phi, np.abs(data["position_error"].values), label="position error", **line_style(0))
    lost = ~data["inside"].values
    if np.any(lost):
        error += upper.loglog(
            phi[lost], np.abs(data["position_error"].values[lost]), "x", color="black", label="outside the layer"
        )
    names = (("lag_margin", "one first-order lag at v"), ("delay_margin", "pure delay at v"))
    tolerated = [
        lower.loglog(phi, data[name].values, label=label, **line_style(k))[0] for k, (name, label) in enumerate(names)
    ]
    upper.set(
        ylabel="steady error (m)",
        title=f"boundary layer, D = {data.attrs['disturbance']:g} {_unit(len(data.attrs['C']))}",
    )
    lower.set(xlabel=f"half-width phi ({data['phi'].attrs['units']})", ylabel="tolerated at v (s)")
    for one in (upper, lower):
        one.grid(True, which="both", color="0.85")
        one.legend()
    return control_plot(axes, [error, tolerated])


def _unit(derivative: int) -> str:
    return "m" if derivative == 0 else "m/s" if derivative == 1 else f"m/s{derivative}"
