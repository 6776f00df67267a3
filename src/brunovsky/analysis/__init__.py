"""Linear and sliding-mode analysis of the Brunovsky chains, in python-control's own objects.

`linear` holds the chains as plants, gains and surfaces for them, and what is known of the linear loop: margins,
sensitivities, responses, root loci. `sliding` looks at the switching law: bounds, reaching, boundary layer, sampling,
super-twisting, phase portraits. Both work on gains and surfaces alone, for chains of any order.

`chatter` predicts what a `SwitchingLoop`, a chain behind an actuator with lags, delay or sampling, does: by describing
function and exactly, beside a measurement. `robot` cuts the robot's loop at its actuators and predicts its chatter
with lags there. `rest` draws resting poses and says what becomes of them under poles in the frame of the goal, by
forecast and by simulation. `coupling` steps the components of a diagram as a master does and finds the limit of its
communication step. `input_sensitivity` says what v costs at u for any plant; `system` hands a whole block to
python-control.
"""

from brunovsky.analysis.chatter.basin import basin_edge, cycle_state
from brunovsky.analysis.chatter.figures import describing_function_plot, relay_locus_plot
from brunovsky.analysis.chatter.limit_cycles import LimitCycle, harmonic_balance, predicted_cycles
from brunovsky.analysis.chatter.measured import MeasuredChatter, measured_chatter
from brunovsky.analysis.chatter.relay_locus import relay_cycles, relay_locus
from brunovsky.analysis.chatter.sampled_relay import sampled_chatter_band, sampled_cycles
from brunovsky.analysis.chatter.simulated_cycle import SimulatedResponse, simulated_cycle
from brunovsky.analysis.chatter.switching_loop import SwitchingLoop
from brunovsky.analysis.chatter.table import ChatterRow, chatter_table
from brunovsky.analysis.coupling.bound import coupling_error_bound
from brunovsky.analysis.coupling.simulated import coupled_simulation
from brunovsky.analysis.coupling.stability import coupled_step_matrix, largest_communication_step, spectral_radius
from brunovsky.analysis.coupling.study import CouplingError, coupling_error_plot, coupling_errors, measured_order
from brunovsky.analysis.input_sensitivity import InputSensitivity, input_gain, input_sensitivity, input_sensitivity_plot
from brunovsky.analysis.linear.design import (
    boundary_layer_gain,
    closed_loop_poles,
    place,
    sliding_gain,
    surface_from_poles,
    surface_poles,
    switching_gain_margin,
)
from brunovsky.analysis.linear.disk_margin import DiskMargin, disk_margin
from brunovsky.analysis.linear.integrator_chains import chain, chains, error_dynamics
from brunovsky.analysis.linear.optimal import lqr_gain, surface_from_cost
from brunovsky.analysis.linear.robustness import Margins, lag_margin, loop_margins, loop_transfer, margins
from brunovsky.analysis.linear.root_locus import (
    pole_zero_map,
    root_locus_over_reaching_rate,
    root_locus_over_surface_gain,
)
from brunovsky.analysis.linear.set_point import (
    bandwidth,
    complementary_sensitivity,
    gang_of_four,
    sensitivity,
    set_point_transfer,
    step_information,
)
from brunovsky.analysis.rest.forecast import goal_frame_forecast
from brunovsky.analysis.rest.manoeuvre import goal_frame_rate
from brunovsky.analysis.rest.outcome import outcome_table
from brunovsky.analysis.rest.poses import resting_poses
from brunovsky.analysis.rest.runs import goal_frame_runs
from brunovsky.analysis.robot.actuator_loop import actuator_loop, actuator_loop_transfer, return_difference
from brunovsky.analysis.robot.actuator_margins import ActuatorMargins, actuator_margins, longest_robot_sampling
from brunovsky.analysis.robot.chatter import (
    RobotChatter,
    actuated_response,
    predicted_robot_chatter,
)
from brunovsky.analysis.robot.chatter_table import RobotChatterRow, robot_chatter_table
from brunovsky.analysis.robot.opened_loop import OpenedLoop, opened_loop
from brunovsky.analysis.robot.steady_motion import SteadyMotion, steady_motion
from brunovsky.analysis.sliding.boundary_layer import boundary_layer_plot, boundary_layer_trade_off
from brunovsky.analysis.sliding.bounds import (
    forward_disturbance_bound,
    matched_disturbance_bound,
    unmatched_residual,
    yaw_disturbance_bound,
)
from brunovsky.analysis.sliding.phase_plane import (
    lagged_reaching,
    reaching_phase_plane,
    surface_motion,
    surface_phase_plane,
)
from brunovsky.analysis.sliding.reaching import RelayCycle, reaching_time, relay_cycle
from brunovsky.analysis.sliding.sampled import largest_sampling_period, sampled_sliding_gain, sampled_sliding_poles
from brunovsky.analysis.sliding.super_twisting_plane import super_twisting_motion, super_twisting_phase_plane
from brunovsky.analysis.sliding.twisting import (
    super_twisting_condition,
    super_twisting_slope_bound,
)
from brunovsky.analysis.system import to_control

