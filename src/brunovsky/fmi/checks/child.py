"""What the process of its own does: load the FMU, make one check after the other, write each result at once."""

from __future__ import annotations

import json
import os
import sys
import threading
from pathlib import Path

from brunovsky.fmi.checks.behaviour import CHECKS, LIFE_CYCLE, Subject
from brunovsky.fmi.checks.description import load_description, load_root
from brunovsky.fmi.checks.instance import Refused
from brunovsky.fmi.checks.process import TIMED_OUT
from brunovsky.fmi.checks.report import FAILED

_MEMORY = 8 << 30


def main() -> None:
    """Entry point; the order is JSON in the only argument."""
    order = json.loads(sys.argv[1])
    _limit()
    folder = Path(order["folder"])
    subject = Subject(folder, load_description(folder, load_root(folder, folder.name)), order["interface"])
    with open(order["results"], "a", encoding="utf-8") as results:
        for name in order["names"]:
            watch = threading.Timer(order["time_limit"], os._exit, [TIMED_OUT])
            watch.daemon = True
            watch.start()
            status, detail = answer(subject, name)
            watch.cancel()
            results.write(json.dumps([name, status, detail]) + "\n")
            results.flush()
            if status == FAILED and name == LIFE_CYCLE:
                break  # the others would say the same
    os._exit(0)  # what an FMU left behind must not matter


def answer(subject: Subject, name: str) -> tuple[str, str]:
    """Status and detail of a check, whatever it raises."""
    try:
        status, detail = CHECKS[subject.interface][name].function(subject)
    except Refused as error:
        status, detail = FAILED, str(error)
    except Exception as error:  # fmpy raises its own and plain ones
        status, detail = FAILED, str(error) or type(error).__name__
    if status == FAILED and subject.last_message:
        detail += f" ({subject.last_message[:200]})"
    return status, " ".join(detail.replace(f"{subject.folder}{os.sep}", "").split())


def _limit() -> None:
    """No core files, and no more memory than a model may need."""
    try:
        import resource
    except ImportError:  # Windows
        return
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    if hard == resource.RLIM_INFINITY or hard > _MEMORY:
        resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, hard))
