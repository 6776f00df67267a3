"""The tracker of a reference from rest, and its closed loop with the bare robot."""

from __future__ import annotations

from brunovsky.blocks.block import Block
from brunovsky.blocks.diagram import Diagram
from brunovsky.blocks.library.references import circle
from brunovsky.blocks.library.rest_to_rest.course import CLOCK, course
from brunovsky.blocks.library.rest_to_rest.follow import COURSE_INPUTS
from brunovsky.blocks.library.rest_to_rest.regulator import bare_robot_loop, with_outer_loop
from brunovsky.blocks.library.rest_to_rest.supervisor import COMMANDS, ROBOT, supervisor
from brunovsky.errors import ModelError

_SHOWN = ("mode", "elapsed", "pace", "reference[1]", "reference[2]")


def tracker(reference: Block | None = None, law: Block | None = None) -> Diagram:
    """Controller of the bare robot that drives it from rest anywhere to a reference, and tracks it.

    The supervisor is that of :func:`regulator`. Its goal is the pose of the reference where it begins, position and
    direction of motion: from there the reference is tracked by a clock of its own, which starts from rest
    as every leg does, so that the start is regular, and stands while the robot is elsewhere. Where the error leaves
    the tube, or the robot is turned away, it brakes and goes back to where the reference stands. A reference that comes
    to rest ends in ``mode`` 0, where its last pose is held.

    Limits are respected by scaling time: before, the reference is examined at 300 points, over ``horizon`` where it
    has no end, and the rate of the clock, ``pace``, is 1 where its speed and accelerations let it, less elsewhere. The
    clock needs some time more for its rise from rest, and for its fall where the reference ends.

    Parameters
    ----------
    reference : Block, optional
        A function of time for the robot's chains, such as :func:`circle`, the default, :func:`lemniscate`,
        :func:`line`, :func:`polynomial` or :func:`waypoints`. It begins at t = 0, or where it leaves rest later.
    law : Block, optional
        Outer loop, as for :func:`regulator`.

    Returns
    -------
    Diagram
        Inputs the robot's ``x``, ``y``, ``theta``, ``eta[1..2]``; outputs ``u[1..2]`` (m/s2, rad/s2), ``mode`` (0 at
        rest, 1 moving, 2 braking), ``elapsed`` (s), ``pace`` (1) and where the reference stands, ``reference[1..2]``
        (m). Parameters: those of the reference (``reference.NAME`` where the regulator has the same name),
        of :func:`regulator`, and ``horizon`` (s).

    Raises
    ------
    ModelError
        If the reference is no function of time, rests for ever (as :func:`set_point` does: that is the regulator's
        goal), or switches at times that are not given; if `law` is not for the robot's chains.
    ParameterError
        At the start, where a limit is not positive or the reference does not move; the message has the reason.

    References
    ----------
    Scaling in time to limits: J. M. Hollerbach, "Dynamic scaling of manipulator trajectories", J. Dyn. Sys., Meas.,
    Control 106(1), 102-106, 1984.
    """
    given = course(circle() if reference is None else reference)
    parts = with_outer_loop(supervisor(tracking=True), law)
    taken = {*parts["parameters"], *(one.name for one in (*ROBOT, *COMMANDS))}
    parameters = {f"reference.{one.name}" if one.name in taken else one.name: f"reference.{one.name}"
                  for one in given.parameters}  # fmt: skip
    parts["components"] = {"reference": given, **parts["components"]}
    parts["parameters"] = parameters | parts["parameters"]
    parts["connections"] |= {f"supervisor.{one.name}": one.name.replace("course", "reference") for one in COURSE_INPUTS}
    parts["connections"][f"reference.{CLOCK.name}"] = f"supervisor.{CLOCK.name}"
    outputs = {one: f"supervisor.{one}" for one in (*(one.name for one in COMMANDS), *_SHOWN)}
    return Diagram(
        "tracker",
        f"tracker of the bare robot from rest for the reference {given.name}: supervisor, outer and inner loop",
        inputs={one.name: f"supervisor.{one.name}" for one in ROBOT},
        outputs=outputs,
        **parts,
    )


def rest_to_trajectory(reference: Block | None = None, *, tracker_block: Block | None = None) -> Diagram:
    """Closed loop of :func:`tracker` and the bare robot.

    Parameters
    ----------
    reference : Block, optional
        What is tracked; :func:`circle` by default.
    tracker_block : Block, optional
        A tracker with another law, instead of a reference.

    Returns
    -------
    Diagram
        Inputs ``d[1..2]``; outputs ``x``, ``y``, ``theta``, ``eta[1..2]`` and those of the tracker. Parameters
        ``x_start``, ``y_start``, ``theta_start``, ``eta_start[1..2]``, those of the tracker, and ``rho[1..2]``.

    Raises
    ------
    ModelError
        If both are given, or as :func:`tracker` does.
    """
    if reference is not None and tracker_block is not None:
        raise ModelError("rest_to_trajectory takes a reference or a tracker, which has its own, not both; give one")
    control = tracker(reference) if tracker_block is None else tracker_block
    return Diagram(
        "rest_to_trajectory",
        "robot that drives from rest to a reference and tracks it",
        **bare_robot_loop("tracker", control, _SHOWN, {}, {}),
    )
