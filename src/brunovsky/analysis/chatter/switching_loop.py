"""One chain under the sliding-mode law with an actuator that lags, and its linear part seen from the switching element.

The law v = -(1/cn)(Q S + P f(S) + c1 e2 + ... ) passes through the actuator G(s) = exp(-delay s) / prod(1 + lag_i s),
with a zero-order hold where it is sampled, and then through the chain; S = C e. Cut at f, this is S = -W f with

    W(s) = (P/cn) G(s) c(s) / (s^n + G(s) k(s)),   c(s) = c1 + ... + cn s^(n-1),   k = `sliding_gain`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import control
import numpy as np
from numpy.typing import ArrayLike, NDArray

from brunovsky.analysis._checks import finite_scalar, finite_vector, surface_coefficients
from brunovsky.analysis.chatter._argument import argument_change
from brunovsky.analysis.linear.design import sliding_gain, surface_poles
from brunovsky.analysis.linear.integrator_chains import chain
from brunovsky.errors import ParameterError

_WHERE = "SwitchingLoop"
_GRID = 1000  # frequencies along which the Nyquist curve is followed, before refinement


@dataclass(frozen=True)
class SwitchingLoop:
    """One Brunovsky chain under v = -(1/cn)(Q S + P f(S) + c1 e2 + ... ), behind an actuator.

    Set-point case (z_d^(n) = 0). f is sign(S), sat(S/phi) or a relay with hysteresis.

    Parameters
    ----------
    surface : array_like, shape (n,)
        C = [c1, ..., cn], cn != 0, with a stable motion on S = 0 (1/s2, 1/s, 1 for n = 3).
    reaching_rate, switching_gain : float
        Q >= 0 (1/s) and P >= 0 (m/s3 for n = 3).
    boundary_layer : float
        phi >= 0, half-width of the saturation (unit of S, m/s2 for n = 3); 0 for a relay.
    hysteresis : float
        Half-width of the relay's hysteresis (unit of S); 0 for sign(S). Excludes a boundary layer.
    lags : sequence of float
        Time constants (s) of first-order lags in series at v; those that are 0 are dropped.
    delay : float
        Pure delay at v (s).
    sampling : float or None
        Period (s) at which v is computed and then held; None for a continuous law.

    Raises
    ------
    ParameterError
        If a number is not finite or out of its range, or the motion on the surface is not stable.

    References
    ----------
    The paper's eqs. (20)-(23); A. Gelb and W. E. Vander Velde, *Multiple-Input Describing Functions and Nonlinear
    System Design*, McGraw-Hill, 1968.
    """

    surface: tuple[float, ...]
    reaching_rate: float
    switching_gain: float
    boundary_layer: float = 0.0
    hysteresis: float = 0.0
    lags: tuple[float, ...] = ()
    delay: float = 0.0
    sampling: float | None = None

    def __post_init__(self) -> None:
        C = surface_coefficients(self.surface, _WHERE)
        poles = surface_poles(C)
        if np.any(poles.real >= -1e-12 * np.max(np.abs(poles), initial=0.0)):
            raise ParameterError(
                f"{_WHERE}: the motion on C = {C.tolist()} is not stable (poles {poles.round(6).tolist()}); "
                "pass a surface with poles in the left half-plane, for instance from surface_from_poles"
            )
        lags = finite_vector(self.lags, "lags", _WHERE, minimum_size=0)
        values: dict[str, Any] = {
            "surface": tuple(C.tolist()),
            "lags": tuple(finite_scalar(one, "lag", _WHERE, minimum=0.0) for one in lags if one != 0.0),
        }
        for field, name in (
            ("reaching_rate", "Q"),
            ("switching_gain", "P"),
            ("boundary_layer", "phi"),
            ("hysteresis", "hysteresis"),
            ("delay", "delay"),
        ):
            values[field] = finite_scalar(getattr(self, field), name, _WHERE, minimum=0.0)
        if self.sampling is not None:
            if self.sampling == 0:
                raise ParameterError(f"{_WHERE}: sampling = 0 is no period; pass None for a continuous law")
            values["sampling"] = finite_scalar(self.sampling, "sampling", _WHERE, minimum=0.0)
        if values["boundary_layer"] > 0.0 and values["hysteresis"] > 0.0:
            raise ParameterError(f"{_WHERE}: a saturation has no hysteresis; pass either boundary_layer or hysteresis")
        for field, value in values.items():
            object.__setattr__(self, field, value)

    @property
    def order(self) -> int:
        """Number of integrators n."""
        return len(self.surface)

    @property
    def gain(self) -> NDArray[np.float64]:
        """K of the linear part v = -K e, shape (n,); see `sliding_gain`."""
        return sliding_gain(self.surface, self.reaching_rate)

    @property
    def dead_time(self) -> float:
        """Sum of the lags, the delay and the sampling period (s), the scale of the chatter's period."""
        return sum(self.lags) + self.delay + (self.sampling or 0.0)

    def frequency_response(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """W(j w), exact with a delay; a hold enters by its own response (1 - exp(-s h))/(s h), without aliases.

        Parameters
        ----------
        frequency : array_like
            w > 0 (rad/s), any shape.

        Returns
        -------
        ndarray of complex, same shape
            W (unit of S).
        """
        s = 1j * np.asarray(frequency, dtype=float)
        hold = self._dead_time_response(s)
        numerator = self.switching_gain / self.surface[-1] * hold * np.polyval(self.surface[::-1], s)
        return np.asarray(numerator / self._characteristic(s, hold))

    def loop_response(self, frequency: ArrayLike, switching: float = 0.0) -> NDArray[np.complex128]:
        """L(j w) of the linear loop cut at v, G(s) (k(s) + (N P/cn) c(s)) / s^n, exact with a delay.

        Parameters
        ----------
        frequency : array_like
            w > 0 (rad/s), any shape.
        switching : float
            N, the gain that stands for f (1/unit of S): 0 for the linear part, 1/phi within a boundary layer.

        Returns
        -------
        ndarray of complex, same shape
            L, with the sign of negative feedback; without lags, delay and sampling it is `loop_transfer`. A hold
            enters by its own response, as in `frequency_response`.
        """
        s = 1j * np.asarray(frequency, dtype=float)
        gain = sliding_gain(self.surface, self.reaching_rate + switching * self.switching_gain)
        chain_part = s**self.order * np.polyval(self._lag_polynomial(), s)
        return np.asarray(self._dead_time_response(s) * np.polyval(gain[::-1], s) / chain_part)

    def characteristic(
        self, frequency: ArrayLike, switching: float = 0.0, latency: float = 0.0
    ) -> NDArray[np.complex128]:
        """Characteristic function s^n prod(1 + lag_i s) + exp(-delay s) (k(s) + (N P/cn) c(s)) at s = j w.

        Parameters
        ----------
        frequency : array_like
            w (rad/s), any shape.
        switching : float
            N, the gain that stands for f (1/unit of S); 0 for the linear part.
        latency : float
            Delay (s) that stands for the phase of f, where it has hysteresis.

        Returns
        -------
        ndarray of complex, same shape
            Zero where the loop has an undamped mode.
        """
        s = 1j * np.asarray(frequency, dtype=float)
        hold = self._dead_time_response(s)
        gain = switching * self.switching_gain / self.surface[-1] * np.exp(-latency * s)
        feedback = gain * np.polyval(self.surface[::-1], s)
        return self._characteristic(s, hold) + hold * feedback

    def unstable_poles(self, switching: float = 0.0, latency: float = 0.0, mode: float | None = None) -> int:
        """Number of roots of `characteristic` in the right half-plane, by the argument principle.

        Parameters
        ----------
        switching, latency : float
            Gain N (1/unit of S) and delay (s) that stand for f; 0 for the linear part.
        mode : float, optional
            Frequency (rad/s) of a pair of roots on the imaginary axis, which is divided out.

        Returns
        -------
        int
            Count with multiplicity; a root at s = 0 (Q = 0) is not counted.
        """
        degree = self.order + len(self.lags)
        grid = self.frequencies()
        path = np.geomspace(1e-2 * grid[0], 1e2 * grid[-1], _GRID)
        radius = float(np.sqrt(grid[0] * grid[-1]))

        def bounded(w: NDArray[np.float64]) -> NDArray[np.complex128]:
            values = self.characteristic(w, switching, latency) / (1j * w + radius) ** degree
            return values if mode is None else values * (1j * w + radius) ** 2 / (mode**2 - w**2)

        if mode is not None:
            path = path[np.abs(path / mode - 1.0) > 1e-5]
        # half a turn for each root; a root at s = 0 gives a quarter
        return int(np.floor(0.25 - argument_change(bounded, path) / np.pi))

    def linear_part(self, pade_order: int | None = None) -> control.TransferFunction:
        """W(s) as a transfer function, from f to -S.

        Parameters
        ----------
        pade_order : int, optional
            Order of `control.pade` for the delay; needed only where there is one. `frequency_response` is exact.

        Returns
        -------
        control.TransferFunction
            Input ``f``, output ``-S``.

        Raises
        ------
        ParameterError
            If the law is sampled, or has a delay and no order is given.
        """
        if self.sampling is not None:
            raise ParameterError(f"{_WHERE}: a sampled law has no rational W(s); use frequency_response")
        delay: tuple[Any, Any] = ([1.0], [1.0])
        if self.delay > 0.0:
            if pade_order is None or isinstance(pade_order, bool) or pade_order < 1:
                raise ParameterError(
                    f"{_WHERE}: W(s) has a delay of {self.delay:g} s, which is not rational; pass pade_order >= 1, "
                    "or use frequency_response, which is exact"
                )
            delay = control.pade(self.delay, pade_order)
        chain_part = np.polymul(self._lag_polynomial(), np.r_[1.0, np.zeros(self.order)])
        denominator = np.polyadd(np.polymul(chain_part, delay[1]), np.polymul(self.gain[::-1], delay[0]))
        numerator = self.switching_gain / self.surface[-1] * np.polymul(self.surface[::-1], delay[0])
        return control.tf(numerator, denominator, inputs=["f"], outputs=["-S"], name="W")

    def actuated_chain(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Chain with the lags in front of it, x' = A x + B v, as seen after the delay.

        Returns
        -------
        A, B : ndarray, shape (n + m, n + m) and (n + m,)
            x holds the n errors e, then the outputs of the m lags, the one nearest the chain first.
        """
        n, m = self.order, len(self.lags)
        A, B = np.zeros((n + m, n + m)), np.zeros(n + m)
        A[:n, :n] = chain(n).A
        B[-1] = 1.0 / self.lags[-1] if m else 1.0
        for i, lag in enumerate(self.lags, start=n):
            A[i - 1, i] = 1.0 / self.lags[i - n - 1] if i > n else 1.0
            A[i, i] = -1.0 / lag
        return A, B

    def frequencies(self, count: int = 600) -> NDArray[np.float64]:
        """Grid of frequencies (rad/s), shape (count,), wide enough for the limit cycles of the loop."""
        modes = np.abs(np.append(surface_poles(self.surface), self.reaching_rate))
        modes = modes[modes > 0.0]
        fast = [1.0 / one for one in (*self.lags, self.delay, self.sampling or 0.0) if one > 0.0]
        if self.hysteresis > 0.0 and self.switching_gain > 0.0:
            fast.append(self.switching_gain / self.hysteresis)
        rates = [*modes.tolist(), *fast] or [1.0]
        top = 10.0 * max(rates)
        if self.sampling is not None:
            top = min(top, np.pi / self.sampling)
        return np.geomspace(min(1e-2 * min(rates), 1e-3 * top), top, count)

    def _lag_polynomial(self) -> NDArray[np.float64]:
        polynomial: NDArray[np.float64] = np.ones(1)
        for lag in self.lags:
            polynomial = np.asarray(np.polymul(polynomial, [lag, 1.0]), dtype=np.float64)
        return polynomial

    def _dead_time_response(self, s: NDArray[np.complex128]) -> NDArray[np.complex128]:
        response = np.exp(-self.delay * s)
        if self.sampling is not None:
            half = 0.5 * self.sampling * s
            response = response * np.exp(-half) * np.sinc(half.imag / np.pi)
        return np.asarray(response)

    def _characteristic(self, s: NDArray[np.complex128], hold: NDArray[np.complex128]) -> NDArray[np.complex128]:
        return np.asarray(s**self.order * np.polyval(self._lag_polynomial(), s) + hold * np.polyval(self.gain[::-1], s))
