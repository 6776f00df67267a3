"""Linear and sliding-mode analysis of the Brunovsky chains, in python-control's own objects.

`integrator_chains` holds the plants, `design` and `optimal` gains and surfaces, `robustness` the margins of the linear
loop, `sliding` the bounds of the switching law, `reaching` its reaching times and the relay's cycle; they work on
gains and surfaces alone, for chains of any order. `system` hands a whole block to python-control.
"""

from brunovsky.analysis.design import (
    boundary_layer_gain,
    closed_loop_poles,
    place,
    sliding_gain,
    surface_from_poles,
    surface_poles,
)
from brunovsky.analysis.integrator_chains import chain, chains, error_dynamics
from brunovsky.analysis.optimal import lqr_gain, surface_from_cost
from brunovsky.analysis.reaching import RelayCycle, reaching_time, relay_cycle
from brunovsky.analysis.robustness import Margins, lag_margin, loop_transfer, margins
from brunovsky.analysis.sampled import largest_sampling_period, sampled_sliding_poles
from brunovsky.analysis.sliding import (
    forward_disturbance_bound,
    matched_disturbance_bound,
    unmatched_residual,
    yaw_disturbance_bound,
)
from brunovsky.analysis.system import to_control
from brunovsky.analysis.twisting import super_twisting_condition, super_twisting_gains, super_twisting_slope_bound

__all__ = [
    "Margins",
    "RelayCycle",
    "boundary_layer_gain",
    "chain",
    "chains",
    "closed_loop_poles",
    "error_dynamics",
    "forward_disturbance_bound",
    "lag_margin",
    "largest_sampling_period",
    "loop_transfer",
    "lqr_gain",
    "margins",
    "matched_disturbance_bound",
    "place",
    "reaching_time",
    "relay_cycle",
    "sampled_sliding_poles",
    "sliding_gain",
    "super_twisting_condition",
    "super_twisting_gains",
    "super_twisting_slope_bound",
    "surface_from_cost",
    "surface_from_poles",
    "surface_poles",
    "to_control",
    "unmatched_residual",
    "yaw_disturbance_bound",
]
