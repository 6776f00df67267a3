"""Native code: C from a block's expressions, compiled, cached, loaded and run."""

from brunovsky.native.code import model_source
from brunovsky.native.compiler import compile_library, find_compiler
from brunovsky.native.engine import NativeEngine
from brunovsky.native.jacobian import jacobian_source
from brunovsky.native.simulate import simulate

__all__ = [
    "NativeEngine",
    "compile_library",
    "find_compiler",
    "jacobian_source",
    "model_source",
    "simulate",
]
