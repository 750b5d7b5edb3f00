"""Finds what ships beside the code: the grammar, the templates, the benchmarks and the bundled library.

A checkout (and an editable install) has ``grammars/``, ``templates/`` and ``benchmarks/`` at its top level; a wheel has them
under ``cspdiag/_resources/``.
"""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def _folder(name: str) -> Path:
    installed = _PACKAGE / "_resources" / name
    return installed if installed.is_dir() else _PACKAGE.parent / name


def grammar_path() -> Path:
    """Where the grammar of the language is."""
    return _folder("grammars") / "csp.lark"


def grammar() -> str:
    """The text of the grammar."""
    return grammar_path().read_text(encoding="utf-8")


def template_folder(target: str) -> Path:
    """The folder of the templates of a target, such as ``python``."""
    return _folder("templates") / target


def benchmark_folder() -> Path:
    """The folder of the benchmarks, itself a program."""
    return _folder("benchmarks")


def library_source(name: str) -> str | None:
    """The text of a bundled library by the name that ``import`` gives it (``std.control``), or None if there is none."""
    parts = name.split(".")
    if len(parts) < 2 or parts[0] != "std" or not all(part.isidentifier() for part in parts):
        return None
    path = _PACKAGE.joinpath(*parts).with_suffix(".csp")
    return path.read_text(encoding="utf-8") if path.is_file() else None
