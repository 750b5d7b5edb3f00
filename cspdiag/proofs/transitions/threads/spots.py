"""What a thread does in a state, in words for people."""

from __future__ import annotations

from cspdiag.base.record import replaced
from cspdiag.network.dump.expression import expression_text
from cspdiag.network.ir.actions import (
    AfterEvent,
    Branch,
    Choice,
    InputEvent,
    OutputEvent,
    ParallelSteps,
    ReadValue,
    ReadyEvent,
    StopStep,
    WaitStep,
)
from cspdiag.proofs.transitions.occurrences import PATIENT
from cspdiag.proofs.transitions.systems.template import Path, Reference, Spot
from cspdiag.proofs.transitions.threads.thread import Configuration, Context, Frame, Thread

MISSED_A_SAMPLE = "raises Timeout"
"""Where a missed sample has ended the outermost process."""


def spot(thread: Thread, configuration: Configuration) -> Spot:
    """What the thread does in a configuration."""
    assert configuration.stack is not None
    return replaced(_spot(thread, configuration.stack[0]), path=_innermost(configuration))


def _innermost(configuration: Configuration) -> Path:
    """The innermost process that has not ended."""
    stack = configuration.stack
    while stack is not None:
        frame, stack = stack
        if frame[0] == "leave":
            path: Path = frame[1].path
            return path
    return ()


def _spot(thread: Thread, frame: Frame) -> Spot:
    match frame[0]:
        case "run":
            return _action(frame)
        case "put":
            return Spot("waits to write", frame[1], frame[3].span)
        case "delivering":
            span = None if frame[2] is None else frame[2].span
            return Spot("waits until all readers have taken what it wrote to", frame[1], span)
        case "withdrawing":
            return Spot("takes back what it wrote to", frame[1])
        case "choice":
            return _choice(frame)
        case "reading" | "writing":
            return _law(thread, frame)
        case "join":
            words = "waits for its parallel branches to end" if frame[3] == "wait" else "ends its parallel branches"
            return Spot(words, None, frame[1].span)
        case "picking":
            return Spot("decides", None, frame[1].span)
        case "open":
            return Spot("decides", None, frame[2].span)
        case "guard only":
            words, reference = _guard(frame[1].action.branch, frame[2])
            return Spot(words, reference, frame[1].action.branch.span)
        case "pass":
            return Spot("goes on", None, frame[1].span)
        case "closing":
            return Spot("goes on", None, frame[1][1].span)
        case "split":
            return Spot("computes", None, frame[1][0][3].span) if frame[1][0][0] == "put" else Spot("computes")
        case "load":
            return Spot("computes", None, frame[1][1]) if frame[1][0] == "risk" else Spot("looks at", frame[1])
        case "store":
            return Spot("assigns", frame[1])
        case "foreign":
            return Spot("decides what to do", None, frame[1].definition.definition.span)
        case "foreign port":
            _, context, element, _ = frame
            return Spot("waits to communicate on", context.ports[element], context.definition.definition.span)
        case "diverges":
            return Spot("goes round for ever without a communication")
        case "idle":
            return Spot("has not been started")
        case "faulted":
            return Spot("has ended by a fault")
        case "raised":
            return Spot(f"raises {frame[1]}")
        case "either":
            return Spot("was cancelled")
    return Spot("has ended")


def _action(frame: Frame) -> Spot:
    _, node, context = frame
    action = node.action
    match action:
        case ReadValue():
            return Spot("waits to read", context.reference(action.source), node.span)
        case WaitStep():
            return Spot(f"is in `wait {expression_text(action.duration)}`", None, node.span)
        case StopStep():
            return Spot("waits for ever, at stop", None, node.span)
        case ParallelSteps():
            return Spot("starts its parallel branches", None, node.span)
    return Spot("goes on", None, node.span)


def _choice(frame: Frame) -> Spot:
    _, node, context, decided = frame
    assert isinstance(node.action, Choice)
    branches = [branch for branch, on in zip(node.action.branches, decided, strict=True) if on is not None]
    if not branches:
        return Spot("waits for an alternative of which no guard is enabled", None, node.span)
    if len(branches) == 1:
        words, reference = _guard(branches[0], context)
        return Spot(words, reference, branches[0].span)
    return Spot("waits for one of its guards", None, node.span)


def _guard(branch: Branch, context: Context) -> tuple[str, Reference | None]:
    match branch.event:
        case ReadyEvent(source=source) | InputEvent(source=source):
            return "waits to read", context.reference(source)
        case OutputEvent(sink=sink):
            return "waits to write", context.reference(sink)
        case AfterEvent(duration=duration):
            return f"waits for `after {expression_text(duration)}`", None
    return "goes on", None


def _law(thread: Thread, frame: Frame) -> Spot:
    kind, context, instance, node, remaining = frame
    connections = context.definition.instances[instance].connections
    law = thread.law(context, instance)
    assert law is not None
    side = "in" if kind == "reading" else "out"
    names = {port.name for port in law.ports if port.direction == side}
    ends = [context.reference(c.attachment) for c in connections if c.port in names]
    waiting = [ends[position] for position in remaining]
    patient = [reference for reference in waiting if thread.medium(reference).kind in PATIENT] or waiting
    return Spot("waits to read" if side == "in" else "waits to write", patient[0], node.span)
