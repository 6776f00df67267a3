"""The linear part that a switching law closes, against -1/N(A) of its switching element."""

from __future__ import annotations

from dataclasses import dataclass

import control
import numpy as np
from matplotlib.figure import Figure

from brunovsky.analysis import LimitCycle, SwitchingLoop, predicted_cycles
from brunovsky.comparison import drawing
from brunovsky.comparison.analyzed_loops import law_numbers
from brunovsky.comparison.study import Study
from brunovsky.errors import ParameterError


@dataclass(frozen=True)
class DescribingFunction:
    """A switching law of a study as the describing function sees it, on one chain, for its first scenario.

    Attributes
    ----------
    index : int
        Of the law in the study.
    law, title : str
        Its name, and its title for people.
    loop : SwitchingLoop
        Without actuator, delay or sampling.
    cycles : tuple of LimitCycle
        Where W(j w) meets -1/N(A).
    """

    index: int
    law: str
    title: str
    loop: SwitchingLoop
    cycles: tuple[LimitCycle, ...]


def describing_functions(study: Study) -> tuple[DescribingFunction, ...]:
    """Each law with a switching term of the paper's form; those with an unstable surface are left out."""
    found: dict[str, DescribingFunction] = {}
    for run in study.plan():
        index, law = next((k, one) for k, one in enumerate(study.laws) if one.name == run.law)
        if law.kind not in ("sign", "saturation") or law.name in found or not run.parameters["P"]:
            continue
        *C, Q, P, phi = law_numbers(run)
        try:
            loop = SwitchingLoop(tuple(C), Q, P, boundary_layer=phi if law.kind == "saturation" else 0.0)
        except ParameterError:
            continue
        found[law.name] = DescribingFunction(index, law.name, law.title or law.name, loop, predicted_cycles(loop))
    return tuple(found.values())


def describing_function_figure(found: tuple[DescribingFunction, ...]) -> Figure:
    """W(j w) of each law in the complex plane, and -1/N(A) of its relay or saturation."""
    figure = drawing.new_figure(9.4, 3.6)
    axes = figure.subplots()
    reach = 0.0
    for one in found:
        look = drawing.style(one.index)
        curve = one.loop.frequency_response(one.loop.frequencies(600))
        axes.plot(curve.real, curve.imag, label=f"W(jω), {one.title}", **look)
        reach = max(reach, float(np.max(np.abs(curve))))
    for one in found:
        look = drawing.style(one.index)
        inverse = _inverse(one.loop, 1.2 * reach)
        label = f"−1/N(A), {one.title}"
        axes.plot(inverse, np.zeros_like(inverse), label=label, **{**look, "linewidth": look["linewidth"] + 1.0})
        axes.plot(inverse[:1], [0.0], marker="|", markersize=12, color=look["color"], zorder=look["zorder"])
        for cycle in one.cycles:
            at = complex(one.loop.frequency_response(cycle.frequency))
            word = "stable" if cycle.stable else "unstable"
            label = f"{word}: A = {cycle.amplitude:.3g} m/s² at {cycle.frequency:.3g} rad/s"
            fill = "full" if cycle.stable else "none"
            axes.plot(at.real, at.imag, "o", color="#000000", fillstyle=fill, label=label, zorder=9.0)
    axes.set(xlim=(-1.2 * reach, 1.2 * reach), xlabel="real part, m/s²", ylabel="imaginary part, m/s²")
    axes.axvline(0.0, color="#7d878e", linewidth=0.6)
    figure.legend(loc="outside right center", frameon=False)
    return figure


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
