"""What the folder's own figures share with python-control's: axes on demand, and the object they return."""

from collections.abc import Sequence
from typing import Any

import control
import numpy as np
from matplotlib import pyplot

DASHES: tuple[Any, ...] = ("solid", (0, (4, 2)), (0, (1, 1.2)), (0, (6, 2, 1, 2)))
COLORS = ("#0b3c6f", "#d4610a", "#2f8f5b", "#7a3b8f")  # of different luminance, so that they differ in grey as well


def new_axes(ax: Any, rows: int = 1, *, size: tuple[float, float] = (6.4, 4.0)) -> np.ndarray[Any, np.dtype[Any]]:
    """Axes to draw on, shape (rows, 1): those given, or those of a new figure that share their horizontal axis."""
    if ax is not None:
        return np.asarray(ax, dtype=object).reshape(rows, 1)
    return np.asarray(pyplot.subplots(rows, 1, sharex=True, squeeze=False, layout="constrained", figsize=size)[1])


def line_style(index: int) -> dict[str, Any]:
    """Line properties of the curve with this index."""
    return {"linestyle": DASHES[index % len(DASHES)], "color": COLORS[index % len(COLORS)]}


def control_plot(axes: np.ndarray[Any, np.dtype[Any]], lines: Sequence[list[Any]]) -> control.ControlPlot:
    """Lines of each of the axes, shape (rows, 1), as python-control returns them."""
    drawn = np.empty(axes.shape, dtype=object)
    for row, found in enumerate(lines):
        drawn[row, 0] = found
    return control.ControlPlot(drawn, axes, axes[0, 0].figure)
