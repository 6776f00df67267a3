"""FMUs of the tests, each exported once; and a block that has one of everything."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest
import sympy as sp
from fmpy import extract, read_model_description
from fmpy.model_description import ModelDescription
from fmpy.validation import validate_fmu

from brunovsky.blocks import TIME, Block, Input, Mode, Output, Parameter, Sample, State, Transition, library, symbols
from brunovsky.fmi import description2, description3, export_fmu


@dataclass(frozen=True)
class Exported:
    """A block, its FMU and the folder where this was unpacked."""

    block: Block
    fmu: Path
    folder: Path


@pytest.fixture(scope="session")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Exported]:
    folder = tmp_path_factory.mktemp("fmus")
    known: dict[str, Exported] = {}

    def export(block: Block, version: int = 2, arrays: bool = False) -> Exported:
        name = f"{block.name}{version}{'arrays' if arrays else ''}"
        if name not in known:
            fmu = export_fmu(block, folder / f"{name}.fmu", version, arrays=arrays)
            known[name] = Exported(block, fmu, Path(extract(str(fmu), str(folder / name))))
        return known[name]

    return export


@pytest.fixture
def described(tmp_path: Path) -> Callable[..., ModelDescription]:
    """Description that fmpy reads of a block, without a binary; nothing to find in it."""

    def describe(block: Block, version: int = 3, **options: bool) -> ModelDescription:
        text = (
            description3.model_description(block, "{token}", "0", **options)
            if version == 3
            else description2.model_description(block, "{token}", ("model.c",), "0")
        )
        folder = tmp_path / f"{block.name}{version}{len(options)}"
        folder.mkdir(exist_ok=True)
        (folder / "modelDescription.xml").write_bytes(text)
        assert validate_fmu(str(folder)) == []
        return read_model_description(str(folder))

    return describe


@pytest.fixture(scope="session")
def robot(exported: Callable[[Block], Exported]) -> Exported:
    return exported(library.linearized_robot())


@pytest.fixture(scope="session")
def loop(exported: Callable[[Block], Exported]) -> Exported:
    return exported(library.closed_loop())


@pytest.fixture(scope="session")
def zoo() -> Block:
    """One of everything: time, sample, modes, reset; outputs of all types and aliased; both kinds of parameters."""
    x, y, held, gear, u, gain, x_start = symbols("x", "y", "held", "gear", "u", "gain", "x_start")
    return Block(
        "zoo",
        'one of everything, with "quotes" & 100 % of <XML>',
        inputs=(Input("u", "m/s", "input", 0.5),),
        parameters=(
            Parameter("x_start", "m", "start of x", 0.2),
            Parameter("gain", "1/s", "gain", 2.0, 0.5, 10.0, tunable=True),
        ),
        states=(
            State("x", "m", "a state that is an output", derivative=u - gain * x / gear, start=x_start),
            State("y", "m.rad", "a state that is not", derivative=x + held * sp.sin(TIME)),
        ),
        samples=(Sample("held", "m", "x, held", update=x, period=sp.Rational(1, 10)),),
        modes=(Mode("gear", "1", "gear, an output", start=1), Mode("hidden", "1", "another mode", start=7)),
        outputs=(
            Output("x", "m", "state", x),
            Output("gear", "1", "mode", gear),
            Output("fast", "1", "true where u is above 1 m/s", u > 1),
            Output("copy", "m", "sample under another name", held),
            Output("mixed", "m2/s", "time, state and input", u * x + y * sp.cos(TIME)),
        ),
        transitions=(
            Transition("up", sp.And(sp.Eq(gear, 1), x > sp.Rational(3, 10)), {gear: sp.Integer(2), y: sp.Integer(0)}),
        ),
    )
