"""How runs of FMUs and packages are held against the native simulation."""

from __future__ import annotations

from brunovsky.comparison.agreement import Agreement, cross_check
from brunovsky.comparison.coupling_bound import position_bound
from brunovsky.comparison.engines import Engine, FmuSimulation, NativeSimulation, Outcome, check_outcome
from brunovsky.comparison.ssp_engine import SspSimulation
from brunovsky.comparison.study import PlannedRun


def agreement_with(native: NativeSimulation, planned: PlannedRun, engine: Engine, outcome: Outcome) -> Agreement:
    """Repeat a run of another engine natively and compare; through packages also at half the communication step."""
    twin = check_outcome(native.run(planned), planned)
    if not isinstance(engine, SspSimulation) or engine.own:
        own = isinstance(engine, FmuSimulation | SspSimulation) and engine.own
        return cross_check(planned, outcome, twin, basis="models" if own else "rounding")
    ended = outcome.status.state == twin.status.state == "ok"
    finer = check_outcome(engine.halved().run(planned), planned) if ended else None
    bound = position_bound(planned, twin, engine.communication_step, engine.scheme)
    return cross_check(planned, outcome, twin, basis="coupling", finer=finer, bound=bound)
