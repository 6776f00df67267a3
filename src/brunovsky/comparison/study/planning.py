"""From the tables of a study to runs: which value each parameter of a loop gets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from brunovsky._frozen import FrozenMapping
from brunovsky.blocks.units import BASE_UNITS, unit_exponents
from brunovsky.comparison.study.keys import input_keys, loop_keys, remedy
from brunovsky.comparison.study.law import Law
from brunovsky.comparison.study.loops import IDEAL, Hardware, Loop, knows_hardware
from brunovsky.comparison.study.planned import PlannedRun
from brunovsky.comparison.study.protocols import (
    BANDWIDTH,
    GROUPS,
    CouplingTable,
    EqualEffortTable,
    MarginsTable,
    ParetoTable,
    Protocol,
)
from brunovsky.comparison.study.scenario import Scenario
from brunovsky.comparison.study.table import by_name

GOAL_HEADING = "goal_heading_rad"
NOTHING: Mapping[str, float] = FrozenMapping({})


def planned_run(
    law: Law,
    scenario: Scenario,
    *,
    shared: Mapping[str, float],
    step_size: float,
    seed: tuple[int, ...],
    band: float,
    changed: Mapping[str, float] = NOTHING,
    duration: float | None = None,
    hardware: Hardware | None = None,
) -> PlannedRun:
    """Run of a scenario under a law: study, scenario, law and what a protocol changes, each before those after it.

    A key that the loop doesn't have is left out: it belongs to other laws of the study.

    Raises
    ------
    ParameterError
        If a changed value is out of range.
    """
    loop = law.loop(hardware or scenario.resolved_hardware)
    keys = loop_keys(loop)
    tables = {**shared, **scenario.parameters}
    values = by_name({text: value for text, value in tables.items() if text in keys}, keys) | _of_law(law, loop)
    values |= by_name({text: value for text, value in changed.items() if text in keys and text not in GROUPS}, keys)
    known = {one.name for one in loop.block.parameters}
    for text, names in GROUPS.items():
        if text in changed:
            values |= {name: changed[text] for name in names if name in known}
    disturbances = by_name(scenario.disturbances, input_keys())
    given = {
        *values,
        *disturbances,
        *scenario.noise.deviations,
        *(n for one in scenario.signals for n in one.amplitudes),
    }
    resolved = loop.block.parameter_values(values)
    if BANDWIDTH in changed:
        resolved = loop.block.parameter_values({**resolved, **scaled_gains(loop, resolved, changed[BANDWIDTH])})
    return PlannedRun(
        name=f"{scenario.name}/{law.name}",
        scenario=scenario.name,
        law=law.name,
        duration=duration or scenario.duration_s,
        step_size=step_size,
        parameters=FrozenMapping(resolved),
        inputs=FrozenMapping({one.name: one.start for one in loop.block.inputs} | disturbances),
        loop=loop,
        signals=scenario.signals,
        noise=FrozenMapping(scenario.noise.deviations),
        noise_period=scenario.noise.period_s or step_size,
        seed=seed,
        given=frozenset(given),
        band=band,
        goal_heading={**tables, **changed}.get(GOAL_HEADING),
    )


def _of_law(law: Law, loop: Loop) -> dict[str, float]:
    """Parameters of a law; one that samples does so with the computer that it runs on, unless it says otherwise."""
    names = {one.name for one in loop.block.parameters}
    inner = {name: f"controller.{name}" for name in law.values}
    found = {inner[name] if inner[name] in names else name: value for name, value in law.values.items()}
    if "controller.sampling_period" in names and loop.hardware.period is not None:
        found.setdefault("controller.sampling_period", loop.hardware.period)
    return found


def scaled_gains(loop: Loop, values: Mapping[str, float], factor: float) -> dict[str, float]:
    """Gains of the outer loop in 1/s^n times the n-th power of a factor: all its poles times the factor."""
    own = {one.name: _rate(one.unit) for one in loop.block.components["controller"].parameters}
    return {name: values[name] * factor**n for name, n in own.items() if n and name in values}


def _rate(unit: str) -> int:
    """N of the unit 1/s^n, 0 for any other."""
    exponents = dict(zip(BASE_UNITS, unit_exponents(unit), strict=True))
    n = -exponents.pop("s")
    return n if n > 0 and not any(exponents.values()) else 0


def check_protocol(protocol: Protocol, where: str, laws: Sequence[Law], scenario: Scenario) -> None:
    """Refuse laws that the scenario doesn't run under, and knobs that a law doesn't have.

    Raises
    ------
    ValueError
        What is wrong, where, and the remedy.
    """
    known = {law.name: law for law in laws}
    named = [*(protocol.laws or ()), *(law for law in protocol.knobs if law)]
    if isinstance(protocol, EqualEffortTable) and protocol.target_law is not None:
        named.append(protocol.target_law)
    for name in named:
        if name not in known:
            raise ValueError(f"{where}scenario '{scenario.name}' has no law '{name}'; {remedy(name, list(known))}")
    compared = protocol.laws or tuple(known)
    if isinstance(protocol, EqualEffortTable | ParetoTable):
        for name in compared:
            if name not in protocol.knobs:
                table = "tuned" if isinstance(protocol, EqualEffortTable) else "spaces"
                raise ValueError(f"{where}there is no {table}.{name}; give one, or leave the law out of laws")
    if isinstance(protocol, MarginsTable):
        _check_margins(protocol, where, [known[name] for name in compared], scenario)
    if isinstance(protocol, CouplingTable):
        _check_coupling(where, [known[name] for name in compared], scenario)
    for name, knobs in protocol.knobs.items():
        having = [known[name]] if name else [known[one] for one in compared]
        for knob in sorted(knobs - {BANDWIDTH}):
            if not any(_has(law.loop(scenario.resolved_hardware), knob) for law in having):
                owner = f"law '{name}'" if name else "any of its laws"
                raise ValueError(f"{where}{knob} is no parameter of {owner}; remove it or name another")


def _has(loop: Loop, knob: str) -> bool:
    """Whether a loop has what a knob sets."""
    if knob not in GROUPS:
        return knob in loop_keys(loop)
    return not {one.name for one in loop.block.parameters}.isdisjoint(GROUPS[knob])


def _check_margins(protocol: MarginsTable, where: str, laws: Sequence[Law], scenario: Scenario) -> None:
    hardware = scenario.resolved_hardware
    if any(hardware.lags) or any(hardware.delays) or hardware.period is not None:
        raise ValueError(
            f"{where}scenario '{scenario.name}' has lags, delays or sampling already; margins are measured from a "
            "scenario without: name one"
        )
    for law in laws:
        if not knows_hardware(law.kind):
            raise ValueError(
                f"{where}law '{law.name}' of kind '{law.kind}' commands the bare robot, around which no hardware "
                "stands; leave it out of laws"
            )


def _check_coupling(where: str, laws: Sequence[Law], scenario: Scenario) -> None:
    if scenario.disturbances or scenario.signals or scenario.resolved_hardware != IDEAL:
        raise ValueError(
            f"{where}scenario '{scenario.name}' has disturbances, noise or hardware; the coupling error is that of the "
            "ideal loop: name a scenario without"
        )
    for law in laws:
        if law.loop().block.clocks or not knows_hardware(law.kind):
            raise ValueError(f"{where}law '{law.name}' of kind '{law.kind}' cannot be coupled; leave it out of laws")
