"""A curve of a plane without the strokes that cover nothing new."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from brunovsky.comparison.metrics import Array

_INCH = 72.0  # points
_GRID = 216.0  # positions an inch that are told apart in a phase portrait
_CELL = 0.75  # points; half of a line's width
_JUST = 3.0 * _CELL  # along the curve
_FRAME = 20.0  # pixels about the axes, beyond which nothing is told apart
_AT_ONCE = 2_000_000  # cells


def drawn_once(axes: Axes, x: Array, y: Array) -> tuple[Array, Array]:
    """A curve of a plane on axes with their final limits, without the strokes that only repeat what earlier ones cover.

    A stroke joins two points of a grid with a width of a third of a point (1/72 inch). One is left out, and the curve
    broken by not-a-number, if each cell of three quarters of a point through which it leads has been drawn in before,
    so that a region that is covered densely costs as many strokes as fill it, not as many as the run has steps.
    """
    axes.get_xlim(), axes.get_ylim()  # limits that follow from what was drawn are set when they are asked for
    if not x.size:
        return x, y
    frame = np.array(axes.bbox.extents) + _FRAME * np.array([-1.0, -1.0, 1.0, 1.0])
    points = np.clip(axes.transData.transform(np.column_stack((x, y))), frame[:2], frame[2:]) * (
        _INCH / axes.figure.dpi
    )
    cells = np.round(points * (_GRID / _INCH)).astype(np.int64)
    moved = np.concatenate(([True], np.any(cells[1:] != cells[:-1], axis=1)))
    points, x, y = points[moved], x[moved], y[moved]
    gap = np.array([np.nan])
    xs, ys = [x[:1]], [y[:1]]
    for begin, end in _stretches(_covers(points)):
        xs += [gap, x[begin : end + 1]]
        ys += [gap, y[begin : end + 1]]
    return np.concatenate(xs), np.concatenate(ys)


def _covers(points: Array) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Which strokes between successive points (1/72 inch) lead through a cell that none before them did.

    What was drawn just before along the curve does not count, so that a curve isn't broken at each cell.
    """
    lengths = np.hypot(*np.diff(points, axis=0).T)
    way = np.concatenate(([0.0], np.cumsum(lengths)))
    lowest = np.min(points, axis=0)
    columns = int((np.max(points[:, 1]) - lowest[1]) / _CELL) + 2
    rows = int((np.max(points[:, 0]) - lowest[0]) / _CELL) + 2
    reached = np.full(rows * columns, np.inf)  # how far along the curve each cell was first drawn in
    keep = np.zeros(lengths.size, dtype=bool)
    counts = np.ceil(lengths / _CELL).astype(np.int64) + 1
    for begin, end in _portions(counts):
        stroke = np.repeat(np.arange(begin, end), counts[begin:end])
        first = np.repeat(np.cumsum(counts[begin:end]) - counts[begin:end], counts[begin:end])
        share = (np.arange(stroke.size) - first) / (counts[stroke] - 1).clip(1)
        place = points[stroke] + share[:, np.newaxis] * (points[stroke + 1] - points[stroke])
        row, column = ((place - lowest) / _CELL).astype(np.int64).T
        cell, far = row * columns + column, way[stroke] + share * lengths[stroke]
        np.minimum.at(reached, cell, far)
        keep[stroke[far - reached[cell] <= _JUST]] = True
    return keep


def _portions(counts: np.ndarray[Any, np.dtype[np.int64]]) -> Iterator[tuple[int, int]]:
    """Begin and end of successive stretches with a bounded sum of counts each, unless one alone exceeds it."""
    part = np.cumsum(counts) // _AT_ONCE
    edges = np.flatnonzero(np.diff(part, prepend=-1))
    yield from itertools.pairwise([*edges.tolist(), counts.size])


def _stretches(keep: Any) -> list[tuple[int, int]]:
    """Begin and end of each run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], keep.astype(int), [0]))))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]
