"""The loops that a study can name: reference, outer loop and robot, wired as blocks, each made once."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import Any, Literal, get_args

import brunovsky.blocks.library as library
from brunovsky.blocks import Block, Diagram

LawKind = Literal[
    "linear",
    "saturation",
    "sign",
    "relay",
    "sampled",
    "sampled_exact",
    "sampled_explicit",
    "super_twisting",
    "super_twisting_sampled",
    "integral_sliding_mode",
    "disturbance_observer",
    "pole_placement",
    "flat_sliding_mode",
    "sliding_sector",
    "second_order_sliding_mode",
    "polar_sliding_mode",
    "backstepping",
    "rest_to_rest",
    "goal_frame",
]
KINDS: tuple[LawKind, ...] = get_args(LawKind)
FAMILY: tuple[LawKind, ...] = ("linear", "saturation", "sign")
"""Kinds that are the paper's law and differ in P and phi alone; the others are blocks of their own."""

_RENAMED = {"relay": "sliding_mode_relay", "sampled": "sliding_mode_sampled"}
_OPTIONS: Mapping[str, Mapping[str, Any]] = {
    "sampled_exact": {"surface_map": "exact"},
    "sampled_explicit": {"scheme": "explicit"},
}  # of sliding_mode_sampled
_ACCELERATIONS = ("polar_sliding_mode", "backstepping")  # laws that command the bare robot
_FROM_REST = {"rest_to_rest": "rest_to_rest", "goal_frame": "goal_frame_manoeuvre"}  # whole loops of their own

AIMS_AT_HEADING = frozenset({"rest_to_rest", "goal_frame", "polar_sliding_mode", "backstepping"})
"""Kinds that bring the heading to a wanted one; of the others it is left free."""


@dataclass(frozen=True)
class Hardware:
    """What stands between the law and the robot; by default nothing. See :func:`blocks.robot_with_hardware`.

    Attributes
    ----------
    lags, delays : tuple of float, shape (2,)
        Time constants and transport delays behind the two commands, s; 0 for none.
    number : int
        How many equal lags each command has, in series.
    limits : tuple of float, shape (2,)
        Limits of u1 (m/s2) and u2 (rad/s2); infinite for none.
    period : float or None
        Sampling period of sensors and commands, s; None for none.
    noisy, matched : bool
        Whether there is measurement noise, and a disturbance at v.
    """

    lags: tuple[float, float] = (0.0, 0.0)
    number: int = 1
    delays: tuple[float, float] = (0.0, 0.0)
    limits: tuple[float, float] = (math.inf, math.inf)
    period: float | None = None
    noisy: bool = False
    matched: bool = False


IDEAL = Hardware()


@dataclass(frozen=True)
class Loop:
    """Which block a run simulates: the name of the outer loop in the library, and the hardware around it."""

    controller: str = "sliding_mode"
    hardware: Hardware = IDEAL

    @property
    def block(self) -> Diagram:
        """The closed loop, made once."""
        return _made(self)

    @property
    def maker(self) -> Callable[..., Any]:
        """Function of the library that makes the outer loop, or the whole one where the law is no block of its own."""
        name = _RENAMED["sampled"] if self.controller in _OPTIONS else self.controller
        made: Callable[..., Any] = getattr(library, _FROM_REST.get(self.controller, name))
        return made

    @property
    def law(self) -> Block:
        """Block of the outer loop; the whole loop where the law is no block of its own."""
        return self.block.components.get("controller", self.block)


def loop_of(kind: LawKind, hardware: Hardware = IDEAL) -> Loop:
    """Loop of a law of this kind."""
    return Loop("sliding_mode" if kind in FAMILY else _RENAMED.get(kind, kind), hardware)


def knows_hardware(kind: LawKind) -> bool:
    """Whether a law commands the jerk v, so that hardware can stand around its inner loop."""
    return kind not in _ACCELERATIONS and kind not in _FROM_REST


@lru_cache
def _made(loop: Loop) -> Diagram:
    options, make = _OPTIONS.get(loop.controller, {}), loop.maker
    if loop.controller in _FROM_REST:
        whole: Diagram = make()
        return whole
    if loop.controller in _ACCELERATIONS:
        return library.posture_loop(make())
    controller = None if loop.controller == "sliding_mode" else make(**options)
    if loop.hardware == IDEAL:
        return library.closed_loop(controller)
    plant = library.robot_with_hardware(**asdict(loop.hardware))
    return library.closed_loop(controller, plant=plant)
