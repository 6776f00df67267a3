"""Coupling errors of a study's laws: the components of each loop as FMUs, exchanged at communication points."""

from __future__ import annotations

from collections.abc import Callable

from numpy.typing import ArrayLike

from brunovsky.analysis import (
    CouplingError,
    boundary_layer_gain,
    coupling_errors,
    largest_communication_step,
    sliding_gain,
)
from brunovsky.comparison.protocols.coupling import Coupling, Key, Layer, coupling_of
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
    layers: dict[str, Layer] = {}
    for count, law in enumerate(study.laws_of_protocol(table)):
        progress(count)
        planned = study.planned_case(table, law, {})
        p = planned.parameters
        layered = law.in_family and p["P"] > 0.0 and p["phi"] > 0.0
        errors[law.name] = coupling_errors(
            planned.loop.block,
            planned.duration,
            table.communication_steps_s,
            schemes=table.schemes,
            orders=table.derivatives,
            watched=("S[1]", "S[2]") if layered else (),
            step_size=planned.step_size,
            parameters=p,
        )
        if law.in_family:
            surface = [p[f"C[{k}]"] for k in (1, 2, 3)]
            limits |= {(law.name, *one): found for one, found in _limits(table, sliding_gain(surface, p["Q"])).items()}
            if layered:
                gain = boundary_layer_gain(surface, p["Q"], p["P"], p["phi"])
                layers[law.name] = Layer(p["phi"], _limits(table, gain))
    return coupling_of(errors, limits, layers, large=table.lost_m, small=table.small_s)


def _limits(table: CouplingTable, gain: ArrayLike) -> dict[tuple[str, int], float]:
    """Largest communication step (s) of one linear loop for each coupling."""
    return {
        (scheme, order): largest_communication_step(gain, scheme, order)
        for scheme in table.schemes
        for order in table.derivatives
    }
