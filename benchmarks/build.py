"""Time and size of the FMUs that ship, built with an empty cache and again with a full one, as JSON on standard output.

Times are in s, of the wall clock and of all processors: on a busy machine the second says more. The whole command line
runs in a process of its own, as does each block when it is built again.

Usage: python benchmarks/build.py [PLATFORM]     (host by default; all needs ziglang)
"""

import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from brunovsky.fmi import shipped_fmus
from brunovsky.native.compiler import compiler_version, find_compiler

ALL_COLD, ONE_WARM, SIZE = 10.0, 1.0, 1_000_000
"""Limits: all blocks for the host with an empty cache, and one with a full one, in s; a file in bytes."""

_ONE = """
import json, os, sys
name, chosen = sys.argv[1:]
from brunovsky.fmi import export_fmu, shipped_block, shipped_fmus
import time
spent = []
for version in (2, 3):
    if name not in shipped_fmus(version):
        continue
    start, used = time.perf_counter(), sum(os.times()[:4])
    export_fmu(shipped_block(name), f"{name}{version}.fmu", version, (chosen,))
    spent.append((version, time.perf_counter() - start, sum(os.times()[:4]) - used))
print(json.dumps(spent))
"""


def command(arguments: list[str], folder: Path, cache: Path) -> tuple[float, float, str]:
    """Seconds on the wall and on processors, and what a Python process printed."""
    environment = os.environ | {"BRUNOVSKY_CACHE": str(cache), "PYTHONPATH": os.pathsep.join(sys.path)}
    start, used = time.perf_counter(), sum(os.times()[2:4])
    run = subprocess.run(
        [sys.executable, *arguments], cwd=folder, env=environment, check=True, stdout=subprocess.PIPE, text=True
    )
    return time.perf_counter() - start, sum(os.times()[2:4]) - used, run.stdout


def measure(chosen: str, folder: Path) -> dict[str, object]:
    cache = folder / "cache"
    build = ["-m", "brunovsky", "build", "-o", "built", "--platform", chosen]
    cold, cold_used, _ = command(build, folder, cache)
    warm, warm_used, _ = command(build, folder, cache)
    sizes = {
        path.relative_to(folder / "built").as_posix(): path.stat().st_size for path in folder.glob("built/*/*.fmu")
    }
    blocks = {
        name: {
            f"fmi{version}": {"wall_s": round(wall, 3), "processors_s": round(used, 3)}
            for version, wall, used in json.loads(command(["-c", _ONE, name, chosen], folder, cache)[2])
        }
        for name in shipped_fmus()
    }
    return {
        "cold": {"wall_s": round(cold, 2), "processors_s": round(cold_used, 2)},
        "warm": {"wall_s": round(warm, 2), "processors_s": round(warm_used, 2)},
        "warm_blocks": blocks,
        "bytes": dict(sorted(sizes.items())),
        "largest_bytes": max(sizes.values()),
    }


def main() -> None:
    chosen = sys.argv[1] if len(sys.argv) > 1 else "host"
    with tempfile.TemporaryDirectory() as folder:
        found = measure(chosen, Path(folder))
    limits = {"all_cold_s": ALL_COLD, "one_warm_s": ONE_WARM, "bytes": SIZE}
    versions = {"python": platform.python_version(), "compiler": compiler_version(find_compiler())}
    json.dump(
        {"benchmark": "build", "platform": chosen, "limits": limits, "versions": versions, **found},
        sys.stdout,
        indent=2,
    )
    print()


if __name__ == "__main__":
    main()
