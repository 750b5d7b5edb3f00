"""The communications and guards that a thread offers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, TypeAlias, assert_never

from cspdiag.network.dump.delay import delay_text
from cspdiag.network.ir import actions as ir
from cspdiag.proofs.transitions.classes.built_in_exceptions import TIMEOUT
from cspdiag.proofs.transitions.classes.program import Node
from cspdiag.proofs.transitions.occurrences import BLOCKING
from cspdiag.proofs.transitions.systems.labels import (
    INTERNAL,
    Bind,
    Bound,
    Guarded,
    Input,
    Label,
    Miss,
    Output,
    Read,
    Ready,
    Sample,
    Write,
)
from cspdiag.proofs.transitions.systems.references import Constant, Reference
from cspdiag.proofs.transitions.threads import frames
from cspdiag.proofs.transitions.threads.context import Context
from cspdiag.proofs.transitions.threads.silent.follow import Follower
from cspdiag.proofs.transitions.threads.thread import Configuration, Thread, reading_end
from cspdiag.proofs.transitions.values import ANY, UNKNOWN, Known

Move: TypeAlias = tuple[Label, Configuration]


class Missed:
    """The type of ``MISSED``."""

    __slots__ = ()


MISSED: Final = Missed()
"""In place of a value: the sample was overwritten, and Timeout is raised in the reader."""


class Communications:
    """The edges by which one thread reads, writes and takes guards."""

    def __init__(self, thread: Thread, follower: Follower) -> None:
        self.thread = thread
        self.follower = follower

    def written(
        self, reference: Reference, value: Known, label: type[Write] | type[Guarded] = Write
    ) -> Output | Write | Guarded:
        """The label of a write; notes its value if values of the medium are followed."""
        medium = self.thread.medium(reference)
        if medium.kind == "output":
            return Output(reference, value)
        self.thread.wrote(reference, value)
        return label(reference, value if medium.relevant else UNKNOWN)

    def delivering(self, reference: Reference, node: Node | None, after: Configuration) -> Configuration:
        """The configuration after a write; on a broadcast, the writer then waits until every end has taken
        the value.
        """
        if self.thread.medium(reference).kind != "broadcast":
            return after
        return after.at((frames.Delivering(reference, node), after.stack))

    def reads(
        self, c: Configuration, context: Context, end: ir.End
    ) -> list[tuple[Label, Known | Missed, Configuration]]:
        """The possible reads at an end where a reader may wait: label, value, and the configuration in which the
        session of the end has begun.
        """
        reference = context.reference(end)
        medium = self.thread.medium(reference)
        where = reading_end(context, end)
        if medium.kind == "sampled":
            begun = self.thread.beginning(c, context, where)
            found: list[tuple[Label, Known | Missed, Configuration]] = [
                (Sample(reference, value), value, begun) for value in medium.given
            ]
            if self.thread.begun(c, context, where) and self._may_miss():
                found.append((Miss(reference), MISSED, begun))
            return found
        if medium.kind == "event":
            return [(Input(reference, value), value, c) for value in medium.given]
        domain = self.thread.domain(reference) if medium.relevant else None
        if domain is None:
            return [(Read(reference, UNKNOWN, where), UNKNOWN, c)]
        return [(Read(reference, value, where), value, c) for value in domain]

    def watched(self, c: Configuration, context: Context, branches: Sequence[ir.Branch]) -> Configuration:
        """The configuration after waiting for guards: the sessions of their sampled inputs have begun, even if another
        guard was taken.
        """
        for branch in branches:
            if isinstance(branch.event, ir.ReadyEvent | ir.InputEvent):
                end = branch.event.source
                if self.thread.medium(context.reference(end)).kind == "sampled":
                    c = self.thread.beginning(c, context, reading_end(context, end))
        return c

    def _may_miss(self) -> bool:
        """Whether a missed sample raises Timeout; a specification never misses one."""
        if self.thread.facts.specification is not None:
            return False
        environments = self.thread.facts.program.network.environments
        return not environments or any(environment.on_miss == "timeout" for environment in environments)

    def guarded(self, held: Configuration, context: Context, branch: ir.Branch, body: Node, value: Known) -> list[Move]:
        """The edges by which a guard is taken; ``held`` is the configuration after the alternative."""
        event: ir.Event = branch.event
        on = held.at((frames.Run(body, context), held.stack))
        match event:
            case ir.SkipEvent():
                return [(INTERNAL, on)]
            case ir.AfterEvent():
                return [(self.follower.delay(delay_text(event), value), on)]
            case ir.OutputEvent():
                reference = context.reference(event.sink)
                if self.thread.medium(reference).kind in ("var", "discard"):
                    return [(INTERNAL, self.follower.stored(on, reference, value))]
                on = self.follower.spent(on) if value == ANY else on
                found: list[Move] = [(self.written(reference, value, Guarded), on)]
                if self.thread.medium(reference).kind in ("sync", "any", "broadcast"):
                    found.append((Bind(reference), on.at((frames.Put(reference, value, body), on.stack))))
                return found
            case ir.InputEvent():
                return self._input_guard(held, on, context, event)
            case ir.ReadyEvent():
                return self._ready_guard(on, context, event, body)
            case _:
                assert_never(event)

    def _input_guard(
        self, held: Configuration, on: Configuration, context: Context, event: ir.InputEvent
    ) -> list[Move]:
        reference = context.reference(event.source)
        if held.fetched is not None:
            value = held.fetched[1]
            return [(INTERNAL, assigning(on._replace(fetched=None), context, event.target, value))]
        if self.thread.medium(reference).kind not in BLOCKING:
            value = UNKNOWN
            if isinstance(reference, Constant):
                value = reference.value
            elif self.thread.medium(reference).relevant and not self.thread.is_shared(reference):
                value = self.thread.slot_value(held, reference)
            return [(INTERNAL, assigning(on, context, event.target, value))]
        found: list[Move] = []
        for label, taken, given in self.reads(on, context, event.source):
            if isinstance(taken, Missed):
                found.append((label, self.follower.thrown(given.at(held.stack), TIMEOUT)))
            else:
                found.append((label, assigning(given, context, event.target, taken)))
        return found

    def _ready_guard(self, on: Configuration, context: Context, event: ir.ReadyEvent, guard: Node) -> list[Move]:
        reference = context.reference(event.source)
        kind = self.thread.medium(reference).kind
        if on.fetched is not None or kind not in BLOCKING:
            return [(INTERNAL, on)]
        if kind in ("sampled", "event"):
            return [(Ready(reference), self.thread.beginning(on, context, reading_end(context, event.source)))]
        if guard in self.thread.unfused:
            self.thread.abstracted(
                "a ready guard is taken before its communication, which another process might make", event.span
            )
            return [(INTERNAL, on)]
        found: list[Move] = [
            (label, given._replace(fetched=(reference, value, guard)))
            for label, value, given in self.reads(on, context, event.source)
            if not isinstance(value, Missed)
        ]
        between = kind == "any" or self.thread.role.cancellable or frames.is_interruptible(on.stack)
        if between and kind in ("sync", "any", "broadcast"):
            found.append((Bound(reference), on))
        return found


def assigning(c: Configuration, context: Context, target: ir.Target, value: Known) -> Configuration:
    """The configuration in which a value that was read is assigned to its variable in the next step."""
    return c.at((frames.Assign(context, target, value), c.stack))
