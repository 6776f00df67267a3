"""Time and size of the FMUs that ship, as JSON on standard output.

* ``cold``: `brunovsky build` of all FMUs and the package, with an empty cache.
* ``warm``: the same again, when the cache has them.
* ``warm_blocks``: each block in a process of its own, made and exported in every version it ships in, when the cache
  has its FMUs; the import of this package, which is the same for all, is told apart (``import``).
* ``derived_blocks``: the same when the cache has object files, but no FMUs: what it costs to derive a block anew.

Times are in s, of the wall clock and of all processors: on a busy machine the second says more. Python finds its
bytecode, as that of an installed package.

Usage: python benchmarks/build.py [PLATFORM]     (host by default; all needs ziglang)
"""

import json
import os
import platform
import shutil
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
import json, os, sys, time
name, chosen = sys.argv[1:]
begun = time.perf_counter()
from brunovsky.fmi import export_fmu, shipped_block, shipped_fmus
start, used = time.perf_counter(), sum(os.times()[:4])
block = shipped_block(name)
for version in (2, 3):
    if name in shipped_fmus(version):
        export_fmu(block, f"{name}{version}.fmu", version, (chosen,))
print(json.dumps([start - begun, time.perf_counter() - start, sum(os.times()[:4]) - used]))
"""


def command(arguments: list[str], folder: Path, cache: Path) -> tuple[float, float, str]:
    """Seconds on the wall and on processors, and what a Python process printed."""
    environment = os.environ | {"BRUNOVSKY_CACHE": str(cache), "PYTHONPATH": os.pathsep.join(sys.path)}
    environment |= {"PYTHONPYCACHEPREFIX": str(folder / "bytecode"), "PYTHONDONTWRITEBYTECODE": ""}
    start, used = time.perf_counter(), sum(os.times()[2:4])
    run = subprocess.run(
        [sys.executable, *arguments], cwd=folder, env=environment, check=True, stdout=subprocess.PIPE, text=True
    )
    return time.perf_counter() - start, sum(os.times()[2:4]) - used, run.stdout


def seconds(wall: float, used: float) -> dict[str, float]:
    return {"wall_s": round(wall, 3), "processors_s": round(used, 3)}


def measure(chosen: str, folder: Path) -> dict[str, object]:
    cache = folder / "cache"
    build = ["-m", "brunovsky", "build", "-o", "built", "--platform", chosen]
    command(["-m", "brunovsky", "--version"], folder, cache)  # writes the bytecode
    cold = command(build, folder, cache)
    warm = command(build, folder, cache)
    sizes = {
        path.relative_to(folder / "built").as_posix(): path.stat().st_size for path in folder.glob("built/*/*.fmu")
    }
    imports, again, anew = [], {}, {}
    for name in shipped_fmus():
        imported, *spent = json.loads(command(["-c", _ONE, name, chosen], folder, cache)[2])
        imports.append(imported)
        again[name] = seconds(*spent)
    shutil.rmtree(cache / "fmus")
    for name in shipped_fmus():
        anew[name] = seconds(*json.loads(command(["-c", _ONE, name, chosen], folder, cache)[2])[1:])
    return {
        "cold": seconds(*cold[:2]),
        "warm": seconds(*warm[:2]),
        "import": {"wall_s": round(sum(imports) / len(imports), 3)},
        "warm_blocks": again,
        "warm_slowest_s": max(one["wall_s"] for one in again.values()),
        "derived_blocks": anew,
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
