"""The check of one FMU: unpack it, read its description, run it elsewhere."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from brunovsky.fmi.checks.description import Unreadable, load_description, load_root, static_checks
from brunovsky.fmi.checks.process import run_checks
from brunovsky.fmi.checks.report import FAILED, NOT_RUN, PASSED, Check, CheckReport
from brunovsky.fmi.checks.unpacking import unpack_fmu

TIME_LIMIT = 60.0
"""Seconds that one check of the run may take."""


def check_fmu(
    path: str | os.PathLike[str], *, strict: bool = False, run: bool = True, time_limit: float = TIME_LIMIT
) -> CheckReport:
    """Check an FMU, of FMI 2.0 or 3.0 and of whatever tool: its file, its description, and what it does.

    It runs in a process of its own, so that one that crashes or hangs fails a check and does no more. That is no
    protection from malice: the code of the FMU has the rights of who runs it.

    Parameters
    ----------
    path : path
        Of the FMU.
    strict : bool
        Whether to make illegal calls too, which must be refused. FMUs made here are always asked, others can crash.
    run : bool
        Whether to run it, or to look at file and description only.
    time_limit : float
        Seconds that one check of the run may take.

    Returns
    -------
    CheckReport
        With every check, passed or not.

    Raises
    ------
    BrunovskyError
        If the file can't be used: it isn't an FMU, has no binaries, or would do harm when unpacked or read.
    """
    path = Path(path)
    with tempfile.TemporaryDirectory(prefix="brunovsky-check-", ignore_cleanup_errors=True) as scratch:
        folder = Path(scratch) / "fmu"
        folder.mkdir()
        unpack_fmu(path, folder)
        root = load_root(folder, str(path))
        try:
            description = load_description(folder, root)
        except Unreadable as error:
            checks = [Check("readable", FAILED, str(error)), Check("all others", NOT_RUN, "there is no model to check")]
        else:
            checks = [Check("readable", PASSED, f"{len(description.modelVariables)} variables")]
            checks += static_checks(folder, description)
            if run:
                own = (description.generationTool or "").startswith("brunovsky ")
                checks += run_checks(folder, description, Path(scratch), strict or own, time_limit)
        return CheckReport(str(path), root.get("modelName", ""), root.get("fmiVersion"), tuple(checks))
