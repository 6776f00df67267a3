"""The blocks that ship, one short file each."""

from brunovsky.blocks.library.circle import circle
from brunovsky.blocks.library.closed_loop import closed_loop
from brunovsky.blocks.library.outer_loop import errors
from brunovsky.blocks.library.pole_placement import pole_placement
from brunovsky.blocks.library.robot import linearized_robot, robot, robot_linearization, robot_system
from brunovsky.blocks.library.sliding_mode import sliding_mode

__all__ = [
    "circle",
    "closed_loop",
    "errors",
    "linearized_robot",
    "pole_placement",
    "robot",
    "robot_linearization",
    "robot_system",
    "sliding_mode",
]
