"""In-process components: a block as an instance that fmpy drives, without an FMU file.

A component runs the code of the FMU itself, compiled for this process, behind fmpy's own base classes. So it has one
life cycle with the FMU, the same numbers and the same messages, which an exception carries instead of a log.
"""

from __future__ import annotations

import ctypes
import tempfile
import weakref
from collections import deque
from pathlib import Path
from typing import Any, Literal, Self

from fmpy import freeLibrary
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Model, FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.model_description import ModelDescription, read_model_description

from brunovsky.blocks import Block
from brunovsky.errors import BrunovskyError, ParameterError
from brunovsky.fmi.archive import check_version
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


class _Component:
    """What both kinds of component have: the files, the instance behind them, its messages and its end."""

    component: int | None
    _close: weakref.finalize[..., Any] | None = None

    def __init__(self, block: Block, *, instance_name: str | None = None, logging: bool = False) -> None:
        self.block = block
        folder = tempfile.TemporaryDirectory(prefix="brunovsky-")
        self.directory = folder.name
        for name, data in fmu_files(block).items():
            path = Path(folder.name, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
        self.model_description: ModelDescription = read_model_description(self.directory, validate=False)
        variables = self.model_description.modelVariables
        self.references: dict[str, int] = {one.name: one.valueReference for one in variables}
        messages: deque[tuple[str, str]] = deque(maxlen=100)
        self.messages = messages

        def log(_environment: Any, _name: bytes, _status: int, category: bytes, message: bytes) -> None:
            messages.append((category.decode(), message.decode().replace("%%", "%")))

        super().__init__(
            guid=self.model_description.guid,
            modelIdentifier=block.name,
            unzipDirectory=self.directory,
            instanceName=instance_name or block.name,
        )  # type: ignore[call-arg]
        callbacks = fmi2CallbackFunctions()
        callbacks.logger = fmi2CallbackLoggerTYPE(log)
        self.instantiate(callbacks=callbacks, loggingOn=logging)  # type: ignore[attr-defined]
        library: Any = self.dll  # type: ignore[attr-defined]
        handle = ctypes.c_void_p(self.component)
        self._close = weakref.finalize(self, _release, library, handle, folder)

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


def _release(library: Any, handle: ctypes.c_void_p, folder: tempfile.TemporaryDirectory[str]) -> None:
    library.fmi2FreeInstance(handle)
    freeLibrary(library._handle)
    folder.cleanup()


class FMU2SlaveComponent(_Component, FMU2Slave):  # type: ignore[misc]
    """Component for co-simulation; made by :func:`component`."""


class FMU2ModelComponent(_Component, FMU2Model):  # type: ignore[misc]
    """Component for model exchange; made by :func:`component`."""


def component(
    block: Block,
    fmi_version: int = 2,
    interface: Literal["CoSimulation", "ModelExchange"] = "CoSimulation",
    *,
    instance_name: str | None = None,
    logging: bool = False,
) -> FMU2SlaveComponent | FMU2ModelComponent:
    """Running instance of a block for fmpy, without an FMU file.

    Parameters
    ----------
    block : Block
        Any block or diagram.
    fmi_version : int
        2, the only one so far.
    interface : {"CoSimulation", "ModelExchange"}
        Which of fmpy's classes it is: ``FMU2Slave`` or ``FMU2Model``.
    instance_name : str, optional
        The name of the block by default.
    logging : bool
        Whether events are reported in ``messages`` as well.

    Returns
    -------
    FMU2SlaveComponent or FMU2ModelComponent
        Already instantiated, with all methods of fmpy's class; also ``directory`` (has the modelDescription.xml),
        ``model_description``, ``references`` (value reference by name) and ``messages`` (category and text of what
        the last call logged). It ends, and removes its folder, with its ``with`` block, ``freeInstance()``, or
        when it is garbage.

    Raises
    ------
    ParameterError
        For a version or interface that is not available.
    CompilerError
        If there is no C compiler or it fails.
    ComponentError
        Raised by the component's methods; it is an ``fmpy.fmi1.FMICallException`` too.

    Examples
    --------
    fmpy asks for the type of an instance that it didn't make; reset the component before it runs again::

        with brunovsky.component(brunovsky.blocks.library.closed_loop()) as robot:
            fmpy.simulate_fmu(robot.directory, fmu_instance=robot, fmi_type="CoSimulation", stop_time=20)
            robot.reset()
    """
    check_version(fmi_version)
    kinds: dict[str, type[FMU2SlaveComponent] | type[FMU2ModelComponent]] = {
        "CoSimulation": FMU2SlaveComponent,
        "ModelExchange": FMU2ModelComponent,
    }
    if interface not in kinds:
        raise ParameterError(f"there is no interface '{interface}'; use {' or '.join(kinds)}")
    return kinds[interface](block, instance_name=instance_name, logging=logging)
