"""Units as integer exponents of SI base units and rad, the form FMI defines them in."""

from __future__ import annotations

import re
from functools import lru_cache

from brunovsky.errors import ModelError

BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
DERIVED_UNITS = {
    "N": "kg.m/s2",
    "J": "kg.m2/s2",
    "W": "kg.m2/s3",
    "Hz": "1/s",
    "V": "kg.m2/s3/A",
    "ohm": "kg.m2/s3/A2",
    "H": "kg.m2/s2/A2",
    "Wb": "kg.m2/s2/A",
}
_FACTOR = re.compile(r"([./*]?)([A-Za-z]+|1)(-?\d+)?")


@lru_cache
def unit_exponents(unit: str) -> tuple[int, ...]:
    """Exponents of a unit in the order of :data:`BASE_UNITS`.

    Parameters
    ----------
    unit : str
        Factors joined by ``.`` or ``/``, each with an integer exponent: ``"m/s2"``, ``"1/s"``, ``"kg.m2"``.

    Raises
    ------
    ModelError
        If the text is not such a product or names an unknown unit.
    """
    exponents = dict.fromkeys(BASE_UNITS, 0)
    position = 0
    while position < len(unit):
        match = _FACTOR.match(unit, position)
        if match is None or (position > 0) != bool(match[1]):
            break
        position = match.end()
        power = int(match[3] or 1) * (-1 if match[1] == "/" else 1)
        if match[2] in exponents:
            exponents[match[2]] += power
        elif match[2] in DERIVED_UNITS:
            for name, exponent in zip(BASE_UNITS, unit_exponents(DERIVED_UNITS[match[2]]), strict=True):
                exponents[name] += power * exponent
        elif match[2] != "1":
            raise ModelError(
                f"unit '{unit}': '{match[2]}' is unknown; known are {', '.join([*exponents, *DERIVED_UNITS])}"
            )
    if not unit or position < len(unit):
        raise ModelError(f"unit '{unit}' cannot be read from '{unit[position:]}' on; write it like 'm/s2' or 'kg.m2/s'")
    return tuple(exponents.values())


def derivative_unit(unit: str, order: int) -> str:
    """Unit of the time derivative of the given order: ``derivative_unit("m", 3) == "m/s3"``."""
    unit_exponents(unit)
    written = [match for match in _FACTOR.finditer(unit) if match[2] == "s"]  # not the seconds within V, N, …
    seconds = sum(int(match[3] or 1) * (-1 if match[1] == "/" else 1) for match in written) - order
    rest = "".join(match[0] for match in _FACTOR.finditer(unit) if match[2] != "s")
    rest = rest[1:] if rest.startswith(".") else f"1{rest}" if rest.startswith("/") else rest or "1"
    if seconds == 0:
        return rest
    size = f"s{abs(seconds)}" if abs(seconds) > 1 else "s"
    if seconds > 0:
        return size if rest == "1" else f"{rest}.{size}"
    return f"{rest}/{size}"
