"""Which file ran what: FMUs and packages of a study with the runs they made, their hardware and their hashes."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from brunovsky.analysis.coupling.scheme import ORDERS
from brunovsky.comparison.engines import Engine, FmuSimulation
from brunovsky.comparison.facts import given, joined
from brunovsky.comparison.protocol_section import Table
from brunovsky.comparison.ssp_engine import SspSimulation
from brunovsky.comparison.study import PlannedRun, Study
from brunovsky.comparison.study.loops import Hardware
from brunovsky.comparison.study.protocols import CouplingTable, MarginsTable

UNITS = {"step_size": "s", "communication_step": "s"}
"""Units of the numbers in a provenance."""


def run_files(engine: Engine, plan: Sequence[PlannedRun]) -> list[dict[str, Any]]:
    """Each file that simulated runs of a plan: its hash, these runs and their hardware, and the FMUs of a package."""
    if not isinstance(engine, FmuSimulation | SspSimulation):
        return []
    opened: Mapping[Any, Any] = engine.fmus if isinstance(engine, FmuSimulation) else engine.packages
    found: dict[Path, dict[str, Any]] = {}
    for planned in plan:
        file = opened[planned.loop]
        row = found.setdefault(file.path, {"file": file.path.name, "sha256": _sha256(file.path), "runs": []})
        row["runs"].append(planned.name)
        row.setdefault("hardware", hardware_text(planned.loop.hardware))
        if isinstance(engine, SspSimulation):
            row["components"] = [
                {"name": name, "file": one.path.name, "sha256": _sha256(one.path)} for name, one in file.fmus.items()
            ]
    return list(found.values())


def files_table(files: Sequence[Mapping[str, Any]]) -> Table:
    """The same as a table; the components of a package follow it, in the order of their steps."""
    rows: list[tuple[str, str, str, str]] = []
    for one in files:
        rows.append((one["file"], ", ".join(one["runs"]), one["hardware"], one["sha256"]))
        rows += [(f"{one['file']}: {part['file']}", "", "", part["sha256"]) for part in one.get("components", ())]
    return Table("files", ("file", "scenario/law", "hardware", "SHA-256"), tuple(rows), "What simulated which run")


def hardware_text(hardware: Hardware) -> str:
    """What stands between law and robot, in words; its sizes are parameters of the runs."""
    lags = {1: "lags", 2: "two lags in series"}.get(hardware.number, f"{hardware.number} lags in series")
    parts = {
        lags: any(hardware.lags),
        "delays": any(hardware.delays),
        "limits": any(map(math.isfinite, hardware.limits)),
        f"sampling every {given(1e3 * (hardware.period or 0.0))} ms": hardware.period is not None,
        "noise": hardware.noisy,
        "disturbance at v": hardware.matched,
    }
    return joined([text for text, there in parts.items() if there] or ["ideal"])


def coupling_text(files: Sequence[Mapping[str, Any]], provenance: Mapping[str, Any], *, own: bool) -> str:
    """How the components of packages were coupled; empty where none were."""
    if "communication_step" not in provenance:
        return ""
    orders = dict.fromkeys(" → ".join(part["name"] for part in one["components"]) for one in files)
    stepped = f"Components step {ORDERS[provenance['scheme']]}, in the order {joined(list(orders))}"
    inner = f"with RK4 in steps of at most {given(1e3 * provenance['step_size'])} ms"
    step = given(1e3 * provenance["communication_step"])
    return (
        f"How it was coupled: {stepped}; they exchange values every {step} ms, "
        "and inputs are held in between (no derivatives are exchanged, order 0). Before the first step all are in "
        "initialisation mode and exchange outputs until every input agrees with what drives it. Within a step each "
        f"component integrates by itself, {'with its own solver' if own else inner}."
    )


def aside_text(study: Study, engine: str) -> str:
    """Which protocols of a study did not run through its files; empty where all did."""
    if engine == "native":
        return ""
    margins = any(isinstance(one, MarginsTable) for one in study.protocols)
    coupled = any(isinstance(one, CouplingTable) for one in study.protocols)
    return " ".join(
        (["Margins were measured natively."] if margins else [])
        + (
            ["The protocol of coupling runs FMUs of the components within this process, not these files."]
            if coupled
            else []
        )
    )


def _sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
