"""The files of the program that the studio was started with: pages get them, and may save them."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

from cspdiag.base.errors import file_error
from cspdiag.base.files.whole import write_whole
from cspdiag.base.span import with_line_feeds
from cspdiag.studio.server.refusal import RefusedError

_BESIDE = (".py", ".svg")
"""Hand-written bodies, and drawings that move with the run."""
_IMPORT = re.compile(r'^\s*import\s+"([^"\n]+)"', re.MULTILINE)
_LONGEST = 1_000_000
"""Bytes of a file."""
_WHEN_CHANGED = "copy what you want to keep, and reload the page"


class ProgramFiles:
    """The files of a program. Only these can be saved, and only while nobody else changes them.

    Their names are paths relative to the folder that has them all.
    """

    def __init__(self, main: Path) -> None:
        self._main = main.resolve()
        self._folder = self._main.parent
        self._names: frozenset[str] = frozenset()

    @property
    def command_folder(self) -> str:
        """The folder in which the program runs."""
        return str(self._main.parent)

    def load(self) -> dict[str, Any]:
        """The program as it is on disk: the file, those that it imports, and what lies beside them."""
        programs = self._programs()
        self._folder = Path(os.path.commonpath([path.parent for path in programs]))
        beside = {
            path
            for folder in {path.parent for path in programs}
            for path in folder.iterdir()
            if path.suffix in _BESIDE and path.is_file()
        }
        found = {path: _text(path) for path in (*programs, *sorted(beside))}
        texts = {self._name(path): text for path, text in found.items() if text is not None}
        self._names = frozenset(texts)
        return {"files": texts, "main": self._name(self._main)}

    def _name(self, path: Path) -> str:
        return path.relative_to(self._folder).as_posix()

    def _programs(self) -> list[Path]:
        """The file, and those that it imports, also indirectly."""
        found = [self._main]
        for path in found:
            for name in _IMPORT.findall(_text(path) or ""):
                imported = (path.parent / name).resolve()
                if imported.is_file() and imported not in found:
                    found.append(imported)
        return found

    def save(self, name: object, text: object, before: object) -> None:
        """Replace a file as a whole; ``before`` is what it contained when the page got it. Raises RefusedError."""
        if not isinstance(name, str) or not isinstance(text, str):
            raise RefusedError("`file` and `text` are texts")
        if name not in self._names:
            raise RefusedError(f"{name} is not a file of the program that the studio was started with")
        path = self._folder / name
        try:
            data = text.encode()
        except UnicodeEncodeError:
            raise RefusedError(f"{name} has half of a character of two code units (a surrogate)") from None
        try:
            present = path.read_bytes()
            if with_line_feeds(present.decode(errors="replace")) != before:
                raise RefusedError(f"{name} has changed on disk since this page was opened", _WHEN_CHANGED)
            if b"\r\n" in present:
                data = with_line_feeds(text).replace("\n", "\r\n").encode()
            write_whole(path, data)
        except OSError as problem:
            raise RefusedError(f"not saved: {file_error(problem)}") from None


def _text(path: Path) -> str | None:
    """What a file contains; None if it cannot be read, or is not a text of reasonable size."""
    try:
        data = path.read_bytes()
        return with_line_feeds(data.decode()) if len(data) <= _LONGEST else None
    except (OSError, UnicodeDecodeError):
        return None
