"""The blocks that ship: the robot, outer loops and references for chains, and the closed loop of them."""

from brunovsky.blocks.library.chains import Chains
from brunovsky.blocks.library.closed_loop import closed_loop
from brunovsky.blocks.library.errors import errors
from brunovsky.blocks.library.outer_loops import (
    disturbance_observer,
    integral_sliding_mode,
    pole_placement,
    sliding_mode,
    sliding_mode_relay,
    sliding_mode_sampled,
    super_twisting,
    super_twisting_sampled,
)
from brunovsky.blocks.library.references import circle, preview, set_point
from brunovsky.blocks.library.robot import linearized_robot, robot, robot_linearization, robot_system

__all__ = [
    "Chains",
    "circle",
    "closed_loop",
    "disturbance_observer",
    "errors",
    "integral_sliding_mode",
    "linearized_robot",
    "pole_placement",
    "preview",
    "robot",
    "robot_linearization",
    "robot_system",
    "set_point",
    "sliding_mode",
    "sliding_mode_relay",
    "sliding_mode_sampled",
    "super_twisting",
    "super_twisting_sampled",
]
