"""FMUs that are unpacked for several runs, and what of a study they must have."""

from __future__ import annotations

import contextlib
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from brunovsky.blocks import Block
from brunovsky.comparison.study import PlannedRun
from brunovsky.errors import BrunovskyError, StudyError
from brunovsky.fmi.checks.markup import require_plain
from brunovsky.fmi.checks.unpacking import unpack_fmu

RECORDED = (
    *("x", "y", "theta", "eta[1]", "eta[2]", "u[1]", "u[2]", "singular"),
    *("position_error[1]", "position_error[2]", "e1[1]", "e1[2]", "e2[1]", "e2[2]", "S[1]", "S[2]", "v[1]", "v[2]"),
)  # of a loop, what it has of them


def recorded(block: Block) -> list[str]:
    """What is recorded of a loop."""
    there = {one.name for one in block.outputs}
    return [name for name in RECORDED if name in there]


@dataclass(frozen=True)
class OpenedFmu:
    """An FMU that is unpacked for several runs.

    Attributes
    ----------
    path, folder : Path
        The FMU, and where it is unpacked.
    description : object
        fmpy's model description of it.
    """

    path: Path
    folder: Path
    description: Any = field(repr=False)

    @cached_property
    def variables(self) -> Mapping[str, Any]:
        """Variables by name, as fmpy has them."""
        return {one.name: one for one in self.description.modelVariables}

    @property
    def parameters(self) -> Collection[str]:
        """Real numbers that are set before a run."""
        return {name for name, one in self.variables.items() if one.causality == "parameter" and one.type == "Real"}

    def instance(self, log: list[str], name: str = "") -> Any:
        """Instance (``fmpy.fmi2.FMU2Slave``) whose messages go to the log."""
        from fmpy.fmi2 import FMU2Slave

        from brunovsky.fmi.callbacks import logging_callbacks

        instance = FMU2Slave(
            guid=self.description.guid,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            unzipDirectory=str(self.folder),
            instanceName=name or self.description.modelName,
        )
        instance.instantiate(callbacks=logging_callbacks(lambda _category, message: log.append(message)))
        return instance


def open_fmu(path: Path, folder: Path, shown: str = "") -> OpenedFmu:
    """Unpack an FMU for co-simulation in FMI 2.0.

    Parameters
    ----------
    path, folder : Path
        The FMU, and where it goes; the folder is made.
    shown : str
        Name in messages, by default the path.

    Raises
    ------
    StudyError
        If it is missing, is no such FMU, or cannot be instantiated on this machine.
    """
    import fmpy

    shown = shown or str(path)
    folder.mkdir(parents=True)
    with unusable(str(path), shown):
        unpack_fmu(path, folder)
        require_plain(folder / "modelDescription.xml", f"{shown}: modelDescription.xml")
    try:
        description = fmpy.read_model_description(str(folder))
    except Exception as error:  # whatever fmpy and lxml have
        raise StudyError(f"{shown}: its description is no FMI: {_first(error)}; brunovsky check says more") from None
    if not description.fmiVersion.startswith("2.") or description.coSimulation is None:
        raise StudyError(
            f"{shown}: is FMI {description.fmiVersion}"
            f"{'' if description.coSimulation else ' without co-simulation'}; give one for co-simulation in FMI 2.0"
        )
    opened = OpenedFmu(path, folder, description)
    log: list[str] = []
    try:
        instance = opened.instance(log)
    except Exception as error:
        reason = " ".join(log) or _first(error)
        raise StudyError(f"{shown}: cannot be started on this machine: {reason}; export it for this one") from None
    release(instance)
    return opened


def release(instance: Any) -> None:
    """End an instance, whatever state it is in."""
    with contextlib.suppress(Exception):  # some statuses forbid it
        instance.freeInstance()


@contextlib.contextmanager
def unusable(path: str, shown: str) -> Iterator[None]:
    """Errors of a file as those of the study that names it."""
    try:
        yield
    except BrunovskyError as error:
        raise StudyError(str(error).replace(path, shown)) from None


def check_variables(
    shown: str, run: PlannedRun, parameters: Collection[str], inputs: Collection[str], outputs: Collection[str]
) -> None:
    """Refuse a file of the user's own without what the study sets in it and records of it.

    Raises
    ------
    StudyError
        With the first variable that is missing.
    """
    for name in sorted(run.given):
        kind, known = ("input", inputs) if name in run.inputs else ("parameter", parameters)
        if name not in known:
            raise StudyError(
                f"{shown}: has no {kind} '{name}', which the study sets in run '{run.name}'; "
                "add it there (a real number), or leave it out of the study"
            )
    for name in recorded(run.loop.block):
        if name not in outputs:
            raise StudyError(f"{shown}: has no output '{name}', which is recorded of run '{run.name}'; add it there")


def _first(error: BaseException) -> str:
    return str(error).strip().partition("\n")[0] or type(error).__name__
