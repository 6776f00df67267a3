"""Feedback linearisation: affine systems, Lie derivatives, relative degree, dynamic extension, linearising law.

Everything here is symbolic and knows nothing of simulation. The theory is that of A. Isidori, *Nonlinear Control
Systems*, 3rd ed., 1995, doi:10.1007/978-1-84628-615-5.
"""

from brunovsky.linearization.affine import AffineSystem
from brunovsky.linearization.extension import Extension, ExtensionStep, add_integrators
from brunovsky.linearization.input_transformation import InputTransformation
from brunovsky.linearization.lie import lie_bracket, lie_derivative
from brunovsky.linearization.linearize import Linearization, linearize
from brunovsky.linearization.normal_form import NormalForm
from brunovsky.linearization.rank import generic_rank
from brunovsky.linearization.relative_degree import (
    OutputDerivatives,
    decoupling_matrix,
    differentiate_outputs,
    vector_relative_degree,
)
from brunovsky.linearization.static_feedback import StaticLinearizability, is_involutive, static_linearizability
from brunovsky.linearization.zero_dynamics import ZeroDynamics

__all__ = [
    "AffineSystem",
    "Extension",
    "ExtensionStep",
    "InputTransformation",
    "Linearization",
    "NormalForm",
    "OutputDerivatives",
    "StaticLinearizability",
    "ZeroDynamics",
    "add_integrators",
    "decoupling_matrix",
    "differentiate_outputs",
    "generic_rank",
    "is_involutive",
    "lie_bracket",
    "lie_derivative",
    "linearize",
    "static_linearizability",
    "vector_relative_degree",
]
