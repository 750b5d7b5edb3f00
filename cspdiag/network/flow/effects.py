"""The variables and ends that instructions read and write."""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from cspdiag.network.flow.code import (
    Abandon,
    Call,
    Communicate,
    Communication,
    Compute,
    Delay,
    Enter,
    Fork,
    Instruction,
    IterationEnd,
    Join,
    Leave,
    Loop,
    Merge,
    ProcessEnd,
    Raise,
    Resume,
    Select,
    Stop,
    Take,
    Test,
    Unwatch,
    Watch,
)
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import VariableValue
from cspdiag.network.ir.walk import parts


def reads(instruction: Instruction) -> Iterator[VariableValue | ir.End]:
    """The variables in the expressions of an instruction and the ends that it reads, in order; none for a ``Call``,
    whose instance has its own.
    """
    match instruction:
        case Compute():
            step = instruction.step
            yield from _variables((step.value, step.target.indexes) if isinstance(step, ir.AssignValue) else step)
        case Communicate():
            yield from _of_communication(instruction.step)
        case Delay():
            yield from _variables(instruction.step.duration)
        case Test():
            yield from _variables(instruction.condition)
        case Take():
            yield from _variables(instruction.branch.condition)
            yield from _of_communication(instruction.branch.event)
        case (
            Call() | Select() | Loop() | IterationEnd() | Fork() | Join() | Merge() | Watch() | Unwatch() | Abandon()
            | Resume() | Raise() | Stop() | Enter() | Leave() | ProcessEnd()
        ):  # fmt: skip
            return
        case _:
            assert_never(instruction)


def writes(instruction: Instruction) -> Iterator[ir.Target | ir.End]:
    """The variables, or elements of them, that an instruction assigns, and the ends that it writes."""
    match instruction:
        case Compute(step=ir.AssignValue(target=target)):
            yield target
            return
        case Communicate():
            step: Communication | ir.Event = instruction.step
        case Take():
            step = instruction.branch.event
        case (
            Compute() | Delay() | Call() | Select() | Test() | Loop() | IterationEnd() | Fork()
            | Join() | Merge() | Watch() | Unwatch() | Abandon() | Resume() | Raise() | Stop()
            | Enter() | Leave() | ProcessEnd()
        ):  # fmt: skip
            return
        case _:
            assert_never(instruction)
    match step:
        case ir.ReadValue() | ir.InputEvent():
            yield step.target
        case ir.WriteValue() | ir.OutputEvent():
            yield step.sink
        case ir.WriteOutputs():
            yield from (write.sink for write in step.writes)
        case ir.ReadInputs() | ir.ReadyEvent() | ir.AfterEvent() | ir.SkipEvent():
            return
        case _:
            assert_never(step)


def _of_communication(step: Communication | ir.Event) -> Iterator[VariableValue | ir.End]:
    match step:
        case ir.ReadValue() | ir.InputEvent():
            yield step.source
            yield from _variables(step.target.indexes)
        case ir.WriteValue() | ir.OutputEvent() | ir.WriteOutputs() | ir.AfterEvent() | ir.SkipEvent():
            yield from _variables(step)
        case ir.ReadInputs():
            yield from (read.source for read in step.reads)
        case ir.ReadyEvent():
            yield step.source
        case _:
            assert_never(step)


def _variables(item: object) -> Iterator[VariableValue]:
    return (part for part in parts(item) if isinstance(part, VariableValue)) if item else iter(())
