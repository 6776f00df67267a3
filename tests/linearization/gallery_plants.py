"""The gallery that ships, the robot, and plants that are not from the literature, linearised once for all tests."""

from functools import cache

import sympy as sp
from linearization_plants import nominal_robot

from brunovsky.linearization import AffineSystem, Linearization, gallery, linearize


def mixed_inputs() -> AffineSystem:
    """Not from the literature: u1 + c u2 moves both outputs, so u1 is replaced before the first extension."""
    a, b, c, d, u1, u2 = sp.symbols("a b c d u1 u2", real=True)
    gains = [[1, c], [d, c * d], [0, 1], [0, 1]]
    return AffineSystem((a, b, c, d), (u1, u2), [0, 0, -c, 0], gains, (a, b))


def three_mixed_inputs() -> AffineSystem:
    """Not from the literature: three outputs move through two combinations of three inputs."""
    a, b, c, d, e, f, u1, u2, u3 = sp.symbols("a b c d e f u1 u2 u3", real=True)
    gains = [[1, 0, d], [0, 1, e], [f, 1, d * f + e], [0, 0, 0], [0, 0, 0], [0, 0, 1]]
    drift = [0, 0, 0, -d, -e, -f]
    return AffineSystem((a, b, c, d, e, f), (u1, u2, u3), drift, gains, (a, b, c))


GALLERY = {name: getattr(gallery, name) for name in gallery.__all__} | {
    plant.__name__: plant for plant in (mixed_inputs, three_mixed_inputs, nominal_robot)
}


@cache
def linearized(name: str) -> Linearization:
    return linearize(GALLERY[name]())
