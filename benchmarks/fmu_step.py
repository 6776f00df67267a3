"""Time of a co-simulation step of an FMU and of the same RK4 step in plain C, as JSON on standard output.

Both are compiled with the flags of every FMU into one library and called in a loop in C, turn about. The plain step is
four evaluations of the generated derivatives and the update; no events, checks, outputs or life cycle.

Usage: python benchmarks/fmu_step.py [BLOCK]
"""

import ctypes
import json
import platform
import statistics
import sys
import tempfile
from pathlib import Path

import numpy as np

from brunovsky.blocks import Block, library
from brunovsky.fmi.contents import fmu_files, headers_folder, source_files
from brunovsky.native import compile_library
from brunovsky.native.compiler import compiler_version, find_compiler

STEP = 1e-3
STEPS = 2000
REPETITIONS = 201
LIMIT = 2.5
"""The most that a step may cost, in plain steps."""


def measure(block: Block, version: int, folder: Path) -> dict[str, object]:
    for path, data in fmu_files(block, version).items():
        if path.startswith("sources/"):
            (folder / Path(path).name).write_bytes(data)
    target = folder / "measure.so"
    sources = [Path(__file__).with_suffix(".c"), *(folder / name for name in source_files(version))]
    compile_library(sources, target, include=[folder, headers_folder()], defines={"FMI": str(version)})
    inputs = np.array([one.start + 0.1 for one in block.inputs])
    plain, fmu = np.empty(REPETITIONS), np.empty(REPETITIONS)
    states, fmu_states = np.empty(len(block.states)), np.empty(len(block.states))
    pointers = [one.ctypes.data_as(ctypes.c_void_p) for one in (inputs, plain, fmu, states, fmu_states)]
    failed = ctypes.CDLL(str(target)).measure(
        pointers[0], ctypes.c_long(STEPS), ctypes.c_double(STEP), REPETITIONS, *pointers[1:]
    )
    if failed or not np.allclose(states, fmu_states, rtol=1e-9, atol=1e-12):
        raise SystemExit(
            f"{block.name} reached {fmu_states} instead of {states}: only blocks without events can be timed"
        )
    ratios = fmu / plain
    return {
        "plain_us": round(1e6 * statistics.median(plain) / STEPS, 4),
        "fmu_us": round(1e6 * statistics.median(fmu) / STEPS, 4),
        "ratio": round(statistics.median(ratios), 3),
        "ratio_quartiles": [round(float(one), 3) for one in np.quantile(ratios, [0.25, 0.75])],
    }


def main() -> None:
    name = sys.argv[1] if len(sys.argv) > 1 else "linearized_robot"
    block, found = getattr(library, name)(), {}
    for version in (2, 3):
        with tempfile.TemporaryDirectory() as folder:
            found[f"fmi{version}"] = measure(block, version, Path(folder))
    settings = {"step_s": STEP, "steps": STEPS, "repetitions": REPETITIONS, "limit": LIMIT}
    versions = {"python": platform.python_version(), "compiler": compiler_version(find_compiler())}
    json.dump({"benchmark": "fmu_step", "block": name, **settings, "versions": versions, **found}, sys.stdout, indent=2)
    print()


if __name__ == "__main__":
    main()
