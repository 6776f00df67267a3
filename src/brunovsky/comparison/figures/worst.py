"""The worst cases of a Monte-Carlo protocol, as paths."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from brunovsky.comparison import drawing
from brunovsky.comparison.figures.traces import END, START
from brunovsky.comparison.metrics import values

_GREYS = ("#000000", "#7a7a7a")
_DASHES: tuple[Any, ...] = ("solid", (0, (5, 2)), (0, (1, 1.2)), (0, (6, 2, 1, 2)), (0, (2, 2)))


class Case(Protocol):
    """A case and what happened in it."""

    @property
    def case(self) -> int:
        """Its number."""

    @property
    def trajectory(self) -> xr.Dataset:
        """``x`` and ``y`` over ``time``."""


def worst_paths_figure(cases: Mapping[str, Sequence[Case]], titles: Mapping[str, str]) -> Figure:
    """Paths of several cases, a panel for each law, on equal scales; each begins at a circle and ends at a cross.

    Parameters
    ----------
    cases : mapping of str to sequence
        The cases of each law, in the order in which they are told.
    titles : mapping of str to str
        Titles of the laws.
    """
    columns = min(len(cases), 2)
    rows = -(-len(cases) // columns)
    figure = drawing.new_figure(9.4, 0.3 + 4.4 * rows)
    panels = np.atleast_1d(figure.subplots(rows, columns)).ravel()
    for axes in panels[len(cases) :]:
        axes.remove()
    for axes, (law, some) in zip(panels, cases.items(), strict=False):
        for index, one in enumerate(some):
            x, y = values(one.trajectory, "x"), values(one.trajectory, "y")
            if not x.size:
                continue
            axes.plot(
                x[:: max(len(x) // 2000, 1)],
                y[:: max(len(x) // 2000, 1)],
                color=_GREYS[index % 2],
                linestyle=_DASHES[index // 2 % len(_DASHES)],
                linewidth=1.2,
                label=f"case {one.case}",
            )
            axes.plot(x[:1], y[:1], **START)
            axes.plot(x[-1:], y[-1:], **END | {"marker": "x"})
        axes.set_aspect("equal", adjustable="datalim")
        axes.set(xlabel="x, m", ylabel="y, m")
        axes.set_title(titles.get(law, law), loc="left")
        axes.legend(frameon=False, fontsize=7, ncols=2)
    return figure
