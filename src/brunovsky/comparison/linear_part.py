"""What the linear part of a study's laws says before any simulation: poles and margins."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from brunovsky.analysis import (
    Margins,
    boundary_layer_gain,
    closed_loop_poles,
    margins,
    sliding_gain,
    surface_poles,
)
from brunovsky.comparison.metrics import Array
from brunovsky.comparison.study import Study
from brunovsky.errors import ParameterError


@dataclass(frozen=True, eq=False)
class LinearLoop:
    """Linear loop of one chain.

    Attributes
    ----------
    title : str
        Which loop it is.
    gain : ndarray, shape (3,)
        K of v = -K e (1/s3, 1/s2, 1/s).
    poles : ndarray of complex, shape (3,)
        Closed-loop poles (1/s).
    margins : Margins or None
        None where the loop isn't stable.
    """

    title: str
    gain: Array
    poles: np.ndarray[tuple[int], np.dtype[np.complex128]]
    margins: Margins | None


def linear_loops(study: Study) -> tuple[LinearLoop, ...]:
    """Linear loops of the first run under the paper's law: the shared part, and each law within its boundary layer.

    None where no law is of that family.
    """
    first = next((run.parameters for run in study.plan() if run.in_family), None)
    if first is None:
        return ()
    surface = [first[f"C[{k}]"] for k in (1, 2, 3)]
    loops = [_loop("shared linear part (P = 0)", sliding_gain(surface, first["Q"]))]
    for law in study.laws:
        if law.kind == "saturation":
            gain = boundary_layer_gain(surface, first["Q"], law.values["P"], law.values["phi"])
            loops.append(_loop(f"“{law.name}” within its boundary layer", gain))
    return tuple(loops)


def motion_on_surface(study: Study) -> np.ndarray[tuple[int], np.dtype[np.complex128]]:
    """Poles of the motion on S = 0 of the first run under the paper's law, 1/s; none without one."""
    first = next((run.parameters for run in study.plan() if run.in_family), None)
    if first is None:
        return np.empty(0, dtype=np.complex128)
    return np.asarray(surface_poles([first[f"C[{k}]"] for k in (1, 2, 3)]))


def shares_one_linear_part(study: Study) -> bool:
    """Whether all runs under the paper's laws have the same C and Q."""
    names = ("C[1]", "C[2]", "C[3]", "Q")
    return len({tuple(run.parameters[name] for name in names) for run in study.plan() if run.in_family}) <= 1


def _loop(title: str, gain: Array) -> LinearLoop:
    try:
        found: Margins | None = margins(gain)
    except ParameterError:
        found = None
    return LinearLoop(title, gain, np.asarray(closed_loop_poles(gain)), found)
