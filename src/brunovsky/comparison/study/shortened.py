"""The short form of a study: the same tables, cut to runs and protocols that take seconds."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

TRIALS: Mapping[str, Callable[[dict[str, Any]], dict[str, Any]]] = {
    "swept": lambda one: {"values": (one["values"][0], one["values"][-1])},
    "equal_effort": lambda one: {"budget": 10},
    "pareto": lambda one: {"budget": 2},
    "map": lambda one: {axis: {**one[axis], "points": 2} for axis in ("across", "up") if one.get(axis)},
    "coupling": lambda one: {"communication_steps_s": one["communication_steps_s"][-2:], "derivatives": (0,)},
    "margins": lambda one: {"cuts": one["cuts"][-1:], "changes": one["changes"][:1], "tolerance": 0.2},
    "monte_carlo": lambda one: {"cases": min(one["cases"], 3)},
}
"""What of a protocol is cut, by its kind."""


def shortened_tables(study: Mapping[str, Any], duration_s: float) -> dict[str, Any]:
    """Tables of a study, dumped from its model, with nothing longer than a duration.

    Signals keep their place in the run: their instants and widths shrink with its duration, their amplitudes and
    frequencies do not. Of a grid of chatter its first point is kept.
    """
    return {
        **study,
        "scenarios": tuple(_scenario(one, duration_s) for one in study["scenarios"]),
        "protocols": tuple(_protocol(one, duration_s) for one in study["protocols"]),
        "chatter": tuple(_grid(one) for one in study["chatter"]),
    }


def _scenario(one: Mapping[str, Any], longest: float) -> dict[str, Any]:
    duration = min(one["duration_s"], longest)
    share = duration / one["duration_s"]
    return {**one, "duration_s": duration, "signals": tuple(_signal(signal, share) for signal in one["signals"])}


def _signal(one: Mapping[str, Any], share: float) -> dict[str, Any]:
    shrunk = {key: share * one[key] for key in ("start_s", "stop_s", "width_s") if one.get(key) is not None}
    return {**one, **shrunk}


def _protocol(one: dict[str, Any], longest: float) -> dict[str, Any]:
    duration = {"duration_s": min(one["duration_s"], longest)} if one.get("duration_s") else {}
    return {**one, **TRIALS[one["kind"]](one), **duration}


def _grid(one: Mapping[str, Any]) -> dict[str, Any]:
    first = {key: values[:1] for key, values in one["parameters"].items()}
    return {**one, "lags_s": one["lags_s"][:1], "delay_s": one["delay_s"][:1], "parameters": first}
