"""Compiled blocks: built once, cached by content, loaded with ctypes."""

from __future__ import annotations

import ctypes
import hashlib
import os
import tempfile
from functools import cache, lru_cache
from pathlib import Path

from brunovsky._resources import runtime_folder
from brunovsky.blocks import Block
from brunovsky.native.code import model_source
from brunovsky.native.compiler import SUFFIX, cache_folder, compile_library, compiler_version, find_compiler

ENGINE_SOURCES = ("engine.c", "events.c", "inputs.c", "rk4.c", "dormand_prince.c")
ENGINE_HEADERS = ("names.h", "model.h", "engine.h", "solver.h")
"""C files of the runtime that run a block; its generated ``model.c`` goes with them."""


def build_library(block: Block) -> Path:
    """Shared library of a block with its engine, compiled unless the cache has it.

    Raises
    ------
    CompilerError
        If there is no C compiler or it fails.
    """
    text = model_source(block)
    runtime = runtime_folder()
    parts = [
        text,
        *((runtime / name).read_text() for name in (*ENGINE_SOURCES, *ENGINE_HEADERS)),
        compiler_version(find_compiler()),
    ]
    key = hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]
    name = f"{block.name}-{key}{SUFFIX}"
    library = cache_folder() / name
    if not library.exists():
        library = _writable_folder() / name
    if not library.exists():
        with tempfile.TemporaryDirectory() as folder:
            source = Path(folder) / "model.c"
            source.write_text(text)
            sources = [source, *(runtime / name for name in ENGINE_SOURCES)]
            compile_library(sources, library, include=[runtime], defines={"ENGINE_API": _EXPORT})
    return library


def _writable_folder() -> Path:
    """The cache, or a folder of this process where the cache can't be written."""
    folder = cache_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return Path(_own_folder().name)
    return folder if os.access(folder, os.W_OK) else Path(_own_folder().name)


@cache
def _own_folder() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(prefix="brunovsky-")


_EXPORT = "__declspec(dllexport)" if os.name == "nt" else '__attribute__((visibility("default")))'


class EngineStruct(ctypes.Structure):
    """``Engine`` of engine.h."""

    _fields_ = (
        ("model", ctypes.c_void_p),
        ("time", ctypes.c_double),
        ("start_time", ctypes.c_double),
        ("step_size", ctypes.c_double),
        ("tolerance", ctypes.c_double),
        ("solver", ctypes.c_int),
        ("p", ctypes.POINTER(ctypes.c_double)),
        ("u", ctypes.POINTER(ctypes.c_double)),
        ("x", ctypes.POINTER(ctypes.c_double)),
        ("q", ctypes.POINTER(ctypes.c_double)),
        ("due", ctypes.POINTER(ctypes.c_longlong)),
        ("m", ctypes.POINTER(ctypes.c_int)),
        ("r", ctypes.POINTER(ctypes.c_int)),
        ("y", ctypes.POINTER(ctypes.c_double)),
        ("work", ctypes.POINTER(ctypes.c_double)),
        ("backup", ctypes.c_void_p),
        ("reason", ctypes.c_char_p),
        ("variable", ctypes.c_char * 128),
        ("message", ctypes.c_char * 512),
    )


@lru_cache(maxsize=256)
def load_library(block: Block) -> ctypes.CDLL:
    """Library of a block, compiled if need be, with the types of its functions declared."""
    library = ctypes.CDLL(str(build_library(block)))
    engine, vector = ctypes.POINTER(EngineStruct), ctypes.c_void_p
    for name, result, arguments in (
        ("new", engine, (ctypes.c_void_p, ctypes.c_double)),
        ("free", None, (engine,)),
        ("reset", None, (engine,)),
        ("start", ctypes.c_int, (engine, ctypes.c_double, ctypes.c_int)),
        ("event", ctypes.c_int, (engine,)),
        ("relations", None, (engine,)),
        ("next_sample", ctypes.c_double, (engine,)),
        ("advance", ctypes.c_int, (engine, ctypes.c_double)),
        ("outputs", None, (engine,)),
        ("derivatives", None, (engine, vector)),
        ("indicators", None, (engine, vector)),
        ("check_finite", ctypes.c_int, (engine,)),
        ("run", ctypes.c_long, (engine, ctypes.c_long, ctypes.c_double, vector, vector)),
        ("state_size", ctypes.c_size_t, (engine,)),
        ("save", None, (engine, vector)),
        ("restore", None, (engine, vector)),
    ):
        function = getattr(library, f"engine_{name}")
        function.restype, function.argtypes = result, arguments
    return library
