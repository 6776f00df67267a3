"""Keys of a study as symbols with units, for sentences and axes: ``P_m_per_s3`` is P in m/s³."""

from __future__ import annotations

import re
from collections.abc import Callable

from brunovsky.comparison.facts import given

_UNIT = re.compile(r"(_(?:m|s|rad))?((?:_per_(?:m|s|rad)\d?)*)$")
_LETTERS = {"C": "c", "rho": "ρ", "phi": "φ", "gamma": "γ"}
_SYMBOLS = {
    "x_start": "x(0)",
    "y_start": "y(0)",
    "theta_start": "θ(0)",
    "eta_start_1": "η₁(0)",
    "eta_start_2": "η₂(0)",
    "u_start_1": "u₁(0)",
    "u_start_2": "u₂(0)",
    "eta_min": "η_min",
    "radius": "radius of the circle",
    "rate": "rate of the circle",
    "phase": "phase of the circle",
    "center_1": "x of the centre",
    "center_2": "y of the centre",
    "goal_1": "x of the goal",
    "goal_2": "y of the goal",
    "goal_heading": "heading of the goal",
    "sampling_period": "sampling period",
    "u1_max": "limit of u₁",
    "u2_max": "limit of u₂",
}
_EXPONENTS = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
_INDICES = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


def symbol(key: str) -> str:
    """What a key of a study names, without its unit; a name that has no symbol stays as it is."""
    stem = _UNIT.sub("", key)
    if stem in _SYMBOLS:
        return _SYMBOLS[stem]
    letter, _, index = stem.partition("_")
    if index and not index.isdigit():
        return stem
    return _LETTERS.get(letter, letter) + index.translate(_INDICES)


def key_unit(key: str) -> str:
    """Unit of a key as people write it, such as ``"m/s³"``; empty where it has none."""
    found = _UNIT.search(key)
    over, under = (found.group(1) or "", found.group(2)) if found else ("", "")
    text = (over.removeprefix("_") or ("1" if under else "")) + under.replace("_per_", "/")
    return re.sub(r"\d+$", lambda digits: digits.group().translate(_EXPONENTS), text) if under else text


def variable_symbol(name: str) -> str:
    """Symbol of a variable of a block: ``C[1]`` is c₁."""
    return symbol(name.replace("[", "_").replace("]", ""))


def unit_text(unit: str) -> str:
    """Unit of a variable of a block as people write it: ``m/s3`` is m/s³; empty for ``1``."""
    return "" if unit == "1" else re.sub(r"(?<=[a-z])\d+", lambda digits: digits.group().translate(_EXPONENTS), unit)


def with_key_unit(key: str) -> str:
    """Symbol and unit, the title of an axis."""
    return f"{symbol(key)}, {key_unit(key)}" if key_unit(key) else symbol(key)


def key_value(value: float, key: str, text: Callable[[float], str] = given) -> str:
    """A value of a key with its unit."""
    return f"{text(value)}\u00a0{key_unit(key)}".rstrip()


def setting(key: str, value: float, text: Callable[[float], str] = given) -> str:
    """A key that is set, as an equation with its unit."""
    return f"{symbol(key)} = {key_value(value, key, text)}"
