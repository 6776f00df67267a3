"""Linear and sliding-mode analysis of the Brunovsky chains, in python-control's own objects.

`integrator_chains` holds the plants, `design` gains and surfaces, `robustness` the margins of the linear loop,
`sliding` the bounds of the switching law; they work on gains and surfaces alone, for chains of any order.

A `SwitchingLoop` is a chain under the switching law behind an actuator with lags, delay or sampling. Its chatter is
predicted by describing function (`limit_cycles`) and exactly (`relay_locus`, `sampled_relay`), and measured
(`simulated_cycle`, `basin`); `chatter` sets the three side by side.

`system` hands a whole block to python-control.
"""

from brunovsky.analysis.basin import basin_edge, cycle_state
from brunovsky.analysis.chatter import ChatterRow, chatter_table
from brunovsky.analysis.chatter_figures import describing_function_plot, relay_locus_plot
from brunovsky.analysis.design import (
    boundary_layer_gain,
    closed_loop_poles,
    place,
    sliding_gain,
    surface_from_poles,
    surface_poles,
)
from brunovsky.analysis.integrator_chains import chain, chains, error_dynamics
from brunovsky.analysis.limit_cycles import LimitCycle, harmonic_balance, predicted_cycles
from brunovsky.analysis.relay_locus import relay_cycles, relay_locus
from brunovsky.analysis.robustness import Margins, lag_margin, loop_transfer, margins
from brunovsky.analysis.sampled_relay import sampled_chatter_band, sampled_cycles
from brunovsky.analysis.simulated_cycle import SimulatedResponse, simulated_cycle
from brunovsky.analysis.sliding import (
    forward_disturbance_bound,
    matched_disturbance_bound,
    reaching_time,
    unmatched_residual,
    yaw_disturbance_bound,
)
from brunovsky.analysis.switching_loop import SwitchingLoop
from brunovsky.analysis.system import to_control

__all__ = [
    "ChatterRow",
    "LimitCycle",
    "Margins",
    "SimulatedResponse",
    "SwitchingLoop",
    "basin_edge",
    "boundary_layer_gain",
    "chain",
    "chains",
    "chatter_table",
    "closed_loop_poles",
    "cycle_state",
    "describing_function_plot",
    "error_dynamics",
    "forward_disturbance_bound",
    "harmonic_balance",
    "lag_margin",
    "loop_transfer",
    "margins",
    "matched_disturbance_bound",
    "place",
    "predicted_cycles",
    "reaching_time",
    "relay_cycles",
    "relay_locus",
    "relay_locus_plot",
    "sampled_chatter_band",
    "sampled_cycles",
    "simulated_cycle",
    "sliding_gain",
    "surface_from_poles",
    "surface_poles",
    "to_control",
    "unmatched_residual",
    "yaw_disturbance_bound",
]
