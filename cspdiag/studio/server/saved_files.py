"""The files of the program that the studio was started with: pages save them, and others change them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cspdiag.base.errors import file_error
from cspdiag.base.files.content import digest_of_file
from cspdiag.base.files.whole import write_whole
from cspdiag.base.span import with_line_feeds
from cspdiag.studio.engine.program_file import ProgramFile
from cspdiag.studio.server.refusal import RefusedError

_WHEN_CHANGED = "copy what you want to keep, and reload the page"


class SavedFiles:
    """Saves the files of a program as pages know them: only these, and only while nobody else changes them. Says when
    the disk has others than pages know.
    """

    def __init__(self, file: ProgramFile) -> None:
        self._file = file
        self._folder = Path(file.own_folder)
        self._names: frozenset[str] = frozenset()
        self._known: dict[str, str | None] = {}
        self._seen: dict[str, str | None] = {}
        """The digests of the files when they were last looked at."""

    @property
    def command_folder(self) -> str:
        """The folder of the program."""
        return self._file.own_folder

    def opened(self, program: Mapping[str, Any]) -> None:
        """Pages get this program, of the engine that has read it. What is not on the disk now may come back."""
        folder = Path(self._file.folder(program["main"]))
        before = self._names if folder == self._folder else frozenset()
        self._folder, self._names = folder, before | frozenset(program["files"])

    def look(self) -> bool:
        """Whether there is news for pages: files are not those of ``note``, and have not changed since the last
        look, so that nobody is in the middle of writing one.
        """
        before = self._seen
        self._seen = {name: digest_of_file(str(self._folder / name)) for name in self._names}
        return self._seen == before and self._seen != self._known

    def note(self) -> None:
        """Pages know what the disk has."""
        self._known = self._seen

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
