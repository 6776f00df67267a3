"""The command line: derive, build, check, analyze, compare, schema, list.

Exit status 0 on success, 1 on a failed check or a comparison all of whose runs failed, 2 on unusable input, 130 on
Ctrl-C, with one readable line and no traceback unless ``--debug``.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator, Mapping
from enum import StrEnum
from pathlib import Path
from typing import Annotated, TypeVar

import typer
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

import brunovsky as br
from brunovsky._resources import resource
from brunovsky._suggest import unknown_name
from brunovsky.errors import BrunovskyError, ParameterError
from brunovsky.fmi import export_ssp, robot_system, robot_variants, shipped_fmus
from brunovsky.fmi.archive import export_fmus
from brunovsky.fmi.checks.table import check_summary, check_table
from brunovsky.fmi.contents import FMI_VERSIONS
from brunovsky.fmi.platforms import HOST, chosen_platforms
from brunovsky.fmi.platforms import NAMES as PLATFORMS
from brunovsky.linearization import gallery

app = typer.Typer(
    name="brunovsky",
    help="Feedback linearisation, sliding-mode and linear outer loops, FMUs and comparison reports.",
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
T = TypeVar("T")
_out = Console(highlight=False)
_err = Console(stderr=True, highlight=False)

SYSTEMS: Mapping[str, Callable[[], br.AffineSystem | br.Linearization]] = {
    "robot": br.blocks.robot_linearization,
    **{name: getattr(gallery, name) for name in gallery.__all__},
}
BLOCKS: Mapping[str, Callable[[], br.Block]] = {
    name: getattr(br.blocks, name)
    for name in (
        "robot",
        "linearized_robot",
        "robot_with_lags",
        "circle",
        "line",
        "lemniscate",
        "polynomial",
        "sliding_mode",
        "sliding_mode_relay",
        "sliding_mode_sampled",
        "sliding_mode_clocked",
        "super_twisting",
        "super_twisting_sampled",
        "integral_sliding_mode",
        "pole_placement",
        "disturbance_observer",
        "flat_sliding_mode",
        "sliding_sector",
        "second_order_sliding_mode",
        "polar_sliding_mode",
        "backstepping",
        "closed_loop",
        "regulator",
        "rest_to_rest",
        "tracker",
        "rest_to_trajectory",
    )
}


class Engine(StrEnum):
    """What runs a comparison."""

    native = "native"
    fmpy = "fmpy"
    ssp = "ssp"


class FmiVersion(StrEnum):
    """FMI versions that can be exported."""

    two = "2"
    three = "3"


class SspVersion(StrEnum):
    """Versions of the system structure package that can be exported."""

    one = "1"
    two = "2"


@app.callback()
def _options(
    context: typer.Context,
    debug: Annotated[bool, typer.Option("--debug", help="Show the traceback of an error.")] = False,
    version: Annotated[bool, typer.Option("--version", help="Print the version.", is_eager=True)] = False,
) -> None:
    """Accept the options that hold for all commands; ``--debug`` is read by :func:`main`."""
    if version:
        _say(br.__version__)
    elif context.invoked_subcommand is None:
        sys.stdout.write(context.get_help() + "\n")


@app.command()
def derive(
    system: Annotated[str, typer.Argument(help="A system that ships; see `brunovsky list`.")] = "robot",
    latex: Annotated[bool, typer.Option("--latex", help="Print LaTeX instead of plain text.")] = False,
) -> None:
    """Print the derivation: relative degree, extension, F, G, det G, law."""
    found = _known(system, SYSTEMS, "system")()
    linearization = br.linearize(found) if isinstance(found, br.AffineSystem) else found
    sys.stdout.write((linearization.latex() if latex else linearization.explain()).rstrip() + "\n")


@app.command()
def build(
    blocks: Annotated[list[str] | None, typer.Argument(metavar="BLOCK", help="By default the FMUs that ship.")] = None,
    output: Annotated[
        Path, typer.Option("-o", "--output", help="Folder; the files go to its fmi2/, fmi3/ and ssp/.")
    ] = Path("build"),
    fmi: Annotated[FmiVersion | None, typer.Option("--fmi", help="FMI version; by default both.")] = None,
    ssp: Annotated[
        SspVersion | None,
        typer.Option("--ssp", help="Version of ssp/robot.ssp: 1 (FMI 2) or 2 (FMI 3); built unless blocks are named."),
    ] = None,
    platform: Annotated[
        str,
        typer.Option(
            metavar="[host|all|NAME]",
            help=f"Platform of the binaries: {', '.join(PLATFORMS)}; any but the host's needs the extra 'zig'.",
        ),
    ] = HOST,
) -> None:
    """Build FMUs, co-simulation and model exchange in one file, and a package of three of them, robot.ssp."""
    chosen_platforms((platform,), int(fmi) if fmi else 3)  # refused before anything is built
    names = blocks or shipped_fmus(int(fmi) if fmi else None)
    chosen = {name: _known(name, BLOCKS, "block") for name in names}
    with _progress() as progress:
        task = progress.add_task("building FMUs", total=len(chosen))

        def wanted() -> Iterator[tuple[br.Block, Path, int]]:
            for name, make in chosen.items():
                progress.update(task, description=f"building {name}")
                block = make()
                for version in (int(fmi),) if fmi else _versions(name, block):
                    yield block, output / f"fmi{version}" / f"{name}.fmu", version
                progress.advance(task)

        paths = list(export_fmus(wanted(), (platform,)))
        if ssp or not blocks:
            progress.update(task, description="building robot.ssp")
            paths.append(_build_ssp(output, int(ssp or (2 if fmi == FmiVersion.three else 1)), (platform,)))
        progress.update(task, description="building FMUs")
    for path in paths:
        _say(str(path))


def _build_ssp(folder: Path, version: int, platforms: tuple[str, ...]) -> Path:
    """Write ``ssp/robot.ssp``; without connectors of the system, which libcosim and ecos do not read."""
    return export_ssp(
        robot_system(),
        folder / "ssp" / "robot.ssp",
        ssp_version=version,
        variants=robot_variants(),
        platforms=platforms,
        system_connectors=False,
    )


def _versions(name: str, block: br.Block) -> list[int]:
    """Versions of FMI that a block is built in by default."""
    listed = [version for version in FMI_VERSIONS if name in shipped_fmus(version)]
    return listed or ([3] if block.clocks else list(FMI_VERSIONS))


@app.command()
def check(
    fmus: Annotated[list[Path], typer.Argument(metavar="FMU...", help="FMUs of any tool, FMI 2.0 or 3.0.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")] = False,
    strict: Annotated[
        bool, typer.Option("--strict", help="Make illegal calls too; FMUs made here always get them.")
    ] = False,
    static: Annotated[bool, typer.Option("--static", help="Look at file and description only; run nothing.")] = False,
    time_limit: Annotated[float, typer.Option("--time-limit", help="Seconds that one check may take.")] = 60.0,
) -> None:
    """Check FMUs: the file, the description, and a run in a process of its own."""
    reports, unusable = [], []
    with _progress() as progress:
        task = progress.add_task("checking FMUs", total=len(fmus))
        for path in fmus:
            progress.update(task, description=escape(f"checking {path.name}"))
            try:
                reports.append(br.check_fmu(path, strict=strict, run=not static, time_limit=time_limit))
            except ParameterError:
                raise
            except BrunovskyError as error:
                unusable.append({"path": str(path), "unusable": str(error)})
            progress.advance(task)
        progress.update(task, description="checking FMUs")
    if as_json:
        listed = [*(one.as_dict() for one in reports), *unusable]
        sys.stdout.write(json.dumps(listed, indent=2, allow_nan=False) + "\n")
    else:
        for report in reports:
            _out.print(check_table(report))
            _say(check_summary(report) + "\n")
    for one in unusable:
        _err.print(f"brunovsky: {escape(one['unusable'])}", soft_wrap=True)
    if unusable or not all(report.passed for report in reports):
        sys.exit(2 if unusable else 1)


@app.command()
def analyze(
    study: Annotated[Path, typer.Argument(help="Study file (TOML), or the name of one that ships.")],
    output: Annotated[Path | None, typer.Option("-o", "--output", help="Folder; by default build/STUDY.")] = None,
) -> None:
    """Analyse a study without running it: poles, margins, sensitivity, predicted chatter."""
    from brunovsky.comparison import analysis_tables, analyze_study, load_study, write_analysis
    from brunovsky.comparison.analyze import require_folder

    path = study if study.suffix == ".toml" else _shipped_study(str(study))
    folder = output or Path("build") / path.stem
    loaded = load_study(path)
    require_folder(folder)
    with _progress() as progress:
        task = progress.add_task(escape(loaded.title), total=None)

        def show(done: int, total: int, what: str) -> None:
            progress.update(task, completed=done, total=total, description=escape(what))

        analysis = analyze_study(loaded, progress=show)
        written = write_analysis(analysis, folder, progress=show)
    for table in analysis_tables(analysis):
        _out.print(table)
        _out.print()
    for one in (written.analysis, written.figures[0].parent):
        _say(str(one))


@app.command()
def compare(
    study: Annotated[Path, typer.Argument(help="Study file (TOML), or the name of one that ships.")],
    output: Annotated[Path | None, typer.Option("-o", "--output", help="Folder; by default build/STUDY.")] = None,
    engine: Annotated[
        Engine | None, typer.Option("--engine", help="What runs the study, in place of its own choice.")
    ] = None,
    pdf: Annotated[bool, typer.Option("--pdf", help="Write report.pdf too (extra pdf).")] = False,
) -> None:
    """Run a study and write its report, metrics, traces and tables."""
    from brunovsky.comparison import compare_study, load_study  # here, since it takes longer than the other commands
    from brunovsky.comparison.run import check_own_file

    path = study if study.suffix == ".toml" else _shipped_study(str(study))
    folder = output or Path("build") / path.stem
    loaded = load_study(path)
    check_own_file(loaded, engine.value if engine else None)
    with _progress() as progress:
        task = progress.add_task(loaded.title, total=None)

        def show(done: int, total: int, what: str) -> None:
            progress.update(task, completed=done, total=total, description=what)

        written = compare_study(loaded, folder, engine=engine.value if engine else None, pdf=pdf, progress=show)
    for one in (
        written.report,
        written.pdf,
        written.metrics,
        written.protocols,
        *_folders(written.traces, written.tables),
    ):
        if one is not None:
            _say(str(one))
    runs = json.loads(written.metrics.read_text(encoding="utf-8"))["runs"]
    failed = [run for run in runs if run["status"] != "ok"]
    for run in failed:
        _err.print(f"brunovsky: {escape(run['name'])} failed: {escape(str(run['status_message']))}", soft_wrap=True)
    if len(failed) == len(runs):
        sys.exit(1)


def _folders(*groups: tuple[Path, ...]) -> list[Path]:
    return [group[0].parent for group in groups if group]


@app.command()
def schema() -> None:
    """Print the JSON schema of study files."""
    from brunovsky.comparison.schema import schema_text

    sys.stdout.write(schema_text())


@app.command("list")
def list_() -> None:
    """List the systems, blocks and studies that ship."""
    shipped = shipped_fmus()
    table = Table("kind", "name", "what it is", box=None, pad_edge=False)
    for name, make in SYSTEMS.items():
        table.add_row("system", name, _summary(make))
    for name, block in BLOCKS.items():
        table.add_row("block", name, f"{escape(shipped[name])} (FMU)" if name in shipped else _summary(block))
    for path in sorted(resource("comparisons").glob("*.toml")):
        table.add_row("study", path.stem, _first_title(path))
    _out.print(table)


def _summary(make: Callable[[], object]) -> str:
    """First line of a docstring; making every block only to list it would take seconds."""
    return escape((make.__doc__ or "").partition("\n")[0].removesuffix("."))


def _first_title(path: Path) -> str:
    from brunovsky.comparison import load_study

    try:
        return escape(load_study(path).title)
    except BrunovskyError as error:
        return escape(f"unusable: {error}")


def _known(name: str, known: Mapping[str, T], kind: str) -> T:
    if name not in known:
        raise BrunovskyError(f"there is {unknown_name(kind, name, known)}")
    return known[name]


def _shipped_study(name: str) -> Path:
    folder = resource("comparisons")
    path = folder / f"{name}.toml"
    if not path.exists():
        known = sorted(one.stem for one in folder.glob("*.toml"))
        raise BrunovskyError(f"'{name}' is not a .toml file, and there is {unknown_name('study', name, known)}")
    return path


def _say(text: str) -> None:
    _out.print(escape(text), soft_wrap=True)


def _progress() -> Progress:
    columns = (TextColumn("{task.description:<44}"), BarColumn(), TextColumn("{task.completed}/{task.total}"))
    return Progress(*columns, TimeElapsedColumn(), console=_err, transient=False)


def main() -> None:
    """Entry point of the ``brunovsky`` command."""
    debug = "--debug" in sys.argv
    try:
        status = app(standalone_mode=False)
        if status == 130:  # how newer versions of typer report Ctrl-C
            raise KeyboardInterrupt
    except BrunovskyError as error:
        if debug:
            raise
        _fail(str(error), 2)
    except OSError as error:
        if debug:
            raise
        _fail(f"{error.filename}: {error.strerror}" if error.filename else str(error), 2)
    except (KeyboardInterrupt, typer.Abort):
        _fail("stopped", 130)
    except Exception as error:
        if debug or not hasattr(error, "format_message"):  # what typer raises for a wrong call has this
            raise
        _fail(error.format_message(), 2)


def _fail(message: str, status: int) -> None:
    _err.print(f"brunovsky: {escape(message)}", soft_wrap=True)
    sys.exit(status)
