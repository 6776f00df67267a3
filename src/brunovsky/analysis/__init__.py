"""Linear and sliding-mode analysis of the Brunovsky chains, in python-control's own objects.

`integrator_chains` holds the plants, `design` gains and surfaces; `robustness`, `disk_margin`, `set_point` and
`root_locus` look at the linear loop, `sliding`, `boundary_layer` and `phase_plane` at the switching law; all of these
work on gains and surfaces alone, for chains of any order. `actuator_loop` cuts the robot's loop at its actuators,
`input_sensitivity` says what v costs at u for any plant, and `system` hands a whole block to python-control.
`integrator_chains` holds the plants, `design` and `optimal` gains and surfaces, `robustness` the margins of the linear
loop, `sliding` the bounds of the switching law, `reaching` its reaching times and the relay's cycle; they work on
gains and surfaces alone, for chains of any order. `system` hands a whole block to python-control.
"""

from brunovsky.analysis.actuator_loop import (
    actuator_loop,
    actuator_loop_transfer,
    return_difference,
)
from brunovsky.analysis.boundary_layer import boundary_layer_plot, boundary_layer_trade_off
from brunovsky.analysis.design import (
    boundary_layer_gain,
    closed_loop_poles,
    place,
    sliding_gain,
    surface_from_poles,
    surface_poles,
)
from brunovsky.analysis.disk_margin import DiskMargin, disk_margin
from brunovsky.analysis.input_sensitivity import (
    InputSensitivity,
    input_gain,
    input_sensitivity,
    input_sensitivity_plot,
)
from brunovsky.analysis.integrator_chains import chain, chains, error_dynamics
from brunovsky.analysis.opened_loop import OpenedLoop, opened_loop
from brunovsky.analysis.optimal import lqr_gain, surface_from_cost
from brunovsky.analysis.phase_plane import lagged_reaching, reaching_phase_plane, surface_motion, surface_phase_plane
from brunovsky.analysis.reaching import RelayCycle, reaching_time, relay_cycle
from brunovsky.analysis.robustness import Margins, lag_margin, loop_margins, loop_transfer, margins
from brunovsky.analysis.root_locus import pole_zero_map, root_locus_over_reaching_rate, root_locus_over_surface_gain
from brunovsky.analysis.set_point import (
    bandwidth,
    complementary_sensitivity,
    gang_of_four,
    sensitivity,
    set_point_transfer,
    step_information,
)
from brunovsky.analysis.sliding import (
    forward_disturbance_bound,
    matched_disturbance_bound,
    unmatched_residual,
    yaw_disturbance_bound,
)
from brunovsky.analysis.steady_motion import SteadyMotion, steady_motion
from brunovsky.analysis.system import to_control

__all__ = [
    "DiskMargin",
    "InputSensitivity",
    "Margins",
    "OpenedLoop",
    "RelayCycle",
    "SteadyMotion",
    "actuator_loop",
    "actuator_loop_transfer",
    "bandwidth",
    "boundary_layer_gain",
    "boundary_layer_plot",
    "boundary_layer_trade_off",
    "chain",
    "chains",
    "closed_loop_poles",
    "complementary_sensitivity",
    "disk_margin",
    "error_dynamics",
    "forward_disturbance_bound",
    "gang_of_four",
    "input_gain",
    "input_sensitivity",
    "input_sensitivity_plot",
    "lag_margin",
    "lagged_reaching",
    "loop_margins",
    "loop_transfer",
    "lqr_gain",
    "margins",
    "matched_disturbance_bound",
    "opened_loop",
    "place",
    "pole_zero_map",
    "reaching_phase_plane",
    "reaching_time",
    "relay_cycle",
    "return_difference",
    "root_locus_over_reaching_rate",
    "root_locus_over_surface_gain",
    "sensitivity",
    "set_point_transfer",
    "sliding_gain",
    "steady_motion",
    "step_information",
    "surface_from_cost",
    "surface_from_poles",
    "surface_motion",
    "surface_phase_plane",
    "surface_poles",
    "to_control",
    "unmatched_residual",
    "yaw_disturbance_bound",
]