__all__ = [
    "ActuatorMargins",
    "ChatterRow",
    "CouplingError",
    "DiskMargin",
    "InputSensitivity",
    "LimitCycle",
    "Margins",
    "MeasuredChatter",
    "OpenedLoop",
    "RelayCycle",
    "RobotChatter",
    "RobotChatterRow",
    "SimulatedResponse",
    "SteadyMotion",
    "SwitchingLoop",
    "actuated_response",
    "actuator_loop",
    "actuator_loop_transfer",
    "actuator_margins",
    "bandwidth",
    "basin_edge",
    "boundary_layer_gain",
    "boundary_layer_plot",
    "boundary_layer_trade_off",
    "chain",
    "chains",
    "chatter_table",
    "closed_loop_poles",
    "complementary_sensitivity",
    "coupled_simulation",
    "coupled_step_matrix",
    "coupling_error_bound",
    "coupling_error_plot",
    "coupling_errors",
    "cycle_state",
    "describing_function_plot",
    "disk_margin",
    "error_dynamics",
    "forward_disturbance_bound",
    "gang_of_four",
    "goal_frame_forecast",
    "goal_frame_rate",
    "goal_frame_runs",
    "harmonic_balance",
    "input_gain",
    "input_sensitivity",
    "input_sensitivity_plot",
    "lag_margin",
    "lagged_reaching",
    "largest_communication_step",
    "largest_sampling_period",
    "longest_robot_sampling",
    "loop_margins",
    "loop_transfer",
    "lqr_gain",
    "margins",
    "matched_disturbance_bound",
    "measured_chatter",
    "measured_order",
    "opened_loop",
    "outcome_table",
    "place",
    "pole_zero_map",
    "predicted_cycles",
    "predicted_robot_chatter",
    "reaching_phase_plane",
    "reaching_time",
    "relay_cycle",
    "relay_cycles",
    "relay_locus",
    "relay_locus_plot",
    "resting_poses",
    "return_difference",
    "robot_chatter_table",
    "root_locus_over_reaching_rate",
    "root_locus_over_surface_gain",
    "sampled_chatter_band",
    "sampled_cycles",
    "sampled_sliding_gain",
    "sampled_sliding_poles",
    "sensitivity",
    "set_point_transfer",
    "simulated_cycle",
    "sliding_gain",
    "spectral_radius",
    "steady_motion",
    "step_information",
    "super_twisting_condition",
    "super_twisting_motion",
    "super_twisting_phase_plane",
    "super_twisting_slope_bound",
    "surface_from_cost",
    "surface_from_poles",
    "surface_motion",
    "surface_phase_plane",
    "surface_poles",
    "switching_gain_margin",
    "to_control",
    "unmatched_residual",
    "yaw_disturbance_bound",
]
