"""Compositions of the network as text, one action on each line."""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from cspdiag.network.dump.delay import delay_text
from cspdiag.network.dump.expression import expression_text
from cspdiag.network.dump.submodel import doc_lines, law_lines
from cspdiag.network.ir import actions as ir


def end_text(end: ir.End) -> str:
    """The text of an end: ``request[3]``, or ``feedback end 1`` for a reading end after the first."""
    name = end.port if isinstance(end, ir.PortEnd) else end.channel
    index = f"[{end.index}]" if isinstance(end, ir.PortEnd) and end.index is not None else ""
    return f"{name}{index}" + (f" end {end.end}" if end.end else "")


def target_text(target: ir.Target) -> str:
    """The text of an assigned variable or element: ``buffer[first]``."""
    return target.channel + "".join(f"[{expression_text(index)}]" for index in target.indexes)


def action_lines(action: ir.Action) -> Iterator[str]:
    """The lines of an action, with the actions inside it indented."""
    match action:
        case ir.RunInstance():
            yield f"run {action.instance}"
        case ir.ReadValue():
            yield f"{end_text(action.source)} ? {target_text(action.target)}"
        case ir.WriteValue():
            yield f"{end_text(action.sink)} ! {expression_text(action.value)}"
        case ir.AssignValue():
            yield f"{target_text(action.target)} := {expression_text(action.value)}"
        case ir.SkipStep():
            yield "skip"
        case ir.StopStep():
            yield "stop"
        case ir.WaitStep():
            yield delay_text(action)
        case ir.ResetInstance():
            yield f"reset {action.instance}"
        case ir.RaiseException():
            yield f"raise {action.exception}"
        case ir.SequentialSteps():
            yield "in sequence"
            for step in action.steps:
                yield from _inside(step)
        case ir.ParallelSteps():
            yield "in parallel" + (" by priority" if action.prioritized else "")
            for step in action.steps:
                yield from _inside(step)
        case ir.Choice():
            yield (
                "alternative"
                + (f" {action.name}" if action.name else "")
                + (" by priority" if action.prioritized else "")
            )
            for branch in action.branches:
                yield from _branch(branch)
        case ir.Repeat():
            yield "repeat" + ("" if action.until is None else f" until {expression_text(action.until)}")
            yield from _inside(action.body)
        case ir.WhileLoop():
            yield f"while {expression_text(action.condition)}"
            yield from _inside(action.body)
        case ir.CountedLoop():
            yield f"repeat {action.iterations} times"
            yield from _inside(action.body)
        case ir.IfElse():
            yield f"if {expression_text(action.condition)}"
            yield from _inside(action.then)
            if not isinstance(action.otherwise, ir.SkipStep):
                yield "else"
                yield from _inside(action.otherwise)
        case ir.CatchException():
            yield "try"
            yield from _inside(action.body)
            yield f"catch {action.exception}"
            yield from _inside(action.handler)
        case ir.InterruptOn():
            yield "interruptible"
            yield from _inside(action.body)
            yield "interrupted"
            yield from _branch(action.branch)
        case ir.Group():
            yield f"group {action.label}"
            yield from _inside(action.body)
        case (
            ir.ReadInputs() | ir.WriteOutputs() | ir.RunLaw() | ir.ResetStates() | ir.ProcessScope()
            | ir.ReportCommunication()
        ):  # fmt: skip
            yield from _made_by_a_pass(action)
        case _:
            assert_never(action)


def _made_by_a_pass(
    action: ir.ReadInputs | ir.WriteOutputs | ir.RunLaw | ir.ResetStates | ir.ProcessScope | ir.ReportCommunication,
) -> Iterator[str]:
    match action:
        case ir.ReadInputs():
            yield "at once"
            for read in action.reads:
                yield f"  {end_text(read.source)} ? {read.name}"
        case ir.WriteOutputs():
            yield "at once"
            for write in action.writes:
                yield f"  {end_text(write.sink)} ! {expression_text(write.value)}"
        case ir.RunLaw():
            yield from doc_lines(action.doc)
            yield f"law {action.law}"
            for line in law_lines(action):
                yield f"  {line}"
        case ir.ResetStates():
            yield f"reset {', '.join(action.states)}"
        case ir.ProcessScope():
            yield from doc_lines(action.doc)
            ends = ", ".join(end_text(end) for end in action.ends)
            yield f"process {action.instance} : {action.class_name}" + (f" closes {ends}" if ends else "")
            yield from _inside(action.body)
        case ir.ReportCommunication():
            yield f"report {action.channel} = {expression_text(action.value)}"
        case _:
            assert_never(action)


def _inside(action: ir.Action) -> Iterator[str]:
    return (f"  {line}" for line in action_lines(action))


def _branch(branch: ir.Branch) -> Iterator[str]:
    condition = "" if branch.condition is None else f" when {expression_text(branch.condition)}"
    yield f"  on {_event(branch.event)}{condition}"
    for line in action_lines(branch.body):
        yield f"    {line}"


def _event(event: ir.Event) -> str:
    match event:
        case ir.ReadyEvent():
            return f"{end_text(event.source)} ready"
        case ir.InputEvent():
            return f"{end_text(event.source)} ? {target_text(event.target)}"
        case ir.OutputEvent():
            return f"{end_text(event.sink)} ! {expression_text(event.value)}"
        case ir.AfterEvent():
            return delay_text(event)
        case ir.SkipEvent():
            return "skip"
        case _:
            assert_never(event)
