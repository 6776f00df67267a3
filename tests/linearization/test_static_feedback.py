"""Exact linearisability by static feedback, with the answers of the literature."""

import pytest
import sympy as sp
from gallery_plants import GALLERY
from linearization_plants import chain, pendulum

from brunovsky.errors import ParameterError
from brunovsky.linearization import AffineSystem, is_involutive, static_linearizability

X, Y, Z = sp.symbols("x y z", real=True)
U = sp.Symbol("u", real=True)


@pytest.mark.parametrize(("name", "indices"), [("flexible_joint", (4,)), ("pm_motor", (2, 1)), ("manipulator", (2, 2))])
def test_exactly_linearisable(name: str, indices: tuple[int, ...]) -> None:
    result = static_linearizability(GALLERY[name]())
    assert result.answer
    assert result.controllability_indices == indices
    assert all(result.involutive)
    assert f"chains have the lengths {', '.join(map(str, indices))}" in result.explain()


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("unicycle", "G_0 is not involutive, [g(v), g(omega)] is not in it"),
        ("nominal_robot", "G_1 is not involutive, [ad_f g(u1), ad_f g(u2)] is not in it"),
        ("ball_and_beam", "G_1 is not involutive, [g(u), ad_f g(u)] is not in it"),
        ("cart_pole", "G_1 is not involutive, [g(F), ad_f g(F)] is not in it"),
        ("induction_motor", "G_1 is not involutive, [ad_f g(u_a), ad_f g(u_b)] is not in it"),
        ("quadrotor", "G_1 is not involutive, [g(T), ad_f g(tau1)] is not in it"),
    ],
)
def test_not_linearisable_by_static_feedback(name: str, reason: str) -> None:
    result = static_linearizability(GALLERY[name]())
    assert not result.answer
    assert result.reason == reason
    assert result.controllability_indices == ()
    assert f"Not exactly linearisable by static feedback: {reason}." in result.explain()


def test_chains_and_pendulum_are_linearisable() -> None:
    assert static_linearizability(pendulum()).ranks == (1, 2)
    assert static_linearizability(chain(5)).controllability_indices == (5,)


def test_what_the_inputs_do_not_reach_is_not_linearisable() -> None:
    result = static_linearizability(AffineSystem((X, Y, Z), (U,), [Y, 0, -Z], [0, 1, 0], (X,)))
    assert not result.answer
    assert result.reason == "the inputs reach only 2 of 3 dimensions (G_2 = G_1)"


def test_generic_ranks_and_those_at_the_operating_point_are_told_apart() -> None:
    system = AffineSystem((X, Y), (U,), [Y**2, 0], [0, 1], (X,))
    assert static_linearizability(system).answer
    there = static_linearizability(system, operating_point={"y": 0})
    assert there.reason == "G_1 has rank 1 at the operating point and 2 near it"
    with pytest.raises(ParameterError, match="speed is not a state or parameter"):
        static_linearizability(system, operating_point={"speed": 0})


def test_involutivity() -> None:
    assert is_involutive([(1, 0, 0), (0, X, 1)], (X, Y, Z)) is False
    assert is_involutive([(1, 0, 0), (0, 1, 0)], (X, Y, Z)) is True
    assert is_involutive([(sp.cos(Z), sp.sin(Z), 0), (0, 0, 1), (-sp.sin(Z), sp.cos(Z), 0)], (X, Y, Z)) is True
