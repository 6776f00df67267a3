"""Random legal and illegal calls, and calls without memory, on the C code of FMUs: no fault, whatever is asked of it.

The programs are of C, so that sanitizers and valgrind see all of it: ``fuzz.c`` and ``memory.c`` say what they check.
"""

import dataclasses
import shutil
import subprocess

import pytest
from fault_programs import PLAIN, SANITIZERS, Fmu, Programs, works

from brunovsky.blocks import Block, library

NAMES = (
    "linearized_robot",
    "robot_without_minimum",
    "closed_loop",
    "sliding_mode_relay",
    "sliding_mode_sampled",
    "super_twisting",
    "ball",
    "zoo",
)
CASES = [(name, 2) for name in NAMES] + [(name, 3) for name in NAMES]
CASES += [("sliding_mode_clocked", 3), ("linearized_robot", "arrays"), ("sliding_mode_clocked", "arrays")]
QUICK = [("robot_without_minimum", 2), ("zoo", 2), ("super_twisting", 2), ("linearized_robot", 3), ("closed_loop", 3)]
QUICK += [("zoo", 3), ("sliding_mode_clocked", 3), ("sliding_mode_clocked", "arrays")]
"""Name of a block, and the version of FMI: 2, 3, or 3 with arrays."""
SEED = 1


@pytest.fixture
def fmu(request: pytest.FixtureRequest) -> Fmu:
    name, version = request.param
    return Fmu(_block(request, name), 2 if version == 2 else 3, version == "arrays")


def _block(request: pytest.FixtureRequest, name: str) -> Block:
    if name in ("ball", "zoo"):
        return request.getfixturevalue(name)
    if name != "robot_without_minimum":
        return getattr(library, name)()
    robot = library.linearized_robot()
    values = {one.name: getattr(robot, one.name) for one in dataclasses.fields(Block)}
    values["parameters"] = tuple(
        dataclasses.replace(one, value=0.0) if one.name == "eta_min" else one for one in robot.parameters
    )
    return Block(**values | {"name": name})


def _programs(tmp_path_factory: pytest.TempPathFactory, name: str, options: tuple[str, ...]) -> Programs:
    folder = tmp_path_factory.mktemp(name)
    if not works(options, folder):
        pytest.skip(f"the C compiler builds no programs with {' '.join(options)} here")
    return Programs(folder, options)


@pytest.fixture(scope="module")
def sanitized(tmp_path_factory: pytest.TempPathFactory) -> Programs:
    return _programs(tmp_path_factory, "sanitized", SANITIZERS)


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Programs:
    return _programs(tmp_path_factory, "plain", PLAIN)


def _run(*command: object, timeout: float = 120) -> str:
    done = subprocess.run([str(one) for one in command], capture_output=True, text=True, timeout=timeout)
    assert done.returncode == 0, f"{command}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout


@pytest.mark.parametrize("fmu", QUICK, indirect=True, ids=str)
def test_random_calls_are_clean(fmu: Fmu, sanitized: Programs) -> None:
    assert "30000 calls" in _run(sanitized.build(fmu, "fuzz"), SEED, 30_000)


@pytest.mark.slow
@pytest.mark.parametrize("fmu", CASES, indirect=True, ids=str)
def test_many_random_calls_are_clean(fmu: Fmu, sanitized: Programs) -> None:
    for seed in range(2, 12):
        _run(sanitized.build(fmu, "fuzz"), seed, 300_000, timeout=600)


@pytest.mark.parametrize(
    "fmu",
    [("linearized_robot", 2), ("sliding_mode_sampled", 2), ("zoo", 3), ("sliding_mode_clocked", "arrays")],
    indirect=True,
    ids=str,
)
def test_out_of_memory_is_an_error_and_leaves_nothing(fmu: Fmu, sanitized: Programs) -> None:
    found = _run(sanitized.build(fmu, "memory"))
    assert found.count("allocations each failed") >= 2, "of each kind of instance"


def _valgrind() -> list[str]:
    if shutil.which("valgrind") is None:
        pytest.skip("valgrind is not installed")
    return ["valgrind", "--quiet", "--error-exitcode=9", "--leak-check=full", "--errors-for-leak-kinds=all"]


@pytest.mark.parametrize("fmu", [("linearized_robot", 2)], indirect=True, ids=str)
def test_valgrind_finds_nothing(fmu: Fmu, plain: Programs) -> None:
    _run(*_valgrind(), plain.build(fmu, "memory"))
    _run(*_valgrind(), plain.build(fmu, "fuzz"), SEED, 3000)


@pytest.mark.slow
@pytest.mark.parametrize("fmu", CASES, indirect=True, ids=str)
def test_valgrind_finds_nothing_in_many_calls(fmu: Fmu, plain: Programs) -> None:
    _run(*_valgrind(), plain.build(fmu, "fuzz"), SEED, 30_000, timeout=600)


BUGS = {
    "a failed step that is not undone": (2, r"engine_restore\(engine, engine->backup\);", "(void)engine;"),
    "a value reference one too far": (
        2,
        r"reference < \(unsigned\)groups\[i\]\.count",
        "reference <= (unsigned)groups[i].count",
    ),
    "a check sum that is not compared": (2, r"if \(header\.check != ", "if (0 && header.check != "),
    "memory that is not freed": (3, r"free\(instance->side\);", ";"),
    "NaN that is let in": (2, r"!isfinite\(value\)", "0"),
    "NaN that is let out": (2, r"isfinite\(\*value\)", "1"),
    "a count of values that is not compared": ("arrays", r"if \(expected == values\)", "if (1 || expected == values)"),
    "memory asked for in a step": (
        3,
        r"engine_advance\(engine, length\)",
        "(__builtin_free(__builtin_malloc(9)), engine_advance(engine, length))",
    ),
}
"""Version of FMI, pattern in the runtime, and what replaces it."""


@pytest.mark.parametrize(
    "bug", [one if k < 3 else pytest.param(one, marks=pytest.mark.slow) for k, one in enumerate(BUGS)]
)
def test_a_bug_in_the_runtime_is_found(bug: str, request: pytest.FixtureRequest, sanitized: Programs) -> None:
    version, pattern, replacement = BUGS[bug]
    fmu = Fmu(_block(request, "robot_without_minimum"), 2 if version == 2 else 3, version == "arrays")
    with pytest.raises(AssertionError, match=r"FAULT|runtime error|Sanitizer"):
        _run(sanitized.build(fmu, "fuzz", (pattern, replacement)), SEED, 50_000)
