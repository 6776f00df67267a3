"""The picture of the README: where the robot goes, and what the switching term is good for."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator

from brunovsky.comparison import drawing
from brunovsky.comparison.metrics import instants, position_error, values
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.study import Scenario

_SHADES = ("#0b3c6f", "#d4610a", "#8a9298")  # told apart in grey as well
_DASHES = ("solid", (0, (5, 2)), (0, (1, 1.2)))
_WIDTHS = (1.6, 1.6, 4.5)
_START: dict[str, Any] = {
    "linestyle": "none",
    "marker": "o",
    "markersize": 6.5,
    "markerfacecolor": "#ffffff",
    "zorder": 8.0,
}
_ARROWS = (0.15, 0.45, 0.9, 1.6, 3.0, 5.5, 8.5)  # s; when the heading is drawn
_UNTIL = 4.0  # s; of the error
_SMALLEST = 1e-7  # m; lower end of its axis


def readme_figure(comparison: Comparison) -> str:
    """Paths of figure 6 under sliding mode, and the error under a yaw disturbance for all laws, as a small SVG."""
    circles = [one for one in comparison.study.scenarios if one.figure == "6"]
    disturbed = [one for one in comparison.study.scenarios if "d_2_rad_per_s2" in one.disturbances]
    with drawing.settings():
        figure = drawing.new_figure(9.0, 4.3)
        left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.1))
        _paths(left, comparison, circles)
        _errors(right, comparison, (disturbed or circles)[0])
        text = drawing.svg(figure, "paper")
    return f'<?xml version="1.0" encoding="utf-8"?>\n{text}\n'


def _paths(axes: Axes, comparison: Comparison, scenarios: list[Scenario]) -> None:
    for index, scenario in enumerate(scenarios):
        pairs = comparison.laws_of(scenario)
        run = next((run for law, run in pairs if law.kind != "linear"), pairs[0][1])
        x, y = values(run.trajectory, "x"), values(run.trajectory, "y")
        color = (*_SHADES[:2], "#c3cbd1")[index % 3]
        axes.plot(
            x[::10],
            y[::10],
            color=color,
            linewidth=_WIDTHS[index % 3],
            linestyle="solid" if index == 2 else _DASHES[index % 3],
            zorder=3.0 - (index == 2),
            label=_short(scenario.title),
        )
        axes.plot(x[:1], y[:1], markeredgecolor="#000000" if index == 2 else color, **_START)
        if scenario is not scenarios[-1] or len(scenarios) == 1:
            _headings(axes, run, color)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.06)
    axes.set(xlabel="x, m", ylabel="y, m")
    axes.set_title("paths under sliding mode", loc="left")
    axes.legend(loc="center", frameon=False, handlelength=2.6, bbox_to_anchor=(0.36, 0.395))


def _short(title: str) -> str:
    return title.split(", ")[-1]


def _headings(axes: Axes, run: Run, color: str) -> None:
    """Arrows along the heading at a few instants."""
    time = instants(run.trajectory)
    index = np.unique(np.searchsorted(time, [one for one in _ARROWS if one <= time[-1]]))
    x, y, theta = (values(run.trajectory, name)[index] for name in ("x", "y", "theta"))
    axes.quiver(
        x, y, -np.sin(theta), np.cos(theta), color=color, angles="xy", width=0.006, scale=11.0, headwidth=4.5, zorder=7
    )


def _errors(axes: Axes, comparison: Comparison, scenario: Scenario) -> None:
    for index, (law, run) in enumerate(comparison.laws_of(scenario)):
        time = instants(run.trajectory)
        shown = time <= _UNTIL
        traced = drawing.thinned(time[shown], position_error(run.trajectory)[shown], 300)
        label = law.title or law.name
        axes.plot(*traced, color=_SHADES[index % 3], linewidth=1.6, linestyle=_DASHES[index % 3], label=label)
    axes.set_yscale("log")
    axes.set_ylim(_SMALLEST, 10.0)
    axes.yaxis.set_major_locator(FixedLocator([10.0**k for k in range(-7, 2, 2)]))
    axes.set_xlim(0.0, _UNTIL)
    axes.set(xlabel="time, s", ylabel="position error, m")
    run = comparison.laws_of(scenario)[0][1]
    disturbance = run.planned.inputs["d[2]"]
    under = f", yaw disturbance {disturbance:g} rad/s²" if disturbance else ""
    axes.set_title(f"error{under}, step {comparison.study.step_size_s * 1e3:g} ms", loc="left")
    axes.legend(loc="upper right", frameon=False)
