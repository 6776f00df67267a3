"""The part of a report on the linear part of a study's laws: poles, margins, Bode, Nyquist, describing functions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from brunovsky.comparison import drawing, figures
from brunovsky.comparison.facts import given, joined
from brunovsky.comparison.figures import DescribingFunction
from brunovsky.comparison.linear_part import linear_loops, motion_on_surface, shares_one_linear_part
from brunovsky.comparison.protocol_section import Table
from brunovsky.comparison.report.scenario import Picture
from brunovsky.comparison.study import Study
from brunovsky.comparison.tables import loop_row, margin_rows, poles_text


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
    margins = tuple((label, *cells) for label, cells in margin_rows(loops))
    named = [(one.title, one.poles) for one in loops] + [("motion on S = 0", surface)]
    poles = "Poles of the linear loops of one chain, and of the motion on S = 0."
    pictures = []
    if loops:
        pictures.append(Picture(drawing.svg(figures.poles_figure(named), "poles", poles), poles, narrow=True))
    bode = figures.bode_figure(study)
    if bode is not None:
        text = (
            "Bode and Nyquist plot of the linear loops, one chain cut at v. Ticks: the phase margin; squares: the "
            "lower "
            "gain margin; dotted circles: the distance of the curve from −1."
        )
        pictures.append(Picture(drawing.svg(bode, "bode", text), text))
    found = figures.describing_functions(study)
    if found:
        text = (
            "Nyquist plot of the linear part W(jω) that the switching element closes, and −1/N(A) of the relay or "
            "saturation, which begins at the tick. Without actuator, delay or sampling."
        )
        pictures.append(
            Picture(drawing.svg(figures.describing_function_figure(found), "describing-function", text), text)
        )
    return LinearSection(
        surface_poles=poles_text(surface),
        shared=shares_one_linear_part(study),
        loops=Table("loops", ("loop", "gain K", "poles, 1/s"), rows),
        margins=Table("margins", ("margin at v", *(one.title for one in loops)), margins),
        figures=tuple(pictures) if "linear" in study.figures else (),
        findings=_predictions(found),
    )


def _predictions(found: Sequence[DescribingFunction]) -> tuple[str, ...]:
    """What the describing functions say of chatter, for each law."""
    quiet = [f"“{one.law}”" for one in found if not one.cycles]
    sentences = []
    if quiet:
        sentences.append(
            f"−1/N(A) and W(jω) of {joined(quiet)} do not meet: in continuous time and without actuator the describing "
            "function predicts no chatter, so that whatever a run shows comes from its step, or from what its "
            "actuators "
            "and samplings add."
        )
    for one in found:
        cycles = [
            f"{'a stable' if cycle.stable else 'an unstable'} one of {given(cycle.amplitude)} m/s² in S at "
            f"{given(cycle.frequency)} rad/s"
            for cycle in one.cycles
        ]
        if cycles:
            sentences.append(f"For “{one.law}” the describing function predicts limit cycles: {joined(cycles)}.")
    return tuple(sentences)
