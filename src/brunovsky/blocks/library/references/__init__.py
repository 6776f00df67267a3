"""References for chains, differentiated symbolically as often as the chains are long."""

from brunovsky.blocks.library.references.circle import circle
from brunovsky.blocks.library.references.lemniscate import lemniscate
from brunovsky.blocks.library.references.line import line
from brunovsky.blocks.library.references.polynomial import polynomial
from brunovsky.blocks.library.references.preview import preview
from brunovsky.blocks.library.references.set_point import set_point
from brunovsky.blocks.library.references.waypoints import waypoints

__all__ = ["circle", "lemniscate", "line", "polynomial", "preview", "set_point", "waypoints"]
