"""Phase portrait (S, S') of super-twisting, derived from the law's block."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import control
import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from brunovsky.analysis._checks import finite_scalar, finite_vector
from brunovsky.analysis._drawing import COLORS
from brunovsky.analysis.sliding.phase_plane import portrait
from brunovsky.blocks import Chains, super_twisting, symbol, symbols
from brunovsky.blocks.library.outer_loops.twisting_gains import WELL_ESTABLISHED
from brunovsky.errors import ParameterError
from brunovsky.linearization.numeric import numeric_function


def super_twisting_motion(
    gains: ArrayLike = WELL_ESTABLISHED, slope: float = 1.0, disturbance_slope: float = 0.0
) -> control.NonlinearIOSystem:
    """Sliding variable under super-twisting, in the coordinates (S, S').

    S' = -k1 sqrt(L abs(S)) sign(S) + w + d and w' = -k2 L sign(S), so S'' = -k1 sqrt(L) S'/(2 sqrt(abs(S))) - k2 L
    sign(S) + d'. The disturbance thus enters the plane by its slope d' alone; in (S, w), the coordinates of the law,
    it would move the origin. S'' is infinite on S = 0, but integrably: S' is continuous there. The law's own
    regularisation near abs(S) = 1e-12 makes it finite.

    Parameters
    ----------
    gains : array_like, shape (2,)
        k1 and k2, both positive, as `brunovsky.blocks.super_twisting` has them.
    slope : float
        L > 0 (unit of S per s2, m/s4 for n = 3).
    disturbance_slope : float
        d', constant (m/s4 for n = 3); within L it is removed.

    Returns
    -------
    control.NonlinearIOSystem
        States and outputs ``S`` (m/s2 for n = 3) and ``S'`` (m/s3), no input; derived from the expressions of the block
        `brunovsky.blocks.super_twisting`.

    Raises
    ------
    ParameterError
        If the gains are not two positive numbers, or a slope is not finite or L not positive.

    References
    ----------
    A. Levant, "Robust exact differentiation via sliding mode technique", Automatica 34(3), 379-384, 1998.
    """
    where = "super_twisting_motion"
    k = finite_vector(gains, "k", where, minimum_size=2)
    if k.size != 2 or np.any(k <= 0.0):
        raise ParameterError(f"{where}: k = {k.tolist()}; pass two positive gains, k1 and k2")
    L = finite_scalar(slope, "slope", where, minimum=0.0, strict=True)
    drift = finite_scalar(disturbance_slope, "disturbance_slope", where)
    acceleration = _super_twisting_acceleration()

    def field(t: float, x: Any, u: Any, params: Any) -> Any:
        return np.array([x[1], float(acceleration(x[0], x[1], k[0], k[1], L)[0]) + drift])

    labels = ["S", "S'"]
    return control.nlsys(field, None, inputs=0, outputs=labels, states=labels, name="super_twisting")


def super_twisting_phase_plane(
    gains: ArrayLike = WELL_ESTABLISHED,
    slope: float = 1.0,
    disturbance_slope: float = 0.0,
    limits: ArrayLike | None = None,
    **options: Any,
) -> Any:
    """Phase portrait (S, S') of super-twisting, with the curve on which S' is all the square root's, w + d = 0.

    Parameters
    ----------
    gains, slope, disturbance_slope
        k, L and d' (m/s4 for n = 3) of `super_twisting_motion`.
    limits : array_like, shape (4,), optional
        Smallest and largest S (m/s2), smallest and largest S' (m/s3); by default as for abs(S) <= L s2.
    **options
        For `control.phase_plane_plot`: ``ax``, ``gridspec``, ``plot_streamlines`` and so on. An even number of columns
        keeps the grid off S = 0.

    Returns
    -------
    control.ControlPlot
        From `control.phase_plane_plot`.

    Raises
    ------
    ParameterError
        As `super_twisting_motion`, or if the limits are not ascending.

    References
    ----------
    See `super_twisting_motion`.
    """
    system = super_twisting_motion(gains, slope, disturbance_slope)
    k1, L = float(np.asarray(gains)[0]), float(slope)
    if limits is None:
        limits = (-L, L, -2.0 * k1 * L, 2.0 * k1 * L)
    titled = {"title": f"super-twisting, L = {L:g}", "gridspec": [40, 40]} | options
    plot = portrait(system, limits, "super_twisting_phase_plane", titled)
    axes = plot.axes[0, 0]
    box = axes.axis()
    S = np.linspace(box[0], box[1], 801)
    axes.plot(
        S,
        -k1 * np.sqrt(L * np.abs(S)) * np.sign(S),
        color=COLORS[1],
        linestyle=(0, (4, 2)),
        linewidth=2,
        label="w + d = 0",
    )
    axes.axis(box)
    axes.set(xlabel="S (m/s²)", ylabel="S' (m/s³)")
    axes.legend(loc="upper right", frameon=True, framealpha=0.9)
    return plot


@lru_cache
def _super_twisting_acceleration() -> Callable[..., Any]:
    """S'' of S, S', k1, k2 and L, from the block on one integrator, where S is the error and v its rate."""
    block = super_twisting(Chains((1,), ("m",)), [1.0])
    rate = next(one.expression for one in block.outputs if one.name == "v[1]")
    (w,) = block.states
    conditions = {one.symbol: one.expression > 0 for one in block.relations}
    error, S, velocity = symbol("Z1[1]"), sp.Dummy("S", real=True), sp.Dummy("S'", real=True)
    total = rate.diff(error) * velocity + rate.diff(w.symbol) * w.derivative.xreplace(conditions)
    reference = {one.symbol: sp.S.Zero for one in block.inputs if one.symbol != error}
    unit_surface = {symbol("C[1]"): sp.S.One}
    arguments = [S, velocity, *symbols("k[1]", "k[2]", "L")]
    found: Callable[..., Any] = numeric_function(
        arguments, [total.xreplace(reference | unit_surface).xreplace({error: S})]
    )
    return found
