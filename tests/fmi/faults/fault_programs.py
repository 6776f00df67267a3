"""Builds the fault drivers of this folder with the sources of an FMU, with or without sanitizers."""

import re
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from brunovsky._resources import runtime_folder
from brunovsky.blocks import Block
from brunovsky.fmi.contents import fmu_files, headers_folder, source_files
from brunovsky.native.compiler import find_compiler

HERE = Path(__file__).parent
SANITIZERS = ("-O0", "-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all")
PLAIN = ("-O1",)
_FLAGS = ("-std=c99", "-g", "-Wall", "-Wextra", "-Werror", "-ffp-contract=off")
_WRAPPED = [f"-Wl,--wrap={name}" for name in ("malloc", "calloc", "realloc", "free")]
_DRIVERS = ("harness", "interface", "states", "variables", "exchange_calls")
_OF_VERSION = {2: ("interface2", "calls2"), 3: ("interface3", "calls3", "clocks3")}


@dataclass(frozen=True)
class Fmu:
    """The FMU whose sources are linked."""

    block: Block
    version: int = 2
    arrays: bool = False

    def write_sources(self, folder: Path) -> None:
        for path, data in fmu_files(self.block, self.version, self.arrays).items():
            if path.startswith("sources/"):
                (folder / Path(path).name).write_bytes(data)


class Programs:
    """The drivers, built in a folder; what all blocks share is compiled once for each version."""

    def __init__(self, folder: Path, options: Sequence[str]) -> None:
        self.folder = folder
        self.options = options
        self.shared: dict[int, list[Path]] = {}

    def build(self, fmu: Fmu, program: str, bug: tuple[str, str] | None = None) -> Path:
        """Path of the program ("fuzz", "memory") with the FMU linked into it.

        ``bug``: what to replace in the runtime, a regular expression, and by what.
        """
        folder = self.folder / f"{fmu.block.name}-{fmu.version}-{fmu.arrays}"
        if bug is not None:
            folder = Path(tempfile.mkdtemp(dir=self.folder))
        target = folder / program
        if not target.exists():
            folder.mkdir(exist_ok=True)
            fmu.write_sources(folder)
            shared = self._shared(fmu, folder) if bug is None else self._planted(fmu, folder, bug)
            generated = [folder / name for name in source_files(fmu.version) if not (runtime_folder() / name).exists()]
            own = [self._compile(path, folder, folder, fmu.version) for path in (*generated, HERE / f"{program}.c")]
            self._run([*map(str, (*own, *shared)), *_WRAPPED], target, "-lm")
        return target

    def _shared(self, fmu: Fmu, sources: Path) -> list[Path]:
        """Objects that are those of every block."""
        if fmu.version not in self.shared:
            folder = self.folder / f"shared{fmu.version}"
            folder.mkdir()
            runtime = [sources / name for name in source_files(fmu.version) if (runtime_folder() / name).exists()]
            drivers = [HERE / f"{name}.c" for name in (*_DRIVERS, *_OF_VERSION[fmu.version])]
            self.shared[fmu.version] = [
                self._compile(path, sources, folder, fmu.version) for path in (*runtime, *drivers)
            ]
        return self.shared[fmu.version]

    def _planted(self, fmu: Fmu, sources: Path, bug: tuple[str, str]) -> list[Path]:
        """The same, of a runtime with a bug."""
        objects = {path.name: path for path in self._shared(fmu, sources)}
        places = 0
        for path in sources.glob("*.c"):
            text, count = re.subn(*bug, path.read_text())
            if count and f"{path.stem}.o" in objects:
                path.write_text(text)
                objects[f"{path.stem}.o"] = self._compile(path, sources, sources, fmu.version)
                places += count
        assert places, f"the runtime no longer has {bug[0]}; name another place for this bug"
        return list(objects.values())

    def _compile(self, source: Path, headers: Path, folder: Path, version: int) -> Path:
        target = folder / f"{'driver-' if source.parent == HERE else ''}{source.stem}.o"
        folders = [f"-I{one}" for one in (headers, HERE, headers_folder())]
        self._run([f"-DFMI={version}", *folders, "-c", str(source)], target)
        return target

    def _run(self, arguments: Sequence[str], target: Path, *last: str) -> None:
        command = [*find_compiler(), *_FLAGS, *self.options, *arguments, "-o", str(target), *last]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr


@lru_cache
def works(options: Sequence[str], folder: Path) -> bool:
    """Whether the compiler builds programs that run with these options here."""
    source, target = folder / "nothing.c", folder / "nothing"
    source.write_text("int main(void) { return 0; }\n")
    built = subprocess.run([*find_compiler(), *options, *_WRAPPED, str(source), "-o", str(target)], capture_output=True)
    return built.returncode == 0 and subprocess.run([target], capture_output=True).returncode == 0
