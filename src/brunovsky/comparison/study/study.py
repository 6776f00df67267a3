"""Study files: which scenarios run under which laws, in TOML read by pydantic.

A study has parameters common to all runs, a list of laws and a list of scenarios; every scenario runs under every law
it names. Laws of the paper's family set only the switching term (``P``, ``phi``) and share one linear part.
"""

from __future__ import annotations

import hashlib
import json
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

from pydantic import Field, FiniteFloat, PrivateAttr, ValidationError, field_validator, model_validator

from brunovsky._frozen import FrozenMapping
from brunovsky.analysis.coupling.scheme import Scheme
from brunovsky.comparison.metrics import REACHED
from brunovsky.comparison.study.chatter_grid import MOST_POINTS, ChatterGrid, ChatterTable
from brunovsky.comparison.study.communication import check_communication
from brunovsky.comparison.study.keys import loop_keys, parameter_keys, remedy, study_block
from brunovsky.comparison.study.law import Law, Name
from brunovsky.comparison.study.loops import KINDS, Hardware, LawKind, knows_hardware
from brunovsky.comparison.study.planned import PlannedRun
from brunovsky.comparison.study.planning import check_protocol, planned_run
from brunovsky.comparison.study.problems import describe, place_of
from brunovsky.comparison.study.protocols import Metric, Protocol
from brunovsky.comparison.study.scenario import Scenario, ScenarioTable
from brunovsky.comparison.study.shortened import shortened_tables
from brunovsky.comparison.study.signals import seed_of
from brunovsky.comparison.study.table import StudyTable, by_name
from brunovsky.errors import BrunovskyError, StudyError

FASTEST_LAYER = 2.5  # step times pole of a boundary layer; RK4 is unstable on the real axis from 2.785 on
MOST_STEPS = 2e6  # of one run, which is kept in memory
EngineName = Literal["fmpy", "native", "ssp"]
FigureName = Literal["path", "errors", "inputs", "sliding", "phase", "linear"]
FIGURES: tuple[FigureName, ...] = get_args(FigureName)
"""Figures of a report in their fixed order: five of each scenario, and those of the linear part."""


