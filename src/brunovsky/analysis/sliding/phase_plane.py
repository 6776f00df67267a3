"""Phase portraits: the motion on the surface, and the sliding variable with its rate behind an actuator's lag."""

from typing import Any

import control
import numpy as np
from numpy.typing import ArrayLike

from brunovsky.analysis._checks import finite_scalar, finite_vector, surface_coefficients
from brunovsky.analysis._drawing import COLORS
from brunovsky.errors import ParameterError


def surface_motion(surface: ArrayLike) -> control.StateSpace:
    """Motion on S = 0 of a chain of three: c1 e + c2 e' + c3 e'' = 0.

    Parameters
    ----------
    surface : array_like, shape (3,)
        C = [c1, c2, c3], c3 != 0 (1/s2, 1/s, 1).

    Returns
    -------
    control.StateSpace
        States and outputs ``e[1]`` (m) and ``e[2]`` (m/s), no input; its poles are `surface_poles`.

    Raises
    ------
    ParameterError
        If the surface has no three finite coefficients or c3 is zero.

    References
    ----------
    The paper's eq. (20); V. I. Utkin, "Variable structure systems with sliding modes", IEEE Trans. Autom. Control
    22(2), 212-222, 1977, doi:10.1109/TAC.1977.1101446.
    """
    C = surface_coefficients(surface, "surface_motion")
    if C.size != 3:
        raise ParameterError(
            f"surface_motion: C = {C.tolist()} has {C.size} coefficients, so the motion on S = 0 has {C.size - 1} "
            "states; pass three for a phase plane (surface_poles takes any number)"
        )
    labels = ["e[1]", "e[2]"]
    A = np.array([[0.0, 1.0], [-C[0] / C[2], -C[1] / C[2]]])
    none = np.zeros((2, 0))
    return control.ss(A, none, np.eye(2), none, outputs=labels, states=labels, name="surface_motion")


def surface_phase_plane(surface: ArrayLike, limits: ArrayLike = (-1.0, 1.0, -20.0, 20.0), **options: Any) -> Any:
    """Phase portrait (e, e') of the motion on the surface S = 0 of a chain of three.

    Parameters
    ----------
    surface : array_like, shape (3,)
        C = [c1, c2, c3], c3 != 0 (1/s2, 1/s, 1).
    limits : array_like, shape (4,)
        Smallest and largest e (m), smallest and largest e' (m/s).
    **options
        For `control.phase_plane_plot`: ``ax``, ``gridspec``, ``plot_streamlines`` and so on.

    Returns
    -------
    control.ControlPlot
        From `control.phase_plane_plot`, of `surface_motion`.

    Raises
    ------
    ParameterError
        If the surface has no three finite coefficients, c3 is zero, or the limits are not ascending.

    References
    ----------
    The paper's eq. (20).
    """
    A = surface_motion(surface).A
    system = control.nlsys(lambda t, x, u, params: A @ x, inputs=0, states=["e[1]", "e[2]"], name="surface_motion")
    titled = {"title": "motion on the surface S = 0"} | options
    plot = portrait(system, limits, "surface_phase_plane", titled)
    plot.axes[0, 0].set(xlabel="e (m)", ylabel="e' (m/s)")
    return plot


