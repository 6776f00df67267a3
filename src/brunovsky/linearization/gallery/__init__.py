"""Plants of the literature with known answers, each a function that returns an :class:`AffineSystem`.

They are in their least form; symbols that stand for masses, lengths and the like are parameters.

Examples
--------
>>> from brunovsky.linearization import gallery, linearize
>>> linearize(gallery.unicycle()).relative_degree
(2, 2)
"""

from brunovsky.linearization.gallery.aircraft import pvtol_centre, pvtol_flat, pvtol_flat_untouched, quadrotor, vtol
from brunovsky.linearization.gallery.arms import flexible_joint, manipulator
from brunovsky.linearization.gallery.balancing import ball_and_beam, cart_pole
from brunovsky.linearization.gallery.motors import induction_motor, pm_motor
from brunovsky.linearization.gallery.wheeled import car, trailer, unicycle

__all__ = [
    "ball_and_beam",
    "car",
    "cart_pole",
    "flexible_joint",
    "induction_motor",
    "manipulator",
    "pm_motor",
    "pvtol_centre",
    "pvtol_flat",
    "pvtol_flat_untouched",
    "quadrotor",
    "trailer",
    "unicycle",
    "vtol",
]
