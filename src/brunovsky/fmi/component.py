"""In-process components: a block as an instance that fmpy drives, without an FMU file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal

from brunovsky.blocks import Block
from brunovsky.errors import ParameterError
from brunovsky.fmi.contents import check_version
from brunovsky.fmi.instances import (
    FMU2ModelComponent,
    FMU2SlaveComponent,
    FMU3ModelComponent,
    FMU3ScheduledComponent,
    FMU3SlaveComponent,
)
from brunovsky.fmi.interfaces import refused_interfaces

Component = FMU2SlaveComponent | FMU2ModelComponent | FMU3SlaveComponent | FMU3ModelComponent | FMU3ScheduledComponent
Interface = Literal["CoSimulation", "ModelExchange", "ScheduledExecution"]

_CLASSES: dict[int, dict[str, type[Component]]] = {
    2: {"CoSimulation": FMU2SlaveComponent, "ModelExchange": FMU2ModelComponent},
    3: {
        "CoSimulation": FMU3SlaveComponent,
        "ModelExchange": FMU3ModelComponent,
        "ScheduledExecution": FMU3ScheduledComponent,
    },
}


def component(
    block: Block,
    fmi_version: int = 2,
    interface: Interface = "CoSimulation",
    *,
    instance_name: str | None = None,
    logging: bool = False,
    event_mode_used: bool = False,
    early_return_allowed: bool = False,
    intermediate_update: Callable[..., None] | None = None,
    required_intermediate_variables: Sequence[int] | None = None,
) -> Component:
    """Running instance of a block for fmpy, without an FMU file.

    Parameters
    ----------
    block : Block
        Any block or diagram.
    fmi_version : int
        2 or 3. A block with clocks needs 3.
    interface : {"CoSimulation", "ModelExchange", "ScheduledExecution"}
        Which of fmpy's classes it is: ``FMU2Slave``, ``FMU2Model``, ``FMU3Slave``, ``FMU3Model`` or
        ``FMU3ScheduledExecution``. Model exchange
        is not for a sign function without a width; the last one is for blocks that clocks alone make act.
    instance_name : str, optional
        The name of the block by default.
    logging : bool
        Whether events are reported in ``messages`` as well.
    event_mode_used, early_return_allowed : bool
        For co-simulation in FMI 3: whether events are left to the master, and whether a step may end before its time.
    intermediate_update : callable, optional
        The same: called during ``doStep`` with the arguments of ``fmi3IntermediateUpdateCallback``, that is the
        instance environment, the time in s, whether inputs may be set, outputs read, whether an internal step is
        finished and whether the step may return early, and a pointer each to what it returns: whether to return
        early, and when.
    required_intermediate_variables : sequence of int, optional
        Value references of what it sets or reads.

    Returns
    -------
    instance of a subclass of fmpy's class
        Already instantiated, with all methods of fmpy's class; also ``directory`` (has the modelDescription.xml),
        ``model_description``, ``references`` (value reference by name) and ``messages`` (category and text of what
        the last call logged). It ends, and removes its folder, with its ``with`` block, ``freeInstance()``, or
        when it is garbage.

    Raises
    ------
    ParameterError
        For a version that is not available or an interface that the block's FMU doesn't have, and for options that an
        interface doesn't have.
    ModelError
        For FMI 2 of a block with clocks.
    CompilerError
        If there is no C compiler or it fails.
    ComponentError
        Raised by the component's methods; it is an ``fmpy.fmi1.FMICallException`` too.

    Examples
    --------
    fmpy asks for the type of an instance that it didn't make; reset the component before it runs again::

        with brunovsky.component(brunovsky.blocks.library.closed_loop(), 3) as robot:
            fmpy.simulate_fmu(robot.directory, fmu_instance=robot, fmi_type="CoSimulation", stop_time=20)
            robot.reset()
    """
    check_version(block, fmi_version)
    refused = refused_interfaces(block)
    kinds = {name: kind for name, kind in _CLASSES[fmi_version].items() if name not in refused}
    if interface not in kinds:
        reason = f": {refused[interface]}" if interface in _CLASSES[fmi_version] else ""
        raise ParameterError(
            f"there is no interface '{interface}' of {block.name} in FMI {fmi_version}{reason}; "
            f"use {' or '.join(kinds)}"
        )
    given: dict[str, Any] = {
        "eventModeUsed": event_mode_used,
        "earlyReturnAllowed": early_return_allowed,
        "intermediateUpdate": intermediate_update,
        "requiredIntermediateVariables": required_intermediate_variables,
    }
    options = {name: value for name, value in given.items() if value}
    if options and kinds[interface] is not FMU3SlaveComponent:
        raise ParameterError(
            "event mode, early return and intermediate update are options of co-simulation in FMI 3; "
            'use fmi_version=3, interface="CoSimulation"'
        )
    return kinds[interface](block, instance_name=instance_name, logging=logging, **options)
