"""How figures look and how they become text: styles that survive grey printing, thinning of traces, SVG."""

from __future__ import annotations

import io
import itertools
import re
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.ticker import FixedFormatter, FixedLocator, FuncFormatter, LogLocator, NullFormatter, NullLocator

from brunovsky.comparison.facts import power_of_ten
from brunovsky.comparison.metrics import Array

SETTINGS: Any = {
    "svg.hashsalt": "brunovsky",
    "svg.fonttype": "path",
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.labelsize": 9.0,
    "legend.fontsize": 8.5,
    "axes.grid": True,
    "grid.color": "#dcdcdc",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "path.simplify": True,
    "path.simplify_threshold": 0.2,
}
BINS = 500  # of the thinning; two values a bin
_USES = re.compile(r'(xlink:href="#|url\(#)([^")]*)')
_DECIMALS = re.compile(r"-?\d+\.\d{3,}")
_PATHS, _PLACES = re.compile(r' d="[^"]*"'), re.compile(r"<use [^>]*>")
_COMMANDS = re.compile(r"\s*([MLQCz])\s*")  # of a path, each on a line of its own in what matplotlib writes
_MARKERS = ("o", "s", "^", "D", "v", "P", "X")
_INCH, _CHARACTER, _HANDLE = 72.0, 5.1, 40.0  # points: of a letter in a legend, and of the line before each entry
_WIDE = 3.0  # points; lines from there on are light, and lie at the back
_FEW = 1e3  # ratio of the ends of a logarithmic axis with few powers of ten
_FEWER = 1e2
LARGEST = 1e12  # what a run that diverged is drawn up to


@dataclass(frozen=True)
class Style:
    """Line of one law: the widest and lightest lies at the back, so that coinciding lines all show."""

    color: str
    width: float
    dash: Any
    order: float


# Luminances differ by at least 20 %, so that the styles are told apart in grey as well.
STYLES = (
    Style("#0b3c6f", 1.5, "solid", 3.0),
    Style("#d4610a", 1.5, (0, (4, 2)), 4.0),
    Style("#c3cbd1", 4.0, "solid", 2.0),
    Style("#2f8f5b", 1.6, (0, (1, 1.2)), 5.0),
    Style("#7a3b8f", 1.3, (0, (6, 2, 1, 2)), 6.0),
    Style("#000000", 0.9, (0, (8, 3)), 7.0),
)
REFERENCE: dict[str, Any] = {"color": "#000000", "linewidth": 0.8, "linestyle": (0, (1, 2)), "zorder": 5.5}


def style(index: int) -> dict[str, Any]:
    """Line properties of the law with this index in the study; beyond the styles, the dark ones in rows of dots."""
    turn, place = divmod(index, len(STYLES))
    one = STYLES[place]
    if turn:
        dots = (0, (3, 1, *(1, 1) * (turn + place % 2)))
        color = marker_color(place)
        return {"color": color, "linewidth": 1.2, "linestyle": dots, "zorder": one.order + 5.0 * turn}
    return {"color": one.color, "linewidth": one.width, "linestyle": one.dash, "zorder": one.order}


