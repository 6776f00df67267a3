"""What a check of an FMU found."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

PASSED = "passed"
FAILED = "failed"
NOT_PROVIDED = "not provided"
NOT_RUN = "not run"


@dataclass(frozen=True)
class Check:
    """One check of an FMU.

    Parameters
    ----------
    name : str
        What was checked.
    status : str
        ``"passed"``, ``"failed"``, ``"not provided"`` (the FMU doesn't claim the feature) or ``"not run"``.
    detail : str
        What was found, with its figure.
    part : str
        ``"file"``, ``"description"``, ``"CoSimulation"`` or ``"ModelExchange"``.
    """

    name: str
    status: str
    detail: str = ""
    part: str = "description"


@dataclass(frozen=True)
class CheckReport:
    """All checks of an FMU.

    Parameters
    ----------
    path : str
        Of the FMU.
    model : str
        Its model name.
    fmi_version : str
        As its description says.
    checks : tuple of Check
        In the order in which they were made.
    """

    path: str
    model: str
    fmi_version: str
    checks: tuple[Check, ...]

    @property
    def passed(self) -> bool:
        """Whether no check failed."""
        return not self.failed

    @property
    def failed(self) -> tuple[Check, ...]:
        """The checks that failed."""
        return tuple(one for one in self.checks if one.status == FAILED)

    def as_dict(self) -> dict[str, Any]:
        """Content for JSON."""
        return asdict(self) | {"checks": [asdict(one) for one in self.checks], "passed": self.passed}
