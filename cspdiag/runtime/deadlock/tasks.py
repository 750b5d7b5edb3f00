"""What a task that waits is doing: where, for what, and which channels it can still reach.

Channels do not know their users. They are found where they are referred to: in the local variables of the coroutines
that wait, and in the attributes of their processes.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator
from gc import get_referents
from inspect import iscoroutine
from types import CodeType, FrameType, FunctionType
from typing import Any, TypeAlias

from ..channels.any_channel import AnyChannel
from ..channels.converting import Converting
from ..channels.ports import In, Out
from ..choice.guards import Output
from ..composition import Branches
from ..kernel.party import Waits
from ..kernel.places import is_of_runtime, source_line
from ..kernel.scheduler import Task
from ..process import Process

_BOTH_SIDES = frozenset(["read", "write"])
NamesIn: TypeAlias = "Callable[[Task, FrameType], set[str]]"
Ends: TypeAlias = "dict[int, tuple[In[Any] | Out[Any], set[str]]]"
"""Ends of channels by their identities, each with the sides at which it is used."""
_OPERATIONS = {"read": ("read", "read_all", "take"), "write": ("write", "write_all", "offer", "choose_output")}


def leaves(task: Task) -> Iterator[Task]:
    """The tasks below ``task`` that do not wait for branches of their own, in text order."""
    pending = [task]
    while pending:
        task = pending.pop()
        if isinstance(task.waiting, Branches) and task.waiting.pending:
            pending += [branch for branch in reversed(task.waiting.tasks) if not branch.ended]
        else:
            yield task


def words_of(waits: Waits) -> str:
    """What is waited for, as in reports: ``to read c or after 3 ms``."""
    return " or ".join(dict.fromkeys(words if end is None else f"{words} {end.name}" for words, end in waits))


def channel_identity(end: Any) -> int:
    """The identity of a channel, the same for both sides of a broadcast, which are different objects."""
    return id(getattr(end, "channel", end))


def frames_of(task: Task) -> Iterator[FrameType]:
    """The frames of what the task executes, outermost first, without those of the runtime."""
    awaited: Any = task.coroutine
    while awaited is not None:
        frame = getattr(awaited, "cr_frame", None) or getattr(awaited, "gi_frame", None)
        if frame is not None and not is_of_runtime(frame):
            yield frame
        awaited = getattr(awaited, "cr_await", None) or getattr(awaited, "gi_yieldfrom", None) or _wrapped(awaited)


def _wrapped(awaited: Any) -> Any:
    """The coroutine inside the object that its ``__await__`` returns, which has no attribute for it."""
    is_wrapper = type(awaited).__name__ == "coroutine_wrapper"
    return next((item for item in get_referents(awaited) if iscoroutine(item)), None) if is_wrapper else None


def place_of_wait(task: Task) -> str | None:
    """The file and line at which a task waits."""
    frames = list(frames_of(task))
    if not frames:
        return None
    code, line = frames[-1].f_code, frames[-1].f_lineno
    # A function that only continues another one, because that is nested deeply, may have no places.
    within = (frame for frame in reversed(frames) if frame.f_code.co_filename == code.co_filename)
    known = (source_line(frame.f_code, frame.f_lineno) for frame in within)
    return next(filter(None, known), None) or source_of(task) or f"{code.co_filename}:{line}"


def source_of(task: Task) -> str | None:
    """Where the process of a task is defined."""
    return None if task.process is None else task.process.source


def channels_used_by(task: Task, names_in: NamesIn | None = None) -> set[int]:
    """Identities of the channels that the task can reach from where it waits; ``names_in`` gives the names of a
    function that count; without it, all do.
    """
    return {channel_identity(end) for end, _ in ends_used_by(task, names_in).values()}


def ends_used_by(task: Task, names_in: NamesIn | None = None) -> Ends:
    """The ends of channels that the task can reach, as ``channels_used_by`` finds them."""
    found: Ends = {}
    for frame in frames_of(task):
        names = names_in_code(frame.f_code) if names_in is None else names_in(task, frame)
        names = _with_callees(names, frame)
        own = frame.f_locals.get("self")
        for name, value in frame.f_locals.items():
            if isinstance(value, Process):
                for part, end in vars(value).items():
                    if part in names:
                        _collect([end], found, _sides(value, part, names))
            else:
                _collect([value], found, _sides(own, name, names))
    return found


def _sides(process: object, name: str, names: Container[str]) -> frozenset[str]:
    """The sides at which a process uses the channel that it knows by ``name``: the side of its port, or else every side
    that occurs in its code.
    """
    annotation = str(getattr(type(process).__init__, "__annotations__", {}).get(name, ""))
    said = frozenset(side for side, kind in (("read", "In["), ("write", "Out[")) if kind in annotation)
    named = frozenset(side for side, operations in _OPERATIONS.items() if any(each in names for each in operations))
    return said or named or _BOTH_SIDES


def _with_callees(names: set[str], frame: FrameType) -> set[str]:
    """The names, those in the functions of the program that they refer to, and so on: parts of a process have methods
    of their own.
    """
    kinds = {type(value) for value in frame.f_locals.values() if isinstance(value, Process)}
    found = set(names)
    pending = list(names)
    while pending:
        name = pending.pop()
        for callee in (*(getattr(kind, name, None) for kind in kinds), frame.f_globals.get(name)):
            if isinstance(callee, FunctionType) and not is_of_runtime(callee):
                new = names_in_code(callee.__code__) - found
                found |= new
                pending += new
    return found


def names_in_code(code: CodeType) -> set[str]:
    """The attributes that a function uses, inner functions included."""
    names = set(code.co_names)
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            names |= names_in_code(constant)
    return names


def _collect(values: Iterable[Any], found: Ends, sides: frozenset[str]) -> None:
    """Adds the ends among values and their parts; ``sides`` are those at which the values themselves are used."""
    pending = [(value, sides) for value in values]
    seen: set[tuple[int, frozenset[str]]] = set()
    while pending:
        value, sides = pending.pop()
        if (id(value), sides) in seen:
            continue
        seen.add((id(value), sides))
        if isinstance(value, Process):
            parts = ((name, part) for name, part in vars(value).items() if name != "enclosing")
            pending += [(part, _sides(value, name, ())) for name, part in parts]
        elif isinstance(value, list | tuple):
            pending += [(part, sides) for part in value]
        elif isinstance(value, dict):
            pending += [(part, sides) for part in value.values()]
        elif isinstance(value, Converting):
            pending.append((value.end, sides))
        elif isinstance(value, In | Out):
            # Only an `any` channel may have several users at one side. At other channels, any user at all is the
            # partner.
            used = sides if isinstance(value, AnyChannel) else _BOTH_SIDES
            found.setdefault(id(value), (value, set()))[1].update(used)
        else:
            guards = [guard for guard in getattr(value, "guards", ()) if hasattr(guard, "end")]
            pending += [(guard.end, frozenset(["write" if isinstance(guard, Output) else "read"])) for guard in guards]
