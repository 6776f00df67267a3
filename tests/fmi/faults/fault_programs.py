"""Builds the fault drivers of this folder with the sources of an FMU, with or without sanitizers."""

import re
import subprocess
import tempfile
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

from brunovsky.blocks import Block
from brunovsky.fmi.contents import fmu_files, headers_folder
from brunovsky.native.compiler import find_compiler

HERE = Path(__file__).parent
SANITIZERS = ("-O0", "-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all")
PLAIN = ("-O1",)
_FLAGS = ("-std=c99", "-g", "-Wall", "-Wextra", "-Werror", "-ffp-contract=off")
_WRAPPED = [f"-Wl,--wrap={name}" for name in ("malloc", "calloc", "realloc", "free")]
_GENERATED = ("model.c", "jacobian.c", "output_derivatives.c", "description.c")
_MAINS = ("fuzz.c", "memory.c")


class Programs:
    """The drivers, built in a folder; what all blocks share is compiled once."""

    def __init__(self, folder: Path, options: Sequence[str]) -> None:
        self.folder = folder
        self.options = options
        self.shared: list[Path] = []

    def build(self, block: Block, program: str, bug: tuple[str, str] | None = None) -> Path:
        """Path of the program ("fuzz", "memory") with the FMU of the block linked into it.

        ``bug``: what to replace in the runtime, a regular expression, and by what.
        """
        folder = self.folder / block.name if bug is None else Path(tempfile.mkdtemp(dir=self.folder))
        target = folder / program
        if not target.exists():
            folder.mkdir(exist_ok=True)
            for path, data in fmu_files(block).items():
                if path.startswith("sources/"):
                    (folder / Path(path).name).write_bytes(data)
            shared = self._shared(folder) if bug is None else self._planted(folder, bug)
            objects = [self._compile(folder / name, folder, folder) for name in _GENERATED]
            main = self._compile(HERE / f"{program}.c", folder, folder)
            self._run([*map(str, (*objects, *shared, main)), *_WRAPPED], target, "-lm")
        return target

    def _shared(self, sources: Path) -> list[Path]:
        """Objects that are those of every block, by their names."""
        if not self.shared:
            runtime = [path for path in sources.glob("*.c") if path.name not in _GENERATED]
            drivers = [path for path in HERE.glob("*.c") if path.name not in _MAINS]
            self.shared = [self._compile(path, sources, self.folder) for path in sorted((*runtime, *drivers))]
        return self.shared

    def _planted(self, sources: Path, bug: tuple[str, str]) -> list[Path]:
        """The same, of a runtime with a bug."""
        objects = {path.name: path for path in self._shared(sources)}
        places = 0
        for path in sources.glob("*.c"):
            text, count = re.subn(*bug, path.read_text())
            if count and path.name not in _GENERATED:
                path.write_text(text)
                objects[f"{path.stem}.o"] = self._compile(path, sources, sources)
                places += count
        assert places, f"the runtime no longer has {bug[0]}; name another place for this bug"
        return list(objects.values())

    def _compile(self, source: Path, headers: Path, folder: Path) -> Path:
        target = folder / f"{source.stem}.o"
        self._run([f"-I{headers}", f"-I{HERE}", f"-I{headers_folder()}", "-c", str(source)], target)
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
