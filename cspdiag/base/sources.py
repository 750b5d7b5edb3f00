"""Reads source files."""

from __future__ import annotations

import errno
import os
import stat
import sys
from collections.abc import Mapping

from cspdiag.base.record import record
from cspdiag.base.span import LINE_END, SourceFile, with_line_feeds

MAXIMUM_SIZE = 64 * 1024 * 1024
"""In bytes. A larger file (or a device that never ends) is not a program."""

STANDARD_INPUT = "-"
BYTE_ORDER_MARK = "\ufeff"

_OPEN_ALREADY = ("/dev/fd", "/proc/self/fd")
"""Folders of files with which the process was started, such as those that a shell makes for ``<(command)``."""

_KINDS = (
    (stat.S_ISFIFO, "a named pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)


@record
class FileStyle:
    """What a file has that its text as a program does not: a byte order mark, if any, and the end of its first line."""

    mark: str = ""
    end: str = "\n"

    @staticmethod
    def of(whole: str) -> FileStyle:
        """The style of a file with these characters."""
        first = LINE_END.search(whole)
        mark = BYTE_ORDER_MARK if whole.startswith(BYTE_ORDER_MARK) else ""
        return FileStyle(mark, "\n" if first is None else first.group())

    def applied(self, text: str) -> str:
        """The characters of a file in this style; all its lines end alike."""
        return self.mark + text.replace("\n", self.end)


def read_source(path: str) -> SourceFile:
    """The text of a file, or of standard input for ``-``, with line ends as ``\\n``.

    Raises OSError, with a ``strerror`` for people, for what cannot be read, is not a file, is not UTF-8 text or is too
    large.
    """
    return SourceFile(name=path, text=decoded(_read(path), path))


def read_whole(path: str) -> tuple[SourceFile, str]:
    """The same, and all characters of the file."""
    data = _read(path)
    return SourceFile(name=path, text=decoded(data, path)), data.decode("utf-8")


def given_source(name: str, texts: Mapping[str, str | None]) -> SourceFile:
    """A file of a program whose texts come from another process, None for those that it could not read.

    Raises OSError for these: only that process knows what is open in the editor, and up to which size it reads files.
    """
    text = texts.get(name)
    if text is None:
        raise OSError(errno.EIO, "it could not be read", name)
    return SourceFile(name=name, text=text)


def _read(path: str) -> bytes:
    try:
        if path == STANDARD_INPUT:
            return _standard_input()
        require_ordinary_file(path)
        with open(path, "rb") as file:
            return file.read(MAXIMUM_SIZE + 1)
    except ValueError as problem:
        raise OSError(errno.EINVAL, str(problem), path) from None


def require_ordinary_file(path: str) -> None:
    """Raise OSError for what exists and is not a file: a pipe or a device may never deliver anything.

    Standard input, by its name, and files with which the process was started are accepted. A missing file is left to
    the caller.
    """
    place = os.path.abspath(path)
    if place == "/dev/stdin" or os.path.dirname(place) in _OPEN_ALREADY:
        return
    try:
        mode = os.stat(path).st_mode
    except OSError:
        return
    for is_kind, name in _KINDS:
        if is_kind(mode):
            raise OSError(errno.EINVAL, f"it is {name}, not a file", path)


def _standard_input() -> bytes:
    try:
        return sys.stdin.buffer.read(MAXIMUM_SIZE + 1)
    except OSError as problem:
        reason = "it is closed" if problem.errno == errno.EBADF else problem.strerror
        raise OSError(problem.errno, reason, "standard input") from None


def decoded(data: bytes, path: str) -> str:
    """The text of a file given by its bytes; raises what ``read_source`` raises."""
    if len(data) > MAXIMUM_SIZE:
        raise OSError(errno.EFBIG, f"larger than {MAXIMUM_SIZE // 1024 // 1024} MiB", path)
    zero = data.find(b"\0")
    if zero >= 0:
        raise OSError(errno.EILSEQ, f"not text (a zero byte at offset {zero})", path)
    try:
        return with_line_feeds(data.decode("utf-8-sig"))
    except UnicodeDecodeError as problem:
        byte = data[problem.start]
        raise OSError(errno.EILSEQ, f"not UTF-8 text (byte 0x{byte:02x} at offset {problem.start})", path) from None
