"""The report of a deadlock: which processes wait for which.

Channels do not know their users. When nothing can continue, they are found where they are referred to: in the local
variables of the coroutines that wait, and in the attributes of their processes. A waiting process is the partner of
another one if it can still reach a use of the channel at which that one waits. What its process does once the parallel
parts have ended, of which it is one, may be such a use, too; whether it is reached depends on the other parts, so it
makes no cycle.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Container, Iterable, Iterator
from dataclasses import dataclass
from gc import get_referents
from inspect import iscoroutine
from types import CodeType, FrameType, FunctionType
from typing import Any, TypeAlias

from .channels.any_channel import AnyChannel
from .channels.broadcast import Broadcast, BroadcastEnd
from .channels.converting import Converting
from .channels.ports import In, Out
from .choice.guards import Output
from .composition import Branches
from .kernel.durations import shown
from .kernel.party import Waits
from .kernel.places import is_of_runtime, source_line
from .kernel.scheduler import Task
from .process import Process

_BOTH_SIDES = frozenset(["read", "write"])
NamesIn: TypeAlias = "Callable[[Task, FrameType], set[str]]"
_OPERATIONS = {"read": ("read", "read_all", "take"), "write": ("write", "write_all", "offer", "choose_output")}


@dataclass(frozen=True)
class WaitingProcess:
    """A process, or one of its parallel parts, that can never continue.

    ``path`` and ``source`` are those of the process (file and line of its definition), ``place`` is the file and line
    at which it waits, ``waits`` says for what, ``channels`` are the channels' names, ``partners`` the paths of the
    processes that could still communicate with it, ``missing`` those of the readers of its broadcasts that have not
    read what it writes, and ``ended`` those among them that have ended.
    """

    path: str
    source: str | None
    place: str | None
    waits: str
    channels: tuple[str, ...]
    partners: tuple[str, ...]
    ended: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()

    def __str__(self) -> str:
        name = self.path or "a process"
        place = self.place or self.source
        return f"{name} waits {self.waits}" + ("" if place is None else f" ({place})")


MOST_SHOWN = 24


@dataclass(frozen=True)
class DeadlockReport:
    """All processes that wait, and those among them that wait for each other, each for the next and the last for the
    first.

    ``cycle`` is empty when no such ring was found: then some process waits for what no process does any more.
    """

    time: int
    waiting: tuple[WaitingProcess, ...]
    cycle: tuple[WaitingProcess, ...]
    others: tuple[WaitingProcess, ...] = ()
    """Processes that do continue: then it is not a deadlock, but those that wait do so forever."""

    @property
    def besides(self) -> tuple[WaitingProcess, ...]:
        """Those that wait outside the cycle."""
        rest = list(self.waiting)
        for process in self.cycle:
            rest.remove(process)  # One only: others may wait alike.
        return tuple(rest)

    @property
    def text(self) -> str:
        """The report for people: a line for each process or parallel part, of many only the first and last."""
        return "\n".join([self._stuck, *self._continuing])

    @property
    def _continuing(self) -> list[str]:
        return ["while others continue:"] * bool(self.others) + [f"  {process}" for process in self.others]

    @property
    def _stuck(self) -> str:
        kind = "stuck" if self.others else "deadlock"
        if self.cycle:
            lines = [f"{kind} at {shown(self.time)}: {_counted(self.cycle)} wait for each other"]
            following = (*self.cycle[1:], self.cycle[0])
            lines += _shortened(
                f"  {process}, for {_partner(partner, process)}{_ended_readers(process, ' and for')}"
                for process, partner in zip(self.cycle, following, strict=True)
            )
            besides = _shortened(f"  {process}{_ended_readers(process, ', for')}" for process in self.besides)
            return "\n".join(lines + ["besides:"] * bool(besides) + besides)
        which = "these processes wait" if self.others else "a process waits"
        lines = [f"{kind} at {shown(self.time)}: nothing that {which} for can happen any more"]
        lines += _shortened(
            f"  {process}{_ended_readers(process, ', for') or _missing_partner(process)}" for process in self.waiting
        )
        return "\n".join(lines)


def _shortened(lines: Iterable[str]) -> list[str]:
    """The first and last of many lines."""
    found = list(lines)
    left_out = len(found) - MOST_SHOWN
    return found if left_out <= 0 else [*found[:-2][: MOST_SHOWN - 2], f"  ... {left_out} more ...", *found[-2:]]


def _missing_partner(process: WaitingProcess) -> str:
    """``; no other process that still runs writes to it``; "" if one may, or if it does not wait for a channel."""
    if process.partners or not process.channels:
        return ""
    several = len(process.channels) > 1
    if "to write" not in process.waits:
        does = f"writes to {'any of them' if several else 'it'}"
    elif "to read" not in process.waits:
        does = f"can take {'any of the values' if several else 'the value'}"
    else:
        does = "is at the other side of any of them"
    return f"; no other process that still runs {does}"


def _counted(cycle: tuple[WaitingProcess, ...]) -> str:
    """``3 processes``; with several parts of one process ``2 parallel parts of Main`` or ``3 parts of 2 processes``."""
    paths = {process.path for process in cycle}
    if len(paths) == len(cycle):
        return f"{len(cycle)} processes"
    if len(paths) == 1:
        return f"{len(cycle)} parallel parts of {cycle[0].path or 'a process'}"
    return f"{len(cycle)} parts of {len(paths)} processes"


def _partner(partner: WaitingProcess, process: WaitingProcess) -> str:
    return "another part of it" if partner.path == process.path else partner.path


def _ended_readers(process: WaitingProcess, before: str) -> str:
    """``, for Main.r, which has ended``; "" if no reader has ended."""
    if not process.ended:
        return ""
    return f"{before} {', '.join(process.ended)}, which {'has' if len(process.ended) == 1 else 'have'} ended"


def _path(task: Task) -> str:
    return "" if task.process is None else task.process.name


def report_deadlock(
    root: Task,
    now: int,
    stuck: Container[Task] | None = None,
    called: Callable[[Task], str] = _path,
    names_in: NamesIn | None = None,
) -> DeadlockReport:
    """Why nothing below ``root`` can continue or, if ``stuck`` is given, why those tasks cannot.

    ``called`` names tasks. ``names_in`` gives the names that count of a function in which a task waits for its parallel
    parts; without it, all do.
    """
    tasks = list(leaves(root))
    waits = [task.waits() for task in tasks]
    own, possible = _Users(), _Users()
    for index, task in enumerate(tasks):
        own.add(index, task)
        possible.add(index, task)
        for around in _enclosing(task):
            possible.add(index, around, names_in)
    paths = [called(task) for task in tasks]
    processes = tuple(
        WaitingProcess(
            path=paths[index],
            source=_source(task),
            place=place_of_wait(task),
            waits=words_of(waits[index]),
            channels=tuple(end.name for _, end in waits[index] if end is not None),
            partners=tuple(paths[other] for other in possible.partners(index, waits[index])),
            ended=tuple(end.owner for end in _missing_ends(waits[index]) if end.closed and not own.readers(index, end)),
            missing=tuple(end.owner for end in _missing_ends(waits[index])),
        )
        for index, task in enumerate(tasks)
    )
    waiting = {index: None for index, task in enumerate(tasks) if stuck is None or task in stuck}
    partners = [own.partners(index, waits[index]) if index in waiting else [] for index in range(len(tasks))]
    cycle = tuple(processes[index] for index in find_cycle(partners))
    others = tuple(process for index, process in enumerate(processes) if index not in waiting)
    return DeadlockReport(now, tuple(processes[index] for index in waiting), cycle, others)


class _Users:
    """Which of the waiting tasks, by their numbers, use which side of a channel."""

    def __init__(self) -> None:
        self._found: defaultdict[tuple[int, str], set[int]] = defaultdict(set)

    def add(self, index: int, task: Task, names_in: NamesIn | None = None) -> None:
        """Adds what the code of ``task`` uses for the task with that number."""
        for end, sides in _ends_used_by(task, names_in).values():
            for side in sides:
                self._found[id(end), side].add(index)

    def partners(self, index: int, waits: Waits) -> list[int]:
        """The others at the other side of what a task waits for."""
        return sorted({other for end in _opposite_ends(waits) for other in self._found[end]} - {index})

    def readers(self, index: int, end: BroadcastEnd[Any]) -> set[int]:
        """The others that read from an end."""
        return self._found[id(end), "read"] - {index}


def _enclosing(task: Task) -> Iterator[Task]:
    """The tasks that wait for ``task`` to end, from the inside outwards."""
    while (parent := getattr(task.join, "_parent", None)) is not None:
        task = parent
        yield task


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


def _opposite_ends(waits: Waits) -> list[tuple[int, str]]:
    """Where partners would communicate, by the identity of the end and the side: the missing ends of a broadcast, or
    the other side of what is read or written.
    """
    opposite = [
        (channel_identity(end), "write" if words == "to read" else "read")
        for words, end in waits
        if end is not None and not isinstance(end, Broadcast)
    ]
    return opposite + [(id(end), "read") for end in _missing_ends(waits)]


def _missing_ends(waits: Waits) -> list[BroadcastEnd[Any]]:
    return [missing for _, end in waits if isinstance(end, Broadcast) for missing in end.missing]


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
    return next(filter(None, known), None) or _source(task) or f"{code.co_filename}:{line}"


def _source(task: Task) -> str | None:
    return None if task.process is None else task.process.source


def channels_used_by(task: Task, names_in: NamesIn | None = None) -> set[int]:
    """Identities of the channels that the task can reach from where it waits; ``names_in`` gives the names of a
    function that count; without it, all do.
    """
    return {channel_identity(end) for end, _ in _ends_used_by(task, names_in).values()}


def _ends_used_by(task: Task, names_in: NamesIn | None = None) -> dict[int, tuple[In[Any] | Out[Any], set[str]]]:
    """The ends of channels, by their identities, as ``channels_used_by`` finds them, with the sides that it uses."""
    found: dict[int, tuple[In[Any] | Out[Any], set[str]]] = {}
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


def _collect(
    values: Iterable[Any], found: dict[int, tuple[In[Any] | Out[Any], set[str]]], sides: frozenset[str]
) -> None:
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


def find_cycle(partners: list[list[int]]) -> list[int]:
    """A cycle of the graph, empty if it has none; depth first, without recursion."""
    state = [0] * len(partners)  # 0: not seen, 1: on the path, 2: leads to no cycle
    for start in range(len(partners)):
        path: list[int] = []
        branches: list[Iterator[int]] = []
        if state[start] == 0:
            path, branches, state[start] = [start], [iter(partners[start])], 1
        while path:
            following = next(branches[-1], None)
            if following is None:
                state[path.pop()] = 2
                branches.pop()
            elif state[following] == 1:
                return path[path.index(following) :]
            elif state[following] == 0:
                state[following] = 1
                path.append(following)
                branches.append(iter(partners[following]))
    return []
