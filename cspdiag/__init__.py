"""cspdiag: communication and composition diagrams in text, checked and turned into control software that runs.

``load`` gives a program; ``check`` and ``compile`` are short cuts. Importing this package loads nothing else.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from os import PathLike

    from cspdiag.api import LoadedProgram
    from cspdiag.base import Diagnostic

__all__ = ["__version__", "check", "compile", "load"]

__version__ = "0.1.0"


def load(path: str | PathLike[str]) -> LoadedProgram:
    """The program in a file; nothing of it is checked yet.

    Raises OSError for a file that cannot be read or is not text.
    """
    from cspdiag.api import load

    return load(path)


def check(path: str | PathLike[str]) -> list[Diagnostic]:
    """Everything that is wrong with the program in a file, as ``load`` reads it."""
    return load(path).check()


def compile(path: str | PathLike[str], target: str = "python") -> dict[str, str]:
    """The generated package of the program in a file: texts by path. Raises ``cspdiag.api.ProgramError``, OSError."""
    return load(path).compile(target)
