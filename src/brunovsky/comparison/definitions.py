"""What each metric is: one table for the appendix of a report, its JSON and the headers of its CSV files."""

from __future__ import annotations

from dataclasses import asdict, dataclass


@dataclass(frozen=True)
class Definition:
    """Definition of one metric.

    Attributes
    ----------
    name : str
        As in metrics.json.
    title : str
        For the rows of tables.
    unit : str
        For people: SI, with superscripts.
    sentence : str
        What is measured, when it is not defined.
    formula : str
        The same in symbols; e is the position error (m), T the duration, t_k the recorded instants.
    """

    name: str
    title: str
    unit: str
    sentence: str
    formula: str

    def as_dict(self) -> dict[str, str]:
        """The same by name, ready for JSON."""
        return asdict(self)

    @property
    def phrase(self) -> str:
        """Title within a sentence: acronyms alone, what else explains in brackets."""
        first, comma, rest = self.title.partition(" (")[0].partition(", ")
        return f"{first} ({rest})" if comma and not first.isupper() else first

    @property
    def header(self) -> str:
        """Name with unit, the header of a column."""
        return f"{self.name} [{self.unit}]"


CONTRACT_METRICS = tuple(
    Definition(*row)
    for row in (
        (
            "settling_time",
            "settling time to 1 cm",
            "s",
            "Last recorded instant at which the position error exceeds 1 cm; 0 if it never does, not defined if it "
            "still does at the end.",
            "max{t_k : e(t_k) > 0.01 m}",
        ),
        (
            "settling_1mm",
            "settling time to 1 mm",
            "s",
            "The same for 1 mm.",
            "max{t_k : e(t_k) > 0.001 m}",
        ),
        (
            "settling_100um",
            "settling time to 0.1 mm",
            "s",
            "The same for 0.1 mm.",
            "max{t_k : e(t_k) > 0.0001 m}",
        ),
        (
            "iae",
            "IAE, integral of the position error",
            "m s",
            "Integral of the distance between the robot and its reference, by the trapezoidal rule over the steps.",
            "∫ e dt, e = √(e₁₁² + e₂₁²)",
        ),
        (
            "ise",
            "ISE, integral of its square",
            "m² s",
            "Integral of the square of that distance.",
            "∫ e² dt",
        ),
        (
            "itae",
            "ITAE, integral of time × error",
            "m s²",
            "Integral of time times that distance, which weighs what remains late.",
            "∫ t e dt",
        ),
        (
            "final_error",
            "final position error",
            "m",
            "Position error at the last instant.",
            "e(T)",
        ),
        (
            "rms_tail_error",
            "RMS position error, last quarter",
            "m",
            "Root of the mean of the squared position error over the instants of the last quarter of the run.",
            "√(mean e²), t ≥ 3T/4",
        ),
        (
            "peak_speed",
            "largest |η₁|",
            "m/s",
            "Largest magnitude of the forward velocity.",
            "max |η₁|",
        ),
        (
            "min_speed",
            "smallest |η₁|",
            "m/s",
            "Smallest magnitude of the forward velocity, the distance from the singularity of the law.",
            "min |η₁|",
        ),
        (
            "peak_yaw_acceleration",
            "largest |u₂|",
            "rad/s²",
            "Largest magnitude of the yaw acceleration.",
            "max |u₂|",
        ),
        (
            "effort_u1",
            "effort, integral of u₁²",
            "m²/s³",
            "Integral of the square of the forward acceleration.",
            "∫ u₁² dt",
        ),
        (
            "effort_u2",
            "effort, integral of u₂²",
            "rad²/s³",
            "Integral of the square of the yaw acceleration.",
            "∫ u₂² dt",
        ),
        (
            "total_variation_u1",
            "total variation of u₁",
            "m/s²",
            "Sum of the absolute changes of the forward acceleration from one recorded instant to the next.",
            "Σ |u₁(t_k+1) − u₁(t_k)|",
        ),
        (
            "total_variation_u2",
            "total variation of u₂",
            "rad/s²",
            "Sum of the absolute changes of the yaw acceleration from one recorded instant to the next.",
            "Σ |u₂(t_k+1) − u₂(t_k)|",
        ),
    )
)
"""What every comparison tells."""

