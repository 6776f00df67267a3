"""References for chains, differentiated symbolically as often as the chains are long."""

from brunovsky.blocks.library.references.circle import circle
from brunovsky.blocks.library.references.line import line
from brunovsky.blocks.library.references.preview import preview
from brunovsky.blocks.library.references.set_point import set_point

__all__ = ["circle", "line", "preview", "set_point"]
