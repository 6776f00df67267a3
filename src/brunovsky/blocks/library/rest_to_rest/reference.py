"""The reference of a leg in time: what the chains follow along a path, and the heading that belongs to it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from brunovsky.blocks.library.rest_to_rest.path import PARAMETER, curvature, path_speed
from brunovsky.blocks.library.rest_to_rest.timing import rise, rise_time
from brunovsky.blocks.variables import TIME, Relation

_COORDINATES = (sp.Function("p_1", real=True), sp.Function("p_2", real=True))
_VELOCITY = sp.Function("V", real=True)


@dataclass(frozen=True)
class Drive:
    """When and how fast a path is driven: begin (s), duration (s), cruising speed (m/s), first acceleration (m/s2)."""

    begin: sp.Expr
    duration: sp.Expr
    speed: sp.Expr
    acceleration: sp.Expr

    @property
    def relations(self) -> tuple[Relation, Relation]:
        """Whether the speed rises, and whether it falls."""
        time = rise_time(self.speed, self.acceleration)
        return (
            Relation("rising", self.begin + time - TIME),
            Relation("falling", TIME - self.begin - self.duration + time),
        )

    @property
    def velocity(self) -> sp.Expr:
        """Speed along the path, m/s: rise, cruise and fall."""
        rising, falling = (one.symbol for one in self.relations)
        time = rise_time(self.speed, self.acceleration)
        up, down = (TIME - self.begin) / time, (self.begin + self.duration - TIME) / time
        return self.speed * sp.Piecewise((rise(up), rising), (rise(down), falling), (1, True))


@dataclass(frozen=True)
class Reference:
    """What the robot does along a path that is driven so: everything by differentiating the path in time.

    ``parameter_rate`` is the derivative of the path parameter; ``position`` and its ``derivatives`` 1 to 3 have shape
    (2, 1) and units m to m/s3; ``direction`` is the unit vector of the heading; ``yaw_rate`` (rad/s) and
    ``yaw_acceleration`` (rad/s2) are those of the heading.
    """

    parameter_rate: sp.Expr
    position: sp.Matrix
    derivatives: tuple[sp.Matrix, sp.Matrix, sp.Matrix]
    direction: sp.Matrix
    yaw_rate: sp.Expr
    yaw_acceleration: sp.Expr

    @classmethod
    def along(cls, path: sp.Matrix, drive: Drive, direction: sp.Expr) -> Reference:
        """Reference along a path in its parameter; ``direction`` is 1, or -1 where it is driven backward."""
        return cls.driven([path.diff(PARAMETER, k) if k else path for k in range(4)], drive, direction)

    @classmethod
    def driven(
        cls, path: Sequence[sp.Matrix], drive: Drive, direction: sp.Expr, scale: sp.Expr | None = None
    ) -> Reference:
        """Reference along a path given with its derivatives 1 to 3 by its parameter.

        ``scale`` is the speed of the drive at which the parameter has the rate 1, a constant; without it the drive's
        speed is that along the path.
        """
        position = sp.Matrix([one(PARAMETER) for one in _COORDINATES])
        rate = _VELOCITY(TIME) / (scale or path_speed(position))

        def in_time(expression: sp.Expr) -> sp.Expr:
            return expression.diff(TIME) + expression.diff(PARAMETER) * rate

        first = position.diff(PARAMETER) * rate
        second = first.applyfunc(in_time)
        third = second.applyfunc(in_time)
        heading = direction * position.diff(PARAMETER) / path_speed(position)
        yaw_rate = curvature(position) * path_speed(position) * rate
        values = _derivatives(_VELOCITY(TIME), drive.velocity, TIME, 2)
        for i, one in enumerate(position):
            values |= {one.diff(PARAMETER, k) if k else one: each[i] for k, each in enumerate(path)}

        def on_path(expression: Any) -> Any:
            return expression.xreplace(values)

        return cls(
            on_path(rate),
            path[0],
            (on_path(first), on_path(second), on_path(third)),
            on_path(heading),
            on_path(yaw_rate),
            on_path(in_time(yaw_rate)),
        )

    def at(self, parameter: dict[sp.Symbol, sp.Expr]) -> Reference:
        """The same with the path parameter replaced."""
        first, second, third = (one.xreplace(parameter) for one in self.derivatives)
        return Reference(
            self.parameter_rate.xreplace(parameter),
            self.position.xreplace(parameter),
            (first, second, third),
            self.direction.xreplace(parameter),
            self.yaw_rate.xreplace(parameter),
            self.yaw_acceleration.xreplace(parameter),
        )

    def unless(self, condition: sp.logic.boolalg.Boolean, other: Reference) -> Reference:
        """The same, but another one where a condition holds; the parameter stays the own one."""

        def chosen(own: Any, others: Any) -> Any:
            if isinstance(own, sp.MatrixBase):
                return sp.Matrix([chosen(*pair) for pair in zip(own, others, strict=True)])
            return sp.Piecewise((others, condition), (own, True))

        first, second, third = map(chosen, self.derivatives, other.derivatives)
        return Reference(
            self.parameter_rate,
            chosen(self.position, other.position),
            (first, second, third),
            chosen(self.direction, other.direction),
            chosen(self.yaw_rate, other.yaw_rate),
            chosen(self.yaw_acceleration, other.yaw_acceleration),
        )


def _derivatives(function: sp.Expr, value: sp.Expr, variable: sp.Symbol, order: int) -> dict[sp.Expr, sp.Expr]:
    """A function and its derivatives with their values: the chain rule is applied to names, which keeps it short."""
    found = {function: value}
    for k in range(1, order + 1):
        found[function.diff(variable, k)] = value.diff(variable, k)
    return found
