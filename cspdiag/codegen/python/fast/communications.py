"""Inlined communications: a rendezvous uses the slots of the channel, everything else calls the runtime."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Literal

from cspdiag.codegen.python.fast.spelling import Spelling, is_alternated, is_inline, is_plain_access
from cspdiag.codegen.python.text.code import (
    AND,
    BITS_AND,
    COMPARISON,
    FALSE,
    NONE,
    SUM,
    TRUE,
    Code,
    Constant,
    Element,
    Name,
    WholeNumber,
    call,
    delegated,
    tuple_of,
)
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.operators import infix, infix_all, negated
from cspdiag.codegen.python.text.statements import (
    YIELD,
    Block,
    Plain,
    Statement,
    Statements,
    assign,
    change,
    else_,
    if_,
    run,
    unpack,
)
from cspdiag.model.types import BoolType, EnumType, IntType, RealType, TimeType
from cspdiag.network.flow.waiting import WRITTEN_AT_ONCE
from cspdiag.network.ir.actions import End
from cspdiag.network.ir.network import Medium


def is_not_none(item: Code) -> Code:
    """``x is not None``."""
    return infix("is not", COMPARISON, item, NONE)


def is_finite(value: Code) -> Code:
    """Whether a real in a local variable is finite: only then its difference from itself is zero."""
    return infix("==", COMPARISON, infix("-", SUM, value, value), Constant("0.0"))


@dataclass
class Communications:
    """Writes the communications of one process class.

    ``checked``: whether the code checks before each communication whether it was cancelled. ``traced``: whether
    communications over internal channels are reported.
    """

    spelling: Spelling
    imports: Imports
    checked: bool
    traced: bool
    tracked: bool
    """Whether the scheduler itself keeps track of the running task."""
    levels: bool
    """Whether the program has prioritized parallels, and so a ready queue for each level."""
    finite: frozenset[Code] = frozenset()
    """Local variables that have just been tested."""
    owned: dict[Statement, None] = field(default_factory=dict)
    """What the function that is being written has to do at its beginning: note whose the ends of channels are."""

    @contextmanager
    def function(self) -> Iterator[Mapping[Statement, None]]:
        """Around the writing of another function; gives what that has to do at its beginning."""
        outer, self.owned = self.owned, {}
        try:
            yield self.owned
        finally:
            self.owned = outer

    def runtime(self, name: str) -> Code:
        """A name of the runtime."""
        return Name(self.imports.runtime(name))

    def check(self) -> Statements:
        """A point of cancellation."""
        if not self.checked:
            return ()
        return (if_(self.spelling["me"].field("cancelled"), Plain("raise", self.runtime("Cancelled"))),)

    def set_current_task(self) -> Statements:
        """Tell the scheduler which task runs, before a call of the runtime that may need it."""
        if self.tracked:
            return ()
        return (assign(self.spelling.of_run("scheduler").field("current"), self.spelling["me"]),)

    def push(self, party: Code) -> Statement:
        """Make a task ready."""
        queue = party.field("ready_queue") if self.levels else self.spelling.of_run("queue")
        return run(queue.call("append", party if self.tracked else party.field("entry")))

    def report(self, channel: Code, value: Code, writer: Code, reader: Code) -> Statements:
        """Report a communication to the observer, if communications are traced."""
        if not self.traced:
            return ()
        return (self.observed(channel.field("label"), value, writer, reader),)

    def observed(self, name: Code, value: Code, writer: Code, reader: Code) -> Statement:
        """Report a communication to the observer, if there is one."""
        observe = self.spelling.of_run("observe")
        return if_(is_not_none(observe), run(call(observe, name, value, writer, reader)))

    # One communication

    def read(self, source: End, into: Code) -> Statements:
        """Read into a local variable or attribute."""
        medium = self.spelling.medium(source)
        if is_plain_access(source, medium):
            return (assign(into, self.spelling.value_at(source)),)
        end = self.spelling.source(source)
        if is_inline(medium):
            return (*self.check(), *self._rendezvous_read(source, into))
        if medium.kind == "sampled":
            return (*self.check(), *self._sampled_read(end, into, medium))
        return (*self.set_current_task(), assign(into, delegated(end.call("read"))))

    def _channel(self, end: Code) -> tuple[Statements, Code]:
        if not isinstance(end, Element):
            return (), end
        channel = self.spelling["channel"]
        return (assign(channel, end),), channel

    def _rendezvous_read(self, source: End, into: Code) -> Statements:
        before, channel = self._channel(self.spelling.source(source))
        waits = (*self._awaited(source, channel), YIELD, assign(into, channel.field("value")))
        return (*before, *self._met_writer(source, channel, into, waits))

    def _met_writer(self, source: End, channel: Code, into: Code, otherwise: Statements) -> Statements:
        """Take the value of the writer that waits; ``otherwise`` if none does."""
        me, offered = self.spelling["me"], channel.field("offered")
        if self.spelling.is_dedicated(source):
            owner = channel.field("writer")
            taken = (assign(into, offered), assign(offered, NONE), self.push(owner))
            there = (*taken, *self.report(channel, into, owner, me))
            return (if_(is_not_none(offered), *there), else_(*otherwise))
        writer = self.spelling["writer"]
        there = (
            assign(channel.field("writing"), NONE),
            assign(into, offered),
            *self._lowered(channel, is_alternated(self.spelling.medium(source))),
            self.push(writer),
            *self.report(channel, into, writer, me),
        )
        return (assign(writer, channel.field("writing")), if_(is_not_none(writer), *there), else_(*otherwise))

    def _awaited(self, source: End, channel: Code) -> Statements:
        """Be the reader that waits."""
        if not self.spelling.is_dedicated(source):
            return (assign(channel.field("reading"), self.spelling["me"]),)
        return (*self._belongs_to_me(channel, "reader"), assign(channel.field("value"), NONE))

    def _belongs_to_me(self, channel: Code, end: Literal["reader", "writer"]) -> Statements:
        """Note whose an end of a dedicated channel is: if it has a variable to itself, once in each function."""
        note = assign(channel.field(end), self.spelling["me"])
        if channel == self.spelling["channel"]:
            return (note,)
        self.owned[note] = None
        return ()

    @staticmethod
    def _lowered(channel: Code, alternated: bool) -> Statements:
        """Tell alternatives that the writer of a channel no longer waits."""
        return (run(channel.call("lower")),) if alternated else ()

    def _sampled_read(self, end: Code, into: Code, medium: Medium) -> Statements:
        """Wait for a sample, and take it."""
        me = self.spelling["me"]
        in_turn = infix("and", AND, end.field("steady"), infix("is", COMPARISON, end.field("waiter"), NONE))
        wait = (
            if_(in_turn, assign(me.field("waiting"), end), assign(end.field("waiter"), me)),
            else_(run(end.call("wait", me))),
            YIELD,
            *self.check(),
        )
        return (if_(negated(end.field("fresh")), *wait), *self._sample_taken(end, into, medium))

    def _sample_taken(self, end: Code, into: Code, medium: Medium) -> Statements:
        """Take a sample that is there; inlined if that only hands it over."""
        me, inputs = self.spelling["me"], end.field("inputs")
        lowered = if_(inputs, run(call(self.runtime("lower_bits"), inputs))) if medium.guarded_reads else None
        in_place: Statements = (
            assign(end.field("fresh"), FALSE),
            assign(into, end.field("value")),
            *([lowered] if lowered else []),
            self.observed(end.field("name"), into, NONE, me),
        )
        return (if_(end.field("steady"), *in_place), else_(assign(into, end.call("taken", me))))

    def write(self, sink: End, value: Code) -> Statements:
        """Write a value that is simple enough to be evaluated twice."""
        medium = self.spelling.medium(sink)
        if medium.kind == "discard":
            return ()
        if medium.kind == "var":
            return (assign(self.spelling.value_at(sink), value),)
        end = self.spelling.sink(sink)
        if is_inline(medium):
            return (*self.check(), *self._rendezvous_write(sink, value))
        if medium.kind == "latched" and (isinstance(value, Name) or value in (TRUE, FALSE)):
            return (*self.check(), *self._latched(sink, end, value))
        if medium.kind in WRITTEN_AT_ONCE:
            known = () if medium.kind in ("latched", "direct") else self.set_current_task()
            return (*self.check(), *known, run(end.call("offer", self.spelling["me"], value)))
        return (*self.set_current_task(), run(delegated(end.call("write", value))))

    def is_unseen(self, sink: End) -> bool:
        """Whether a write is only kept: until the next tick, or in a variable."""
        medium = self.spelling.medium(sink)
        return medium.kind in ("latched", "discard") or is_plain_access(sink, medium)

    def _latched(self, sink: End, end: Code, value: Code) -> Statements:
        """Keep a finite value for the next tick."""
        me = self.spelling["me"]
        latch = (
            assign(end.field("latched"), value),
            assign(end.field("writer"), me),
            assign(end.field("written"), TRUE),
        )
        type_ = self.spelling.type_of(sink)
        if isinstance(type_, BoolType | IntType | EnumType | TimeType) or value in self.finite:
            return latch
        refused = run(end.call("offer", me, value))
        if not isinstance(type_, RealType):
            return (refused,)
        return (if_(is_finite(value), *latch), else_(refused))

    def _rendezvous_write(self, sink: End, value: Code) -> Statements:
        before, channel = self._channel(self.spelling.sink(sink))
        return (*before, *self._met_reader(sink, channel, value, (*self._offered(sink, channel, value), YIELD)))

    def _met_reader(self, sink: End, channel: Code, value: Code, otherwise: Statements) -> Statements:
        """Pass a value to the reader that waits for it; ``otherwise`` if none does."""
        me = self.spelling["me"]
        passed = assign(channel.field("value"), value)
        if self.spelling.is_dedicated(sink):
            owner = channel.field("reader")
            there = (passed, self.push(owner), *self.report(channel, value, me, owner))
            return (if_(infix("is", COMPARISON, channel.field("value"), NONE), *there), else_(*otherwise))
        reader = self.spelling["reader"]
        there = (
            assign(channel.field("reading"), NONE),
            passed,
            self.push(reader),
            *self.report(channel, value, me, reader),
        )
        return (assign(reader, channel.field("reading")), if_(is_not_none(reader), *there), else_(*otherwise))

    def _offered(self, sink: End, channel: Code, value: Code) -> Statements:
        """Be the writer that waits."""
        offer = assign(channel.field("offered"), value)
        if self.spelling.is_dedicated(sink):
            return (*self._belongs_to_me(channel, "writer"), offer)
        parked = (assign(channel.field("writing"), self.spelling["me"]), offer)
        if not is_alternated(self.spelling.medium(sink)):
            return parked
        guards, bit = self.spelling["ready_guards"], channel.field("bit")
        return (
            *parked,
            assign(guards, channel.field("selector")),
            change(guards.field("ready"), "|=", bit),
            if_(infix("&", BITS_AND, guards.field("armed"), bit), *self.set_current_task(), run(guards.call("wake"))),
        )

    # Several at once

    def read_all(self, reads: Sequence[tuple[End, Code]]) -> Statements:
        """Begin all reads in order, then wait for all."""
        spelling = self.spelling
        slow = [(end, into) for end, into in reads if not is_plain_access(end, spelling.medium(end))]
        here = tuple(
            assign(into, spelling.value_at(end)) for end, into in reads if is_plain_access(end, spelling.medium(end))
        )
        if not slow:
            return (*self.check(), *here)
        if len(slow) == 1:
            first = reads.index(slow[0])
            return (*self.check_early(first), *here, *self.read(*slow[0]))
        if all(is_inline(spelling.medium(end)) for end, _ in slow):
            return (*self.check(), *here, *self._rendezvous_reads(slow))
        ends = [spelling.source(end) for end, _ in slow]
        waiting = delegated(call(self.runtime("read_all"), *ends))
        wait = (*self.set_current_task(), unpack([into for _, into in slow], waiting))
        media = [spelling.medium(end) for end, _ in slow]
        if any(medium.kind != "sampled" for medium in media):
            return (*self.check_early(1), *here, *wait)
        there = infix_all("and", AND, [end.field("fresh") for end in ends])
        taken = tuple(
            statement
            for end, (_, into), medium in zip(ends, slow, media, strict=True)
            for statement in self._sample_taken(end, into, medium)
        )
        return (*self.check(), *here, if_(there, *taken), else_(*wait))

    def check_early(self, before: int) -> Statements:
        """A point of cancellation, if there are accesses before that are not communications."""
        return self.check() if before else ()

    def _rendezvous_reads(self, reads: Sequence[tuple[End, Code]]) -> Statements:
        waiting = self.spelling["waiting"]
        begun: list[Statement] = [assign(waiting, WholeNumber(0))]
        for source, _ in reads:
            before, channel = self._channel(self.spelling.source(source))
            waits = (*self._awaited(source, channel), change(waiting, "+=", WholeNumber(1)))
            begun += [*before, *self._met_writer(source, channel, channel.field("value"), waits)]
        taken = [assign(into, self.spelling.source(source).field("value")) for source, into in reads]
        return (*begun, self._all_done(), *taken)

    def _all_done(self) -> Statement:
        waiting = self.spelling["waiting"]
        return Block("while", waiting, (YIELD, change(waiting, "-=", WholeNumber(1))))

    def write_all(self, writes: Sequence[tuple[End, Code]]) -> Statements:
        """Offer all values in order, then wait until all have been taken."""
        spelling = self.spelling
        media = [spelling.medium(sink) for sink, _ in writes]
        waiting = [position for position, medium in enumerate(media) if medium.kind not in WRITTEN_AT_ONCE]
        one_last = len(waiting) == 1 and all(
            is_plain_access(sink, medium)
            for (sink, _), medium in list(zip(writes, media, strict=True))[waiting[0] :][1:]
        )
        if not waiting or (one_last and waiting[0] == len(writes) - 1):
            statements: list[Statement] = [*self.check()]
            for sink, value in writes:
                statements += self._unchecked(self.write(sink, value))
            return tuple(statements)
        if all(
            is_inline(medium) or is_plain_access(sink, medium) for (sink, _), medium in zip(writes, media, strict=True)
        ):
            return (*self.check(), *self._rendezvous_writes(writes))
        pairs = [
            tuple_of((spelling.sink(sink), value))
            for (sink, value), medium in zip(writes, media, strict=True)
            if medium.kind != "discard"
        ]
        return (*self.set_current_task(), run(delegated(call(self.runtime("write_all"), *pairs))))

    def _unchecked(self, statements: Statements) -> Statements:
        check = self.check()
        return statements[1:] if check and statements[:1] == check else statements

    def _rendezvous_writes(self, writes: Sequence[tuple[End, Code]]) -> Statements:
        waiting = self.spelling["waiting"]
        begun: list[Statement] = [assign(waiting, WholeNumber(0))]
        for sink, value in writes:
            medium = self.spelling.medium(sink)
            if is_plain_access(sink, medium):
                begun += self.write(sink, value)
                continue
            before, channel = self._channel(self.spelling.sink(sink))
            offered = (*self._offered(sink, channel, value), change(waiting, "+=", WholeNumber(1)))
            begun += [*before, *self._met_reader(sink, channel, value, offered)]
        return (*begun, self._all_done())

    def take(self, source: End, into: Code, guards: Code, index: int) -> Statements:
        """The communication of the input guard that was chosen, number ``index`` of ``guards``."""
        end = self.spelling.source(source)
        if not is_alternated(self.spelling.medium(source)):
            return (*self.set_current_task(), assign(into, end.call("take")))
        me, writer = self.spelling["me"], self.spelling["writer"]
        before, channel = self._channel(end)
        bit = channel.field("bit") if before else Constant(str(1 << index))
        chosen = infix("is", COMPARISON, channel.field("selector"), guards)
        return (
            *before,
            assign(writer, channel.field("writing")),
            assign(channel.field("writing"), NONE),
            assign(into, channel.field("offered")),
            if_(chosen, change(guards.field("ready"), "^=", bit)),
            else_(run(channel.call("lower"))),
            self.push(writer),
            *self.report(channel, into, writer, me),
        )
