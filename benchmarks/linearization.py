"""Time to linearise each gallery plant, in s and as a multiple of the robot's, as JSON on standard output.

Usage: python benchmarks/linearization.py [PLANT...]
"""

import itertools
import json
import platform
import sys
import time

import sympy as sp
from sympy.core.cache import clear_cache

from brunovsky.blocks import robot_linearization
from brunovsky.linearization import gallery, linearize, static_linearizability
from brunovsky.linearization.simplify import tidy

ROBOT = "robot"
GALLERY = {name: getattr(gallery, name) for name in gallery.__all__} | {ROBOT: lambda: robot_linearization().system}


def measure(name: str) -> dict[str, object]:
    tidy.cache_clear()
    clear_cache()
    system = GALLERY[name]()
    marks = [time.perf_counter()]
    result = linearize(system)
    marks.append(time.perf_counter())
    form = result.normal_form
    marks.append(time.perf_counter())
    zero = result.zero_dynamics
    marks.append(time.perf_counter())
    static_linearizability(system)
    marks.append(time.perf_counter())
    linearization, normal_form, zero_dynamics, static = (b - a for a, b in itertools.pairwise(marks))
    return {
        "relative_degree": result.relative_degree,
        "states": len(result.extended_system.states),
        "linearize_s": round(linearization, 3),
        "normal_form_s": round(normal_form, 3),
        "has_inverse": form.inverse is not None,
        "zero_dynamics_s": round(zero_dynamics, 3) if zero else None,
        "static_linearizability_s": round(static, 3),
    }


def main() -> None:
    names = sys.argv[1:] or list(GALLERY)
    measure("unicycle")  # imports and first-use costs of SymPy
    robot = measure(ROBOT)
    plants = {name: robot if name == ROBOT else measure(name) for name in names}
    for found in plants.values():
        found["ratio_to_robot"] = round(found["linearize_s"] / robot["linearize_s"], 1)
    versions = {"python": platform.python_version(), "sympy": sp.__version__}
    json.dump({"benchmark": "linearization", "versions": versions, "plants": plants}, sys.stdout, indent=2)
    print()


if __name__ == "__main__":
    main()
