"""From rest to rest, with heading: a path and its time, a supervisor with modes, and the closed loop with the robot.

The flat outputs see neither a robot that turns in place nor the heading of one that rests, so that a supervisor plans
from rest to rest and hands the chains a reference that starts and stops regularly.
"""

from brunovsky.blocks.library.rest_to_rest.regulator import regulator, rest_to_rest
from brunovsky.blocks.library.rest_to_rest.tracker import rest_to_trajectory, tracker

__all__ = ["regulator", "rest_to_rest", "rest_to_trajectory", "tracker"]
