"""The bound of the coupling error for runs of a study, where theory has one."""

from __future__ import annotations

import numpy as np

from brunovsky.analysis import coupling_error_bound, sliding_gain
from brunovsky.analysis.coupling.scheme import Scheme
from brunovsky.comparison.engines import Outcome
from brunovsky.comparison.study import PlannedRun
from brunovsky.errors import ParameterError

MOST_INSTANTS = 50_000  # the work grows with their square


def position_bound(planned: PlannedRun, native: Outcome, communication_step: float, scheme: Scheme) -> float | None:
    """Bound of the distance between the coupled and the native position, m, to first order in the communication step.

    Known for components that step all at once under the paper's law without a relay, on an undisturbed robot with ideal
    hardware that stays away from rest, where its chains are exact.
    """
    trajectory, values = native.trajectory, planned.parameters
    if scheme != "jacobi" or native.status.state != "ok" or trajectory.sizes["time"] > MOST_INSTANTS:
        return None
    if planned.loop.controller != "sliding_mode" or not (planned.is_ideal and planned.is_undisturbed):
        return None
    if (values["P"] > 0.0 and values["phi"] == 0.0) or float(abs(trajectory["eta[1]"]).min()) <= values["eta_min"]:
        return None
    try:
        gain = sliding_gain([values[f"C[{i}]"] for i in (1, 2, 3)], values["Q"])
        chains = [
            coupling_error_bound(trajectory["time"], trajectory[v], gain, communication_step) for v in ("v[1]", "v[2]")
        ]
    except ParameterError:  # gains that do not stabilise
        return None
    return float(np.max(np.hypot(*chains)))
