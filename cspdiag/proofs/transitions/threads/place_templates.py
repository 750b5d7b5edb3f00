"""Describes in words what a thread does in a state."""

from __future__ import annotations

from typing import assert_never

from cspdiag.base.record import replaced
from cspdiag.network.dump.delay import delay_text
from cspdiag.network.ir import actions as ir
from cspdiag.proofs.transitions.occurrences import BLOCKING
from cspdiag.proofs.transitions.systems.references import Path, Reference
from cspdiag.proofs.transitions.systems.template import PlaceTemplate
from cspdiag.proofs.transitions.threads import frames
from cspdiag.proofs.transitions.threads.context import Context
from cspdiag.proofs.transitions.threads.thread import Configuration, Thread

MISSED_A_SAMPLE = "raises Timeout"
"""The words for the state in which a missed sample has ended the outermost process."""


def place_template(thread: Thread, configuration: Configuration) -> PlaceTemplate:
    """What the thread does in a configuration."""
    assert configuration.stack is not None
    return replaced(_place_template(thread, configuration.stack[0]), path=_innermost(configuration))


def _innermost(configuration: Configuration) -> Path:
    """The innermost process that has not ended."""
    stack = configuration.stack
    while stack is not None:
        frame, stack = stack
        if isinstance(frame, frames.Leave):
            return frame.context.path
    return ()


def _place_template(thread: Thread, frame: frames.Frame) -> PlaceTemplate:
    match frame:
        case frames.Run():
            return _action(frame)
        case frames.Put():
            return PlaceTemplate("waits to write", frame.reference, frame.node.span)
        case frames.Delivering():
            span = None if frame.node is None else frame.node.span
            return PlaceTemplate("waits until all readers have taken what it wrote to", frame.reference, span)
        case frames.Withdrawing():
            return PlaceTemplate("takes back what it wrote to", frame.reference)
        case frames.Choosing():
            return _choice(frame)
        case frames.Reading() | frames.Writing():
            return _law(thread, frame)
        case frames.Join():
            words = "waits for its parallel branches to end" if frame.stage == "wait" else "ends its parallel branches"
            return PlaceTemplate(words, None, frame.node.span)
        case frames.Picking():
            return PlaceTemplate("decides", None, frame.node.span)
        case frames.Open():
            return PlaceTemplate("decides", None, frame.condition.span)
        case frames.GuardOnly():
            assert isinstance(frame.node.action, ir.InterruptOn)
            words, reference = _guard(frame.node.action.branch, frame.context)
            return PlaceTemplate(words, reference, frame.node.action.branch.span)
        case frames.InterruptPoint():
            return PlaceTemplate("continues", None, frame.node.span)
        case frames.Closing():
            return PlaceTemplate("continues", None, frame.interrupt.node.span)
        case frames.Split():
            first = frame.parts[0]
            return PlaceTemplate("computes", None, first.node.span if isinstance(first, frames.Put) else None)
        case frames.Load(what=frames.Risk() as risk):
            return PlaceTemplate("computes", None, risk.span)
        case frames.Load(what=reference):
            return PlaceTemplate("reads", reference)
        case frames.Store():
            return PlaceTemplate("assigns", frame.reference)
        case frames.Foreign():
            return PlaceTemplate("decides what to do", None, frame.context.definition.definition.span)
        case frames.ForeignPort():
            reference = frame.context.ports[frame.element]
            return PlaceTemplate("waits to communicate on", reference, frame.context.definition.definition.span)
        case frames.Diverges():
            return PlaceTemplate("loops forever without a communication")
        case frames.Idle():
            return PlaceTemplate("has not been started")
        case frames.Faulted():
            return PlaceTemplate("has ended by a fault")
        case frames.Raised():
            return PlaceTemplate(f"raises {frame.exception}")
        case frames.MayEnd():
            return PlaceTemplate("was cancelled")
        case frames.Ended() | frames.Over():
            return PlaceTemplate("has ended")
        case (
            frames.Deciding() | frames.Offering() | frames.Compute() | frames.Interrupting() | frames.Interruptible()
            | frames.Interrupt() | frames.Storing() | frames.Assign() | frames.LoopEnd() | frames.Iterations()
            | frames.Catch() | frames.Leave()
        ):  # fmt: skip
            raise AssertionError(f"{frame} is a silent step")
        case _:
            assert_never(frame)


def _action(frame: frames.Run) -> PlaceTemplate:
    node, context = frame.node, frame.context
    action = node.action
    match action:
        case ir.ReadValue():
            return PlaceTemplate("waits to read", context.reference(action.source), node.span)
        case ir.WaitStep():
            return PlaceTemplate(f"is in `{delay_text(action)}`", None, node.span)
        case ir.StopStep():
            return PlaceTemplate("waits forever, at stop", None, node.span)
        case ir.ParallelSteps():
            return PlaceTemplate("starts its parallel branches", None, node.span)
        case _:
            raise AssertionError(f"{type(action).__name__} is a silent step")


def _choice(frame: frames.Choosing) -> PlaceTemplate:
    node, context, decided = frame.node, frame.context, frame.decided
    assert isinstance(node.action, ir.Choice)
    branches = [branch for branch, on in zip(node.action.branches, decided, strict=True) if on is not None]
    if not branches:
        return PlaceTemplate("waits for an alternative of which no guard is enabled", None, node.span)
    if len(branches) == 1:
        words, reference = _guard(branches[0], context)
        return PlaceTemplate(words, reference, branches[0].span)
    return PlaceTemplate("waits for one of its guards", None, node.span)


def _guard(branch: ir.Branch, context: Context) -> tuple[str, Reference | None]:
    match branch.event:
        case ir.ReadyEvent(source=source) | ir.InputEvent(source=source):
            return "waits to read", context.reference(source)
        case ir.OutputEvent(sink=sink):
            return "waits to write", context.reference(sink)
        case ir.AfterEvent():
            return f"waits for `{delay_text(branch.event)}`", None
        case ir.SkipEvent():
            return "continues", None
        case _:
            assert_never(branch.event)


def _law(thread: Thread, frame: frames.Reading | frames.Writing) -> PlaceTemplate:
    context, node = frame.context, frame.node
    connections = context.definition.instances[frame.instance].connections
    law = thread.law(context, frame.instance)
    assert law is not None
    assert frame.remaining is not None
    side = "in" if isinstance(frame, frames.Reading) else "out"
    names = {port.name for port in law.ports if port.direction == side}
    ends = [context.reference(c.attachment) for c in connections if c.port in names]
    waiting = [ends[position] for position in frame.remaining]
    patient = [reference for reference in waiting if thread.medium(reference).kind in BLOCKING] or waiting
    return PlaceTemplate("waits to read" if side == "in" else "waits to write", patient[0], node.span)
