"""How a thread is abandoned where it waits: by the guard of an interrupt around it, or by the cancellation of all that it does."""

from __future__ import annotations

from cspdiag.network.ir.actions import Branch, InputEvent, InterruptOn, OutputEvent, ReadyEvent, SkipEvent
from cspdiag.proofs.transitions.occurrences import PATIENT
from cspdiag.proofs.transitions.program import Node
from cspdiag.proofs.transitions.systems.template import INTERNAL_LABEL, LATE, Label
from cspdiag.proofs.transitions.threads.communications import Communications, Move
from cspdiag.proofs.transitions.threads.follow import POINTS
from cspdiag.proofs.transitions.threads.thread import Configuration, Context, Frame, Stack, reading_end
from cspdiag.proofs.transitions.values import Known


class Abandoning(Communications):
    """The edges of one thread with which it leaves what it does."""

    def is_abandoned_at_once(self, stack: Stack) -> bool:
        """Whether an interrupt around a place has a guard that is always ready: nothing is done in its body where it could wait."""
        while stack is not None:
            frame, stack = stack
            if frame[0] == "interrupt":
                _, node, context, _ = frame
                if self.is_always_ready(context, node.action.branch):
                    return True
        return False

    def interruptions(self, c: Configuration, present: Frame) -> list[Move]:
        """The guards of the interrupts around what waits."""
        found: list[Move] = []
        stack, held = c.stack, c._replace(fetched=None, loaded=())
        while stack is not None:
            frame, stack = stack
            if frame[0] == "leave":
                held = self.thread.closed(held, frame[1])
            elif frame[0] == "interrupt":
                _, node, context, value = frame
                assert isinstance(node.action, InterruptOn)
                outside = held._replace(stack=stack)
                moves = self.guarded(outside, context, node.action.branch, node.children[1], value)
                moves += self._lost_races(outside, context, node, value)
                for label, target in moves:
                    if present[0] == "delivering":
                        target = target._replace(stack=(("withdrawing", present[1]), target.stack))
                    if present[0] == "join":
                        abandon = ("join", present[1], present[2], "abandon")
                        target = target._replace(stack=(abandon, target.stack))
                    found.append((label, target))
        return found

    def _lost_races(self, outside: Configuration, context: Context, node: Node, value: Known) -> list[Move]:
        """The body was abandoned because the guard was ready, and then it is not any more: nothing is left but to wait for the guard."""
        assert isinstance(node.action, InterruptOn)
        event = node.action.branch.event
        if isinstance(event, OutputEvent):
            reference = context.reference(event.sink)
            alarm: Label = ("alarm", reference, "read", None)
        elif isinstance(event, InputEvent | ReadyEvent):
            reference = context.reference(event.source)
            alarm = ("alarm", reference, "write", reading_end(context, event.source))
        else:
            return []
        medium = self.thread.medium(reference)
        if medium.kind not in ("sync", "any", "broadcast") and not medium.is_contended:
            return []
        waits = ("guard only", node, context, value)
        return [(alarm, outside._replace(stack=(waits, outside.stack)))]

    def closing(self, c: Configuration, frame: Frame, rest: Stack) -> list[Move]:
        """The body of an interrupt is about to end or to raise an exception, which nobody knows yet: an alternative may choose the guard before."""
        _, (_, node, context, value), exception = frame
        ended = self._closed(c)
        if c.doomed:
            return [(INTERNAL_LABEL, ended)]
        event = node.action.branch.event
        taken = self.guarded(c._replace(stack=rest), context, node.action.branch, node.children[1], value)
        if exception is not None and isinstance(event, ReadyEvent):
            taken = [(("bound", context.reference(event.source)), ended)]
        return [
            (INTERNAL_LABEL, ended),
            *(
                ((*label, LATE) if label[0] == "read" else label, target if exception is None else ended)
                for label, target in taken
            ),
        ]

    def _closed(self, c: Configuration) -> Configuration:
        """The body of an interrupt has ended or raised an exception."""
        assert c.stack is not None
        (_, _, exception), rest = c.stack
        after = c._replace(stack=rest)
        return after if exception is None else self.follower.thrown(after, exception)

    def cancellation(self, c: Configuration, frame: Frame) -> list[Move]:
        """What a cancelled thread does: it ends where it waits, and goes on to such a place elsewhere."""
        label: Label = ("cancelled",)
        if frame[0] in ("idle", "over", "faulted"):
            return []
        if frame[0] in ("ended", "raised"):
            return [(label, c._replace(stack=(("ended",), None)))]
        if frame[0] == "closing":
            return [(label, self._closed(c._replace(doomed=True)))]
        if frame[0] == "join" and frame[3] == "wait":
            assert c.stack is not None
            abandon = ("join", frame[1], frame[2], "abandon")
            return [(label, c._replace(stack=(abandon, (("either",), c.stack[1])), doomed=True))]
        if frame[0] == "delivering":
            ended = self.follower.abandoned(c)
            return [(label, ended._replace(stack=(("withdrawing", frame[1]), ended.stack)))]
        if is_point(frame):
            return [(label, self.follower.abandoned(c))]
        return [(label, c._replace(doomed=True))]

    def is_always_ready(self, context: Context, branch: Branch) -> bool:
        """Whether a guard never has to wait for anybody."""
        match branch.event:
            case SkipEvent():
                return True
            case OutputEvent(sink=sink):
                return self.thread.medium(context.reference(sink)).kind in ("output", "var", "discard", "overwrite")
            case InputEvent(source=source) | ReadyEvent(source=source):
                return self.thread.medium(context.reference(source)).kind not in PATIENT
        return False


def is_point(frame: Frame) -> bool:
    """Whether a cancelled or interrupted process ends there."""
    return frame[0] in POINTS
