"""The icon of an FMU, drawn from the interface of its block: inputs on the left, outputs on the right."""

from __future__ import annotations

import io
import re
from collections.abc import Iterable, Sequence
from functools import lru_cache

from PIL import Image, ImageDraw, ImageFont

from brunovsky.blocks import Block

_SCALE = 2  # pixels
_ROW, _MARGIN, _GAP, _ARROW = 16 * _SCALE, 10 * _SCALE, 24 * _SCALE, 10 * _SCALE
_MOST = 12  # rows; an icon is small
_INK, _PAPER, _ACCENT = "#1f2d3d", "#ffffff", "#2f6f9f"
_COLOURS = 32  # enough for smooth letters, in a third of the bytes


@lru_cache(maxsize=64)
def icon(block: Block) -> bytes:
    """PNG of the icon: the block's name over its ports, the elements of one array in one line.

    Returns
    -------
    bytes
        The same for equal interfaces and one version of Pillow.
    """
    left, right = _ports(one.name for one in block.inputs), _ports(one.name for one in block.outputs)
    text, title = ImageFont.load_default(11 * _SCALE), ImageFont.load_default(13 * _SCALE)
    widths = [max((round(text.getlength(one)) for one in side), default=0) for side in (left, right)]
    inside = max(sum(widths) + _GAP, round(title.getlength(block.name))) + 2 * _MARGIN
    width = inside + 2 * _ARROW
    top = _MARGIN + _ROW + _MARGIN // 2
    height = top + max(len(left), len(right), 1) * _ROW + _MARGIN
    image = Image.new("RGBA", (width + 1, height + 1), (255, 255, 255, 0))
    draw = ImageDraw.Draw(image)
    frame = (_ARROW, 0, _ARROW + inside, height)
    draw.rounded_rectangle(frame, 4 * _SCALE, fill=_PAPER, outline=_ACCENT, width=_SCALE)
    draw.text((width // 2, _MARGIN), block.name, fill=_ACCENT, font=title, anchor="mt")
    for side, start, anchor, place in (
        (left, 0, "lm", _ARROW + _MARGIN),
        (right, _ARROW + inside, "rm", _ARROW + inside - _MARGIN),
    ):
        for row, label in enumerate(side):
            middle = top + row * _ROW + _ROW // 2
            half = 3 * _SCALE
            draw.polygon([(start, middle - half), (start + _ARROW, middle), (start, middle + half)], fill=_ACCENT)
            draw.text((place, middle), label, fill=_INK, font=text, anchor=anchor)
    stream = io.BytesIO()
    few = image.quantize(_COLOURS, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    few.save(stream, "PNG", optimize=True)
    return stream.getvalue()


def _ports(names: Iterable[str]) -> Sequence[str]:
    """Names without indices, each once; the last row stands for those that have no room."""
    ports = list(dict.fromkeys(re.sub(r"\[[\d,]+\]$", "", one) for one in names))
    return ports if len(ports) <= _MOST else [*ports[: _MOST - 1], "..."]
