"""From rest to a resting goal by poles placed in the goal's frame, the way before planning: a comparison."""

from brunovsky.blocks.library.goal_frame.law import goal_frame_law
from brunovsky.blocks.library.goal_frame.manoeuvre import goal_frame_manoeuvre

__all__ = ["goal_frame_law", "goal_frame_manoeuvre"]
