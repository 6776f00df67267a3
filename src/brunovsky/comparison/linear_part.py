"""What the linear part of a study's laws says before any simulation: poles, margins, residuals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from brunovsky.analysis import (
    Margins,
    boundary_layer_gain,
    closed_loop_poles,
    forward_disturbance_bound,
    margins,
    sliding_gain,
    surface_poles,
    unmatched_residual,
    yaw_disturbance_bound,
)
from brunovsky.comparison.metrics import Array
from brunovsky.comparison.run import Run
from brunovsky.comparison.study import Law, PlannedRun, Study
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
    """Linear loops of the study's first scenario: the shared part, and each law within its boundary layer."""
    first = study.plan()[0].parameters
    surface = [first[f"C[{k}]"] for k in (1, 2, 3)]
    loops = [_loop("shared linear part (P = 0)", sliding_gain(surface, first["Q"]))]
    for law in study.laws:
        if law.kind == "saturation":
            gain = boundary_layer_gain(surface, first["Q"], law.values["P"], law.values["phi"])
            loops.append(_loop(f"“{law.name}” within its boundary layer", gain))
    return tuple(loops)


def motion_on_surface(study: Study) -> np.ndarray[tuple[int], np.dtype[np.complex128]]:
    """Poles of the motion on S = 0 of the study's first scenario, 1/s."""
    first = study.plan()[0].parameters
    return np.asarray(surface_poles([first[f"C[{k}]"] for k in (1, 2, 3)]))


def shares_one_linear_part(study: Study) -> bool:
    """Whether all runs have the same C and Q."""
    return len({tuple(run.parameters[name] for name in ("C[1]", "C[2]", "C[3]", "Q")) for run in study.plan()}) == 1


def predicted_residual(planned: PlannedRun, law: Law) -> float | None:
    """Amplitude of the position error that constant disturbances leave on the circle, m.

    In the steady state the robot moves at eta1 = R w with its heading turning at w, so that in complex notation
    e (k1 + j w k2 - w^2 k3 - j w^3) = d1 (k3 + 2 j w) + j eta1 d2. For a saturation K is that of the boundary layer;
    for the sign function what remains is the unmatched part. None where this doesn't apply.
    """
    if not law.in_family:
        return None
    p = planned.parameters
    if not any(planned.inputs.values()) or p["radius"] == 0.0 or p["rho[1]"] != 1.0 or p["rho[2]"] != 1.0:
        return None
    d1, d2 = planned.inputs["d[1]"], planned.inputs["d[2]"]
    surface, w = [p[f"C[{k}]"] for k in (1, 2, 3)], p["rate"]
    if law.kind == "sign":
        return unmatched_residual(surface, d1, w)
    if law.kind == "linear":
        gain = sliding_gain(surface, p["Q"])
    else:
        gain = boundary_layer_gain(surface, p["Q"], p["P"], p["phi"])
    left = gain[0] + 1j * w * gain[1] - w**2 * gain[2] - 1j * w**3
    right = d1 * (gain[2] + 2j * w) + 1j * p["radius"] * w * d2
    return float(abs(right / left))


def within_bounds(run: Run) -> bool:
    """Whether P rejects the disturbances of a run in its last quarter: their shares of the two bounds sum to below 1.

    The bounds are taken at the largest speed and yaw rate of that quarter; without disturbance the answer is yes.
    """
    p, d1, d2 = run.planned.parameters, abs(run.planned.inputs["d[1]"]), abs(run.planned.inputs["d[2]"])
    if not d1 and not d2:
        return True
    if run.facts is None or not p["P"]:
        return False
    surface = [p[f"C[{k}]"] for k in (1, 2, 3)]
    forward = forward_disturbance_bound(surface, p["P"], run.facts.tail_turning)
    yaw = yaw_disturbance_bound(surface, p["P"], run.facts.tail_fastest)
    return d1 / forward + d2 / yaw < 1.0


def _loop(title: str, gain: Array) -> LinearLoop:
    try:
        found: Margins | None = margins(gain)
    except ParameterError:
        found = None
    return LinearLoop(title, gain, np.asarray(closed_loop_poles(gain)), found)