class Study(StudyTable):
    """A comparison: laws, scenarios and how they are run.

    ``engine = "ssp"`` runs the components of each loop as FMUs that exchange values every ``communication_step_s`` (the
    step by default), all at once (``scheme = "jacobi"``) or in sequence (``"gauss_seidel"``). ``fmu`` and ``ssp`` are
    files of your own, relative to the study file, that the engines ``fmpy`` and ``ssp`` run in place of the exported
    ones. ``metrics`` and ``figures`` are what the report shows, by default everything: neither changes what is run,
    what is claimed or what is kept beside the report. Figures of protocols come with these.
    """

    name: Name
    title: str
    description: str = ""
    model: Literal["closed_loop"] = "closed_loop"
    engine: EngineName = "fmpy"
    step_size_s: Annotated[FiniteFloat, Field(gt=0.0)] = 1e-3
    communication_step_s: Annotated[FiniteFloat, Field(gt=0.0)] | None = None
    scheme: Scheme = "gauss_seidel"
    fmu: str | None = None
    ssp: str | None = None
    seed: Annotated[int, Field(ge=0)] = 0
    metrics: tuple[Metric, ...] = Field(default=(), strict=False)
    figures: tuple[FigureName, ...] = Field(default=FIGURES, strict=False)
    parameters: ScenarioTable = Field(default_factory=lambda: FrozenMapping({}))
    laws: tuple[Law, ...] = Field(min_length=1, strict=False)
    scenarios: tuple[Scenario, ...] = Field(min_length=1, strict=False)
    chatter: tuple[ChatterTable, ...] = Field(default=(), strict=False)
    protocols: tuple[Protocol, ...] = Field(default=(), strict=False)
    _folder: Path | None = PrivateAttr(default=None)  # that of the study file, where it names others
    _places: dict[str, str] = PrivateAttr(default_factory=dict)  # where it does so

    @field_validator("metrics", "figures")
    @classmethod
    def _check_shown(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        twice = next((one for k, one in enumerate(names) if one in names[:k]), None)
        if twice is not None:
            raise ValueError(f"'{twice}' is named twice; name it once")
        return names

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
            self._check_hardware(scenario)
        self._check_parameters()
        self._check_files()
        if self.engine == "ssp":
            check_communication(self)
        for run in self.plan():
            self._check_layer(run)
            for check in run.loop.block.failed_checks(run.parameters, "start"):
                raise ValueError(f"scenario '{run.scenario}', law '{run.law}': {check.message}")
        return self

    def _check_files(self) -> None:
        """Refuse a file that the study's own engine would not run."""
        if (self.fmu or self.ssp) and not self._own(self.engine):
            named = "fmu" if self.fmu else "ssp"
            other = "fmpy" if self.fmu else "ssp"
            raise ValueError(
                f"{named} is run by engine '{other}', but engine is '{self.engine}'; write engine = '{other}', "
                f"or remove {named}"
            )

    def _own(self, engine: EngineName) -> str | None:
        return {"fmpy": self.fmu, "ssp": self.ssp}.get(engine)

    def own_file(self, engine: EngineName) -> Path | None:
        """File of the user's own that an engine runs in place of what it exports."""
        named = self._own(engine)
        return None if named is None else (self._folder or Path()) / named

    def own_place(self, engine: EngineName) -> str:
        """Where the study names that file: study file, line and key, as far as they are known."""
        key = "fmu" if engine == "fmpy" else engine
        return self._places.get(key, f"study '{self.name}': {key}")

    @property
    def communication_step(self) -> float:
        """Step at whose ends the components of a loop exchange values, s."""
        return self.communication_step_s or self.step_size_s

    def _check_hardware(self, scenario: Scenario) -> None:
        if scenario.noise.period_s is not None and scenario.noise.period_s < self.step_size_s:
            raise ValueError(
                f"scenario '{scenario.name}': noise.period_s = {scenario.noise.period_s:g} is shorter than "
                f"step_size_s = {self.step_size_s:g}, over which inputs are held; lengthen the one or shorten the other"
            )
        for law in self.laws_of(scenario):
            if scenario.resolved_hardware != law.loop().hardware and not knows_hardware(law.kind):
                raise ValueError(
                    f"scenario '{scenario.name}': law '{law.name}' of kind '{law.kind}' commands the bare robot; "
                    "noise, hardware and disturbances at v are there for laws that command v: name those in laws"
                )
            try:
                law.loop(scenario.resolved_hardware).block  # noqa: B018
            except BrunovskyError as error:
                raise ValueError(f"scenario '{scenario.name}': {error}") from None

    def _check_parameters(self) -> None:
        """Refuse a parameter that no loop has under which it would be used."""
        for scenario in self.scenarios:
            known = {text for law in self.laws_of(scenario) for text in loop_keys(law.loop(scenario.resolved_hardware))}
            for text in scenario.parameters:
                if text not in known:
                    raise ValueError(f"scenario '{scenario.name}': {text} belongs to none of its laws; remove it")
        used = {text for law in self.laws for text in loop_keys(law.loop())}
        for text in self.parameters:
            if text not in used:
                raise ValueError(f"parameters: {text} belongs to no law of this study; remove it")

    @model_validator(mode="after")
    def _check_protocols(self) -> Study:
        for k, protocol in enumerate(self.protocols, 1):
            where = f"protocols[{k}] "
            names = [one.name for one in self.scenarios]
            if protocol.scenario not in names:
                raise ValueError(
                    f"{where}there is no scenario '{protocol.scenario}'; {remedy(protocol.scenario, names)}"
                )
            check_protocol(
                protocol, where, self.laws_of(self.scenario(protocol.scenario)), self.scenario(protocol.scenario)
            )
        return self

    @model_validator(mode="after")
    def _check_chatter(self) -> Study:
        points = sum(len(grid.loops) for grid in self.chatter_grids())
        if points > MOST_POINTS:
            raise ValueError(f"the chatter tables have {points} points together; give at most {MOST_POINTS}")
        return self

    def chatter_grids(self) -> tuple[ChatterGrid, ...]:
        """Grids of switching loops whose chatter is predicted and measured, a grid for each chatter table."""
        switching = [law for law in self.laws if law.in_family and law.values["P"] > 0.0]
        given = {text: value for text, value in self.parameters.items() if text in parameter_keys()}
        shared = study_block().parameter_values(by_name(given, parameter_keys()))
        return tuple(table.grid(k, shared, switching) for k, table in enumerate(self.chatter, 1))

    def _check_layer(self, run: PlannedRun) -> None:
        """Refuse a boundary layer too thin for the step: within it S' = -(Q + P/phi) S, a linear branch."""
        Q, P, phi = (run.parameters.get(name, 0.0) for name in ("Q", "P", "phi"))
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
        return planned_run(
            law,
            scenario,
            shared=self.parameters,
            step_size=self.step_size_s,
            seed=seed_of(self.seed, scenario.name),
            band=self.band,
        )

    @property
    def band(self) -> float:
        """Half-width of the band about S = 0 that counts as reached under every law: the widest layer, m/s2."""
        layers = (law.values.get("phi", 0.0) for law in self.laws if law.in_family and law.values["P"])
        return max([REACHED, *layers])

    def scenario(self, name: str) -> Scenario:
        """The scenario of this name."""
        return next(one for one in self.scenarios if one.name == name)

    def laws_of_protocol(self, protocol: Protocol) -> tuple[Law, ...]:
        """Laws that a protocol compares, in the order of the study."""
        laws = self.laws_of(self.scenario(protocol.scenario))
        return tuple(one for one in laws if protocol.laws is None or one.name in protocol.laws)

    def planned_case(
        self,
        protocol: Protocol,
        law: Law,
        changed: Mapping[str, float],
        seed: tuple[int, ...] | None = None,
        hardware: Hardware | None = None,
    ) -> PlannedRun:
        """One run of a protocol: its scenario under a law, with keys changed, another seed of the noise or hardware."""
        scenario = self.scenario(protocol.scenario)
        return planned_run(
            law,
            scenario,
            shared=self.parameters,
            step_size=protocol.step_size_s or self.step_size_s,
            seed=seed or seed_of(self.seed, scenario.name),
            band=self.band,
            changed=changed,
            duration=protocol.duration_s,
            hardware=hardware,
        )

    def shortened(self, duration_s: float = 1.0) -> Study:
        """The same study with runs of at most a duration (s) and few trials: a quick look, and no result.

        Raises
        ------
        StudyError
            If the duration is not above zero.
        """
        if not duration_s > 0.0:
            raise StudyError(f"a study cannot be shortened to {duration_s!r} s; give a duration above 0")
        tables = shortened_tables(self.model_dump(exclude_none=True), duration_s)
        return Study.model_validate(tables, context={"kinds": _kinds(tables)})

    def resolved(self) -> str:
        """The study with all defaults, as JSON."""
        return json.dumps(self.model_dump(mode="json"), indent=1, ensure_ascii=False)

    def digest(self) -> str:
        """SHA-256 of the resolved study, as a report prints it."""
        return hashlib.sha256(self.resolved().encode()).hexdigest()

    def run_by(self, engine: EngineName) -> Study:
        """The same study under an engine.

        Raises
        ------
        StudyError
            If the study names a file that this engine does not run.
        """
        if (self.fmu or self.ssp) and not self._own(engine):
            named = f'fmu = "{self.fmu}"' if self.fmu else f'ssp = "{self.ssp}"'
            raise StudyError(
                f"study '{self.name}': engine '{engine}' does not run the study's own file; leave engine "
                f"'{self.engine}', or remove {named}"
            )
        return self if engine == self.engine else self.model_copy(update={"engine": engine})


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
        study = Study.model_validate(data, context={"kinds": _kinds(data)})
        if study.fmu or study.ssp:
            study._folder = path.parent
            study._places = {key: place_of(path, text, key) for key in ("fmu", "ssp")}
        return study
    except ValidationError as error:
        raise StudyError(
            describe(path, text, error, {"": Study, "laws": Law, "scenarios": Scenario, "chatter": ChatterTable})
        ) from None


def _kinds(data: Mapping[str, Any]) -> list[LawKind]:
    """Kinds of laws that a study file names, before it is checked: only their loops are made."""
    laws = data.get("laws")
    named = [one.get("kind") for one in laws if isinstance(one, dict)] if isinstance(laws, list | tuple) else []
    return [kind for kind in KINDS if kind in named]
