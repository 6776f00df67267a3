"""Study files: which scenarios run under which laws, in TOML read by pydantic.

A study has parameters common to all runs, a list of laws and a list of scenarios; every scenario runs under every law
it names. Laws set only the switching term (``P``, ``phi``), so that all laws of a study share one linear part.
"""

from __future__ import annotations

import hashlib
import json
import tomllib
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    Field,
    FiniteFloat,
    PlainSerializer,
    ValidationError,
    model_validator,
)

from brunovsky._frozen import FrozenMapping
from brunovsky.comparison.chatter_grid import MOST_POINTS, ChatterGrid, ChatterTable
from brunovsky.comparison.keys import input_keys, parameter_keys, remedy, study_block
from brunovsky.comparison.problems import describe
from brunovsky.comparison.study_table import StudyTable, by_name, in_range, known_key
from brunovsky.errors import StudyError

FASTEST_LAYER = 2.5  # step times pole of a boundary layer; RK4 is unstable on the real axis from 2.785 on
MOST_STEPS = 2e6  # of one run, which is kept in memory
SWITCHING = ("P", "phi")  # what a law sets, and nothing else does
Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]*$")]
LawKind = Literal["linear", "saturation", "sign"]
EngineName = Literal["fmpy", "native"]


def _scenario_parameter(text: str) -> str:
    key = parameter_keys()[known_key(text, parameter_keys(), "parameter or unit")]
    if key.variable.name in SWITCHING:
        raise ValueError("belongs to a law, so that laws differ in nothing else; move it to a [[laws]] table")
    return text


def _law_parameter(text: str) -> str:
    key = parameter_keys()[known_key(text, parameter_keys(), "parameter or unit")]
    if key.variable.name not in SWITCHING:
        raise ValueError("is shared by all laws, which differ only in P and phi; move it to [parameters] or a scenario")
    return text


def _disturbance(text: str) -> str:
    return known_key(text, input_keys(), "disturbance or unit")


_Freeze = (AfterValidator(in_range), PlainSerializer(dict))
ScenarioTable = Annotated[Mapping[Annotated[str, AfterValidator(_scenario_parameter)], FiniteFloat], *_Freeze]
LawTable = Annotated[Mapping[Annotated[str, AfterValidator(_law_parameter)], FiniteFloat], *_Freeze]
DisturbanceTable = Annotated[Mapping[Annotated[str, AfterValidator(_disturbance)], FiniteFloat], *_Freeze]


class Law(StudyTable):
    """One outer loop: the shared linear part, plus a switching term or none.

    ``linear`` is pole placement (P = 0), ``saturation`` the boundary layer (phi > 0), ``sign`` the relay (phi = 0).
    """

    name: Name
    kind: LawKind
    title: str = ""
    parameters: LawTable = Field(default_factory=lambda: FrozenMapping({}))

    @model_validator(mode="after")
    def _check_kind(self) -> Law:
        given = {parameter_keys()[text].variable.name for text in self.parameters}
        if self.kind == "linear" and given:
            raise ValueError("a linear law has no switching term: remove its parameters, or choose another kind")
        if self.kind == "sign" and "phi" in given:
            raise ValueError("kind 'sign' means phi = 0: remove phi, or choose kind 'saturation'")
        if self.kind == "saturation" and self.values["phi"] <= 0.0:
            raise ValueError("kind 'saturation' needs phi > 0; for phi = 0 choose kind 'sign'")
        return self

    @property
    def values(self) -> dict[str, float]:
        """P and phi of this law by their names in the model."""
        forced = {"linear": {"P": 0.0}, "sign": {"phi": 0.0}, "saturation": {}}[self.kind]
        defaults = {one.name: one.value for one in study_block().parameters if one.name in SWITCHING}
        return defaults | by_name(self.parameters, parameter_keys()) | forced


class Scenario(StudyTable):
    """One task for the robot: start, reference, disturbances and duration, run under several laws."""

    name: Name
    title: str
    about: str = ""
    figure: Literal["4", "5", "6"] | None = None
    duration_s: Annotated[FiniteFloat, Field(gt=0.0)]
    laws: tuple[str, ...] | None = Field(default=None, strict=False)
    parameters: ScenarioTable = Field(default_factory=lambda: FrozenMapping({}))
    disturbances: DisturbanceTable = Field(default_factory=lambda: FrozenMapping({}))


@dataclass(frozen=True)
class PlannedRun:
    """One scenario under one law, everything resolved to names and values of the model.

    Attributes
    ----------
    name, scenario, law : str
        ``scenario/law`` and its parts.
    duration, step_size : float
        In s.
    parameters, inputs : mapping of str to float
        All parameters and inputs (constant) of the block, SI.
    """

    name: str
    scenario: str
    law: str
    duration: float
    step_size: float
    parameters: Mapping[str, float]
    inputs: Mapping[str, float]

    def resolved(self) -> dict[str, Any]:
        """The same as plain data, for JSON."""
        data = asdict(self)
        return data | {"parameters": dict(self.parameters), "inputs": dict(self.inputs)}


