"""Coupling errors of a study's laws: the components of each loop as FMUs, exchanged at communication points."""

from __future__ import annotations

from collections.abc import Callable

from brunovsky.analysis import CouplingError, coupling_errors, largest_communication_step, sliding_gain
from brunovsky.comparison.protocols.coupling import Coupling, Key, coupling_of
from brunovsky.comparison.study import Study
from brunovsky.comparison.study.protocols import CouplingTable


def run_coupling(study: Study, table: CouplingTable, progress: Callable[[int], None]) -> Coupling:
    """Couple the loops of a scenario as the table says, and compare each run with the loop as one system.

    Raises
    ------
    SimulationError
        If a loop fails as one system.
    """
    errors: dict[str, tuple[CouplingError, ...]] = {}
    limits: dict[Key, float] = {}
    for count, law in enumerate(study.laws_of_protocol(table)):
        progress(count)
        planned = study.planned_case(table, law, {})
        errors[law.name] = coupling_errors(
            planned.loop.block,
            planned.duration,
            table.communication_steps_s,
            schemes=table.schemes,
            orders=table.derivatives,
            step_size=planned.step_size,
            parameters=planned.parameters,
        )
        if law.in_family:
            p = planned.parameters
            gain = sliding_gain([p[f"C[{k}]"] for k in (1, 2, 3)], p["Q"])
            for scheme in table.schemes:
                for order in table.derivatives:
                    limits[law.name, scheme, order] = largest_communication_step(gain, scheme, order)
    return coupling_of(errors, limits, large=table.lost_m, small=table.small_s)
