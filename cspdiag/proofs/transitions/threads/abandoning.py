"""How a thread leaves what it waits for: the guard of an interrupt around it is taken, or the whole thread is
cancelled.
"""

from __future__ import annotations

from typing import assert_never

from cspdiag.network.flow.waiting import is_always_ready
from cspdiag.network.ir.actions import (
    AfterEvent,
    Branch,
    InputEvent,
    InterruptOn,
    OutputEvent,
    ReadyEvent,
    SkipEvent,
)
from cspdiag.proofs.transitions.classes.program import Node
from cspdiag.proofs.transitions.systems.labels import INTERNAL, Alarm, Bound, Cancelled, Read
from cspdiag.proofs.transitions.threads import frames
from cspdiag.proofs.transitions.threads.communications import Communications, Move
from cspdiag.proofs.transitions.threads.context import Context
from cspdiag.proofs.transitions.threads.thread import Configuration, reading_end
from cspdiag.proofs.transitions.values import Known


class Abandoning(Communications):
    """The edges by which one thread is interrupted or cancelled."""

    def is_abandoned_at_once(self, stack: frames.Stack) -> bool:
        """Whether an interrupt around this position has a guard that is always ready: its body ends at the first point
        where it could wait.
        """
        while stack is not None:
            frame, stack = stack
            if isinstance(frame, frames.Interrupt):
                assert isinstance(frame.node.action, InterruptOn)
                if self.is_always_ready(frame.context, frame.node.action.branch):
                    return True
        return False

    def interruptions(self, c: Configuration, present: frames.Frame) -> list[Move]:
        """The edges by which guards of the surrounding interrupts are taken."""
        found: list[Move] = []
        stack, held = c.stack, c._replace(fetched=None, loaded=())
        while stack is not None:
            frame, stack = stack
            if isinstance(frame, frames.Leave):
                held = self.thread.closed(held, frame.context)
            elif isinstance(frame, frames.Interrupt):
                node, context, value = frame.node, frame.context, frame.value
                assert isinstance(node.action, InterruptOn)
                outside = held.at(stack)
                moves = self.guarded(outside, context, node.action.branch, node.children[1], value)
                moves += self._lost_races(outside, context, node, value)
                for label, target in moves:
                    match present:
                        case frames.Delivering():
                            target = target.at((frames.Withdrawing(present.reference), target.stack))
                        case frames.Join():
                            abandon = frames.Join(present.node, present.context, "abandon")
                            target = target.at((abandon, target.stack))
                        case _:  # Any other frame needs no cleanup.
                            pass
                    found.append((label, target))
        return found

    def _lost_races(self, outside: Configuration, context: Context, node: Node, value: Known) -> list[Move]:
        """The guard was seen ready and the body abandoned, but the guard is no longer ready: the process now waits for
        the guard alone.
        """
        assert isinstance(node.action, InterruptOn)
        event = node.action.branch.event
        match event:
            case OutputEvent():
                alarm = Alarm(context.reference(event.sink), "read", None)
            case InputEvent() | ReadyEvent():
                alarm = Alarm(context.reference(event.source), "write", reading_end(context, event.source))
            case AfterEvent() | SkipEvent():
                return []
            case _:
                assert_never(event)
        medium = self.thread.medium(alarm.reference)
        if medium.kind not in ("sync", "any", "broadcast") and not medium.is_contended:
            return []
        waits = frames.GuardOnly(node, context, value)
        return [(alarm, outside.at((waits, outside.stack)))]

    def closing(self, c: Configuration, frame: frames.Closing, rest: frames.Stack) -> list[Move]:
        """The body of an interrupt is about to end or to raise an exception, and other processes do not know that yet:
        an alternative may choose the guard before.
        """
        node, context, exception = frame.interrupt.node, frame.interrupt.context, frame.exception
        assert isinstance(node.action, InterruptOn)
        ended = self._closed(c, frame, rest)
        if c.doomed:
            return [(INTERNAL, ended)]
        event = node.action.branch.event
        taken = self.guarded(c.at(rest), context, node.action.branch, node.children[1], frame.interrupt.value)
        if exception is not None and isinstance(event, ReadyEvent):
            taken = [(Bound(context.reference(event.source)), ended)]
        return [
            (INTERNAL, ended),
            *(
                (
                    label._replace(late=True) if isinstance(label, Read) else label,
                    target if exception is None else ended,
                )
                for label, target in taken
            ),
        ]

    def _closed(self, c: Configuration, frame: frames.Closing, rest: frames.Stack) -> Configuration:
        """The body of an interrupt has ended or raised an exception."""
        after = c.at(rest)
        return after if frame.exception is None else self.follower.thrown(after, frame.exception)

    def cancellation(self, c: Configuration, frame: frames.Frame, rest: frames.Stack) -> list[Move]:
        """What a thread does when it is cancelled: it ends if it is at a cancellation point, and otherwise continues to
        the next one.
        """
        label = Cancelled()
        match frame:
            case frames.Idle() | frames.Over() | frames.Faulted():
                return []
            case frames.Ended() | frames.Raised():
                return [(label, c.at((frames.Ended(), None)))]
            case frames.Closing():
                return [(label, self._closed(c._replace(doomed=True), frame, rest))]
            case frames.Join(stage="wait"):
                abandon = frames.Join(frame.node, frame.context, "abandon")
                return [(label, c._replace(stack=(abandon, (frames.MayEnd(), rest)), doomed=True))]
            case frames.Delivering():
                ended = self.follower.abandoned(c)
                return [(label, ended.at((frames.Withdrawing(frame.reference), ended.stack)))]
            case (
                frames.Run() | frames.Put() | frames.Choosing() | frames.Reading() | frames.Writing()
                | frames.Foreign() | frames.ForeignPort() | frames.InterruptPoint() | frames.GuardOnly()
            ):  # fmt: skip
                return [(label, self.follower.abandoned(c))]
            case (
                frames.Withdrawing() | frames.Picking() | frames.Join() | frames.MayEnd() | frames.Open()
                | frames.Split() | frames.Load() | frames.Store() | frames.Diverges()
            ):  # fmt: skip
                return [(label, c._replace(doomed=True))]
            case (
                frames.Deciding() | frames.Offering() | frames.Compute() | frames.Interrupting()
                | frames.Interruptible() | frames.Interrupt() | frames.Storing() | frames.Assign() | frames.LoopEnd()
                | frames.Iterations() | frames.Catch() | frames.Leave()
            ):  # fmt: skip
                raise AssertionError(f"{frame} is a silent step")
            case _:
                assert_never(frame)

    def is_always_ready(self, context: Context, branch: Branch) -> bool:
        """Whether a guard never waits for another process."""
        return is_always_ready(branch.event, lambda end: self.thread.medium(context.reference(end)).kind)


def is_cancellation_point(frame: frames.Frame) -> bool:
    """Whether a cancelled or interrupted process ends at this frame."""
    return type(frame) in frames.CANCELLATION_POINTS
