"""Where components, connectors and lines are drawn: signals run from left to right, feedback below.

A component stands in the column after those that drive it. Lines that close a loop do not count where they leave a
state, since a loop has at least one such line. Lines between components are orthogonal, each on a track of its own;
those to connectors of the system are straight.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter

from brunovsky.fmi.ssp.wiring import SYSTEM, Port, Wire, Wiring

PITCH, WIDTH, MARGIN = 5.0, 60.0, 10.0
_Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class Geometry:
    """Coordinates, with y upwards.

    Parameters
    ----------
    boxes : mapping of str to (x1, y1, x2, y2)
        Lower left and upper right corner of each component.
    connectors : mapping of Port to (x, y)
        Place of each connector within its component, from (0, 0) to (1, 1).
    routes : tuple of sequences of (x, y)
        Points between the ends of each wire, in the order of the wires; none for a straight one.
    canvas : (x1, y1, x2, y2)
        The system.
    """

    boxes: Mapping[str, _Box]
    connectors: Mapping[Port, tuple[float, float]]
    routes: tuple[tuple[tuple[float, float], ...], ...]
    canvas: _Box


def geometry(plan: Wiring) -> Geometry:
    """Layout of a system, computed from its wires alone."""
    names = [one for one in plan.connectors if one != SYSTEM]
    columns = _columns(names, plan.wires)
    kinds = [_kind(one, columns) for one in plan.wires]
    sides = _sides(plan, kinds)
    boxes = _boxes(names, columns, sides, kinds, plan.wires)
    inside = _union(boxes.values())
    loops = MARGIN + PITCH * (1 + kinds.count("back"))
    over = MARGIN + PITCH * (1 + kinds.count("over"))
    canvas = (inside[0] - loops - MARGIN, inside[1] - loops, inside[2] + loops + MARGIN, inside[3] + over)
    connectors = {}
    for (part, right), ports in sides.items():
        box = canvas if part == SYSTEM else boxes[part]
        for index, name in enumerate(ports):
            x = 0.0 if part == SYSTEM and not right else 1.0 if part == SYSTEM else float(right)
            if part == SYSTEM:
                span = inside[3] - inside[1]
                y = inside[3] - span * (index + 0.5) / len(ports)
            else:
                y = box[3] - PITCH * (index + 1)
            connectors[part, name] = (x, (y - box[1]) / (box[3] - box[1]))
    routes = _routes(plan.wires, kinds, boxes | {SYSTEM: canvas}, connectors, inside)
    return Geometry(boxes, connectors, routes, canvas)


def _columns(names: Sequence[str], wires: Sequence[Wire]) -> dict[str, int]:
    """Column of each component: one more than those that drive it, loops cut at states."""
    edges = {(one.source[0], one.target[0]) for one in wires if SYSTEM not in (one.source[0], one.target[0])}
    direct = {(one.source[0], one.target[0]) for one in wires if one.direct}
    reach = {name: {b for a, b in edges if a == name} for name in names}
    for middle in names:
        for name in names:
            if middle in reach[name]:
                reach[name] |= reach[middle]
    forward = {(a, b) for a, b in edges if a != b and (a not in reach[b] or (a, b) in direct)}
    try:
        order = list(TopologicalSorter({name: {a for a, b in forward if b == name} for name in names}).static_order())
    except CycleError:  # direct lines of different variables, both ways: as declared
        order = list(names)
        forward = {(a, b) for a, b in forward if order.index(a) < order.index(b)}
    columns: dict[str, int] = {}
    for name in order:
        columns[name] = max((columns[a] + 1 for a, b in forward if b == name), default=0)
    return columns


def _kind(wire: Wire, columns: Mapping[str, int]) -> str:
    """How a wire is drawn: to the next column, over those between, or back below everything; straight at the system."""
    if SYSTEM in (wire.source[0], wire.target[0]):
        return "system"
    start, end = columns[wire.source[0]], columns[wire.target[0]]
    return "back" if end <= start else "next" if end == start + 1 else "over"


def _sides(plan: Wiring, kinds: Sequence[str]) -> dict[tuple[str, bool], list[str]]:
    """Connectors by component and side (inputs left), from the top: over, next, not connected, back."""
    drawn: dict[Port, str] = {}
    for wire, kind in zip(plan.wires, kinds, strict=True):
        drawn.setdefault(wire.source, kind)
        drawn.setdefault(wire.target, kind)
        if kind == "back":
            drawn[wire.source] = drawn[wire.target] = kind
    levels = {"over": 0, "next": 1, "system": 2, "": 2, "back": 3}
    sides: dict[tuple[str, bool], list[str]] = {}
    for part, variables in plan.connectors.items():
        for right in (False, True):
            names = [one.name for one in variables if (one.causality == "output") == right]
            sides[part, right] = sorted(names, key=lambda name: levels[drawn.get((part, name), "")])
    return sides


def _boxes(
    names: Sequence[str],
    columns: Mapping[str, int],
    sides: Mapping[tuple[str, bool], Sequence[str]],
    kinds: Sequence[str],
    wires: Sequence[Wire],
) -> dict[str, _Box]:
    boxes: dict[str, _Box] = {}
    x = 0.0
    for column in range(max(columns.values()) + 1):
        members = [name for name in names if columns[name] == column]
        y = 0.0
        for name in members:
            height = PITCH * (1 + max(len(sides[name, False]), len(sides[name, True]), 2))
            boxes[name] = (x, y - height, x + WIDTH, y)
            y -= height + 2 * MARGIN
        beside = [
            columns.get(one.source[0]) == column or columns.get(one.target[0]) == column + 1
            for one, kind in zip(wires, kinds, strict=True)
            if kind != "system"
        ]
        tracks = sum(beside) + kinds.count("over")
        x += WIDTH + 2 * MARGIN + PITCH * tracks
    return boxes


def _routes(
    wires: Sequence[Wire],
    kinds: Sequence[str],
    boxes: Mapping[str, _Box],
    connectors: Mapping[Port, tuple[float, float]],
    inside: _Box,
) -> tuple[tuple[tuple[float, float], ...], ...]:
    def place(port: Port) -> tuple[float, float]:
        x1, y1, x2, y2 = boxes[port[0]]
        x, y = connectors[port]
        return x1 + x * (x2 - x1), y1 + y * (y2 - y1)

    ends = [(place(one.source), place(one.target)) for one in wires]
    routes: list[tuple[tuple[float, float], ...]] = [()] * len(wires)
    back = sorted((i for i, kind in enumerate(kinds) if kind == "back"), key=lambda i: ends[i][0][1])
    for rank, i in enumerate(back):
        (xs, ys), (xt, yt) = ends[i]
        step = MARGIN + PITCH * rank
        routes[i] = ((xs + step, ys), (xs + step, inside[1] - step), (xt - step, inside[1] - step), (xt - step, yt))
    over = sorted((i for i, kind in enumerate(kinds) if kind == "over"), key=lambda i: -ends[i][0][1])
    for rank, i in enumerate(over):
        (xs, ys), (xt, yt) = ends[i]
        step = MARGIN + PITCH * rank
        routes[i] = ((xs + step, ys), (xs + step, inside[3] + step), (xt - step, inside[3] + step), (xt - step, yt))
    gaps: dict[float, list[int]] = {}
    for i, kind in enumerate(kinds):
        (_, ys), (xt, yt) = ends[i]
        if kind == "next" and abs(ys - yt) > 1e-9:
            gaps.setdefault(ends[i][0][0], []).append(i)
    for members in gaps.values():
        falling = sorted((i for i in members if ends[i][1][1] < ends[i][0][1]), key=lambda i: ends[i][0][1])
        rising = sorted((i for i in members if ends[i][1][1] > ends[i][0][1]), key=lambda i: -ends[i][0][1])
        for rank, i in enumerate((*falling, *rising)):
            (xs, ys), (_, yt) = ends[i]
            x = xs + MARGIN + PITCH * (rank + len(over))
            routes[i] = ((x, ys), (x, yt))
    return tuple(routes)


def _union(boxes: object) -> _Box:
    corners = list(boxes)  # type: ignore[call-overload]
    return (
        min(one[0] for one in corners),
        min(one[1] for one in corners),
        max(one[2] for one in corners),
        max(one[3] for one in corners),
    )
