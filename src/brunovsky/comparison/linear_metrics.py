"""Robustness of a law's linear part as metrics, None where its loop is not stable."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass

from numpy.typing import ArrayLike

from brunovsky.analysis import boundary_layer_gain, disk_margin, loop_transfer, margins, sliding_gain
from brunovsky.comparison.definitions import Definition
from brunovsky.comparison.output import plain
from brunovsky.errors import ParameterError


@dataclass(frozen=True)
class LinearMetrics:
    """Robustness of the linear loop of one chain, cut at v; all None where it is not stable.

    Attributes
    ----------
    max_sensitivity : float or None
        Ms (1).
    disk_margin : float or None
        Radius of the balanced disk margin (1).
    gain_lower, gain_upper : float or None
        Factors between which the gain may vary (1); None for an upper one that nothing limits.
    phase_margin : float or None
        In rad.
    delay_margin : float or None
        In s.
    """

    max_sensitivity: float | None = None
    disk_margin: float | None = None
    gain_lower: float | None = None
    gain_upper: float | None = None
    phase_margin: float | None = None
    delay_margin: float | None = None

    def as_dict(self) -> dict[str, float | None]:
        """The same by name, ready for JSON."""
        return asdict(self)


def linear_metrics(gain: ArrayLike) -> LinearMetrics:
    """Ms, disk margin and classical margins of v = -K e on one chain.

    Parameters
    ----------
    gain : array_like, shape (n,)
        K = [k1, ..., kn].
    """
    try:
        classical = margins(gain)
    except ParameterError:
        return LinearMetrics()
    found = {
        "max_sensitivity": classical.max_sensitivity,
        "disk_margin": disk_margin(loop_transfer(gain)).radius,
        "gain_lower": classical.gain_lower,
        "gain_upper": classical.gain_upper,
        "phase_margin": classical.phase,
        "delay_margin": classical.delay,
    }
    return LinearMetrics(**plain(found))


def linear_metrics_of(parameters: Mapping[str, float], *, within_layer: bool = False) -> LinearMetrics:
    """The same for the parameters of a run: of the linear part (P = 0), or within the boundary layer.

    Parameters
    ----------
    parameters : mapping
        ``C[1]``, ``C[2]``, ``C[3]``, ``Q``, and ``P`` and ``phi`` for the layer.
    within_layer : bool
        With the gain P/phi of the boundary layer added; a relay, phi = 0, has no such gain and its metrics are None.
    """
    surface = [parameters[f"C[{k}]"] for k in (1, 2, 3)]
    if not within_layer or not parameters["P"]:
        return linear_metrics(sliding_gain(surface, parameters["Q"]))
    if not parameters["phi"]:
        return LinearMetrics()
    return linear_metrics(boundary_layer_gain(surface, parameters["Q"], parameters["P"], parameters["phi"]))


LINEAR_DEFINITIONS = tuple(
    Definition(*row)
    for row in (
        (
            "max_sensitivity",
            "Ms",
            "1",
            "Peak of the sensitivity of the linear loop cut at v; its inverse is the distance from −1 to the Nyquist "
            "plot.",
            "max |1/(1 + L(jω))|",
        ),
        (
            "disk_margin",
            "disk margin",
            "1",
            "Radius of the largest balanced disk of simultaneous changes of gain and phase that leaves the loop "
            "stable.",
            "1 / max |(S − T)/2|",
        ),
        (
            "gain_lower",
            "lower gain margin (factor)",
            "1",
            "Smallest factor of the loop gain for which the linear loop is stable.",
            "L → k L",
        ),
        (
            "gain_upper",
            "upper gain margin (factor)",
            "1",
            "Largest such factor; not defined where nothing limits it.",
            "L → k L",
        ),
        (
            "phase_margin",
            "phase margin",
            "rad",
            "Smallest lag of phase at a gain crossover that destabilises the linear loop.",
            "arg L(jω_c) + π",
        ),
        (
            "delay_margin",
            "delay margin",
            "s",
            "Longest pure delay at v before the linear loop is unstable.",
            "min φ_m/ω_c",
        ),
    )
)
"""Definitions of the metrics of the linear part."""
