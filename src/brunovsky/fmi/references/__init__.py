"""Reference results that an FMU carries, by the layered standard FMI-LS-REF."""

from brunovsky.fmi.references.files import FOLDER, reference_files

__all__ = ["FOLDER", "reference_files"]
