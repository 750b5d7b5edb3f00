"""Which channels a task that waits may still come to: those that are named after the place where it waits, in whatever
may follow there.

A statement of generated code waits at most once, when all that it names has been looked up. What a loop goes over and
the handler of an interrupt are looked up before and used later: then all counts that the function names.
"""

from __future__ import annotations

import dis
from functools import lru_cache
from types import CodeType, FrameType
from typing import Any

from cspdiag.runtime.choice.interrupt import _Body
from cspdiag.runtime.deadlock import channel_identity, channels_used_by, names_in_code
from cspdiag.runtime.kernel.scheduler import Task

_LEAVING = ("RETURN_", "RAISE_VARARGS", "RERAISE", "JUMP_FORWARD", "JUMP_BACKWARD")
"""Instructions whose names begin so are not followed by the next one."""


def channels_to_come(task: Task) -> set[int]:
    """Identities of the channels at which the task waits, and of those that it may come to."""
    waits = {channel_identity(end) for _, end in task.waits() if end is not None}
    return waits | channels_used_by(task, _names_to_come)


def _names_to_come(task: Task, frame: FrameType) -> set[str]:
    if isinstance(task.waiting, _Body):
        return names_in_code(frame.f_code)
    return set(_names_after(frame.f_code, frame.f_lasti))


def _entries(code: CodeType) -> list[Any]:
    """Of the table of exceptions: from which instruction to which, and where it goes on."""
    return list(dis.Bytecode(code).exception_entries)  # type: ignore[attr-defined]


@lru_cache(maxsize=4096)
def _names_after(code: CodeType, position: int) -> frozenset[str]:
    """The names in what can be executed after the instruction at a position; -1 is the beginning."""
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
