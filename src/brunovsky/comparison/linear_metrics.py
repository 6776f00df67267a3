"""Robustness of a law's linear part as metrics, None where its loop is not stable."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from numpy.typing import ArrayLike

from brunovsky.analysis import disk_margin, loop_transfer, margins
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
