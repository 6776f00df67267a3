"""Protocols of fairness that a study asks for, each for one of its scenarios."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import (
    AfterValidator,
    Field,
    FiniteFloat,
    PlainSerializer,
    ValidationInfo,
    WithJsonSchema,
    model_validator,
)

from brunovsky._frozen import FrozenMapping
from brunovsky.analysis.coupling.scheme import Scheme
from brunovsky.comparison.definitions import METRIC_DEFINITIONS, definition
from brunovsky.comparison.study.keys import kinds_of, known_parameter, remedy
from brunovsky.comparison.study.law import Name
from brunovsky.comparison.study.table import StudyTable

BANDWIDTH = "bandwidth"
"""Knob that scales the linear part in time: every gain of the outer loop in 1/s^n by its n-th power."""
MOST_POINTS = 20_000  # of a map


GROUPS: Mapping[str, tuple[str, ...]] = {
    "lag_s": ("lag[1]", "lag[2]"),
    "delay_s": ("delay[1]", "delay[2]"),
    "sampling_period_s": ("sampling_period", "controller.sampling_period"),
    "loop_gain": ("rho[1]", "rho[2]"),
}
"""Knobs that set several parameters of a loop alike: lags and delays of both commands where the scenario has them, the
period of sensors, law and commands, and the gain of both actuators (ratios of nominal to true mass and inertia)."""


def _metric(name: str) -> str:
    if definition(name) is None:
        raise ValueError(f"there is no metric '{name}'; {remedy(name, [one.name for one in METRIC_DEFINITIONS])}")
    return name


def _knob(text: str, info: ValidationInfo) -> str:
    if text != BANDWIDTH and text not in GROUPS:
        known_parameter(text, kinds_of(info))
    return text


def _frozen(table: Mapping[str, object]) -> FrozenMapping[str, object]:
    return FrozenMapping(table)


_METRICS = {"type": "string", "enum": [one.name for one in METRIC_DEFINITIONS]}
Metric = Annotated[str, AfterValidator(_metric), WithJsonSchema(_METRICS)]
KnobKey = Annotated[str, AfterValidator(_knob)]
Cut = Literal["u1", "u2", "both"]
Change = Literal["gain", "delay", "lag", "two_lags", "sampling"]
Range = Annotated[tuple[FiniteFloat, FiniteFloat], Field(strict=False)]


def _thawed(table: Mapping[str, Any]) -> dict[str, Any]:
    return {key: dict(value) if isinstance(value, Mapping) else value for key, value in table.items()}


_Plain = (AfterValidator(_frozen), PlainSerializer(_thawed))


class _Protocol(StudyTable):
    """What all protocols share."""

    scenario: Name
    laws: tuple[str, ...] | None = Field(default=None, strict=False, min_length=1)
    metrics: tuple[Metric, ...] = Field(min_length=1, strict=False)
    step_size_s: Annotated[FiniteFloat, Field(gt=0.0)] | None = None
    duration_s: Annotated[FiniteFloat, Field(gt=0.0)] | None = None

    @property
    def knobs(self) -> dict[str, set[str]]:
        """Keys that are set, by law; under ``""`` those of all laws."""
        return {}


class SweptTable(_Protocol):
    """The same linear part, one parameter swept: by default what the switching gain P adds."""

    kind: Literal["swept"]
    knob: KnobKey = "P_m_per_s3"
    values: tuple[FiniteFloat, ...] = Field(min_length=2, strict=False)

    @property
    def knobs(self) -> dict[str, set[str]]:
        """The swept parameter, for all laws."""
        return {"": {self.knob}}


class KnobTable(StudyTable):
    """What is tuned about a law, and between which values."""

    knob: KnobKey
    low: Annotated[FiniteFloat, Field(gt=0.0)]
    high: Annotated[FiniteFloat, Field(gt=0.0)]

    @model_validator(mode="after")
    def _check(self) -> KnobTable:
        if self.low >= self.high:
            raise ValueError(f"low = {self.low:g} must be below high = {self.high:g}")
        return self


class EqualEffortTable(_Protocol):
    """Each law tuned by one knob until a physical input has the same effort: a number, or that of a law as it is."""

    kind: Literal["equal_effort"]
    effort: Metric
    target: Annotated[FiniteFloat, Field(gt=0.0)] | None = None
    target_law: str | None = None
    tuned: Annotated[Mapping[str, KnobTable], *_Plain] = Field(min_length=1)
    budget: Annotated[int, Field(ge=10, le=1000)] = 40

    @model_validator(mode="after")
    def _check(self) -> EqualEffortTable:
        if (self.target is None) == (self.target_law is None):
            raise ValueError("give target, the effort in SI units, or target_law, whose effort it is; one of the two")
        return self

    @property
    def knobs(self) -> dict[str, set[str]]:
        """The tuned knob of each law."""
        return {law: {one.knob} for law, one in self.tuned.items()}


class ParetoTable(_Protocol):
    """Fronts of two metrics, each law tuned with the same number of designs over its own knobs."""

    kind: Literal["pareto"]
    objectives: Annotated[tuple[Metric, Metric], Field(strict=False)] = ("iae", "total_variation_u2")
    spaces: Annotated[Mapping[str, Annotated[Mapping[KnobKey, Range], *_Plain]], *_Plain]
    budget: Annotated[int, Field(ge=2, le=4096)] = 32
    metrics: tuple[Metric, ...] = Field(default=(), strict=False)

    @model_validator(mode="after")
    def _check(self) -> ParetoTable:
        if self.budget & (self.budget - 1):
            raise ValueError(f"budget = {self.budget} must be a power of two, such as 32")
        for law, space in self.spaces.items():
            for knob, (low, high) in space.items():
                if not 0.0 < low < high:
                    raise ValueError(f"spaces.{law}.{knob}: give [low, high] with 0 < low < high")
        return self

    @property
    def knobs(self) -> dict[str, set[str]]:
        """The knobs of each law."""
        return {law: set(space) for law, space in self.spaces.items()}


class DistributionTable(StudyTable):
    """One of ``uniform = [low, high]``, ``normal = [mean, deviation]``, ``loguniform = [low, high]``."""

    uniform: Range | None = None
    normal: Range | None = None
    loguniform: Range | None = None

    @model_validator(mode="after")
    def _check(self) -> DistributionTable:
        given = [kind for kind in ("uniform", "normal", "loguniform") if getattr(self, kind) is not None]
        if len(given) != 1:
            raise ValueError("give one of uniform, normal and loguniform")
        first, second = self.pair
        usable = {"uniform": first < second, "normal": second > 0.0, "loguniform": 0.0 < first < second}
        if not usable[given[0]]:
            wanted = {"uniform": "low < high", "normal": "[mean, deviation > 0]", "loguniform": "0 < low < high"}
            raise ValueError(f"{given[0]} = [{first:g}, {second:g}]; give {wanted[given[0]]}")
        return self

    @property
    def shape(self) -> Literal["uniform", "normal", "loguniform"]:
        """Which distribution it is."""
        return "uniform" if self.uniform else "normal" if self.normal else "loguniform"

    @property
    def pair(self) -> tuple[float, float]:
        """Its two numbers."""
        found = self.uniform or self.normal or self.loguniform
        assert found is not None
        return found


class MonteCarloTable(_Protocol):
    """Cases with drawn parameters and noise, the same under every law.

    ``resting_poses_within_m`` draws starts at rest, uniform in a disc about the origin, with headings of start
    and goal. ``worst`` names the metric by which the worst cases are drawn as paths.
    """

    kind: Literal["monte_carlo"]
    cases: Annotated[int, Field(ge=2, le=100_000)] = 100
    distributions: Annotated[Mapping[KnobKey, DistributionTable], *_Plain] = Field(
        default_factory=lambda: FrozenMapping({})
    )
    resting_poses_within_m: Annotated[FiniteFloat, Field(gt=0.0)] | None = None
    near_m_per_s: Annotated[FiniteFloat, Field(gt=0.0)] = 0.05
    worst: Metric | None = None

    @property
    def knobs(self) -> dict[str, set[str]]:
        """What is drawn, for all laws."""
        return {"": set(self.distributions)}


class AxisTable(StudyTable):
    """A key that is swept along an axis of a map: so many values from low to high, both included."""

    knob: KnobKey
    low: FiniteFloat
    high: FiniteFloat
    points: Annotated[int, Field(ge=2, le=1000)]

    @model_validator(mode="after")
    def _check(self) -> AxisTable:
        if self.low >= self.high:
            raise ValueError(f"low = {self.low:g} must be below high = {self.high:g}")
        return self

    @property
    def values(self) -> tuple[float, ...]:
        """The values, ascending."""
        width = (self.high - self.low) / (self.points - 1)
        return (*(self.low + k * width for k in range(self.points - 1)), self.high)


class MapTable(_Protocol):
    """Metrics over one or two swept keys, as a map: how a law depends on the start, say. Holds nothing else equal."""

    kind: Literal["map"]
    across: AxisTable
    up: AxisTable | None = None

    @model_validator(mode="after")
    def _check(self) -> MapTable:
        if self.up is not None and self.up.knob == self.across.knob:
            raise ValueError(f"across and up are both {self.up.knob}; give two keys, or leave out up")
        runs = self.across.points * (self.up.points if self.up else 1)
        if runs > MOST_POINTS:
            raise ValueError(f"the map has {runs} points; give at most {MOST_POINTS}")
        return self

    @property
    def knobs(self) -> dict[str, set[str]]:
        """What is swept, for all laws."""
        return {"": {self.across.knob, *([self.up.knob] if self.up else [])}}


class MarginsTable(_Protocol):
    """Gain, delay, lags or sampling period at which each law loses a scenario, by bisection on whole simulations.

    Each change acts at the actuators of ``cuts``: of u1, of u2, or of both alike. A run counts as stable if its
    position error stays within ``bound_m`` over its last quarter without growing, where under a law that chatters what
    is below ``still_m`` may grow; the runs are native.
    """

    kind: Literal["margins"]
    metrics: tuple[Metric, ...] = Field(default=(), strict=False)
    cuts: tuple[Cut, ...] = Field(default=("both",), min_length=1, strict=False)
    changes: tuple[Change, ...] = Field(default=("gain", "delay", "lag", "two_lags"), min_length=1, strict=False)
    bound_m: Annotated[FiniteFloat, Field(gt=0.0)] = 0.05
    still_m: Annotated[FiniteFloat, Field(gt=0.0)] = 1e-4
    lowest_gain: Annotated[FiniteFloat, Field(gt=0.0, lt=1.0)] = 0.01
    highest_gain: Annotated[FiniteFloat, Field(gt=1.0)] = 100.0
    shortest_s: Annotated[FiniteFloat, Field(gt=0.0)] = 1e-3
    longest_s: Annotated[FiniteFloat, Field(gt=0.0)] = 0.1
    tolerance: Annotated[FiniteFloat, Field(gt=0.0, le=0.2)] = 0.01

    @model_validator(mode="after")
    def _check(self) -> MarginsTable:
        if self.shortest_s >= self.longest_s:
            raise ValueError(f"shortest_s = {self.shortest_s:g} must be below longest_s = {self.longest_s:g}")
        if "sampling" in self.changes and self.cuts != ("both",):
            raise ValueError("sampling changes sensors, law and all commands together; give cuts = ['both']")
        return self


class CouplingTable(_Protocol):
    """Components of a loop as FMUs that exchange values at communication points alone, against the loop as one system.

    A run whose error exceeds ``lost_m`` counts as lost; the order of convergence is that of steps up to ``small_s``.
    """

    kind: Literal["coupling"]
    metrics: tuple[Metric, ...] = Field(default=(), strict=False)
    communication_steps_s: tuple[Annotated[FiniteFloat, Field(gt=0.0)], ...] = Field(min_length=2, strict=False)
    schemes: tuple[Scheme, ...] = Field(default=("jacobi", "gauss_seidel"), min_length=1, strict=False)
    derivatives: tuple[Annotated[int, Field(ge=0, le=3)], ...] = Field(default=(0, 1), min_length=1, strict=False)
    lost_m: Annotated[FiniteFloat, Field(gt=0.0)] = 1.0
    small_s: Annotated[FiniteFloat, Field(gt=0.0)] = 2e-3


Protocol: TypeAlias = Annotated[
    SweptTable | EqualEffortTable | ParetoTable | MonteCarloTable | MapTable | MarginsTable | CouplingTable,
    Field(discriminator="kind"),
]
