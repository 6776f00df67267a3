"""The short summary of a study's chatter that is kept beside its file, in Markdown."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from brunovsky.analysis import ChatterRow
from brunovsky.comparison.analyze import Analysis
from brunovsky.comparison.facts import given, joined, number, percent
from brunovsky.errors import StudyError

_SOURCES = {"predicted": "describing function", "locus": "relay locus"}
_EXACT = 1e-3  # relative error below which a prediction is told to agree
_QUANTITIES = {"amplitude": "amplitude", "frequency_rad_s": "frequency"}


def chatter_markdown(analysis: Analysis) -> str:
    """What the chatter grids of a study found: how far both predictions are from simulation, and every row.

    Without dates and versions, so that it changes only where the findings do.

    Parameters
    ----------
    analysis : Analysis
        From :func:`analyze_study`.

    Returns
    -------
    str
        Markdown.

    Raises
    ------
    StudyError
        If the study has no chatter tables.
    """
    study = analysis.study
    rows = [row for _, found in analysis.grids for row in found]
    if not rows:
        raise StudyError(f"study '{study.name}' has no chatter tables; add [[chatter]]")
    relays = [row for row in rows if row.phi == 0.0]
    lines = [
        f"# {study.title}",
        "",
        study.description,
        "",
        f"Written from the {len(rows)} points of the chatter tables of `{study.name}.toml` by "
        "`docs/refresh_reports.py`. Amplitudes are half of peak to peak of the sliding variable S, of one chain at a "
        "set point. In the tables A is an amplitude in m/s² and ω a frequency in rad/s; a prediction is followed by "
        "its error against simulation.",
        "",
        "## How good the predictions are",
        "",
        f"- Relay, linear part stable: {_errors([row for row in relays if row.linear_part_stable])}",
        f"- Relay, linear part unstable: {_errors([row for row in relays if not row.linear_part_stable])}",
        f"- Boundary layer: {_errors([row for row in rows if row.phi > 0.0], ('predicted',))}",
        f"- {_agreement(rows)}",
    ]
    for grid, found in analysis.grids:
        lines += ["", f"## {grid.title}", "", *_table(found)]
    return "\n".join(lines) + "\n"


def relative_error(row: ChatterRow, source: str, quantity: str) -> float | None:
    """Of one prediction against simulation, with its sign; None where either is missing."""
    said, seen = getattr(row, f"{source}_{quantity}"), getattr(row, f"simulated_{quantity}")
    return None if said is None or seen is None else said / seen - 1.0


def largest_error(rows: Sequence[ChatterRow], source: str, quantity: str) -> float | None:
    """Largest absolute relative error of one prediction; None where nothing can be compared."""
    found = (relative_error(row, source, quantity) for row in rows)
    return max((abs(one) for one in found if one is not None), default=None)


def _errors(rows: Sequence[ChatterRow], sources: Sequence[str] = tuple(_SOURCES)) -> str:
    seen = [row for row in rows if row.simulated_amplitude is not None]
    if not seen:
        return f"none of {len(rows)} points oscillates."
    parts = [f"the {_SOURCES[source]} {_off(seen, source)}" for source in sources]
    return f"{len(seen)} of {len(rows)} points oscillate; {joined(parts)}."


def _off(rows: Sequence[ChatterRow], source: str) -> str:
    found = {what: largest_error(rows, source, key) or 0.0 for key, what in _QUANTITIES.items()}
    if max(found.values()) < _EXACT:  # its digits are those of the simulation's tolerance
        return f"agrees with the simulation to within {percent(_EXACT)}"
    return f"is off by at most {joined([f'{percent(one)} in {what}' for what, one in found.items()])}"


def _agreement(rows: Sequence[ChatterRow]) -> str:
    """Whether prediction and simulation agree on where there is a limit cycle at all."""
    wrong = [row for row in rows if (row.predicted_amplitude is None) != (row.simulated_amplitude is None)]
    if not wrong:
        return "A stable limit cycle is predicted at every point that oscillates, and at no other."
    return f"At {len(wrong)} points a limit cycle is predicted and not seen, or seen and not predicted."


def _table(rows: Sequence[ChatterRow]) -> list[str]:
    columns = (
        "lags, ms",
        "delay, ms",
        "C",
        "Q, 1/s",
        "P, m/s³",
        "φ, m/s²",
        "A DF",
        "A locus",
        "A seen",
        "ω DF",
        "ω locus",
        "ω seen",
        "linear part",
        "outcome",
    )
    lines = [f"| {' | '.join(columns)} |", f"| --- |{' ---: |' * (len(columns) - 3)} --- | --- |"]
    for row in rows:
        cells = [" ".join(given(1e3 * one) for one in row.lag_s) or "none", given(1e3 * row.delay_s)]
        cells += [" ".join(map(given, row.C)), given(row.Q), given(row.P), given(row.phi)]
        for quantity in _QUANTITIES:
            cells += [_cell(row, source, quantity) for source in _SOURCES]
            cells.append(number(getattr(row, f"simulated_{quantity}")))
        cells += ["stable" if row.linear_part_stable else "unstable", row.outcome]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def _cell(row: ChatterRow, source: str, quantity: str) -> str:
    value, error = getattr(row, f"{source}_{quantity}"), relative_error(row, source, quantity)
    if error is None:
        return number(value)
    return f"{number(value)} ({100.0 * np.round(error, 3) + 0.0:+.1f} %)".replace("-", "−")
