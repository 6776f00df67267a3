"""The process in which an FMU runs: started here, watched, and started again behind a check that ended it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from fmpy.model_description import ModelDescription

from brunovsky.errors import ParameterError
from brunovsky.fmi.checks.behaviour import CHECKS
from brunovsky.fmi.checks.description import binary_path, interfaces
from brunovsky.fmi.checks.report import FAILED, NOT_RUN, Check

TIMED_OUT = 98
_START = 60.0
"""Seconds that the process may take to start."""
_CODE = "from brunovsky.fmi.checks.child import main; main()"


def run_checks(
    folder: Path, description: ModelDescription, scratch: Path, strict: bool, time_limit: float
) -> list[Check]:
    """All checks of the run of an unpacked FMU; a crash or hang fails the check where it happened."""
    if not time_limit > 0:
        raise ParameterError(f"the time limit is {time_limit:g} s; it must be positive")
    found = []
    version = int(description.fmiMajorVersion)
    for interface, one in interfaces(description).items():
        if interface not in CHECKS:
            found.append(Check("run", NOT_RUN, "scheduled execution is not run", interface))
        elif binary_path(folder, one.modelIdentifier or "", version) is None:
            found.append(Check("run", NOT_RUN, "there is no binary for this machine", interface))
        else:
            names = [
                name
                for name, check in CHECKS[interface].items()
                if check.version <= version and (strict or not check.illegal)
            ]
            made = _run_interface(folder, interface, scratch, names, time_limit)
            if one.needsExecutionTool and made[0].status == FAILED:
                why = f"the FMU needs its tool, and without it: {made[0].detail}"
                made = [Check("run", NOT_RUN, why, interface)]
            found += made
    return found


def _run_interface(folder: Path, interface: str, scratch: Path, names: Sequence[str], time_limit: float) -> list[Check]:
    done: list[Check] = []
    while len(done) < len(names):
        rest = names[len(done) :]
        found, ending = _run_child(folder, interface, scratch, rest, time_limit)
        done += [Check(name, *found[name], interface) for name in rest if name in found]
        if not (done and done[0].status == FAILED) and len(found) < len(rest):
            done.append(Check(names[len(done)], FAILED, ending, interface))
        if done[0].status == FAILED:
            done += [Check(name, NOT_RUN, f"'{names[0]}' failed", interface) for name in names[len(done) :]]
    return done


def _run_child(
    folder: Path, interface: str, scratch: Path, names: Sequence[str], time_limit: float
) -> tuple[dict[str, tuple[str, str]], str]:
    """Status and detail by check, of those that ended; and how the process ended."""
    results, home = scratch / "results", scratch / "home"
    results.write_bytes(b"")
    home.mkdir(exist_ok=True)
    order = {
        "folder": str(folder), "interface": interface, "names": list(names),
        "results": str(results), "time_limit": time_limit,
    }  # fmt: skip
    process = subprocess.Popen(
        [sys.executable, "-P", "-c", _CODE, json.dumps(order)],
        cwd=home, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(one for one in map(os.path.abspath, sys.path) if one)},
        start_new_session=True,
    )  # fmt: skip
    try:
        status = process.wait(_START + time_limit * len(names))
    except subprocess.TimeoutExpired:
        status = TIMED_OUT
    finally:
        _end(process)
    found = {}
    for line in results.read_text(encoding="utf-8", errors="replace").splitlines():
        try:
            name, state, detail = json.loads(line)
        except ValueError:  # it ended while it wrote this
            break
        found[name] = (state, detail)
    return found, _ending(status, time_limit)


def _end(process: subprocess.Popen[bytes]) -> None:
    """End the process and what it started."""
    if hasattr(os, "killpg"):
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)
    process.kill()
    process.wait()


def _ending(status: int, time_limit: float) -> str:
    if status == TIMED_OUT:
        return f"it hangs: not done after {time_limit:g} s"
    if status < 0:
        return f"it crashes the process ({_signal(-status)})"
    return f"it ends the process with status {status}"


def _signal(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"
