"""The tracker of a reference from rest, and its closed loop with the bare robot."""

from __future__ import annotations

from brunovsky.blocks.block import Block
from brunovsky.blocks.diagram import Diagram
from brunovsky.blocks.library.references import circle
from brunovsky.blocks.library.rest_to_rest.course import ELAPSED, course
from brunovsky.blocks.library.rest_to_rest.follow import COURSE_INPUTS
from brunovsky.blocks.library.rest_to_rest.regulator import bare_robot_loop, with_outer_loop
from brunovsky.blocks.library.rest_to_rest.supervisor import COMMANDS, ROBOT, supervisor

_SHOWN = ("Z1d[1]", "Z2d[1]")
"""Outputs that say where the reference stands."""


def tracker(reference: Block | None = None, law: Block | None = None) -> Diagram:
    """Controller of the bare robot that tracks a reference from rest anywhere.
    """
    given = course(circle() if reference is None else reference)
    parts = with_outer_loop(supervisor(tracking=True), law)
    parts["components"] = {"reference": given, **parts["components"]}
    parts["connections"] |= {f"supervisor.{one.name}": one.name.replace("course", "reference") for one in COURSE_INPUTS}
    parts["connections"][f"reference.{ELAPSED.name}"] = f"supervisor.{ELAPSED.name}"
    taken = {*parts["parameters"], *(one.name for one in (*ROBOT, *COMMANDS))}
    own = {one.name if one.name not in taken else f"reference.{one.name}": f"reference.{one.name}"
           for one in given.parameters}  # fmt: skip
    parts["parameters"] = own | parts["parameters"]
    return Diagram(
        "tracker",
        f"tracker of a reference ({given.name}) from rest: planner, supervisor, outer and inner loop of the bare robot",
        inputs={one.name: f"supervisor.{one.name}" for one in ROBOT},
        outputs={
            **{one.name: f"supervisor.{one.name}" for one in COMMANDS},
            "mode": "supervisor.mode",
            ELAPSED.name: f"supervisor.{ELAPSED.name}",
            **{one: f"reference.{one}" for one in _SHOWN},
        },
        **parts,
    )


def rest_to_trajectory(reference: Block | None = None, *, controller: Block | None = None) -> Diagram:
    """Closed loop"""
    control = tracker(reference) if controller is None else controller
    return Diagram(
        "rest_to_trajectory",
        "robot that drives from rest to a reference and tracks it",
        **bare_robot_loop("tracker", control, ("mode", ELAPSED.name, *_SHOWN), {}, {}),
    )
