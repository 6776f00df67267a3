"""The linear part that a switching law closes, against -1/N(A) of its switching element."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import control
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from brunovsky.analysis import LimitCycle, SwitchingLoop, predicted_cycles
from brunovsky.comparison import drawing
from brunovsky.comparison.chain_hardware import chain_hardware, chain_loop
from brunovsky.comparison.facts import given
from brunovsky.comparison.study import Study
from brunovsky.errors import ParameterError

_DENSE, _POINTS = 20_000, 300  # frequencies, and points across a panel that are drawn of them
Curve = np.ndarray[Any, np.dtype[np.complex128]]
_GREYS = ("#5c666e", "#9aa4ab", "#c3cbd1")


@dataclass(frozen=True)
class DescribingFunction:
    """A switching law of a study as the describing function sees it, on one chain, with the hardware of its scenarios.

    Attributes
    ----------
    law, title : str
        Its name, and its title for people.
    hardware : str
        What stands at v, in words.
    scenarios : tuple of str
        Where it is so.
    loop : SwitchingLoop
        With lags, delay and sampling.
    cycles : tuple of LimitCycle
        Where W(j w) meets -1/N(A).
    """

    law: str
    title: str
    hardware: str
    scenarios: tuple[str, ...]
    loop: SwitchingLoop
    cycles: tuple[LimitCycle, ...]

    @property
    def linear_part(self) -> SwitchingLoop:
        """The loop that W belongs to: the same for a relay and a saturation."""
        return replace(self.loop, boundary_layer=0.0)


def describing_functions(study: Study) -> tuple[DescribingFunction, ...]:
    """Each law with a switching term of the paper's form, once for each hardware, by law and then by scenario.

    Left out are laws with an unstable surface, and runs whose two commands have different lags or delays.
    """
    found: dict[tuple[str, SwitchingLoop], tuple[str, list[str]]] = {}
    for run in study.plan():
        law, hardware = study.law(run.law), chain_hardware(run)
        if law.kind not in ("sign", "saturation") or hardware is None or not run.parameters["P"]:
            continue
        try:
            loop = chain_loop(run, hardware, run.parameters["phi"] if law.kind == "saturation" else 0.0)
        except ParameterError:
            continue
        found.setdefault((law.name, loop), (hardware.text, []))[1].append(run.scenario)
    order = [law.name for law in study.laws]
    return tuple(
        DescribingFunction(law, study.law(law).title or law, text, tuple(where), loop, predicted_cycles(loop))
        for (law, loop), (text, where) in sorted(found.items(), key=lambda one: order.index(one[0][0]))
    )


def describing_function_figure(found: Sequence[DescribingFunction]) -> Figure:
    """W(j w) for each hardware in the complex plane, and -1/N(A) of each element; right, where they meet."""
    curves = {one.linear_part: one for one in reversed(found)}
    curves = {loop: curves[loop] for loop in dict.fromkeys(one.linear_part for one in found)}
    responses = [loop.frequency_response(loop.frequencies(_DENSE)) for loop in curves]
    reach = 1.2 * max(float(np.max(np.abs(one))) for one in responses)
    cycles = [(one.loop, cycle) for one in found for cycle in one.cycles]
    most = [pair for pair in cycles if pair[1].stable] or cycles
    near = 1.25 * max((abs(complex(loop.frequency_response(one.frequency))) for loop, one in most), default=0.0)
    figure = drawing.new_figure(9.4, 3.6 + 0.1 * (len(curves) + 5))
    panels = list(figure.subplots(1, 2 if most else 1, squeeze=False)[0])
    for axes, size in zip(panels, (reach, near), strict=False):
        for index, (response, one) in enumerate(zip(responses, curves.values(), strict=True)):
            label = f"W(jω), {one.hardware}{_numbers(one, list(curves.values()))}"
            line = _apart(response, size / _POINTS)
            axes.plot(line.real, line.imag, label=label, **drawing.style(index))
        _draw_elements(axes, found, size)
        for loop, cycle in cycles:
            at = complex(loop.frequency_response(cycle.frequency))
            word, fill = ("stable", "full") if cycle.stable else ("unstable", "none")
            axes.plot(at.real, at.imag, "o", color="#000000", fillstyle=fill, label=f"{word} limit cycle", zorder=9.0)
        axes.set(xlim=(-reach, reach), xlabel="real part, m/s²", ylabel="imaginary part, m/s²")
        axes.axvline(0.0, color="#7d878e", linewidth=0.6)
    if most:
        panels[0].set_title("Whole", loc="left")
        panels[1].set_title("Where they meet" if len(most) == len(cycles) else "At the stable limit cycles", loc="left")
        panels[1].set(xlim=(-near, 0.3 * near), ylim=(-0.5 * near, 0.5 * near))
    handles = dict(zip(*reversed(panels[0].get_legend_handles_labels()), strict=True))
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", frameon=False, ncols=2)
    return figure


def _apart(curve: Curve, step: float) -> Curve:
    """Points of a curve that are a step apart along it, and its ends."""
    far = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(curve))))) // step
    keep = np.diff(far, prepend=-1.0) > 0.0
    keep[-1] = True
    return curve[keep]


def _numbers(one: DescribingFunction, others: Sequence[DescribingFunction]) -> str:
    """What tells a curve from another with the same hardware: its gains."""
    if sum(other.hardware == one.hardware for other in others) == 1:
        return ""
    loop = one.loop
    C = ", ".join(map(given, loop.surface))
    return f", C = [{C}], Q = {given(loop.reaching_rate)}, P = {given(loop.switching_gain)}"


def _draw_elements(axes: Axes, found: Sequence[DescribingFunction], reach: float) -> None:
    """-1/N(A) of each element, the wider the layer the wider the line; a tick where it begins."""
    widths = sorted({one.loop.boundary_layer for one in found})
    for rank, width in enumerate(widths):
        loop = next(one.loop for one in found if one.loop.boundary_layer == width)
        inverse = _inverse(loop, reach)
        name = f"saturation, φ = {given(width)} m/s²" if width else "relay"
        look: dict[str, Any] = {"color": _GREYS[min(rank, len(_GREYS) - 1)], "linewidth": 1.0 + 2.0 * rank}
        look["zorder"] = 1.9 - 0.1 * rank
        axes.plot(inverse, np.zeros_like(inverse), label=f"−1/N(A), {name}", **look)
        axes.plot(inverse[:1], [0.0], marker="|", markersize=12, markeredgewidth=1.4, color="#000000", zorder=8.0)


def _inverse(loop: SwitchingLoop, reach: float) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """-1/N(A) from the smallest amplitude on, down to -reach (m/s2); N is python-control's."""
    if loop.boundary_layer:  # sat(S/phi): at small amplitudes N = 1/phi
        width = loop.boundary_layer
        sizes = np.concatenate(([1e-3], np.geomspace(1.0, 2.0 + 2.0 * reach / width, 80))) * width
        N = control.describing_function(control.saturation_nonlinearity(1.0), sizes / width) / width
    else:
        N = control.describing_function(
            control.relay_hysteresis_nonlinearity(1.0, 0.0), sizes := np.geomspace(1e-6, 2.0, 80) * reach
        )
    return np.asarray(-1.0 / np.real(N), dtype=np.float64)
