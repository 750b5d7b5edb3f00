"""The files of programs as the editor shows them: open ones with their unsaved texts, the others from disk."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator, Sequence
from functools import lru_cache

from lsprotocol import types
from pygls import uris

from cspdiag.base.files.content import Stamp, stamp_of
from cspdiag.base.files.resources import library_file
from cspdiag.base.record import replaced
from cspdiag.base.sources import FileStyle, read_source, read_whole
from cspdiag.base.span import SourceFile, with_line_feeds
from cspdiag.lsp.positions import Positions

MAX_CHARACTERS = 1_000_000
"""The longest text of which the server computes anything while it is edited."""


class Document:
    """An open file; ``source`` has its present text, and ``identity`` is the same for all names of the file. ``style``
    is what it has beside that text, in which blanks are in the place of a byte order mark: positions count it.
    """

    def __init__(self, uri: str, name: str, text: str, version: int | None, positions: Positions) -> None:
        self.uri = uri
        self.identity = identity(name)
        self.version = version
        self.style = FileStyle.of(text)
        self.source = SourceFile(name=name, text=self._text(text, positions))
        self.answered: dict[str, str] = {}
        """The last answer about each assertion, by its text; the program may have changed since."""
        self._on_disk: tuple[Stamp, str | None] | None = None
        """What distinguishes the file that was read last, and why that is not text in UTF-8, if it is not."""

    def _text(self, whole: str, positions: Positions) -> str:
        mark = self.style.mark
        return positions.blanks_for(mark) + with_line_feeds(whole.removeprefix(mark))

    @property
    def is_too_large(self) -> bool:
        """Whether the text is too long to be checked while it is edited."""
        return len(self.source.text) > MAX_CHARACTERS

    @property
    def misread(self) -> str | None:
        """Why the file on the disk, as it is now, is not text in UTF-8: every other program refuses it, and what the
        editor shows is a guess. None if it is, or if there is none.
        """
        name = self.source.name
        try:
            found = os.stat(name)
        except (OSError, ValueError):
            return None
        stamp = stamp_of(found)
        if self._on_disk is None or self._on_disk[0] != stamp:
            self._on_disk = stamp, _not_text(name)
        return self._on_disk[1]

    def change(
        self,
        changes: Sequence[types.TextDocumentContentChangeEvent],
        version: int | None,
        positions: Positions,
    ) -> None:
        """Apply what the editor has changed, in order."""
        source = self.source
        for change in changes:
            if isinstance(change, types.TextDocumentContentChangePartial):
                text = with_line_feeds(change.text)
                start = positions.offset(source, change.range.start)
                end = max(start, positions.offset(source, change.range.end))
                text = f"{source.text[:start]}{text}{source.text[end:]}"
            else:
                self.style = FileStyle.of(change.text)
                text = self._text(change.text, positions)
            source = SourceFile(name=source.name, text=text)
        self.source = source
        self.version = version


def _not_text(name: str) -> str | None:
    try:
        read_source(name)
    except OSError as problem:
        return problem.strerror if problem.errno == errno.EILSEQ else None
    return None


@lru_cache(maxsize=4096)
def identity(name: str) -> str:
    """The same for all names of one file."""
    return os.path.realpath(name)


def is_bundled(name: str) -> bool:
    """Whether a source file is a library that comes with cspdiag, or was made by it; neither can be changed."""
    return not os.path.isabs(name) or not name.endswith(".csp")


def name_of(uri: str) -> str:
    """The name of the source file at a URI: its path, or the URI itself if that is not the URI of a file."""
    path = uris.to_fs_path(uri) if uri.startswith("file:") else None
    return uri if path is None else path.replace(os.sep, "/")


class Documents:
    """All open files, by identity. Two editors that have one file open under different names share it."""

    def __init__(self, positions: Positions) -> None:
        self.positions = positions
        self._open: dict[str, Document] = {}

    def __iter__(self) -> Iterator[Document]:
        return iter(self._open.values())

    def open(self, uri: str, text: str, version: int | None) -> Document:
        """Take the text of a file from the editor from now on."""
        document = Document(uri, name_of(uri), text, version, self.positions)
        self._open[document.identity] = document
        return document

    def close(self, uri: str) -> None:
        """Take the text of a file from disk again."""
        self._open.pop(identity(name_of(uri)), None)

    def get(self, uri: str) -> Document | None:
        """The open file at a URI."""
        return self._open.get(identity(name_of(uri)))

    def read(self, name: str) -> SourceFile:
        """The present text of a file.

        Raises OSError if it cannot be read, or is open but not UTF-8 on the disk; ValueError if it is too large.
        """
        document = self._open.get(identity(name))
        reason = None if document is None else document.misread
        if reason is not None:
            raise OSError(errno.EILSEQ, reason, name)
        source = read_source(name) if document is None else document.source
        if len(source.text) > MAX_CHARACTERS:
            size = f"{len(source.text)} characters, more than the {MAX_CHARACTERS}"
            raise ValueError(f"it has {size} up to which files are checked while they are edited")
        return source if source.name == name else SourceFile(name=name, text=source.text)

    def style(self, name: str) -> FileStyle:
        """How the lines of a file end, and whether the editor counts a byte order mark in it."""
        document = self._open.get(identity(name))
        if document is not None:
            return document.style
        try:
            return replaced(FileStyle.of(read_whole(name)[1]), mark="")
        except OSError:
            return FileStyle()

    def uri(self, name: str) -> str:
        """The URI of a source file, as the editor writes it if the file is open."""
        document = self._open.get(identity(name))
        if document is not None:
            return document.uri
        if not os.path.isabs(name):
            # A library, or what a text that is in no file imports, whose path begins in the present folder.
            name = library_file(name.removesuffix(".csp").replace("/", ".")) or os.path.abspath(name)
        return uris.from_fs_path(name) or name

    def version(self, name: str) -> int | None:
        """The version of an open file; None for another one."""
        document = self._open.get(identity(name))
        return None if document is None else document.version