def lagged_reaching(
    reaching_rate: float, switching_gain: float, lag: float, boundary_layer: float = 0.0
) -> control.NonlinearIOSystem:
    """Sliding variable under a reaching law that arrives with a first-order lag: tau S'' + S' = -Q S - P sat(S/phi).

    Without a lag (or a law with states, as super-twisting) S' is a function of S, and the portrait is only a curve. The
    lag acts on the reaching law alone, the equivalent control is taken as ideal: a lag on all of v adds
    tau d(c1 e' + ... + c_(n-1) e^(n-1))/dt on the right, which is small for the fast motion (of the order of
    tau c_(n-1)/cn relative to S') but is what limits the lag of the linear part: see `lag_margin` for stability.

    Parameters
    ----------
    reaching_rate, switching_gain : float
        Q >= 0 (1/s) and P >= 0 (m/s3 for n = 3).
    lag : float
        Time constant tau > 0, s.
    boundary_layer : float
        Half-width phi >= 0 of the saturation (m/s2 for n = 3); 0 for the sign function, a relay.

    Returns
    -------
    control.NonlinearIOSystem
        States and outputs ``S`` (m/s2 for n = 3) and ``S'`` (m/s3), no input.

    Raises
    ------
    ParameterError
        If a number is not finite or out of range.

    References
    ----------
    The paper's eq. (22) behind a lag; Ya. Z. Tsypkin, *Relay Control Systems*, Cambridge University Press, 1984.
    """
    where = "lagged_reaching"
    Q = finite_scalar(reaching_rate, "Q", where, minimum=0.0)
    P = finite_scalar(switching_gain, "P", where, minimum=0.0)
    tau = finite_scalar(lag, "lag", where, minimum=0.0)
    phi = finite_scalar(boundary_layer, "phi", where, minimum=0.0)
    if tau == 0.0:
        raise ParameterError(
            f"{where}: lag = 0, so S' is a function of S and there is no plane, only a curve; pass the time constant > "
            "0 of an actuator at v"
        )

    def slope(t: float, x: Any, u: Any, params: Any) -> Any:
        switch = np.sign(x[0]) if phi == 0.0 else np.clip(x[0] / phi, -1.0, 1.0)
        return np.array([x[1], -(Q * x[0] + P * switch + x[1]) / tau])

    labels = ["S", "S'"]
    return control.nlsys(slope, None, inputs=0, outputs=labels, states=labels, name="lagged_reaching")


def reaching_phase_plane(
    reaching_rate: float,
    switching_gain: float,
    lag: float,
    boundary_layer: float = 0.0,
    limits: ArrayLike | None = None,
    **options: Any,
) -> Any:
    """Phase portrait (S, S') of the reaching law behind a first-order lag, with the law without lag as a curve.

    Parameters
    ----------
    reaching_rate, switching_gain, lag, boundary_layer : float
        Q (1/s), P (m/s3 for n = 3), tau (s) and phi (m/s2) of `lagged_reaching`.
    limits : array_like, shape (4,), optional
        Smallest and largest S (m/s2), smallest and largest S' (m/s3); by default two overshoots P tau wide, 2 P high.
    **options
        For `control.phase_plane_plot`: ``ax``, ``gridspec``, ``plot_streamlines`` and so on.

    Returns
    -------
    control.ControlPlot
        From `control.phase_plane_plot`.

    Raises
    ------
    ParameterError
        If a number is not finite or out of range, the lag is zero, or the limits are not ascending.

    References
    ----------
    The paper's eq. (22) behind a lag; see `lagged_reaching`.
    """
    system = lagged_reaching(reaching_rate, switching_gain, lag, boundary_layer)
    P = float(switching_gain)
    if limits is None:
        size = P if P > 0.0 else 1.0
        limits = (-2.0 * size * lag, 2.0 * size * lag, -2.0 * size, 2.0 * size)
    titled = {"title": f"reaching law behind a lag of {1e3 * lag:g} ms"} | options
    plot = portrait(system, limits, "reaching_phase_plane", titled)
    axes = plot.axes[0, 0]
    left, right = axes.get_xlim()
    S = np.linspace(left, right, 801)
    switch = np.sign(S) if boundary_layer == 0.0 else np.clip(S / boundary_layer, -1.0, 1.0)
    box = axes.axis()
    axes.plot(
        S, -reaching_rate * S - P * switch, color=COLORS[1], linestyle=(0, (4, 2)), linewidth=2, label="without lag"
    )
    axes.axis(box)
    axes.set(xlabel="S (m/s²)", ylabel="S' (m/s³)")
    axes.legend(loc="upper right", frameon=True, framealpha=0.9)
    return plot


def portrait(system: control.NonlinearIOSystem, limits: ArrayLike, where: str, options: dict[str, Any]) -> Any:
    """Phase portrait with the folder's defaults, its origin marked; ParameterError for limits that are no box."""
    box = finite_vector(limits, "limits", where)
    if box.size != 4 or box[0] >= box[1] or box[2] >= box[3]:
        raise ParameterError(
            f"{where}: limits = {limits!r}; pass [smallest x, largest x, smallest y, largest y], ascending"
        )
    chosen = {"color": COLORS[0], "plot_separatrices": False, "plot_equilpoints": False} | options
    plot = control.phase_plane_plot(system, list(box), **chosen)
    plot.axes[0, 0].plot(0.0, 0.0, "o", color="black", markersize=5)
    return plot
