"""Which channels a waiting task may still use: those that occur in the code after the place where it waits, on any
path.

A statement of generated code waits at most once, when all its names have been looked up. What a loop iterates over, and
the handler of an interrupt, are looked up earlier and used later: then all names in the function count.
"""

from __future__ import annotations

import dis
from functools import lru_cache
from types import CodeType, FrameType
from typing import Any

from cspdiag.runtime.choice.interrupt import _Body
from cspdiag.runtime.deadlock.tasks import channel_identity, channels_used_by, names_in_code
from cspdiag.runtime.kernel.scheduler import Task

_LEAVING = ("RETURN_", "RAISE_VARARGS", "RERAISE", "JUMP_FORWARD", "JUMP_BACKWARD")
"""The beginnings of the names of instructions after which the next one is not executed."""


def reachable_channels(task: Task) -> set[int]:
    """Identities of the channels at which the task waits, and of those that it may still use."""
    waits = {channel_identity(end) for _, end in task.waits() if end is not None}
    return waits | channels_used_by(task, reachable_names)


def reachable_names(task: Task, frame: FrameType) -> set[str]:
    """The names that a function of the task may still use."""
    if isinstance(task.waiting, _Body):
        return names_in_code(frame.f_code)
    return set(_names_after(frame.f_code, frame.f_lasti))


def _entries(code: CodeType) -> list[Any]:
    """The entries of the table of exceptions: the first and last instruction of each, and where execution continues."""
    return list(dis.Bytecode(code).exception_entries)  # type: ignore[attr-defined]


@lru_cache(maxsize=4096)
def _names_after(code: CodeType, position: int) -> frozenset[str]:
    """The names in the instructions that can be executed after the one at a position; -1 is the beginning."""
    instructions = list(dis.get_instructions(code))
    numbers = {instruction.offset: number for number, instruction in enumerate(instructions)}
    handlers = [(entry.start, entry.end, entry.target) for entry in _entries(code)]
    names: set[str] = set()
    seen: set[int] = set()
    pending = [number for offset, number in numbers.items() if offset > position][:1]
    pending += [numbers[target] for start, end, target in handlers if start <= position < end]
    while pending:
        number = pending.pop()
        if number in seen:
            continue
        seen.add(number)
        instruction = instructions[number]
        if instruction.opname == "FOR_ITER":
            return frozenset(names_in_code(code))
        if instruction.opcode in dis.hasname:
            names.add(instruction.argval)
        elif isinstance(instruction.argval, CodeType):
            names |= names_in_code(instruction.argval)
        if instruction.opcode in (*dis.hasjrel, *dis.hasjabs):
            pending.append(numbers[instruction.argval])
        if not instruction.opname.startswith(_LEAVING) and number + 1 < len(instructions):
            pending.append(number + 1)
        pending += [numbers[target] for start, end, target in handlers if start <= instruction.offset < end]
    return frozenset(names)
