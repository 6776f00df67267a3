"""The supervisor as a block: goal and robot in, accelerations, chains and their reference out."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS
from brunovsky.blocks.library.rest_to_rest import motion
from brunovsky.blocks.library.rest_to_rest.candidates import candidates
from brunovsky.blocks.library.rest_to_rest.feasibility import feasibility
from brunovsky.blocks.library.rest_to_rest.follow import Target, reference_target
from brunovsky.blocks.library.rest_to_rest.modes import TOLERANCE, TUBE, changes, watched
from brunovsky.blocks.library.rest_to_rest.motion import COMMAND, ETA_MIN, RATE, SPEEDS
from brunovsky.blocks.library.rest_to_rest.path import Pose
from brunovsky.blocks.library.rest_to_rest.plan import BRAKING, MOVING, PATH, PLAN, TURN
from brunovsky.blocks.library.rest_to_rest.reference import Reference
from brunovsky.blocks.library.rest_to_rest.search import CHEAPER, SEARCH, search_transitions
from brunovsky.blocks.library.rest_to_rest.timing import Limits
from brunovsky.blocks.library.robot import robot, robot_linearization
from brunovsky.blocks.variables import (
    Input,
    Mode,
    Output,
    Parameter,
    State,
    Transition,
    described,
    symbol,
    symbols,
)

GOAL = (
    Input("goal[1]", "m", "goal, x"),
    Input("goal[2]", "m", "goal, y"),
    Input("goal_heading", "rad", "heading at the goal"),
)
ROBOT = tuple(Input(**described(one)) for one in robot().outputs)
"""Posture and velocities of the robot."""
COMMANDS = robot().inputs[:2]
"""Its accelerations."""
_LIMITS = (
    Parameter("speed_limit", "m/s", "largest forward speed", 1.5, 0.0, tunable=True),
    Parameter("u_limit[1]", "m/s2", "largest forward acceleration", 2.0, 0.0, tunable=True),
    Parameter("u_limit[2]", "rad/s2", "largest yaw acceleration", 30.0, 0.0, tunable=True),
)
_RESERVE = Parameter("reserve", "1", "part of u_limit that plans leave to the law and to disturbances",
                     0.4, 0.0, 0.9, tunable=True)  # fmt: skip
_OBSERVER = Parameter("observer_rate", "1/s", "rate of the observer of disturbances", 20.0, 0.0, tunable=True)
_MODES = (
    Mode("mode", "1", "0 at rest, 1 moving, 2 braking"),
    Mode("leg", "1", "0 a turn in place, 1 a path, 2 a reference"),
    Mode("search", "1", "step of the search for a plan, 0 if there is none"),
    Mode("choice", "1", "manoeuvre chosen so far"),
    Mode("carry", "1", "1 where the path timed before is driven after this one"),
    Mode("awake", "1", "1 after the first instant"),
)


@cache
def supervisor(tracking: bool = False) -> Block:
    """Supervisor of :func:`regulator` or :func:`tracker`: everything but the outer loop, and but the reference.

    Parameters
    ----------
    tracking : bool
        Whether the goal is the pose of a reference, which is tracked from there.

    Returns
    -------
    Block
        Inputs the goal, or the reference by its own clock, the robot's state and ``v[1..2]``; outputs ``u[1..2]``,
        ``mode``, the chains ``Z1[k]``, ``Z2[k]`` and their reference ``Z1d[k]``, ``Z2d[k]``, ``zd3[i]``.
    """
    mode, leg, awake = symbols("mode", "leg", "awake")
    here, goal = Pose(*(one.symbol for one in ROBOT[:3])), Pose(*(one.symbol for one in GOAL))
    limits = Limits(*(one.symbol for one in _LIMITS)).planned(_RESERVE.symbol)
    target = reference_target() if tracking else Target(GOAL)
    path = motion.following(here.heading, target.course.reference if target.course else None)
    watch = watched(here, goal, path)
    away = sp.Or(watch["beside"].symbol, watch["beyond"].symbol)
    on_path = sp.And(sp.Eq(mode, MOVING), sp.Eq(leg, PATH))
    tracks = sp.And(sp.Eq(mode, MOVING), sp.Ne(leg, TURN))
    wanted = [
        sp.Piecewise((turn, sp.And(sp.Eq(mode, MOVING), sp.Eq(leg, TURN))), (follow, sp.Eq(mode, MOVING)),
                     (brake, sp.Eq(mode, BRAKING)), (rest, True))
        for turn, follow, brake, rest in zip(
            motion.turning(here), path.accelerations, motion.braking(),
            motion.resting(here, goal, away, watch["askew"].symbol), strict=True)
    ]  # fmt: skip
    undisturbed = symbols("xi[1]", "xi[2]")
    disturbance = [_OBSERVER.symbol * (one - free) for one, free in zip(SPEEDS, undisturbed, strict=True)]
    return Block(
        "supervisor",
        "planner, modes, reference and inner loop of the regulator",
        inputs=(*target.inputs, *ROBOT, *(Input(f"v[{i}]", "m/s3", f"input of chain {i}") for i in (1, 2))),
        parameters=(*_LIMITS, _RESERVE, TOLERANCE, TUBE, RATE, _OBSERVER, ETA_MIN, *target.parameters),
        states=(
            State("path_parameter", "1", "path parameter of the reference",
                  sp.Piecewise((path.reference.parameter_rate, on_path), (0, True))),
            State(str(COMMAND), "m/s2", "compensator: commanded forward acceleration",
                  sp.Piecewise((path.jerk, tracks), (0, True))),
            *target.states,
            State("xi[1]", "m/s", "forward velocity without disturbance", wanted[0]),
            State("xi[2]", "rad/s", "yaw rate without disturbance", wanted[1]),
        ),
        samples=(*PLAN, *SEARCH, *target.samples),
        modes=(*_MODES, *target.modes),
        outputs=(
            *(Output(**described(one), expression=asked - disturbed)
              for one, asked, disturbed in zip(COMMANDS, wanted, disturbance, strict=True)),
            Output("mode", "1", "0 at rest, 1 moving, 2 braking", mode),
            *target.outputs,
            *_chain_outputs(path.reference),
        ),
        relations=(*watch.values(), CHEAPER, *motion.relations(), *target.relations),
        transitions=(
            Transition("wake", sp.Eq(awake, 0), {awake: sp.S.One, **dict(zip(undisturbed, SPEEDS, strict=True)),
                                                 **target.wake}),
            *changes(here, goal, limits, watch, target),
            *search_transitions(candidates(here, goal, limits), here, goal, limits),
        ),
        checks=feasibility(Limits(*(one.symbol for one in _LIMITS)), limits, _OBSERVER.symbol),
    )  # fmt: skip


def _chain_outputs(reference: Reference) -> list[Output]:
    """Chains under the commanded acceleration, and their reference."""
    chains = [[one.xreplace({symbol("u[1]"): COMMAND}) for one in chain] for chain in robot_linearization().chains]
    wanted: Sequence[sp.Matrix] = (reference.position, *reference.derivatives)
    elements = [(i, k, ROBOT_CHAINS.unit(i, k - 1)) for i in (1, 2) for k in (1, 2, 3)]
    return [
        *(Output(f"Z{i}[{k}]", unit, f"chain {i}, element {k}", chains[i - 1][k - 1]) for i, k, unit in elements),
        *(Output(f"Z{i}d[{k}]", unit, f"reference of chain {i}, element {k}", wanted[k - 1][i - 1])
          for i, k, unit in elements),
        *(Output(f"zd3[{i}]", ROBOT_CHAINS.unit(i, 3), f"third derivative of the reference of chain {i}",
                 wanted[3][i - 1]) for i in (1, 2)),
    ]  # fmt: skip
