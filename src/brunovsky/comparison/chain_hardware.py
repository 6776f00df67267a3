"""What stands at v of one chain in a run: the lags, the delay and the sampling of its hardware."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from brunovsky.analysis import SwitchingLoop
from brunovsky.comparison.facts import given
from brunovsky.comparison.study import PlannedRun, Study

STRAIGHT = 0.1  # rad; largest turn up to which a path counts as a straight line


@dataclass(frozen=True)
class ChainHardware:
    """Lags in series (s), delay (s) and sampling period (s, or None) of one chain; by default ideal."""

    lags: tuple[float, ...] = ()
    delay: float = 0.0
    sampling: float | None = None

    @property
    def text(self) -> str:
        """In words, for a legend."""
        lag = f"{1e3 * self.lags[0]:.4g} ms" if self.lags else ""
        parts = [f"a lag of {lag}" if len(self.lags) == 1 else f"{len(self.lags)} lags of {lag}"] if lag else []
        parts += [f"a delay of {given(1e3 * self.delay)} ms"] if self.delay else []
        parts += [f"sampling every {given(1e3 * self.sampling)} ms"] if self.sampling else []
        return ", ".join(parts) or "ideal actuators"


def chain_hardware(planned: PlannedRun) -> ChainHardware | None:
    """Hardware of a run as one chain sees it; None where lags or delays of the two commands differ."""
    p, hardware = planned.parameters, planned.loop.hardware
    (lag, other), (delay, late) = ([p.get(f"{name}[{k}]", 0.0) for k in (1, 2)] for name in ("lag", "delay"))
    if lag != other or delay != late:
        return None
    period = p["sampling_period"] if hardware.period is not None else None
    return ChainHardware((lag,) * hardware.number if lag else (), delay, period)


def chain_loop(planned: PlannedRun, hardware: ChainHardware, boundary_layer: float) -> SwitchingLoop:
    """One chain of a run under the paper's law behind its hardware.

    Raises
    ------
    ParameterError
        If the motion on its surface is not stable.
    """
    p = planned.parameters
    return SwitchingLoop(
        (p["C[1]"], p["C[2]"], p["C[3]"]),
        p["Q"],
        p["P"],
        boundary_layer,
        lags=hardware.lags,
        delay=hardware.delay,
        sampling=hardware.sampling,
    )


def uncovered(study: Study) -> tuple[str, ...]:
    """What the loop of one chain with hardware at v leaves out of the hardware of a study's runs, in a sentence."""
    runs = [run for run in study.plan() if run.in_family and not run.has_ideal_actuators]
    late = [run for run in runs if (one := chain_hardware(run)) is None or one.lags or one.delay]
    parts = []
    if late:
        turning = _names(run for run in late if abs(run.parameters["rate"]) * run.duration > STRAIGHT)
        parts.append(
            "lags and delays stand at v, as they do for the motion across the heading of a straight line: along it the "
            "sliding variable contains the command"
            + (f", and where the heading turns ({turning}) the two mix" if turning else "")
        )
    if any(run.loop.hardware.period is not None for run in runs):
        parts.append("a hold enters by its own response, without the aliases of sampling")
    apart = _names(run for run in runs if chain_hardware(run) is None)
    if apart:
        parts.append(f"no one chain has the different lags or delays of {apart}, which is not drawn")
    limited = _names(run for run in runs if min(run.loop.hardware.limits) < math.inf)
    if limited:
        parts.append(f"the limits of the inputs in {limited} are left out")
    return (f"Not covered by the theory: {'; '.join(parts)}.",) if parts else ()


def _names(runs: Iterable[PlannedRun]) -> str:
    return ", ".join(dict.fromkeys(run.scenario for run in runs))
