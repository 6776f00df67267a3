"""Random legal and illegal calls, and calls without memory, on the C code of FMUs: no fault, whatever is asked of it.

The programs are of C, so that sanitizers and valgrind see all of it: ``fuzz.c`` and ``memory.c`` say what they check.
"""

import dataclasses
import shutil
import subprocess

import pytest
from fault_programs import PLAIN, SANITIZERS, Programs, works

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
SEED = 1


@pytest.fixture(scope="module")
def block(request: pytest.FixtureRequest) -> Block:
    if request.param in ("ball", "zoo"):
        return request.getfixturevalue(request.param)
    if request.param != "robot_without_minimum":
        return getattr(library, request.param)()
    robot = library.linearized_robot()
    values = {one.name: getattr(robot, one.name) for one in dataclasses.fields(Block)}
    values["parameters"] = tuple(
        dataclasses.replace(one, value=0.0) if one.name == "eta_min" else one for one in robot.parameters
    )
    return Block(**values | {"name": "robot_without_minimum"})


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


@pytest.mark.parametrize("block", NAMES, indirect=True)
def test_random_calls_are_clean(block: Block, sanitized: Programs) -> None:
    assert "50000 calls" in _run(sanitized.build(block, "fuzz"), SEED, 50_000)


@pytest.mark.slow
@pytest.mark.parametrize("block", NAMES, indirect=True)
def test_many_random_calls_are_clean(block: Block, sanitized: Programs) -> None:
    for seed in range(2, 12):
        _run(sanitized.build(block, "fuzz"), seed, 300_000, timeout=600)


@pytest.mark.parametrize("block", ["linearized_robot", "sliding_mode_sampled", "zoo"], indirect=True)
def test_out_of_memory_is_an_error_and_leaves_nothing(block: Block, sanitized: Programs) -> None:
    found = _run(sanitized.build(block, "memory"))
    assert found.count("allocations each failed") == 2, "of both interface types"


def _valgrind() -> list[str]:
    if shutil.which("valgrind") is None:
        pytest.skip("valgrind is not installed")
    return ["valgrind", "--quiet", "--error-exitcode=9", "--leak-check=full", "--errors-for-leak-kinds=all"]


def test_valgrind_finds_nothing(plain: Programs) -> None:
    robot = library.linearized_robot()
    _run(*_valgrind(), plain.build(robot, "memory"))
    _run(*_valgrind(), plain.build(robot, "fuzz"), SEED, 3000)


@pytest.mark.slow
@pytest.mark.parametrize("block", NAMES, indirect=True)
def test_valgrind_finds_nothing_in_many_calls(block: Block, plain: Programs) -> None:
    _run(*_valgrind(), plain.build(block, "fuzz"), SEED, 100_000, timeout=600)


BUGS = {
    "a failed step that is not undone": (r"engine_restore\(engine, engine->backup\);", ";"),
    "a value reference one too far": (
        r"reference < \(unsigned\)groups\[i\]\.count",
        "reference <= (unsigned)groups[i].count",
    ),
    "a check sum that is not compared": (r"if \(header\.check != ", "if (0 && header.check != "),
    "memory that is not freed": (r"free\(instance->side\);", ";"),
    "NaN that is let in": (r"!isfinite\(value\)", "0"),
}
"""Pattern in the runtime and what replaces it."""


@pytest.mark.parametrize("block", ["linearized_robot"], indirect=True)
@pytest.mark.parametrize("bug", BUGS)
def test_a_bug_in_the_runtime_is_found(bug: str, block: Block, sanitized: Programs) -> None:
    with pytest.raises(AssertionError, match=r"FAULT|ERROR: AddressSanitizer|LeakSanitizer|runtime error"):
        _run(sanitized.build(block, "fuzz", BUGS[bug]), SEED, 50_000)
