"""The blocks that ship: the robot, outer loops and references for chains, and the closed loop of them."""

from brunovsky.blocks.library.actuators import (
    actuator_delays,
    actuator_holds,
    actuator_lags,
    actuator_limits,
    actuator_series,
)
from brunovsky.blocks.library.chains import Chains
from brunovsky.blocks.library.closed_loop import closed_loop
from brunovsky.blocks.library.errors import errors
from brunovsky.blocks.library.goal_frame import goal_frame_law, goal_frame_manoeuvre
from brunovsky.blocks.library.outer_inputs import outer_inputs
from brunovsky.blocks.library.outer_loops import (
    disturbance_observer,
    integral_sliding_mode,
    pole_placement,
    sliding_mode,
    sliding_mode_clocked,
    sliding_mode_relay,
    sliding_mode_sampled,
    super_twisting,
    super_twisting_sampled,
)
from brunovsky.blocks.library.references import (
    circle,
    lemniscate,
    line,
    polynomial,
    preview,
    set_point,
    waypoints,
)
from brunovsky.blocks.library.relatives import (
    backstepping,
    flat_sliding_mode,
    polar_sliding_mode,
    posture_loop,
    posture_reference,
    second_order_sliding_mode,
    sliding_sector,
)
from brunovsky.blocks.library.rest_to_rest import regulator, rest_to_rest, rest_to_trajectory, tracker
from brunovsky.blocks.library.robot import (
    linearized_robot,
    robot,
    robot_linearization,
    robot_system,
    robot_with_hardware,
    robot_with_lags,
)
from brunovsky.blocks.library.sensors import sensors

__all__ = [
    "Chains",
    "actuator_delays",
    "actuator_holds",
    "actuator_lags",
    "actuator_limits",
    "actuator_series",
    "backstepping",
    "circle",
    "closed_loop",
    "disturbance_observer",
    "errors",
    "flat_sliding_mode",
    "goal_frame_law",
    "goal_frame_manoeuvre",
    "integral_sliding_mode",
    "lemniscate",
    "line",
    "linearized_robot",
    "outer_inputs",
    "polar_sliding_mode",
    "pole_placement",
    "polynomial",
    "posture_loop",
    "posture_reference",
    "preview",
    "regulator",
    "rest_to_rest",
    "rest_to_trajectory",
    "robot",
    "robot_linearization",
    "robot_system",
    "robot_with_hardware",
    "robot_with_lags",
    "second_order_sliding_mode",
    "sensors",
    "set_point",
    "sliding_mode",
    "sliding_mode_clocked",
    "sliding_mode_relay",
    "sliding_mode_sampled",
    "sliding_sector",
    "super_twisting",
    "super_twisting_sampled",
    "tracker",
    "waypoints",
]
