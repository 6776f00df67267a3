"""Sampled sliding mode on a declared clock."""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.library.outer_loops.sliding_mode_sampled import Scheme, sampled_sliding_mode
from brunovsky.blocks.library.outer_loops.surface_map import PERIOD, SurfaceMap
from brunovsky.blocks.variables import Clock

CLOCK = Clock("sampling", "ticks where the law is sampled", PERIOD.symbol)


def sliding_mode_clocked(
    chains: Chains | Block = ROBOT_CHAINS,
    surface: Sequence[ArrayLike] | None = None,
    *,
    Q: ArrayLike = 5.0,
    P: ArrayLike = 2.5,
    period: float = 0.01,
    scheme: Scheme = "implicit",
    surface_map: SurfaceMap = "euler",
    preview: bool = False,
    disturbance: ArrayLike | None = None,
) -> Block:
    """The law of :func:`sliding_mode_sampled`, sampled when its clock ``sampling`` ticks.

    In a simulation, and wherever nobody drives the clock, it ticks every ``sampling_period`` from the start on, and the
    block does what :func:`sliding_mode_sampled` does. An FMU of it is one of FMI 3, which has clocks; there the
    importer says when it ticks. The law takes ``sampling_period`` for the time until the next tick, so that what the
    other block states holds only where that is so.

    Parameters
    ----------
    chains, surface, Q, P, period, scheme, surface_map, preview, disturbance
        As for :func:`sliding_mode_sampled`.

    Returns
    -------
    Block
        With the variables of :func:`sliding_mode_sampled` and the clock ``sampling``, whose period is
        ``sampling_period``.

    Raises
    ------
    ModelError
        If the numbers do not fit the chains, an option is unknown, or options do not go together.
    ParameterError
        If the surface is not stable, c_r zero, the period not positive or too long, or P too small for D.

    References
    ----------
    Those of :func:`sliding_mode_sampled`; clocks: Modelica Association, *Functional Mock-up Interface Specification*,
    version 3.0, 2022, https://fmi-standard.org/docs/3.0/.
    """
    return sampled_sliding_mode(
        "sliding_mode_clocked",
        chains,
        surface,
        Q=Q,
        P=P,
        period=period,
        scheme=scheme,
        surface_map=surface_map,
        preview=preview,
        disturbance=disturbance,
        clock=CLOCK,
    )
