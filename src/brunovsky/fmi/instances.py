"""Running instances of a block behind fmpy's classes: what :func:`brunovsky.component` makes.

An instance runs the code of the FMU itself, compiled for this process. So it has one life cycle with the FMU, the same
numbers and the same messages, which an exception carries instead of a log.
"""

from __future__ import annotations

import ctypes
import tempfile
import weakref
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar, Self

from fmpy import freeLibrary
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Model, FMU2Slave
from fmpy.fmi3 import FMU3Model, FMU3ScheduledExecution, FMU3Slave
from fmpy.model_description import ModelDescription, read_model_description

from brunovsky.blocks import Block
from brunovsky.errors import BrunovskyError
from brunovsky.fmi.callbacks import logging_callbacks
from brunovsky.fmi.contents import fmu_files


class ComponentError(BrunovskyError, FMICallException):  # type: ignore[misc]
    """A call that a component refused; its text is the message that the FMU would log.

    Attributes
    ----------
    function : str
        Of FMI, such as ``"fmi2DoStep"``.
    status : int
        2 (discard) or 3 (error); the component is as it was before the call.
    """

    def __init__(self, function: str, status: int, message: str) -> None:
        Exception.__init__(self, message or f"{function} failed with status {status}")
        self.function = function
        self.status = status


class _Instance(ABC):
    """What all kinds of component have: the files, the instance behind them, its messages and its end."""

    fmi_version: ClassVar[int]
    component: int | None
    _close: weakref.finalize[..., Any] | None = None

    def __init__(
        self, block: Block, *, instance_name: str | None = None, logging: bool = False, **options: Any
    ) -> None:
        self.block = block
        folder = tempfile.TemporaryDirectory(prefix="brunovsky-")
        self.directory = folder.name
        for name, data in fmu_files(block, self.fmi_version).items():
            path = Path(folder.name, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
        self.model_description: ModelDescription = read_model_description(self.directory, validate=False)
        variables = self.model_description.modelVariables
        self.references: dict[str, int] = {one.name: one.valueReference for one in variables}
        self.messages: deque[tuple[str, str]] = deque(maxlen=100)
        super().__init__(
            guid=self.model_description.guid,
            modelIdentifier=block.name,
            unzipDirectory=self.directory,
            instanceName=instance_name or block.name,
        )  # type: ignore[call-arg]
        self._start(self.messages, logging, **options)
        library: Any = self.dll  # type: ignore[attr-defined]
        free = getattr(library, f"fmi{self.fmi_version}FreeInstance")
        self._close = weakref.finalize(self, _release, free, ctypes.c_void_p(self.component), library._handle, folder)

    @abstractmethod
    def _start(self, messages: deque[tuple[str, str]], logging: bool, **options: Any) -> None:
        """Instantiate, with a log that writes to the messages and doesn't hold this object."""

    def _call(self, name: str, *arguments: Any) -> Any:
        if self._close and not self._close.alive:  # the library is unloaded
            raise ComponentError(name, 3, f"{name}: the component has ended, as its with block or freeInstance() did")
        self.messages.clear()
        try:
            return super()._call(name, *arguments)  # type: ignore[misc]
        except FMICallException as error:
            raise ComponentError(name, error.status, "; ".join(text for _, text in self.messages)) from None

    def freeInstance(self) -> None:
        """End of the instance; its folder is removed. The same as leaving the ``with`` block."""
        if self._close:
            self._close()
        self.component = None

    def __enter__(self) -> Self:
        """Component itself."""
        return self

    def __exit__(self, *_error: object) -> None:
        """End of the instance."""
        self.freeInstance()


def _release(free: Any, instance: ctypes.c_void_p, library: Any, folder: tempfile.TemporaryDirectory[str]) -> None:
    free(instance)
    freeLibrary(library)
    folder.cleanup()


class _Instance2(_Instance):
    fmi_version = 2

    def _start(self, messages: deque[tuple[str, str]], logging: bool, **options: Any) -> None:
        callbacks = logging_callbacks(lambda category, message: messages.append((category, message)))
        self.instantiate(callbacks=callbacks, loggingOn=logging, **options)  # type: ignore[attr-defined]


_TOLD_BY_EXCEPTIONS = ("logStatusWarning", "logStatusDiscard")


class _Instance3(_Instance):
    fmi_version = 3

    def _start(self, messages: deque[tuple[str, str]], logging: bool, **options: Any) -> None:
        def log(_environment: Any, _status: int, category: bytes, message: bytes) -> None:
            messages.append((category.decode(), message.decode()))

        self.instantiate(loggingOn=logging, logMessage=log, **options)  # type: ignore[attr-defined]
        if not logging:
            self.setDebugLogging(True, list(_TOLD_BY_EXCEPTIONS))

    def setDebugLogging(self, loggingOn: bool, categories: Sequence[str]) -> None:
        """Switch on these log categories alone, beside those that exceptions tell; or switch them off."""
        wanted = [*categories, *_TOLD_BY_EXCEPTIONS] if loggingOn and categories else list(categories)
        super().setDebugLogging(loggingOn, wanted)  # type: ignore[misc]

    # fmpy takes adjoint derivatives to be as many as the unknowns, and fails to count dependencies

    def getAdjointDerivative(
        self, unknowns: Sequence[int], knowns: Sequence[int], seed: Sequence[float], nSensitivity: int | None = None
    ) -> list[float]:
        """Adjoint derivatives: one for each known."""
        count = len(knowns) if nSensitivity is None else nSensitivity
        found: list[float] = super().getAdjointDerivative(unknowns, knowns, seed, count)  # type: ignore[misc]
        return found

    def getNumberOfVariableDependencies(self, valueReference: int) -> int:
        """Number of dependencies of a variable."""
        count = ctypes.c_size_t()
        self.fmi3GetNumberOfVariableDependencies(  # type: ignore[attr-defined]
            self.component, valueReference, ctypes.byref(count)
        )
        return count.value


class FMU2SlaveComponent(_Instance2, FMU2Slave):  # type: ignore[misc]
    """Component for co-simulation; made by :func:`component`."""


class FMU2ModelComponent(_Instance2, FMU2Model):  # type: ignore[misc]
    """Component for model exchange; made by :func:`component`."""


class FMU3SlaveComponent(_Instance3, FMU3Slave):  # type: ignore[misc]
    """Component for co-simulation; made by :func:`component`."""


class FMU3ModelComponent(_Instance3, FMU3Model):  # type: ignore[misc]
    """Component for model exchange; made by :func:`component`."""


class FMU3ScheduledComponent(_Instance3, FMU3ScheduledExecution):  # type: ignore[misc]
    """Component for scheduled execution; made by :func:`component`."""
