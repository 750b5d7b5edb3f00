"""Whether a run is back at a state in which it was: every task is where it was, and what decides how it continues has
the same values; the present instant as well, as long as something depends on it.

A state does not include what a run is free to choose: which process of one level is next, and which guard of ``[]`` is
taken.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from types import FrameType
from typing import Any, TypeAlias, assert_never

from cspdiag.model.types import (
    ArrayType,
    BoolType,
    EnumType,
    IntType,
    RealType,
    StructType,
    TextType,
    TimeType,
    Type,
    UnknownType,
)
from cspdiag.network.ir.network import CoreNetwork, ProcessClass
from cspdiag.proofs.transitions.classes.counting import is_wide
from cspdiag.proofs.transitions.classes.facts import deciding
from cspdiag.proofs.transitions.classes.present_time import last_deciding_instant
from cspdiag.proofs.transitions.classes.program import Program
from cspdiag.runtime.composition import Branches
from cspdiag.runtime.kernel.scheduler import Task
from cspdiag.runtime.process import Process
from cspdiag.verify.runs.memory import memory

State: TypeAlias = tuple[object, ...]


class Recurrence:
    """The states of runs of one program.

    ``exact``: values that decide nothing are ignored, as the proof has left nothing open.
    """

    def __init__(self, network: CoreNetwork, *, exact: bool) -> None:
        self._ignored = _deciding_nothing(network) if exact else frozenset()
        self._last_deciding_instant = last_deciding_instant(network)

    def state(self, outermost: Any, root: Task) -> State:
        """The state of a run in which ``root`` executes the process ``outermost``."""
        remembered = memory(outermost)
        kept = ((name, _kept(value)) for name, value in remembered.items() if name not in self._ignored)
        counts = ((name, len(value)) for name, value in remembered.items() if isinstance(value, tuple))
        clock = min(root.scheduler.now, self._last_deciding_instant + 1)
        return clock, tuple(_standing(root)), tuple(sorted(counts)), tuple(sorted(kept, key=lambda entry: entry[0]))


def _kept(value: object) -> str:
    """A copy of a value, for comparison, that does not change with the run: two reals are equal only if their texts
    are.
    """
    return repr(value)


def counting_to_faults(network: CoreNetwork) -> frozenset[str]:
    """What decides only whether something ends in a fault, by path: no proof follows it."""
    return _deciding_nothing(network, faults=False) - _deciding_nothing(network)


def _deciding_nothing(network: CoreNetwork, *, faults: bool = True) -> frozenset[str]:
    """Variables, buffers and states of control laws, by path, that may count forever and on which no condition and no
    delay depends nor, with ``faults``, a fault.
    """
    decides = deciding(Program(network), faults=faults)
    names = {
        definition.name: [
            entry.name
            for entry in (definition.channels if isinstance(definition, ProcessClass) else definition.states)
            if ("channel", definition.name, entry.name) not in decides and _may_count(entry.type)
        ]
        for definition in network.classes
    }
    paths = [(network.top, network.top), *((instance.path, instance.class_name) for instance in network.instances)]
    return frozenset(f"{path}.{name}" for path, class_name in paths for name in names.get(class_name, ()))


def _may_count(of: Type) -> bool:
    """Whether a variable may count forever where that decides no fault; integers of few bits count to one."""
    match of:
        case ArrayType():
            return _may_count(of.element)
        case IntType() | TimeType():
            return is_wide(of)
        case RealType():
            return True
        case BoolType() | TextType() | EnumType() | StructType() | UnknownType():
            return False
        case _:
            assert_never(of)


def _standing(root: Task) -> Iterator[tuple[object, ...]]:
    """Where in the code each task is, in the order of the branches, and its number of rounds in what is replicated."""
    pending = [root]
    while pending:
        task = pending.pop()
        yield task.cancelled, type(task.waiting).__name__, *_frames(task)
        if isinstance(task.waiting, Branches) and task.waiting.pending:
            pending += [branch for branch in task.waiting.tasks if not branch.ended]


def _frames(task: Task) -> Iterator[tuple[object, ...]]:
    frames = _running() if task is task.scheduler.current else _suspended(task.coroutine)
    for frame in frames:
        in_text = isinstance(frame.f_locals.get("self"), Process)
        numbers = tuple(value for value in frame.f_locals.values() if type(value) is int) if in_text else ()
        yield frame.f_code.co_qualname, frame.f_lasti, numbers


def _running() -> Iterator[FrameType]:
    """The frames of the processes of the current task, from here outwards."""
    frame: FrameType | None = sys._getframe()
    while frame is not None:
        if isinstance(frame.f_locals.get("self"), Process):
            yield frame
        frame = frame.f_back


def _suspended(coroutine: Any) -> Iterator[FrameType]:
    while coroutine is not None:
        frame = getattr(coroutine, "cr_frame", None) or getattr(coroutine, "gi_frame", None)
        if frame is None:
            return
        yield frame
        coroutine = getattr(coroutine, "cr_await", None) or getattr(coroutine, "gi_yieldfrom", None)
