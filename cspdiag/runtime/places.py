"""Where something happened, in terms of the source of the program.

Generated code carries the place of a statement as a comment, ``# laws.csp:12``, at the end of its line or on a line above it.
"""

from __future__ import annotations

import linecache
import re
from types import CodeType, FrameType, TracebackType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .process import Process
    from .routine import Part

_PLACE = re.compile(r"#\s*([^\s#]+\.csp:\d+)")
_RUNTIME = __package__


def place_of(error: BaseException, process: Process | Part) -> str:
    """The process, with the source line of the statement that raised ``error``, or else that of the process."""
    place = statement_of(error) or process.source
    return process.name if place is None else f"{process.name} ({place})"


def statement_of(error: BaseException) -> str | None:
    """The source line of the innermost statement of the program that raised ``error``."""
    place: str | None = None
    traceback: TracebackType | None = error.__traceback__
    while traceback is not None:
        frame = traceback.tb_frame
        if not is_of_runtime(frame):
            place = source_line(frame.f_code, traceback.tb_lineno) or place
        traceback = traceback.tb_next
    return place


def raised_by_program(error: BaseException) -> bool:
    """Whether generated code itself has raised ``error``, and not what it calls: its files are those that have places."""
    files: set[str] = set()
    innermost: CodeType | None = None
    traceback: TracebackType | None = error.__traceback__
    while traceback is not None:
        innermost = traceback.tb_frame.f_code
        if source_line(innermost, traceback.tb_lineno) is not None:
            files.add(innermost.co_filename)
        traceback = traceback.tb_next
    return innermost is not None and innermost.co_filename in files


def is_of_runtime(frame: FrameType) -> bool:
    """Whether a frame executes code of this package."""
    return str(frame.f_globals.get("__package__", "")) == _RUNTIME


def source_line(code: CodeType, line: int) -> str | None:
    """The place in the comment at ``line`` of the generated code or the nearest above it in the same function."""
    for number in range(line, code.co_firstlineno - 1, -1):
        found = _PLACE.search(linecache.getline(code.co_filename, number))
        if found is not None:
            return found[1]
    return None
