"""Runs of a study with everything resolved to names and values of the model."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from brunovsky._frozen import FrozenMapping
from brunovsky.comparison.metrics import REACHED
from brunovsky.comparison.study.loops import IDEAL, Loop
from brunovsky.comparison.study.signals import Array, Signal, noise_series


@dataclass(frozen=True)
class PlannedRun:
    """One scenario under one law.

    Attributes
    ----------
    name, scenario, law : str
        ``scenario/law`` and its parts.
    duration, step_size : float
        In s.
    parameters : mapping of str to float
        All parameters of the block, SI.
    inputs : mapping of str to float
        The inputs' constant part, SI.
    loop : Loop
        Which block it simulates.
    signals : tuple of Signal
        Disturbances that vary.
    noise : mapping of str to float
        Standard deviation of each noise input.
    noise_period : float
        For how long a value of the noise is held, s.
    seed : tuple of int
        Of the noise: equal for the laws of a scenario.
    band : float
        Half-width of the band about S = 0 that counts as reached, the same for all laws of the study, m/s2.
    goal_heading : float or None
        Heading that the robot should have at the end, where the task names one, rad; some laws don't know it.
    given : frozenset of str
        Parameters and inputs that the study itself sets; the others are the block's defaults.
    """

    name: str
    scenario: str
    law: str
    duration: float
    step_size: float
    parameters: Mapping[str, float]
    inputs: Mapping[str, float]
    loop: Loop = field(default_factory=Loop)
    signals: tuple[Signal, ...] = ()
    noise: Mapping[str, float] = FrozenMapping({})
    noise_period: float = 1e-3
    seed: tuple[int, ...] = (0,)
    band: float = REACHED
    goal_heading: float | None = None
    given: frozenset[str] = frozenset()

    @property
    def is_undisturbed(self) -> bool:
        """Whether no disturbance, constant or not, and no noise acts."""
        return not (any(self.inputs.values()) or self.signals or self.noise)

    @property
    def is_uncertain(self) -> bool:
        """Whether mass or inertia is not the nominal one."""
        return any(self.parameters.get(f"rho[{k}]", 1.0) != 1.0 for k in (1, 2))

    @property
    def in_family(self) -> bool:
        """Whether its law is the paper's, with P or without: C, Q, P and phi are its parameters."""
        return self.loop.controller == "sliding_mode"

    @property
    def target(self) -> tuple[float, float] | None:
        """Point where the robot is to come to rest, m; None along a trajectory."""
        p = self.parameters
        if "goal[1]" in p:
            return p["goal[1]"], p["goal[2]"]
        return (p["center[1]"], p["center[2]"]) if p["radius"] == 0.0 else None

    @property
    def aim(self) -> tuple[float, float]:
        """Where the reference is at the start: a point to rest at, or one of the circle, m."""
        if self.target is not None:
            return self.target
        p = self.parameters
        turn = p["radius"] * math.cos(p["phase"]), p["radius"] * math.sin(p["phase"])
        return p["center[1]"] + turn[0], p["center[2]"] + turn[1]

    @property
    def guard(self) -> float | None:
        """abs(eta1) up to which the linearising inner loop is regularised, m/s; None for a loop that has none."""
        return self.parameters.get("eta_min") if "center[1]" in self.parameters else None

    @property
    def is_ideal(self) -> bool:
        """Whether sensors and actuators are ideal."""
        return self.loop.hardware == IDEAL

    @property
    def has_ideal_actuators(self) -> bool:
        """Whether commands act at once, without limits, and nothing is sampled."""
        return replace(self.loop.hardware, noisy=False, matched=False) == IDEAL

    @property
    def layer(self) -> float | None:
        """Half-width of the boundary layer (m/s2), 0 for a relay; None for a law without the paper's switching."""
        return self.parameters.get("phi", 0.0) if self.parameters.get("P") else None

    @property
    def measured(self) -> dict[str, float | None]:
        """What its metrics are measured against: layer, band and the heading of the goal."""
        return {"layer": self.layer, "band": self.band, "goal_heading": self.goal_heading}

    @property
    def is_constant(self) -> bool:
        """Whether its inputs are constant."""
        return not self.signals and not self.noise

    def series(self, time: Array) -> dict[str, float | Array]:
        """Inputs over time: a number where constant, else the value at each instant, held until the next."""
        found: dict[str, float | Array] = dict(self.inputs)
        for signal in self.signals:
            for name, amplitude in signal.amplitudes.items():
                found[name] = found[name] + amplitude * signal.shape(time)
        for name, values in noise_series(self.noise, self.noise_period, self.seed, time).items():
            found[name] = found[name] + values
        return found

    def resolved(self) -> dict[str, Any]:
        """The same as plain data, for JSON."""
        hardware = self.loop.hardware
        return {
            "name": self.name,
            "scenario": self.scenario,
            "law": self.law,
            "duration": self.duration,
            "step_size": self.step_size,
            "parameters": dict(self.parameters),
            "inputs": dict(self.inputs),
            "controller": self.loop.controller,
            "hardware": {
                name: [str(one) if one == float("inf") else one for one in value] if isinstance(value, tuple) else value
                for name, value in vars(hardware).items()
            },
            "signals": [one.model_dump(mode="json") for one in self.signals],
            "noise": dict(self.noise),
            "noise_period": self.noise_period if self.noise else None,
            "seed": list(self.seed) if self.noise else None,
            "goal_heading": self.goal_heading,
        }