def marks(index: int, points: int = 1) -> dict[str, Any]:
    """A few markers along a line of so many points, for laws beyond the styles, which no dash would tell apart."""
    if index < len(STYLES):
        return {}
    apart = max(points // 6, 1)
    look = {"marker": _MARKERS[index % len(_MARKERS)], "markersize": 4.5, "markerfacecolor": "#ffffff"}
    return {**look, "markevery": (int(0.37 * index % 1.0 * apart), apart)}


def legend_columns(labels: Sequence[str], width: float, most: int) -> int:
    """Largest number of columns, up to `most`, in which a legend fits a figure of this width (inches)."""
    for columns in range(min(most, len(labels)), 1, -1):
        rows = -(-len(labels) // columns)
        widest = [max(map(len, labels[k : k + rows])) for k in range(0, len(labels), rows)]
        if sum(_CHARACTER * one + _HANDLE for one in widest) <= _INCH * width:
            return columns
    return 1


def marker_color(index: int) -> str:
    """Colour of the markers of the series with this index: those of the styles, less the one too light for a marker."""
    colors = [one.color for one in STYLES if one.width < _WIDE]
    return colors[index % len(colors)]


def thinned(time: Array, signal: Array, bins: int = BINS) -> tuple[Array, Array]:
    """Smallest and largest value of each of `bins` stretches of a trace, in their order, so that no peak is lost."""
    signal = np.clip(signal, -LARGEST, LARGEST)
    if time.size <= 2 * bins:
        return time, signal
    edges = np.linspace(0, time.size, bins + 1).astype(int)
    keep: list[int] = [0]
    for begin, end in itertools.pairwise(edges):
        part = signal[begin:end]
        keep.extend(sorted((begin + int(np.argmin(part)), begin + int(np.argmax(part)))))
    keep.append(time.size - 1)
    index = np.unique(keep)
    return time[index], signal[index]


def new_figure(width: float, height: float, **layout: Any) -> Figure:
    """Figure of this size in inches, without global state; without a layout it is arranged to fit its texts."""
    figure = Figure(figsize=(width, height), layout=None if layout else "constrained")
    if layout:
        figure.subplots_adjust(**layout)
    return figure


def limit_decades(axes: Axes, lowest: float, highest: float, most: int = 6) -> None:
    """Logarithmic axis from one power of ten to another, with at most `most` labels."""
    low, high = int(np.floor(np.log10(lowest))), int(np.ceil(np.log10(highest)))
    high = max(high, low + 1)
    step = -(-(high - low) // most)
    axes.set_yscale("log")
    axes.set_ylim(10.0**low, 10.0**high)
    _set_ticks(axes.yaxis, [10.0**k for k in range(high, low - 1, -step)])


def signed_decades(axes: Axes, linear: float, at_least: float, most: int = 2) -> None:
    """Vertical axis about zero for what is drawn: logarithmic on both sides beyond `linear`, or linear if that will do.

    Parameters
    ----------
    axes : Axes
        With its lines.
    linear : float
        A power of ten; up to it the axis is linear.
    at_least : float
        Half-width that is shown in any case, unless what is drawn lies between a thousandth and a fifth of it.
    most : int
        Number of labels on each side of a logarithmic axis.
    """
    drawn = [np.asarray(line.get_ydata(), dtype=float) for line in axes.get_lines()]
    peak = max((float(np.max(np.abs(one))) for one in drawn if one.size), default=0.0)
    if 1e-3 * at_least <= peak < 0.2 * at_least:
        axes.set_ylim(-1.2 * peak, 1.2 * peak)
        axes.ticklabel_format(axis="y", scilimits=(-5, 5))
        return
    signed_scale(axes, "y", linear, max(at_least, peak), most)


def signed_scale(axes: Axes, which: str, linear: float, peak: float, most: int = 2) -> None:
    """The same for the axis "x" or "y" and what reaches up to `peak`."""
    axis, limit = (axes.xaxis, axes.set_xlim) if which == "x" else (axes.yaxis, axes.set_ylim)
    low, high = round(np.log10(linear)), int(np.ceil(np.log10(peak)))
    if high - low <= 1:
        limit(-1.2 * peak, 1.2 * peak)
        return
    step = -(-(high - low) // most)
    ticks = [10.0**k for k in range(high, low, -step)]
    (axes.set_xscale if which == "x" else axes.set_yscale)("symlog", linthresh=10.0**low, linscale=0.6)
    limit(-(10.0**high), 10.0**high)
    _set_ticks(axis, [*(-tick for tick in ticks), 0.0, *reversed(ticks)])


def plain_decades(figure: Figure) -> None:
    """Plain text at the ticks of all logarithmic axes; between powers of ten only where there are few of these."""
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            if axis.get_scale() != "log":
                continue
            low, high = sorted(axis.get_view_interval())
            axis.set_major_formatter(FuncFormatter(lambda value, _: power_of_ten(value)))
            few = high < _FEW * low
            axis.set_minor_formatter(FuncFormatter(lambda value, _: _short(value)) if few else NullFormatter())
            if few:
                axis.set_minor_locator(LogLocator(subs=(2.0, 5.0) if high < _FEWER * low else (3.0,)))


def _short(value: float) -> str:
    """A multiple of a power of ten, as the label of an axis."""
    if 1e-3 <= value < 1e4:
        return f"{value:g}"
    power = 10.0 ** np.floor(np.log10(value))
    return f"{value / power:.3g}×{power_of_ten(power)}"


def _set_ticks(axis: Axis, ticks: list[float]) -> None:
    """Ticks at powers of ten, as plain text: typeset ones take most of the time of a figure."""
    axis.set_major_locator(FixedLocator(ticks))
    axis.set_major_formatter(FixedFormatter([power_of_ten(one) for one in ticks]))
    axis.set_minor_locator(NullLocator())


def settings() -> Any:
    """Context in which figures are made and written."""
    return matplotlib.rc_context(SETTINGS)


def svg(figure: Figure, key: str, title: str = "") -> str:
    """Figure as an SVG element whose ids begin with `key`, the same bytes for the same figure.

    Parameters
    ----------
    figure : Figure
        Lengths in it are rounded to a hundredth of a point.
    key : str
        Of its own on the page.
    title : str
        What a screen reader says of it.
    """
    buffer = io.StringIO()
    write: Any = FigureCanvasSVG(figure).print_svg
    write(buffer, metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>\s*", "", text, flags=re.DOTALL)
    text = re.sub(r' xmlns:(?:cc|dc|rdf)="[^"]*"', "", text)
    text = _only_used_ids(re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL), key)
    text = _PATHS.sub(lambda path: _COMMANDS.sub(r"\1", _DECIMALS.sub(_rounded, path[0])), text)
    text = _PLACES.sub(lambda use: _DECIMALS.sub(_rounded, use[0]), text)
    text = re.sub(r"\n\s*", "\n", text)
    return described(text.strip(), title) if title else text.strip()


def described(text: str, title: str) -> str:
    """SVG element with what a screen reader says of it, unless it says something already."""
    opening = text[: text.index(">")]
    return text if "aria-label" in opening else text.replace("<svg", f'<svg role="img" aria-label="{escape(title)}"', 1)


def _only_used_ids(text: str, key: str) -> str:
    """SVG without the ids that nothing in it refers to; the others are numbered."""
    used = {one: f"{key}.{k}" for k, one in enumerate(dict.fromkeys(name for _, name in _USES.findall(text)), 1)}
    text = re.sub(r' id="([^"]*)"', lambda one: f' id="{used[one[1]]}"' if one[1] in used else "", text)
    return _USES.sub(lambda one: one[1] + used[one[2]], text)


def _rounded(match: re.Match[str]) -> str:
    return f"{float(match[0]):.2f}".rstrip("0").rstrip(".")
