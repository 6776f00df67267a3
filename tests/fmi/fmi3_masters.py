"""Small masters of FMI 3 that do what fmpy's do not: clocks, early return at will, scheduled execution."""

from collections.abc import Callable, Iterable, Mapping, Sequence

from brunovsky.fmi.component import Component

Signals = Mapping[str, Callable[[float], float]]
Rows = list[list[float]]


def read(instance: Component, names: Iterable[str]) -> list[float]:
    return list(instance.getFloat64([instance.references[one] for one in names]))


def write(instance: Component, values: Mapping[str, float]) -> None:
    instance.setFloat64([instance.references[one] for one in values], list(values.values()))


def initialize(
    instance: Component,
    values: Mapping[str, float] | None = None,
    *,
    solver: int | None = None,
    tolerance: float | None = None,
    start: float = 0.0,
) -> None:
    instance.enterInitializationMode(tolerance=tolerance, startTime=start)
    write(instance, values or {})
    if solver:
        instance.setInt64([instance.references["solver"]], [solver])
    instance.exitInitializationMode()


def tick(instance: Component, clocks: Sequence[str], *, active: bool = True) -> None:
    instance.setClock([instance.references[one] for one in clocks], [active] * len(clocks))


def in_event_mode(
    instance: Component, times: Sequence[float], inputs: Signals, names: Sequence[str], clocks: Sequence[str] = ()
) -> tuple[Rows, list[float]]:
    """Co-simulation from an initialised instance; at each communication point inputs change and clocks tick.

    Rows after the events of those points, and the instants of the events between them.
    """
    rows, events = [], []
    for index, time in enumerate(times):
        if index:
            instance.enterEventMode()
        write(instance, {name: signal(time) for name, signal in inputs.items()})
        tick(instance, clocks)
        assert not instance.updateDiscreteStates()[0]
        instance.enterStepMode()
        rows.append(read(instance, names))
        end = times[index + 1] if index + 1 < len(times) else time
        while time < end:
            needed, _, early, time = instance.doStep(time, end - time)
            assert early == (time < end)
            if early:
                assert needed
                events.append(time)
                instance.enterEventMode()
                instance.updateDiscreteStates()
                instance.enterStepMode()
    return rows, events


def in_model_exchange(
    instance: Component, times: Sequence[float], inputs: Signals, names: Sequence[str], clocks: Sequence[str]
) -> Rows:
    """Model exchange of a block without continuous states: only its events."""
    rows = []
    for index, time in enumerate(times):
        if index:
            instance.setTime(time)
            instance.enterEventMode()
        write(instance, {name: signal(time) for name, signal in inputs.items()})
        tick(instance, clocks)
        assert not instance.updateDiscreteStates()[0]
        instance.enterContinuousTimeMode()
        rows.append(read(instance, names))
    return rows


def in_scheduled_execution(
    instance: Component, times: Sequence[float], inputs: Signals, names: Sequence[str], clock: str
) -> Rows:
    """Scheduled execution: the one model partition at each of these times."""
    rows = []
    for time in times:
        write(instance, {name: signal(time) for name, signal in inputs.items()})
        instance.activateModelPartition(instance.references[clock], time)
        rows.append(read(instance, names))
    return rows
