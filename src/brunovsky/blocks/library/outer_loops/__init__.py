"""Outer loops for chains of any length and number, one short file each."""

from brunovsky.blocks.library.outer_loops.pole_placement import pole_placement
from brunovsky.blocks.library.outer_loops.sliding_mode import saturation, sliding_mode

__all__ = ["pole_placement", "saturation", "sliding_mode"]
