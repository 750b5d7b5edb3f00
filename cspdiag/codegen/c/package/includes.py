"""Which files of a package a file needs, and includes of those that it does not."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterable, Mapping

from cspdiag.codegen.c.interface.directives import included_in, without_comments
from cspdiag.codegen.c.text.reserved import MATHEMATICS

_DEFINED = re.compile(
    r"#\s*define\s+(\w+)|^(?!return\b)(?:\w+[ *]+)+(\w+)\(|\}\s*(\w+)\s*;|^\s+(\w+)(?: = [^,\n]*)?,?$"
    r"|\b(?:struct|union|enum)\s+(\w+)\s*\{|^typedef\s[^;{]*?(\w+);",
    re.MULTILINE,
)
"""Macros, functions, types and enumerators."""
_INCLUDE = re.compile(r'^#include "([^"\n]+)"\n', re.MULTILINE)
_WORD = re.compile(r"\"(?:\\.|[^\"\\\n])*\"|'\\?[^\n]'|/\*.*?\*/|//[^\n]*|(\w+)", re.DOTALL)
"""A word that is in no text and no comment; these have an empty one."""
_EMPTY_LINES = re.compile(r"\n{3,}")
_FIRST = "csp_core.h"
"""What it includes renames functions of the program, so each file needs it."""
_BY_OTHERS: Mapping[str, frozenset[str]] = {
    "csp_arithmetic.h": frozenset({*MATHEMATICS, *(f"{name}f" for name in MATHEMATICS), "INFINITY", "NAN"}),
    "csp_core.h": frozenset(
        {"bool", "true", "false", "NULL", "memcpy", "memset", "memcmp"}
        | {f"{sign}int{bits}_t" for sign in ("", "u") for bits in (8, 16, 32, 64)}
    ),
}
"""What generated code gets from the headers of C that these include."""


def with_headers(paths: Iterable[str], files: Mapping[str, str], folders: Iterable[str]) -> list[str]:
    """The paths with those of all headers that they include, looked for in ``folders`` among ``files``, sorted."""
    found: set[str] = set()
    pending = list(paths)
    while pending:
        path = pending.pop()
        if path not in found:
            found.add(path)
            names = included_in(files[path])
            pending += [place for name in names for folder in folders if (place := os.path.join(folder, name)) in files]
    return sorted(found)


def defined_in(text: str) -> frozenset[str]:
    """The names that a header defines or declares."""
    return frozenset(name for found in _DEFINED.findall(without_comments(text)) for name in found if name)


class Includes:
    """The includes of the files of a program that are generated, of headers of which not every file needs each."""

    def __init__(
        self,
        files: Mapping[str, str],
        kernel: Mapping[str, str],
        headers: Mapping[str, Collection[str]],
        fixed: Collection[str],
    ) -> None:
        """``headers`` are the names that each defines; files in ``fixed`` and of the ``kernel`` stay as they are."""
        self._defined = {
            header: frozenset(names) | _BY_OTHERS.get(header, frozenset()) for header, names in headers.items()
        }
        self._files = dict(files)
        self._kernel = kernel
        self._own = [path for path in files if path.endswith((".c", ".h")) and path not in fixed]
        self._needed = {path: self._needs(files[path]) for path in self._own}

    def reduced(self) -> dict[str, str]:
        """The files without includes of headers of which they need nothing, and with those that other files had for
        them.
        """
        before = {path: self._reached(path) for path in self._own}
        for path in self._own:
            self._files[path] = _without(self._files[path], self._defined.keys() - self._needed[path])
        for path in self._own:
            lost = before[path] - self._reached(path) - {_FIRST}
            missing = [header for header in self._needed[path] if header in lost]
            self._files[path] = _including(self._files[path], missing)
        for path in self._own:
            self._let_begin(path)
        return self._files

    def _let_begin(self, path: str) -> bool:
        """Whether the first header that a file includes is, or includes, the one that every file needs first; one of
        the program that does not gets it.
        """
        text = self._files.get(path) or self._kernel.get(path, "")
        if path == _FIRST or any(self._let_begin(name) for name in included_in(text)[:1]):
            return True
        if path in self._kernel:
            return _FIRST in self._reached(path)
        if path in self._own:
            self._files[path] = _beginning(text, f'#include "{_FIRST}"')
        return path in self._own

    def _needs(self, text: str) -> list[str]:
        words = set(_WORD.findall(text))
        return [header for header, names in self._defined.items() if header == _FIRST or not names.isdisjoint(words)]

    def _reached(self, path: str) -> set[str]:
        """The headers that a file includes, itself or by others; the file itself counts."""
        found, pending = {path}, [path]
        while pending:
            path = pending.pop()
            for name in included_in(self._files.get(path) or self._kernel.get(path, "")):
                if name not in found:
                    found.add(name)
                    pending.append(name)
        return found


def _without(text: str, headers: Collection[str]) -> str:
    kept = _INCLUDE.sub(lambda found: "" if found[1] in headers else found[0], text)
    return _EMPTY_LINES.sub("\n\n", kept)


def _including(text: str, headers: Iterable[str]) -> str:
    """The text with more includes: those of the kernel go before the constants of the program, because parameters in
    the kernel would shadow these.
    """
    added = [f'#include "{header}"' for header in headers]
    if not added:
        return text
    constants = '#include "constants.h"'
    if constants in text and constants not in added:
        return text.replace(constants, "\n".join([*added, constants]), 1)
    rows = text.split("\n")
    places = [number for number, row in enumerate(rows, 1) if row.startswith("#include")]
    if not places:  # They go behind the guard.
        places, added = [next(number for number, row in enumerate(rows, 1) if row.startswith("#define "))], ["", *added]
    return "\n".join([*rows[: places[-1]], *added, *rows[places[-1] :]])


def _beginning(text: str, include: str) -> str:
    """The text with an include in front of all others."""
    place = re.search(r'^#include "', text, re.MULTILINE)
    if place is None:
        return _including(text, [_FIRST])
    return f"{text[: place.start()]}{include}\n{text[place.start() :]}"
