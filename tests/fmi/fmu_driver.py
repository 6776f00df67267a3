"""Drives the binary of an FMU through the C functions themselves: statuses are returned, messages collected."""

import ctypes
import re
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

import numpy as np
from fmpy import read_model_description
from fmpy.fmi2 import fmi2CallbackFunctions, fmi2CallbackLoggerTYPE, fmi2EventInfo

from brunovsky.fmi.contents import headers_folder

OK, WARNING, DISCARD, ERROR = range(4)
KINDS = {"ModelExchange": 0, "CoSimulation": 1}
FUNCTIONS = re.findall(r"FMI2_Export fmi2(\w+)TYPE", (headers_folder() / "fmi2Functions.h").read_text())
"""Names of all functions of the standard, from its header."""

_C_TYPES = {"Real": ctypes.c_double, "Integer": ctypes.c_int, "Boolean": ctypes.c_int, "Enumeration": ctypes.c_int}


class Driver:
    """One instance of the FMU in a folder."""

    def __init__(
        self,
        folder: Path,
        kind: str = "CoSimulation",
        *,
        name: bytes | None = b"one",
        guid: str | None = None,
        logging: bool = False,
    ) -> None:
        self.description = read_model_description(str(folder))
        self.variables = {one.name: one for one in self.description.modelVariables}
        self.library = ctypes.CDLL(str(next((folder / "binaries").glob("*/*"))))
        self.messages: list[str] = []
        self.statuses: list[int] = []
        self.callbacks = fmi2CallbackFunctions()
        self.callbacks.logger = fmi2CallbackLoggerTYPE(self._log)
        self.library.fmi2Instantiate.restype = ctypes.c_void_p
        self.library.fmi2FreeInstance.restype = None
        token = (self.description.guid if guid is None else guid).encode()
        self.handle = ctypes.c_void_p(
            self.library.fmi2Instantiate(name, KINDS[kind], token, None, ctypes.byref(self.callbacks), 0, int(logging))
        )

    def _log(self, _environment: object, _name: bytes, status: int, category: bytes, message: bytes) -> None:
        self.statuses.append(status)
        self.messages.append(f"{category.decode()} {message.decode()}")

    def __enter__(self) -> "Driver":
        return self

    def __exit__(self, *_error: object) -> None:
        self.library.fmi2FreeInstance(self.handle)

    @property
    def text(self) -> str:
        """What the last call logged."""
        return "\n".join(self.messages)

    def call(self, function: str, *arguments: object) -> int:
        """Status of fmi2FUNCTION; floats are passed as double."""
        self.messages.clear()
        given = [ctypes.c_double(one) if isinstance(one, float) else one for one in arguments]
        return int(getattr(self.library, f"fmi2{function}")(self.handle, *given))

    def done(self, function: str, *arguments: object) -> None:
        """The call must be fmi2OK."""
        status = self.call(function, *arguments)
        assert status == OK, f"{function}: {status} {self.text}"

    def transfer(self, action: str, names: list[str], values: list[float]) -> tuple[int, list[float]]:
        """Status and values of fmi2Get… or fmi2Set… for variables of one type."""
        kind = self.variables[names[0]].type
        references = (ctypes.c_uint * len(names))(*(self.variables[one].valueReference for one in names))
        vector = (_C_TYPES[kind] * len(names))(*values)
        function = action + {"Enumeration": "Integer"}.get(kind, kind)
        return self.call(function, references, ctypes.c_size_t(len(names)), vector), list(vector)

    def set(self, values: Mapping[str, float]) -> int:
        """Status of setting variables of one type, in one call."""
        return self.transfer("Set", list(values), list(values.values()))[0]

    def get(self, *names: str) -> list[float]:
        """Values of variables, each call fmi2OK."""
        found = []
        for one in names:
            status, values = self.transfer("Get", [one], [0])
            assert status == OK, f"{one}: {self.text}"
            found += values
        return found

    def status_of_get(self, name: str) -> int:
        return self.transfer("Get", [name], [0])[0]

    def references(self, names: Sequence[str]) -> ctypes.Array[ctypes.c_uint]:
        return (ctypes.c_uint * len(names))(*(self.variables[one].valueReference for one in names))

    def directional(
        self, unknowns: Sequence[str], knowns: Sequence[str], seed: Sequence[float]
    ) -> tuple[int, list[float]]:
        """Status and values of fmi2GetDirectionalDerivative."""
        found = (ctypes.c_double * len(unknowns))()
        vector = (ctypes.c_double * len(knowns))(*seed)
        sizes = ctypes.c_size_t(len(unknowns)), ctypes.c_size_t(len(knowns))
        status = self.call(
            "GetDirectionalDerivative",
            self.references(unknowns), sizes[0], self.references(knowns), sizes[1], vector, found,
        )  # fmt: skip
        return status, list(found)

    def jacobian(self, unknowns: Sequence[str], knowns: Sequence[str]) -> np.ndarray:
        """Directional derivatives along each known, as columns; each fmi2OK."""
        found = np.zeros((len(unknowns), len(knowns)))
        for column, known in enumerate(knowns):
            status, found[:, column] = self.directional(unknowns, [known], [1.0])
            assert status == OK, f"{known}: {self.text}"
        return found

    def real_unknowns(self) -> list[str]:
        """Names of the Real outputs and state derivatives."""
        rows = (*self.description.outputs, *self.description.derivatives)
        return [one.variable.name for one in rows if one.variable.type == "Real"]

    def states(self) -> list[str]:
        return [one.variable.derivative.name for one in self.description.derivatives]

    def named(self, causality: str) -> list[str]:
        """Names of the Real variables of a causality."""
        rows = self.description.modelVariables
        return [one.name for one in rows if one.causality == causality and one.type == "Real"]

    def outputs(self) -> list[float]:
        return self.get(*(one.name for one in self.description.modelVariables if one.causality == "output"))

    def set_derivatives(self, values: Mapping[tuple[str, int], float]) -> int:
        """Status of setting derivatives of inputs, by name and order, in one call."""
        references, orders = self._of_orders(values)
        numbers = (ctypes.c_double * len(values))(*values.values())
        return self.call("SetRealInputDerivatives", references, ctypes.c_size_t(len(values)), orders, numbers)

    def derivatives(self, *keys: tuple[str, int]) -> list[float]:
        """Derivatives of outputs, by name and order, fmi2OK."""
        references, orders = self._of_orders(keys)
        numbers = (ctypes.c_double * len(keys))()
        self.done("GetRealOutputDerivatives", references, ctypes.c_size_t(len(keys)), orders, numbers)
        return list(numbers)

    def _of_orders(
        self, keys: Collection[tuple[str, int]]
    ) -> tuple[ctypes.Array[ctypes.c_uint], ctypes.Array[ctypes.c_int]]:
        references = (ctypes.c_uint * len(keys))(*(self.variables[name].valueReference for name, _ in keys))
        return references, (ctypes.c_int * len(keys))(*(order for _, order in keys))

    def initialize(
        self, values: Mapping[str, float] | None = None, start: float = 0.0, stop: float | None = None
    ) -> None:
        """Set up, set, enter and leave initialisation mode; all fmi2OK."""
        self.done("SetupExperiment", 0, 0.0, start, int(stop is not None), stop or 0.0)
        self.done("EnterInitializationMode")
        if values:
            assert self.set(values) == OK, self.text
        self.done("ExitInitializationMode")

    def step(self, time: float, length: float) -> int:
        return self.call("DoStep", time, length, 1)

    def new_discrete_states(self) -> fmi2EventInfo:
        info = fmi2EventInfo()
        self.done("NewDiscreteStates", ctypes.byref(info))
        return info

    def vector(self, function: str, count: int, values: list[float] | None = None) -> list[float]:
        """Vector of doubles passed to or filled by a function of model exchange; fmi2OK."""
        array = (ctypes.c_double * max(count, 1))(*(values or []))
        self.done(function, array, ctypes.c_size_t(count))
        return list(array)[:count]

    def enter_continuous_time(self) -> fmi2EventInfo:
        info = self.new_discrete_states()
        self.done("EnterContinuousTimeMode")
        return info
