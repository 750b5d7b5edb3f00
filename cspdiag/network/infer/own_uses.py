"""What the composition of a process itself reads and writes."""

from __future__ import annotations

from typing import assert_never

from cspdiag.network.ir.actions import (
    AssignValue,
    CatchException,
    Choice,
    CountedLoop,
    Group,
    IfElse,
    InputEvent,
    InterruptOn,
    OutputEvent,
    ParallelSteps,
    RaiseException,
    ReadValue,
    ReadyEvent,
    Repeat,
    ResetInstance,
    RunInstance,
    SequentialSteps,
    SkipStep,
    StopStep,
    WaitStep,
    WhileLoop,
    WriteValue,
)
from cspdiag.network.ir.walk import all_actions
from cspdiag.network.relations import end_key
from cspdiag.network.shapes import Key, Shape


def own_uses(shape: Shape) -> tuple[list[Key], list[Key]]:
    """The ports and channels that a process itself writes and reads, each once, in text order; expressions are no
    readers.
    """
    writes: dict[Key, None] = {}
    reads: dict[Key, None] = {}
    for action in [] if shape.body is None else all_actions(shape.body):
        match action:
            case ReadValue():
                reads[end_key(action.source)] = None
            case WriteValue():
                writes[end_key(action.sink)] = None
            case Choice() | InterruptOn():
                branches = action.branches if isinstance(action, Choice) else (action.branch,)
                for branch in branches:
                    if isinstance(branch.event, ReadyEvent | InputEvent):
                        reads[end_key(branch.event.source)] = None
                    elif isinstance(branch.event, OutputEvent):
                        writes[end_key(branch.event.sink)] = None
            case (
                RunInstance() | AssignValue() | SkipStep() | StopStep() | WaitStep() | ResetInstance()
                | RaiseException() | SequentialSteps() | ParallelSteps() | Repeat() | WhileLoop() | CountedLoop()
                | IfElse() | CatchException() | Group()
            ):  # fmt: skip
                pass
            case _:
                assert_never(action)
    return list(writes), list(reads)
