"""cspdiag: communication and composition diagrams in text, checked and turned into control software that runs.

``load`` reads a program from a file, ``parse`` from a text; ``check`` and ``compile`` are shortcuts. Importing this
package loads nothing else: classes are imported on first use.
"""

from __future__ import annotations

TYPE_CHECKING = False
# Type checkers know the name; the module ``typing`` takes as long to load as the interpreter itself.
if TYPE_CHECKING:
    from os import PathLike

    from cspdiag.analyses.margins.linear import NotLinearError
    from cspdiag.api import LoadedProgram, ProgramError
    from cspdiag.base.diagnostic import Diagnostic
    from cspdiag.base.errors import ArgumentError, CspdiagError, FileError, MissingPackageError
    from cspdiag.codegen.shared.target_error import TargetError
    from cspdiag.draw.layout.graph import LayoutError
    from cspdiag.draw.missing import MissingToolError
    from cspdiag.drawing import Drawing
    from cspdiag.live import Tuning
    from cspdiag.model.types import Real
    from cspdiag.network.lower.program import SelectionError
    from cspdiag.settings import SettingError
    from cspdiag.simulate.native.build import CompilerError
    from cspdiag.simulate.result import Run, RunError, UnknownSignalError
    from cspdiag.simulate.run.execute import BodyError, NoEnvironmentError
    from cspdiag.simulate.run.reference import NoMeaningError
    from cspdiag.sweep.measures import MeasureError
    from cspdiag.sweep.table import Sweep
    from cspdiag.verify.systems import VerificationError

__all__ = [
    "ArgumentError",
    "BodyError",
    "CompilerError",
    "CspdiagError",
    "Diagnostic",
    "Drawing",
    "FileError",
    "LayoutError",
    "LoadedProgram",
    "MeasureError",
    "MissingPackageError",
    "MissingToolError",
    "NoEnvironmentError",
    "NoMeaningError",
    "NotLinearError",
    "ProgramError",
    "Run",
    "RunError",
    "SelectionError",
    "SettingError",
    "Sweep",
    "TargetError",
    "Tuning",
    "UnknownSignalError",
    "VerificationError",
    "__version__",
    "check",
    "compile",
    "load",
    "parse",
]

__version__ = "0.1.0"

_HOMES = {
    "ArgumentError": "base.errors",
    "BodyError": "simulate.run.execute",
    "CompilerError": "simulate.native.build",
    "CspdiagError": "base.errors",
    "Diagnostic": "base.diagnostic",
    "Drawing": "drawing",
    "FileError": "base.errors",
    "LayoutError": "draw.layout.graph",
    "LoadedProgram": "api",
    "MeasureError": "sweep.measures",
    "MissingPackageError": "base.errors",
    "MissingToolError": "draw.missing",
    "NoEnvironmentError": "simulate.run.execute",
    "NoMeaningError": "simulate.run.reference",
    "NotLinearError": "analyses.margins.linear",
    "ProgramError": "api",
    "Run": "simulate.result",
    "RunError": "simulate.result",
    "SelectionError": "network.lower.program",
    "SettingError": "settings",
    "Sweep": "sweep.table",
    "TargetError": "codegen.shared.target_error",
    "Tuning": "live",
    "UnknownSignalError": "simulate.result",
    "VerificationError": "verify.systems",
}
"""The modules of the classes that are imported on first use."""


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    found: object = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


def load(path: str | PathLike[str], *, real: Real = "double") -> LoadedProgram:
    """The program in a file (``-`` is standard input); it is not checked yet. ``real`` is what ``double`` means in the
    program: with ``"float32"`` it computes in single precision.

    Raises FileError, an OSError, for a file that cannot be read or is not text, and ArgumentError for another ``real``.
    """
    from cspdiag.api import load

    return load(path, real=real)


def parse(text: str, name: str = "program.csp", *, real: Real = "double") -> LoadedProgram:
    """The program in a text; it is not checked yet. ``name`` is what messages call it, and imports are relative to its
    folder; ``real`` is as for ``load``.

    Raises TypeError if it is not a ``str``, ArgumentError if it contains zero bytes or unpaired surrogates.
    """
    from cspdiag.api import parse

    return parse(text, name, real=real)


def check(path: str | PathLike[str]) -> list[Diagnostic]:
    """Everything that is wrong with the program in a file, as ``load`` reads it."""
    return load(path).check()


def compile(path: str | PathLike[str], target: str = "python") -> dict[str, str]:
    """The generated package of the program in a file: texts by path. Raises what ``load`` and ``LoadedProgram.compile``
    raise.
    """
    return load(path).compile(target)
