"""The relatives of the paper's law that its introduction names, as comparators on the same robot.

Three act on ``v`` of the linearised robot and go into :func:`~brunovsky.blocks.closed_loop`; two act on the
accelerations ``u`` of the bare robot and go into :func:`posture_loop`. Every docstring says where its law comes from,
and where the exact law of the source could not be had.
"""

from brunovsky.blocks.library.relatives.backstepping import backstepping
from brunovsky.blocks.library.relatives.flat_sliding_mode import flat_sliding_mode
from brunovsky.blocks.library.relatives.polar_sliding_mode import polar_sliding_mode
from brunovsky.blocks.library.relatives.posture import posture_reference
from brunovsky.blocks.library.relatives.posture_loop import posture_loop
from brunovsky.blocks.library.relatives.second_order_sliding_mode import second_order_sliding_mode
from brunovsky.blocks.library.relatives.sliding_sector import sliding_sector

__all__ = [
    "backstepping",
    "flat_sliding_mode",
    "polar_sliding_mode",
    "posture_loop",
    "posture_reference",
    "second_order_sliding_mode",
    "sliding_sector",
]
