"""What limits and other parameters must fulfil for a plan to exist and for the robot to rest at its end."""

from __future__ import annotations

import sympy as sp

from brunovsky.blocks.library.rest_to_rest.modes import TOLERANCE, TUBE
from brunovsky.blocks.library.rest_to_rest.motion import ETA_MIN, RATE
from brunovsky.blocks.library.rest_to_rest.timing import SPEED_SHARE, Limits, rise_time, turning_time
from brunovsky.blocks.variables import Check

LONGEST = 120
"""Time that half a turn in place, or reaching the cruising speed, may take, s."""
LEAST_TOLERANCE = 1e-4
"""Distance to the side, m; ways of a hundredth of it have curves that are too narrow to be driven."""
LEAST_RATE = 0.1
"""Rate of holding and of the observer, 1/s; slower ones do not come to rest within a minute."""


def feasibility(limits: Limits, planned: Limits, observer_rate: sp.Expr) -> tuple[Check, ...]:
    """Checks at the start.

    Parameters
    ----------
    limits, planned : Limits
        What must not be exceeded, and what plans use of it.
    observer_rate : Expr
        Rate of the observer of disturbances, 1/s.
    """
    positive = (
        ("speed_limit", limits.speed, "move"),
        ("u_limit[1]", limits.acceleration, "accelerate"),
        ("u_limit[2]", limits.yaw_acceleration, "turn"),
    )
    one = sp.S.One
    rules = (
        *(
            (limit > 0, f"{name} must be positive: a robot that may not {what} cannot be brought to the goal; raise it")
            for name, limit, what in positive
        ),
        (
            turning_time(sp.pi, one) ** 2 <= LONGEST**2 * planned.yaw_acceleration,
            f"with this u_limit[2] half a turn in place takes more than {LONGEST} s; raise u_limit[2] or lower reserve",
        ),
        (
            rise_time(planned.speed, one) <= LONGEST * planned.acceleration,
            f"with this u_limit[1] it takes more than {LONGEST} s to reach speed_limit; "
            "raise u_limit[1], lower reserve or lower speed_limit",
        ),
        (
            ETA_MIN.symbol < planned.speed,
            f"eta_min must be less than the {100 * SPEED_SHARE:g} % of speed_limit that plans use: "
            "the law that tracks would never act alone; lower eta_min or raise speed_limit",
        ),
        (
            TOLERANCE.symbol >= LEAST_TOLERANCE,
            f"tolerance must be at least {LEAST_TOLERANCE:g} m: "
            "it would plan on and on for what is left of the way; raise it",
        ),
        (
            TUBE.symbol > TOLERANCE.symbol,
            "tube must be greater than tolerance: a leg would be given up for an error that counts as reached; "
            "raise tube or lower tolerance",
        ),
        (
            RATE.symbol >= LEAST_RATE,
            f"hold_rate must be at least {LEAST_RATE:g} 1/s: the robot would not settle at the goal; raise it",
        ),
        (
            observer_rate >= LEAST_RATE,
            f"observer_rate must be at least {LEAST_RATE:g} 1/s: "
            "where a constant disturbance acts the robot would never rest, and nothing be planned; raise it",
        ),
    )
    return tuple(Check("limit", condition, message) for condition, message in rules)
