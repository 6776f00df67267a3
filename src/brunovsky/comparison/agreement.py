"""Cross-check of an engine's runs against the native simulation."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from brunovsky.comparison.engines import Outcome
from brunovsky.comparison.study import PlannedRun

POSITION_TOLERANCE = 1e-9  # m; below it two engines agree for every purpose of a study
_ON_SURFACE = 1e-9  # m/s2; a start this near S = 0 leaves the branch of a sign function to rounding


@dataclass(frozen=True)
class Agreement:
    """Largest differences between an engine and the native simulation over one run.

    Attributes
    ----------
    run : str
        Name of the run.
    position : float or None
        Largest distance between the two positions (m); None if there is nothing to compare.
    differences : mapping of str to float
        Largest absolute difference of each recorded variable, in its unit.
    same_status : bool
        Whether both ended in the same way.
    explanation : str
        Why they may differ, where that is known; empty where they agree or no reason is known.
    """

    run: str
    position: float | None
    differences: dict[str, float]
    same_status: bool
    explanation: str

    @property
    def agrees(self) -> bool:
        """Whether both ended in the same way and at most 1 nm apart all along."""
        return self.same_status and (self.position is None or self.position <= POSITION_TOLERANCE)

    def as_dict(self) -> dict[str, Any]:
        """The same as plain data, for JSON."""
        return asdict(self) | {"agrees": self.agrees}


def cross_check(planned: PlannedRun, outcome: Outcome, native: Outcome) -> Agreement:
    """Compare a run with its native twin over the instants both reached."""
    count = min(one.trajectory.sizes["time"] for one in (outcome, native))
    pairs = {
        str(name): [np.asarray(one.trajectory[name].values[:count], dtype=float) for one in (outcome, native)]
        for name in native.trajectory.data_vars
        if name in outcome.trajectory
    }
    differences = {name: float(np.max(np.abs(a - b))) for name, (a, b) in pairs.items()} if count else {}
    gap = [a - b for a, b in (pairs["x"], pairs["y"])]
    position = float(np.max(np.hypot(*gap))) if count else None
    same = (
        outcome.status.state == native.status.state
        and abs((outcome.status.time or 0.0) - (native.status.time or 0.0)) < 1e-9
    )
    apart = position is not None and position > POSITION_TOLERANCE
    explanation = _explanation(planned, native) if apart and same else ""
    return Agreement(planned.name, position, differences, same, explanation)


def _explanation(planned: PlannedRun, native: Outcome) -> str:
    if native.status.state == "diverged":
        return "the run diverges, and the differences with it"
    relay = planned.parameters.get("P", 0.0) > 0.0 and planned.parameters.get("phi") == 0.0
    starts = [abs(float(native.trajectory[name][0])) for name in ("S[1]", "S[2]") if name in native.trajectory]
    if relay and starts and max(starts) <= _ON_SURFACE:
        return "the run starts on S = 0, where rounding picks the branch of the sign function"
    return ""
