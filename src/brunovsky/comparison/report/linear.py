"""The part of a report on the linear part of a study's laws: poles, margins, Bode, Nyquist, describing functions."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass

from brunovsky.analysis import switching_gain_margin
from brunovsky.comparison import drawing, figures
from brunovsky.comparison.chain_hardware import ChainHardware, uncovered
from brunovsky.comparison.facts import joined, number
from brunovsky.comparison.figures import DescribingFunction
from brunovsky.comparison.linear_part import linear_loops, motion_on_surface, shares_one_linear_part
from brunovsky.comparison.protocol_section import Table
from brunovsky.comparison.report.scenario import Picture
from brunovsky.comparison.study import Study
from brunovsky.comparison.tables import loop_row, margin_rows, poles_text
from brunovsky.errors import ParameterError


@dataclass(frozen=True)
class LinearSection:
    """What a report shows of the linear part."""

    surface_poles: str
    shared: bool
    loops: Table
    margins: Table
    figures: tuple[Picture, ...]
    findings: tuple[str, ...]


def linear_section(study: Study) -> LinearSection:
    """Poles and margins of the linear loops, their figures, and what the describing functions predict."""
    loops = list(linear_loops(study))
    surface = motion_on_surface(study)
    rows = tuple((one["title"], one["gain"], one["poles"]) for one in map(loop_row, loops))
    bounds = _switching_bounds(study)
    rest = [f"≤ {number(one, 4)}" for one in bounds.values()]  # of the lower gain margin; there are no others
    margins = tuple(
        (label, *cells, *(rest if index == 0 else ["–"] * len(rest)))
        for index, (label, cells) in enumerate(margin_rows(loops))
    )
    named = [(one.title, one.poles) for one in loops] + [("motion on S = 0", surface)]
    poles = "Poles of the linear loops of one chain, and of the motion on S = 0."
    pictures = []
    if loops:
        pictures.append(Picture(drawing.svg(figures.poles_figure(named), "poles", poles), poles, narrow=True))
    limits = " ".join(uncovered(study))
    bode = figures.bode_figures(study)
    text = (
        "Bode and Nyquist plot of the linear loops, one chain cut at v, with the hardware of the scenarios. Dots and "
        "ticks: gain crossover and phase margin; squares: gain margins; dotted circles: the distance of the curve from "
        f"−1. {limits}"
    ).strip()
    for k, figure in enumerate(bode, 1):
        key = "bode" if len(bode) == 1 else f"bode-{k}"
        pictures.append(Picture(drawing.svg(figure, key, text), text))
    found = figures.describing_functions(study)
    if found:
        text = (
            "Nyquist plot of the linear part W(jω) that the switching element closes, with the hardware of the "
            "scenarios, and −1/N(A) of the relay or saturation, which begins at the tick. Where they meet there is a "
            f"limit cycle. {limits}"
        ).strip()
        pictures.append(
            Picture(drawing.svg(figures.describing_function_figure(found), "describing-function", text), text)
        )
    return LinearSection(
        surface_poles=poles_text(surface),
        shared=shares_one_linear_part(study),
        loops=Table("loops", ("loop", "gain K", "poles, 1/s"), rows),
        margins=Table("margins", ("margin at v", *(one.title for one in loops), *bounds), margins, heads=1),
        figures=tuple(pictures) if "linear" in study.figures else (),
        findings=_predictions(found),
    )


def _switching_bounds(study: Study) -> dict[str, float]:
    """Bound of the lower gain margin of each law with the sign function, by the heading of its column.

    Without one for gains that have none: other than a stable surface of the second order and a positive Q.
    """
    found: dict[str, float] = {}
    for run in study.plan():
        if study.law(run.law).kind == "sign":
            p = run.parameters
            with contextlib.suppress(ParameterError):
                bound = switching_gain_margin([p[f"C[{k}]"] for k in (1, 2, 3)], p["Q"])
                heading = f"“{run.law}”, at any amplitude"
                found[heading] = max(bound, found.get(heading, 0.0))
    return found


def _predictions(found: Sequence[DescribingFunction]) -> tuple[str, ...]:
    """What the describing functions say of chatter, for each law and hardware."""
    quiet: dict[str, list[str]] = {}
    for one in found:
        if not one.cycles:
            quiet.setdefault(one.law, []).append(f"with {one.hardware}")
    sentences = []
    for some in dict.fromkeys(tuple(dict.fromkeys(one)) for one in quiet.values()):
        laws = [f"“{law}”" for law, where in quiet.items() if tuple(dict.fromkeys(where)) == some]
        own = f"with {ChainHardware().text}"
        rest = f" What a run {own} shows all the same comes from its step." if own in some else ""
        sentences.append(
            f"−1/N(A) and W(jω) of {joined(laws)} do not meet {joined(list(some))}: there the describing function "
            f"predicts no chatter.{rest}"
        )
    for one in found:
        cycles = [
            f"{'a stable' if cycle.stable else 'an unstable'} one of {number(cycle.amplitude)} m/s² in S at "
            f"{number(cycle.frequency)} rad/s"
            for cycle in one.cycles
        ]
        if cycles:
            sentences.append(
                f"For “{one.law}” with {one.hardware} ({', '.join(one.scenarios)}) the describing function predicts "
                f"limit cycles: {joined(cycles)}."
            )
    return tuple(dict.fromkeys(sentences))
