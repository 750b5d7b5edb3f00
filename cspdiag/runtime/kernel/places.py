"""Where something happened, in terms of the source of the program.

Generated code carries the place of a statement as a comment, ``# laws.csp:12``, at the end of its line or on a line
above it; two spaces separate it from more text.
"""

from __future__ import annotations

import linecache
import os
import re
import sys
from collections.abc import Iterable
from inspect import CO_COROUTINE, CO_GENERATOR
from types import CodeType, FrameType, FunctionType, TracebackType

from .exceptions import Cancelled, Place, RunEnded
from .executed import Executed

_PLACE = re.compile(r"(?:^\s*|  )# (\S.*?\.csp:\d+)(?:  |\s*$)")
_RUNTIME = (__package__ or "").rpartition(".")[0]
"""The package of the runtime, which may be inside a generated package."""
_BY_HAND = ".external."
"""How the name of the package ends into which bodies written by hand are copied, with a point."""
_LIBRARY = os.path.dirname(os.__file__)


def place_of(error: BaseException, process: Executed) -> Place:
    """The process with the source line of the statement that raised ``error`` or, if unknown, that of the process."""
    return Place(process.name, statement_of(error) or process.source, line_by_hand(error))


def note_place(error: BaseException, process: Executed) -> None:
    """Adds a note with the place at which an exception that is not one of the program's has left ``process``, unless it
    only ends the process.
    """
    if isinstance(error, Cancelled | RunEnded) or hasattr(error, "__notes__"):
        return
    if isinstance(error, GeneratorExit) and _is_closed(error.__traceback__):
        return
    error.add_note(f"in {place_of(error, process)}")


def _is_closed(traceback: TracebackType | None) -> bool:
    """Whether a GeneratorExit was raised where a process waits, and not by a function that it calls."""
    flags = 0
    while traceback is not None:
        flags = traceback.tb_frame.f_code.co_flags
        traceback = traceback.tb_next
    return bool(flags & (CO_GENERATOR | CO_COROUTINE))


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


def line_by_hand(error: BaseException) -> str | None:
    """The innermost line of a body in Python that raised ``error``, or called what did (``law.py:3``); None if it was
    none.
    """
    line: str | None = None
    traceback: TracebackType | None = error.__traceback__
    while traceback is not None:
        frame = traceback.tb_frame
        if f"{frame.f_globals.get('__package__')}.".endswith(_BY_HAND):
            line = f"{os.path.basename(frame.f_code.co_filename)}:{traceback.tb_lineno}"
        traceback = traceback.tb_next
    return line


def raised_by_program(error: BaseException) -> bool:
    """Whether generated code itself has raised ``error``, not a function that it calls. Its files are those that have
    places.
    """
    files: set[str] = set()
    innermost: CodeType | None = None
    traceback: TracebackType | None = error.__traceback__
    while traceback is not None:
        innermost = traceback.tb_frame.f_code
        if source_line(innermost, traceback.tb_lineno) is not None:
            files.add(innermost.co_filename)
        traceback = traceback.tb_next
    return innermost is not None and innermost.co_filename in files


def is_of_runtime(code: FrameType | FunctionType) -> bool:
    """Whether a frame executes, or a function is, code of this package."""
    names = code.__globals__ if isinstance(code, FunctionType) else code.f_globals
    package = str(names.get("__package__", ""))
    return package == _RUNTIME or package.startswith(f"{_RUNTIME}.")


def source_line(code: CodeType, line: int) -> str | None:
    """The place in the comment at ``line`` of the generated code or the nearest above it in the same function."""
    return _first_place(code, range(line, code.co_firstlineno - 1, -1))


def _first_place(code: CodeType, lines: Iterable[int]) -> str | None:
    for number in lines:
        found = _PLACE.search(linecache.getline(code.co_filename, number))
        if found is not None:
            return found[1]
    return None


def whereabouts(thread: int, *, only_processes: bool = False) -> str:
    """Where a thread that hangs is: the process, the source line, and the line of the code written by hand.

    Empty with ``only_processes`` if no process is running.
    """
    frame = sys._current_frames().get(thread)
    process = place = by_hand = ""
    while frame is not None and not (process and place):
        executed = _executed_by(frame)
        if not is_of_runtime(frame):
            place = place or _place_around(frame) or (executed and executed.source) or ""
            if not place and not by_hand and not _is_of_library(frame):
                by_hand = f"{os.path.basename(frame.f_code.co_filename)}:{frame.f_lineno} in {frame.f_code.co_name}"
        process = process or (executed.name if executed is not None else "")
        frame = frame.f_back
    if only_processes and not process:
        return ""
    shown = f"{process} ({place})" if process and place else process or place
    return f"{shown}, at {by_hand}" if shown and by_hand else shown or by_hand


def _place_around(frame: FrameType) -> str | None:
    """The place at which a frame is. Within a loop it is most often at the head of the loop, not at what precedes the
    loop.
    """
    code, line = frame.f_code, frame.f_lineno
    last = max(number or 0 for _, _, number in code.co_lines())
    loop = _head_of_loop(code, line)
    return _first_place(code, (*range(line, loop - 1, -1), *range(line + 1, last + 1))) or source_line(code, loop)


def _head_of_loop(code: CodeType, line: int) -> int:
    """The line of the head of the innermost loop around ``line``, or of the function."""
    depth: int | None = None
    for number in range(line, code.co_firstlineno, -1):
        text = linecache.getline(code.co_filename, number)
        statement = text.lstrip()
        indent = len(text) - len(statement)
        if statement and (depth is None or indent < depth):
            depth = indent
            if statement.startswith(("while ", "for ")):
                return number
    return code.co_firstlineno


def _is_of_library(frame: FrameType) -> bool:
    file = frame.f_code.co_filename
    return file.startswith((_LIBRARY, "<frozen", "<string>")) or "site-packages" in file


def _executed_by(frame: FrameType) -> Executed | None:
    executed = frame.f_locals.get("self")
    if executed is None:
        # A branch of optimized code has a variable for its task, and one for its process only if it uses that.
        executed = getattr(frame.f_locals.get("me"), "process", None)
    return executed if isinstance(executed, Executed) else None
