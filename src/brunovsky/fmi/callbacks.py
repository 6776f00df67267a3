"""Callback functions of FMI 2 with a log of our own.

Not by fmpy's ``logger=`` arguments (0.3.32): its proxy for loggers keeps the address of the last one for all later
instances of the process, beyond the logger's own life, and the next message of another instance ends the process.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fmpy import fmi2


def logging_callbacks(tell: Callable[[str, str], None]) -> fmi2.fmi2CallbackFunctions:
    """Callback functions that pass the category and the text of each message on; to be kept as long as the instance."""

    def log(_environment: Any, _name: Any, _status: int, category: bytes | None, message: bytes | None) -> None:
        # a message is a format for printf
        tell((category or b"").decode(errors="replace"), (message or b"").decode(errors="replace").replace("%%", "%"))

    callbacks = fmi2.fmi2CallbackFunctions()
    callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(log)
    callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmi2.calloc)
    callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmi2.free)
    return callbacks