FURTHER_METRICS = tuple(
    Definition(*row)
    for row in (
        (
            "min_speed_moving",
            "smallest |η₁| while moving",
            "m/s",
            "Smallest magnitude of the forward velocity while there is somewhere to go: over the whole run if the "
            "reference moves by more than 1 cm, otherwise until the settling time; 0 if the velocity changes its "
            "sign meanwhile, between whatever steps. It tells a passage near the singularity from rest at the goal.",
            "min |η₁(t)|, t ≤ T or t ≤ settling time; 0 where η₁ changes sign",
        ),
        (
            "peak_forward_acceleration",
            "largest |u₁|",
            "m/s²",
            "Largest magnitude of the forward acceleration.",
            "max |u₁|",
        ),
        (
            "rms_u1",
            "RMS u₁",
            "m/s²",
            "Root mean square of the forward acceleration over the run.",
            "√((1/T) ∫ u₁² dt)",
        ),
        (
            "rms_u2",
            "RMS u₂",
            "rad/s²",
            "Root mean square of the yaw acceleration over the run.",
            "√((1/T) ∫ u₂² dt)",
        ),
        (
            "effort_v",
            "effort of the outer loop, integral of v₁² + v₂²",
            "m²/s⁵",
            "Integral of the squared magnitude of the jerk that the outer loop asks for; not defined where v was not "
            "recorded.",
            "∫ (v₁² + v₂²) dt",
        ),
        (
            "reaching_time",
            "reaching time",
            "s",
            "Last recorded instant at which the larger of |S₁| and |S₂| exceeds the band, so that both stay in it from "
            "then on. The band is one for all laws that are compared: the widest boundary layer φ among them, at least "
            "0.01 m/s². 0 if never, not defined if they still exceed it at the end or S was not recorded.",
            "max{t_k : max(|S₁|, |S₂|) > max(φ of all laws, 0.01 m/s²)}",
        ),
        (
            "sliding_band",
            "largest |S|, last quarter",
            "m/s²",
            "Largest magnitude of the two sliding variables in the last quarter of the run.",
            "max(|S₁|, |S₂|), t ≥ 3T/4",
        ),
        (
            "chatter_frequency",
            "chatter frequency",
            "rad/s",
            "Mean angular frequency of the sliding variable that oscillates most, from one upward crossing of its mean "
            "to the next, in the last quarter of the run. Not defined where there is no chatter: the law does not "
            "switch, neither sliding variable makes three whole periods about zero, or its amplitude stays within the "
            "boundary layer, where the law is linear. An oscillation that a disturbance forces beyond the layer "
            "counts as well.",
            "2π × periods / their duration",
        ),
        (
            "chatter_amplitude",
            "chatter amplitude of S",
            "m/s²",
            "Half of the range of that sliding variable, mean over its periods.",
            "½ (max S − min S)",
        ),
        (
            "chatter_amplitude_u1",
            "chatter amplitude of u₁",
            "m/s²",
            "Half of the range of the forward acceleration within one period of the chatter, mean over the last "
            "quarter.",
            "½ (max u₁ − min u₁)",
        ),
        (
            "chatter_amplitude_u2",
            "chatter amplitude of u₂",
            "rad/s²",
            "Half of the range of the yaw acceleration within one period of the chatter, mean over the last quarter.",
            "½ (max u₂ − min u₂)",
        ),
        (
            "chatter_samples",
            "steps in a period of the chatter",
            "1",
            "Recorded instants in one period of the chatter. Where there are but a few, the step makes the chatter: "
            "its frequency and amplitude belong to the sampling, not to the law alone.",
            "instants / periods",
        ),
        (
            "final_heading_error",
            "final heading error",
            "rad",
            "Magnitude of the difference between the heading at the last instant and that of the goal, modulo 2π; "
            "not defined where the task names no heading of the goal.",
            "|θ(T) − θ_goal| mod 2π",
        ),
        (
            "arrival_time",
            "arrival time",
            "s",
            "Last recorded instant at which the robot does not rest at the goal: off by more than 5 mm or 0.02 rad, or "
            "moving faster than 1 mm/s or 1 mrad/s. 0 if never, not defined if so at the end, or where the task names "
            "no heading of the goal.",
            "max{t_k : e > 5 mm or |θ − θ_goal| > 0.02 rad or |η₁| > 1 mm/s or |η₂| > 1 mrad/s}",
        ),
    )
)
"""What else is measured: reaching, chatter, inputs."""

METRIC_DEFINITIONS = CONTRACT_METRICS + FURTHER_METRICS
"""Definitions of all metrics in the order in which they are told."""


UNREACHED = frozenset({"settling_time", "settling_1mm", "settling_100um", "reaching_time", "arrival_time"})
"""Times that are not defined where they are beyond the end of the run, so that not defined means longest."""

BETTER_GREATER = frozenset({"min_speed", "min_speed_moving"})
"""Metrics that are distances from trouble; of all others the lower is the better, or neither."""


def definition(name: str) -> Definition | None:
    """Definition of a metric, None for a name that is not one."""
    return next((one for one in METRIC_DEFINITIONS if one.name == name), None)