class Study(StudyTable):
    """A comparison: laws, scenarios and how they are run."""

    name: Name
    title: str
    description: str = ""
    model: Literal["closed_loop"] = "closed_loop"
    engine: EngineName = "fmpy"
    step_size_s: Annotated[FiniteFloat, Field(gt=0.0)] = 1e-3
    parameters: ScenarioTable = Field(default_factory=lambda: FrozenMapping({}))
    laws: tuple[Law, ...] = Field(min_length=1, strict=False)
    scenarios: tuple[Scenario, ...] = Field(min_length=1, strict=False)
    chatter: tuple[ChatterTable, ...] = Field(default=(), strict=False)

    @model_validator(mode="after")
    def _check_runs(self) -> Study:
        for what, names in (("law", self.laws), ("scenario", self.scenarios)):
            seen: set[str] = set()
            for one in names:
                if one.name in seen:
                    raise ValueError(f"two {what}s are named '{one.name}'; rename one")
                seen.add(one.name)
        known = [law.name for law in self.laws]
        for scenario in self.scenarios:
            for name in scenario.laws or ():
                if name not in known:
                    raise ValueError(f"scenario '{scenario.name}': there is no law '{name}'; {remedy(name, known)}")
            if scenario.laws is not None and (not scenario.laws or len(set(scenario.laws)) < len(scenario.laws)):
                raise ValueError(f"scenario '{scenario.name}': laws must name at least one law, each once")
            if scenario.duration_s > MOST_STEPS * self.step_size_s:
                raise ValueError(
                    f"scenario '{scenario.name}': duration_s = {scenario.duration_s:g} is over {MOST_STEPS:g} steps of "
                    f"step_size_s = {self.step_size_s:g}; shorten the one or lengthen the other"
                )
        for run in self.plan():
            self._check_layer(run)
            for check in study_block().failed_checks(run.parameters, "start"):
                raise ValueError(f"scenario '{run.scenario}', law '{run.law}': {check.message}")
        return self

    @model_validator(mode="after")
    def _check_chatter(self) -> Study:
        points = sum(len(grid.loops) for grid in self.chatter_grids())
        if points > MOST_POINTS:
            raise ValueError(f"the chatter tables have {points} points together; give at most {MOST_POINTS}")
        return self

    def chatter_grids(self) -> tuple[ChatterGrid, ...]:
        """Grids of switching loops whose chatter is predicted and measured, a grid for each chatter table."""
        switching = [law for law in self.laws if law.kind != "linear" and law.values["P"] > 0.0]
        shared = study_block().parameter_values(by_name(self.parameters, parameter_keys()))
        return tuple(table.grid(k, shared, switching) for k, table in enumerate(self.chatter, 1))

    def _check_layer(self, run: PlannedRun) -> None:
        """Refuse a boundary layer too thin for the step: within it S' = -(Q + P/phi) S, a linear branch."""
        Q, P, phi = (run.parameters[name] for name in ("Q", "P", "phi"))
        if not P or not phi or self.step_size_s * (Q + P / phi) <= FASTEST_LAYER:
            return
        room = FASTEST_LAYER / self.step_size_s - Q
        remedies = [f"step_size_s of {0.99 * FASTEST_LAYER / (Q + P / phi):.2g} or less", "kind 'sign' (phi = 0)"]
        if room > 0.0:
            remedies.insert(0, f"phi_m_per_s2 of {1.01 * P / room:.3g} or more")
        raise ValueError(
            f"scenario '{run.scenario}', law '{run.law}': the boundary layer phi_m_per_s2 = {phi:g} is too thin for "
            f"step_size_s = {self.step_size_s:g}: its pole Q + P/phi = {Q + P / phi:.4g} 1/s is beyond "
            f"{FASTEST_LAYER:g}/step_size_s = {FASTEST_LAYER / self.step_size_s:.4g} 1/s (RK4 is unstable "
            f"from 2.785/step_size_s on); choose "
            f"{', '.join(remedies[:-1])} or {remedies[-1]}"
        )

    def law(self, name: str) -> Law:
        """The law of this name."""
        return next(one for one in self.laws if one.name == name)

    def laws_of(self, scenario: Scenario) -> tuple[Law, ...]:
        """Laws that a scenario runs under, in the order of the study."""
        return tuple(one for one in self.laws if scenario.laws is None or one.name in scenario.laws)

    def plan(self) -> tuple[PlannedRun, ...]:
        """All runs, scenario by scenario, law by law."""
        return tuple(self._planned(scenario, law) for scenario in self.scenarios for law in self.laws_of(scenario))

    def _planned(self, scenario: Scenario, law: Law) -> PlannedRun:
        inputs = {one.name: one.start for one in study_block().inputs}
        tables = by_name(self.parameters, parameter_keys()) | by_name(scenario.parameters, parameter_keys())
        return PlannedRun(
            name=f"{scenario.name}/{law.name}",
            scenario=scenario.name,
            law=law.name,
            duration=scenario.duration_s,
            step_size=self.step_size_s,
            parameters=FrozenMapping(study_block().parameter_values(tables | law.values)),
            inputs=FrozenMapping(inputs | by_name(scenario.disturbances, input_keys())),
        )

    def digest(self) -> str:
        """SHA-256 of the resolved runs: equal for studies that ask for the same simulations."""
        runs = [one.resolved() for one in self.plan()]
        return hashlib.sha256(json.dumps(runs, sort_keys=True).encode()).hexdigest()


def load_study(path: str | Path) -> Study:
    """Read and check a study file.

    Parameters
    ----------
    path : path
        TOML file.

    Raises
    ------
    StudyError
        If it cannot be read, is not TOML, or has an unknown key or unit, a wrong type or a value out of range; one
        line that names the file, the line, the key and the remedy.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise StudyError(f"{path}: there is no such study file; check the path") from None
    except (OSError, UnicodeDecodeError) as error:
        raise StudyError(f"{path}: cannot be read as UTF-8 text ({error}); give a TOML file") from None
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise StudyError(f"{path}: is not valid TOML: {error}; correct the syntax there") from None
    try:
        return Study.model_validate(data)
    except ValidationError as error:
        raise StudyError(
            describe(path, text, error, {"": Study, "laws": Law, "scenarios": Scenario, "chatter": ChatterTable})
        ) from None
