"""Feedback linearisation: affine systems, Lie derivatives, relative degree, dynamic extension, linearising law.

Nearly everything here is symbolic; nothing knows of simulation. The theory is that of A. Isidori, *Nonlinear Control
Systems*, 3rd ed., 1995, doi:10.1007/978-1-84628-615-5.
"""

from brunovsky.linearization import gallery
from brunovsky.linearization.affine import AffineSystem
from brunovsky.linearization.disturbance import DisturbanceMap, disturbance_map, measured_chains
from brunovsky.linearization.extension import Extension, ExtensionStep, add_integrators
from brunovsky.linearization.forecast import Forecast, chain_values, forecast
from brunovsky.linearization.input_transformation import InputTransformation
from brunovsky.linearization.lie import lie_bracket, lie_derivative
from brunovsky.linearization.linearize import Linearization, linearize
from brunovsky.linearization.normal_form import NormalForm
from brunovsky.linearization.rank import generic_rank
from brunovsky.linearization.regular_start import RegularStart, regular_start
from brunovsky.linearization.relative_degree import (
    OutputDerivatives,
    decoupling_matrix,
    differentiate_outputs,
    vector_relative_degree,
)
from brunovsky.linearization.singularity import distance_to_singularity
from brunovsky.linearization.static_feedback import StaticLinearizability, is_involutive, static_linearizability
from brunovsky.linearization.zero_dynamics import ZeroDynamics

__all__ = [
    "AffineSystem",
    "DisturbanceMap",
    "Extension",
    "ExtensionStep",
    "Forecast",
    "InputTransformation",
    "Linearization",
    "NormalForm",
    "OutputDerivatives",
    "RegularStart",
    "StaticLinearizability",
    "ZeroDynamics",
    "add_integrators",
    "chain_values",
    "decoupling_matrix",
    "differentiate_outputs",
    "distance_to_singularity",
    "disturbance_map",
    "forecast",
    "gallery",
    "generic_rank",
    "is_involutive",
    "lie_bracket",
    "lie_derivative",
    "linearize",
    "measured_chains",
    "regular_start",
    "static_linearizability",
    "vector_relative_degree",
]
