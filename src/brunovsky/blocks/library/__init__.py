"""The blocks that ship, one short file each."""

from brunovsky.blocks.library.circle import circle
from brunovsky.blocks.library.closed_loop import closed_loop
from brunovsky.blocks.library.outer_loop import errors
from brunovsky.blocks.library.pole_placement import pole_placement
from brunovsky.blocks.library.relatives import (
    backstepping,
    flat_sliding_mode,
    polar_sliding_mode,
    posture_loop,
    posture_reference,
    second_order_sliding_mode,
    sliding_sector,
)
from brunovsky.blocks.library.robot import linearized_robot, robot, robot_linearization, robot_system
from brunovsky.blocks.library.sliding_mode import sliding_mode

__all__ = [
    "backstepping",
    "circle",
    "closed_loop",
    "errors",
    "flat_sliding_mode",
    "linearized_robot",
    "polar_sliding_mode",
    "pole_placement",
    "posture_loop",
    "posture_reference",
    "robot",
    "robot_linearization",
    "robot_system",
    "second_order_sliding_mode",
    "sliding_mode",
    "sliding_sector",
]
