"""Outer loops for chains of any length and number, one short file each."""

from brunovsky.blocks.library.outer_loops.disturbance_observer import disturbance_observer
from brunovsky.blocks.library.outer_loops.integral_sliding_mode import integral_sliding_mode
from brunovsky.blocks.library.outer_loops.pole_placement import pole_placement
from brunovsky.blocks.library.outer_loops.sliding_mode import sliding_mode
from brunovsky.blocks.library.outer_loops.sliding_mode_clocked import sliding_mode_clocked
from brunovsky.blocks.library.outer_loops.sliding_mode_relay import sliding_mode_relay
from brunovsky.blocks.library.outer_loops.sliding_mode_sampled import sliding_mode_sampled
from brunovsky.blocks.library.outer_loops.super_twisting import super_twisting
from brunovsky.blocks.library.outer_loops.super_twisting_sampled import super_twisting_sampled
from brunovsky.blocks.library.outer_loops.switching import saturation

__all__ = [
    "disturbance_observer",
    "integral_sliding_mode",
    "pole_placement",
    "saturation",
    "sliding_mode",
    "sliding_mode_clocked",
    "sliding_mode_relay",
    "sliding_mode_sampled",
    "super_twisting",
    "super_twisting_sampled",
]
