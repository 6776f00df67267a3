"""What all tests share: a compile cache of their own, and small blocks that use every kind of event."""

import os
from collections.abc import Iterator
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: small matrices, and one process for each core

import hypothesis
import pytest
import sympy as sp

from brunovsky.blocks import Block, Input, Mode, Output, Parameter, Sample, State, Transition, symbols

hypothesis.settings.register_profile("untimed", deadline=None)  # no test fails because the machine is busy
hypothesis.settings.load_profile("untimed")


SPREAD = (
    "test_shipped_studies.py",
    "test_linearized_plants.py",
    "test_faults.py",
    "test_shipped.py",
    "test_relatives.py",
)
"""Files of long tests that share nothing: each goes to whichever worker is free."""


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Other files go to one worker whole, which makes blocks, FMUs and runs once for them (``--dist loadgroup``)."""
    for one in items:
        if one.path.name not in SPREAD and not one.get_closest_marker("xdist_group"):
            one.add_marker(pytest.mark.xdist_group(one.path.as_posix()))


@pytest.fixture(scope="session", autouse=True)
def _compile_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    before = os.environ.get("BRUNOVSKY_CACHE")
    if before is None:
        os.environ["BRUNOVSKY_CACHE"] = str(Path(tmp_path_factory.getbasetemp()).parent / "brunovsky-test-cache")
    yield
    if before is None:
        del os.environ["BRUNOVSKY_CACHE"]


@pytest.fixture(scope="session")
def relay() -> Block:
    """Relay with hysteresis in a loop with an integrator: a limit cycle between -width and width."""
    x, mode, width = symbols("x", "mode", "width")
    return Block(
        "relay",
        "integrator under a relay with hysteresis",
        parameters=(Parameter("width", "m", "half-width of the hysteresis", 0.1, 0.0),),
        states=(State("x", "m", "integrator", derivative=-mode, start=sp.Float(0.05)),),
        modes=(Mode("mode", "1", "sign of the relay", start=1),),
        outputs=(Output("x", "m", "integrator", x), Output("u", "1", "relay", -mode)),
        transitions=(
            Transition("up", sp.And(sp.Eq(mode, -1), x > width), {mode: sp.Integer(1)}),
            Transition("down", sp.And(sp.Eq(mode, 1), x < -width), {mode: sp.Integer(-1)}),
        ),
    )


@pytest.fixture(scope="session")
def sampled_integrator() -> Block:
    """Forward-Euler integrator of its input with period T, beside a continuous state that follows it."""
    total, lag, u, period = symbols("total", "lag", "u", "T")
    return Block(
        "sampled_integrator",
        "sampled integrator and a continuous lag behind it",
        inputs=(Input("u", "m/s", "what is integrated"),),
        parameters=(Parameter("T", "s", "period", 0.03, 1e-6),),
        states=(State("lag", "m", "follows the sampled total", derivative=total - lag),),
        samples=(Sample("total", "m", "sum of T u", update=total + period * u, period=period),),
        outputs=(Output("total", "m", "sum", total), Output("lag", "m", "lag", lag)),
    )


@pytest.fixture(scope="session")
def ball() -> Block:
    """Bouncing ball: a reset of the velocity where the height is negative and still falling."""
    height, velocity, e, g = symbols("height", "velocity", "e", "g")
    return Block(
        "ball",
        "bouncing ball",
        parameters=(
            Parameter("h_start", "m", "height at the start", 1.0),
            Parameter("e", "1", "restitution", 0.7, 0.0, 1.0),
            Parameter("g", "m/s2", "gravity", 9.81),
        ),
        states=(
            State("height", "m", "height", derivative=velocity, start=symbols("h_start")[0]),
            State("velocity", "m/s", "velocity", derivative=-g),
        ),
        outputs=(Output("height", "m", "height", height), Output("velocity", "m/s", "velocity", velocity)),
        transitions=(Transition("bounce", sp.And(height < 0, velocity < 0), {velocity: -e * velocity}),),
    )
