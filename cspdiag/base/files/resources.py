"""Finds what ships beside the code: the grammar, the templates, the manual pages, the benchmarks and the bundled
library.

A checkout (and an editable install) has ``grammars/`` and the others at its top level; a wheel has them under
``cspdiag/_resources/``. ``pathlib`` is imported only where a path is needed: ``check`` starts without it.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

_PACKAGE = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))


def _place(*parts: str) -> str:
    installed = os.path.join(_PACKAGE, "_resources", *parts)
    return installed if os.path.exists(installed) else os.path.join(os.path.dirname(_PACKAGE), *parts)


def _path(*parts: str) -> Path:
    from pathlib import Path

    return Path(_place(*parts))


def _text(path: str) -> str:
    with open(path, encoding="utf-8") as file:
        return file.read()


def grammar_file() -> str:
    """The path of the grammar."""
    return _place("grammars", "csp.lark")


def grammar() -> str:
    """The text of the grammar."""
    return _text(grammar_file())


def template_folder(target: str) -> Path:
    """The folder of the templates of a target, such as ``python``."""
    return _path("templates", target)


def third_party(*parts: str) -> str | None:
    """The path of a file written by others, such as ``third_party("elkjs", "elk-worker.min.js")``; None if it was not
    fetched.
    """
    path = _place("third-party", *parts)
    return path if os.path.isfile(path) else None


def studio_page() -> str | None:
    """The folder with the page of the studio; None if it was not built."""
    path = _place("studio", "build")
    return path if os.path.isfile(os.path.join(path, "main.js")) else None


def manual_page_file(*parts: str) -> str:
    """The path of a folder of manual pages, or of a page in it."""
    return _place("manual", *parts)


def language_page() -> str:
    """The text of the page that describes the language in brief."""
    return _text(_place("docs", "language-in-brief.md"))


def case_study() -> str:
    """The path of JIWY, the case study."""
    return _place("models", "jiwy", "jiwy.csp")


def example_folder() -> Path:
    """The folder of the example programs, a folder for each."""
    return _path("models")


def benchmark_folder() -> Path:
    """The folder of the benchmarks, itself a program."""
    return _path("benchmarks")


def library_file(name: str) -> str | None:
    """The path of a bundled library by the name that ``import`` gives it (``std.control``), or None if unknown."""
    parts = name.split(".")
    if len(parts) < 2 or parts[0] != "std" or not all(part.isidentifier() for part in parts):
        return None
    path = os.path.join(_PACKAGE, *parts) + ".csp"
    return path if os.path.isfile(path) else None


def library_source(name: str) -> str | None:
    """The text of a bundled library, by its name as for ``library_file``, or None if unknown."""
    path = library_file(name)
    return None if path is None else _text(path)


def library_names() -> list[str]:
    """The names of the bundled libraries, such as ``std.control``."""
    names = sorted(os.listdir(os.path.join(_PACKAGE, "std")))
    return [f"std.{name.removesuffix('.csp')}" for name in names if name.endswith(".csp")]
