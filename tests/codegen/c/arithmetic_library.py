"""The arithmetic of C programs as a library that Python can call."""

from __future__ import annotations

import ctypes
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

from cspdiag.base.files.resources import template_folder
from cspdiag.codegen.c.text.code import call
from tests.support.compiling import compile_once

SUPPORT = template_folder("c") / "support"

_WHOLE = ("add", "subtract", "multiply", "quotient", "remainder", "power", "min_int", "max_int")
_OF_ONE = ("negate", "absolute", "sign_int")
_NARROW = ("int8", "int16", "int32", "uint8", "uint16", "uint32")
_REAL = ("divide", "min", "max", "pow", "atan2", "quantize", "deadzone")
_REAL_OF_ONE = ("exp", "log", "sin", "cos", "tan", "sign")


def compilers() -> list[str]:
    """The C compilers on this machine."""
    return [name for name in ("gcc", "clang") if shutil.which(name)]


def _call(name: str, *operands: str) -> str:
    """A call as in generated code, with the state of the run if the function can note a fault."""
    return str(call(f"csp_{name}", *operands))


def _source() -> str:
    rows = ['#include "csp_arithmetic.h"', "static csp_kernel kernel;", "static csp_kernel *const csp = &kernel;"]
    rows += [f"int64_t t_{name}(int64_t a, int64_t b) {{ return {_call(name, 'a', 'b')}; }}" for name in _WHOLE]
    rows += [f"int64_t t_{name}(int64_t a) {{ return {_call(name, 'a')}; }}" for name in _OF_ONE]
    rows += [f"int64_t t_{name}(int64_t a) {{ return (int64_t){_call(name, 'a')}; }}" for name in _NARROW]
    rows += [
        f"int64_t t_{name}_of_real(double x) {{ return (int64_t){_call(name + '_of_real', 'x')}; }}"
        for name in (*_NARROW, "int64")
    ]
    rows += [f"double t_{name}(double x, double y) {{ return {_call(name, 'x', 'y')}; }}" for name in _REAL]
    rows += [f"double t_{name}(double x) {{ return {_call(name, 'x')}; }}" for name in _REAL_OF_ONE]
    rows += [
        "double t_limit(double x, double low, double high) { return csp_limit(x, low, high); }",
        "double t_floor(double x) { return floor(x); }",
        "double t_ceil(double x) { return ceil(x); }",
        "double t_round(double x) { return round(x); }",
        "double t_sqrt(double x) { return sqrt(x); }",
        "double t_fmod(double x, double y) { return fmod(x, y); }",
        "double t_seconds(int64_t a) { return csp_seconds(a); }",
        "int64_t t_index(int64_t a, int64_t size) { return (int64_t)csp_index(csp, a, size); }",
        'void t_finite(double x) { csp_finite(csp, x, "port"); }',
        "void t_fault(char *text, size_t size) {",
        "    text[0] = '\\0';",
        "    if (csp_faulted(csp)) { kernel.fault.describe(&kernel.fault.operands, text, size); }",
        "    kernel.fault.describe = NULL; kernel.fault.place = NULL;",
        "}",
    ]
    # The outputs are the kernel's, too.
    rows.append("void csp_forget_outputs(csp_kernel *csp) { (void)csp; }")
    return "\n".join([*rows, ""])


class Arithmetic:
    """The functions by name; ``fault`` gives the text of the last fault, or "", and clears it."""

    def __init__(self, folder: Path, compiler: str) -> None:
        source, library = folder / "exported.c", folder / f"arithmetic_{compiler}.so"
        source.write_text(_source())
        # Raising is the kernel's task; csp_core.h declares the operands of faults.
        options = ["-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared", f"-I{SUPPORT}"]
        sources = [source, SUPPORT / "csp_arithmetic.c", SUPPORT / "csp_fault_text.c", SUPPORT / "csp_text.c"]
        compile_once(compiler, *options, *sources, "-lm", "-o", library)
        self._library = ctypes.CDLL(str(library))

    def whole(self, name: str) -> Callable[..., int]:
        """A function of whole numbers."""
        return self._function(name, ctypes.c_int64, ctypes.c_int64)

    def whole_of_real(self, name: str) -> Callable[..., int]:
        """A conversion."""
        return self._function(name, ctypes.c_int64, ctypes.c_double)

    def real(self, name: str) -> Callable[..., float]:
        """A function of reals."""
        return self._function(name, ctypes.c_double, ctypes.c_double)

    def real_of_whole(self, name: str) -> Callable[..., float]:
        """A function from a whole number to a real one."""
        return self._function(name, ctypes.c_double, ctypes.c_int64)

    def _function(self, name: str, result: Any, argument: Any) -> Callable[..., Any]:
        function = getattr(self._library, f"t_{name}")
        function.restype = result
        return lambda *values: function(*(argument(value) for value in values))

    def fault(self) -> str:
        """The fault since the last call."""
        buffer = ctypes.create_string_buffer(4096)
        self._library.t_fault(buffer, ctypes.c_size_t(len(buffer)))
        return buffer.value.decode()
