"""Exceptions of the package.

Every message says what was wrong, where, and what to do about it. The command line turns a
:class:`BrunovskyError` into one readable line and exit status 2.
"""

from typing import Any


class BrunovskyError(Exception):
    """Base of all exceptions raised on purpose by this package."""


class ModelError(BrunovskyError):
    """A system, block or diagram is not well formed (shape, unknown symbol, unit, algebraic loop)."""


class LinearizationError(BrunovskyError):
    """A system cannot be linearised by feedback; the message says why and at which step."""


class ParameterError(BrunovskyError, ValueError):
    """A parameter, start value or input is unknown, not finite or out of its range."""


class CompilerError(BrunovskyError):
    """No C compiler was found, or it failed; the message names the command and the remedy."""


class ReportError(BrunovskyError):
    """A report cannot be written in the form that was asked for."""


class StudyError(BrunovskyError):
    """A study file cannot be used; the message names the file, the key and the remedy."""


class SimulationError(BrunovskyError):
    """A step failed; the block keeps the state it had at the start of that step.

    Attributes
    ----------
    block, variable : str
        Where the failure showed.
    time : float
        Start of the failed step, in s.
    reason : str
        ``"singular"`` where the block's own diagnosis names a singularity, else ``"diverged"``.
    trajectory : xarray.Dataset or None
        What had been simulated until then.
    rows : ndarray or None
        The same as the engine recorded it.
    """

    def __init__(
        self, message: str, *, block: str = "", variable: str = "", time: float = 0.0, reason: str = "diverged"
    ) -> None:
        super().__init__(message)
        self.block = block
        self.variable = variable
        self.time = time
        self.reason = reason
        self.trajectory: Any = None
        self.rows: Any = None
