"""Communications in place: a rendezvous touches two slots of the channel, everything else is a call of the runtime."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cspdiag.codegen.python.fast.places import Spelling, at_once, is_alternated, is_inline
from cspdiag.codegen.python.text.code import AND, COMPARISON, SUM, Atom, call, infix, tuple_of
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.statements import Block, Line, Statement, Unpack, run
from cspdiag.model.types import BoolType, EnumType, IntType, RealType, TimeType
from cspdiag.network.flow.waiting import WRITTEN_AT_ONCE
from cspdiag.network.ir.actions import End
from cspdiag.network.ir.network import Medium

Statements = tuple[Statement, ...]


def text(line: str) -> Line:
    """A statement as it stands."""
    return Line(line)


@dataclass
class Communications:
    """Writes the communications of one process class.

    ``checked``: whether the code asks before each communication if it was cancelled. ``traced``: whether channels
    inside are reported.
    """

    spelling: Spelling
    imports: Imports
    checked: bool
    traced: bool
    tracked: bool
    """Whether the scheduler notes who runs."""
    levels: bool
    """Whether the program has prioritized parallels, and so a ready queue for each level."""

    def check(self) -> Statements:
        """A point of cancellation."""
        if not self.checked:
            return ()
        cancelled = self.imports.runtime("Cancelled")
        return (Block(text(f"if {self.spelling['me']}.cancelled:"), (text(f"raise {cancelled}"),)),)

    def known(self) -> Statements:
        """Says who runs, before something of the runtime is called that may ask."""
        if self.tracked:
            return ()
        return (text(f"{self.imports.runtime('scheduler')}.current = {self.spelling['me']}"),)

    def push(self, party: str) -> Statement:
        """Readies a party."""
        if self.levels:
            return text(f"{party}.ready_queue.append({party})")
        return text(f"{self.imports.runtime('push')}({party})")

    def report(self, channel: str, value: str, writer: str, reader: str) -> Statements:
        """Tells the observer."""
        if not self.traced:
            return ()
        scheduler = self.imports.runtime("scheduler")
        tell = run(call(f"{scheduler}.observe", *map(Atom, (f"{channel}.name", value, writer, reader))))
        return (Block(text(f"if {scheduler}.observe is not None:"), (tell,)),)

    # One communication

    def read(self, source: End, into: str) -> Statements:
        """Reads into a local variable or attribute."""
        medium = self.spelling.medium(source)
        if at_once(source, medium):
            return (text(f"{into} = {self.spelling.value_at(source)}"),)
        end = self.spelling.source(source)
        if is_inline(medium):
            before, channel = self._channel(end)
            return (*self.check(), *before, *self._rendezvous_read(channel, into, is_alternated(medium)))
        if medium.kind == "sampled":
            return (*self.check(), *self._sampled_read(end, into, medium))
        return (*self.known(), text(f"{into} = yield from {end}.read()"))

    def _channel(self, end: str) -> tuple[Statements, str]:
        if not end.endswith("]"):
            return (), end
        channel = self.spelling["channel"]
        return (text(f"{channel} = {end}"),), channel

    def _rendezvous_read(self, channel: str, into: str, alternated: bool) -> Statements:
        me, writer = self.spelling["me"], self.spelling["writer"]
        there: list[Statement] = [text(f"{channel}.writing = None"), text(f"{into} = {channel}.offered")]
        if alternated:
            there.append(text(f"{channel}.lower()"))
        there += [self.push(writer), *self.report(channel, into, writer, me)]
        return (
            text(f"{writer} = {channel}.writing"),
            Block(text(f"if {writer} is not None:"), tuple(there)),
            Block(
                text("else:"),
                (text(f"{channel}.reading = {me}"), text("yield"), text(f"{into} = {channel}.value")),
            ),
        )

    def _sampled_read(self, end: str, into: str, medium: Medium) -> Statements:
        """Waits for a sample, and takes it."""
        wait = (text(f"{end}.wait({self.spelling['me']})"), text("yield"), *self.check())
        return (Block(text(f"if not {end}.fresh:"), wait), *self._sample_taken(end, into, medium))

    def _sample_taken(self, end: str, into: str, medium: Medium) -> Statements:
        """Takes a sample that is there: in place where it is the next of a session."""
        scheduler, me = self.imports.runtime("scheduler"), self.spelling["me"]
        in_place: Statements = (text(f"{end}.fresh = False"), text(f"{into} = {end}.value"))
        if medium.guarded_reads:
            lower = text(f"{self.imports.runtime('lower_bits')}({end}.inputs)")
            in_place = (*in_place, Block(text(f"if {end}.inputs:"), (lower,)))
        tell = run(call(f"{scheduler}.observe", *map(Atom, (f"{end}.name", into, "None", me))))
        in_place = (*in_place, Block(text(f"if {scheduler}.observe is not None:"), (tell,)))
        usual = infix("and", AND, Atom(f"{end}.begun"), Atom(f"not {end}.overdue"))
        rest = text(f"{into} = {end}.taken({me})")
        return (Block(Line("if ", usual, ":"), in_place), Block(text("else:"), (rest,)))

    def write(self, sink: End, value: str) -> Statements:
        """Writes a value that is simple enough to be evaluated twice."""
        medium = self.spelling.medium(sink)
        if medium.kind == "discard":
            return ()
        if medium.kind == "var":
            return (text(f"{self.spelling.value_at(sink)} = {value}"),)
        end = self.spelling.sink(sink)
        if is_inline(medium):
            before, channel = self._channel(end)
            return (*self.check(), *before, *self._rendezvous_write(channel, value, is_alternated(medium)))
        if medium.kind == "latched" and value.isidentifier():
            return (*self.check(), *self._latched(sink, end, value))
        if medium.kind in WRITTEN_AT_ONCE:
            known = () if medium.kind in ("latched", "direct") else self.known()
            return (*self.check(), *known, text(f"{end}.offer({self.spelling['me']}, {value})"))
        return (*self.known(), text(f"yield from {end}.write({value})"))

    def _latched(self, sink: End, end: str, value: str) -> Statements:
        """Keeps a finite value for the next tick."""
        me = self.spelling["me"]
        latch = tuple(text(f"{end}.{line}") for line in (f"latched = {value}", f"writer = {me}", "written = True"))
        type_ = self.spelling.type_of(sink)
        if isinstance(type_, BoolType | IntType | EnumType | TimeType):
            return latch
        refused = text(f"{end}.offer({me}, {value})")
        if not isinstance(type_, RealType):
            return (refused,)
        finite = infix("==", COMPARISON, infix("-", SUM, Atom(value), Atom(value)), Atom("0.0"))
        return (Block(Line("if ", finite, ":"), latch), Block(text("else:"), (refused,)))

    def _rendezvous_write(self, channel: str, value: str, alternated: bool) -> Statements:
        me, reader = self.spelling["me"], self.spelling["reader"]
        there = (
            text(f"{channel}.reading = None"),
            text(f"{channel}.value = {value}"),
            self.push(reader),
            *self.report(channel, value, me, reader),
        )
        waits = (*self._offered(channel, value, alternated), text("yield"))
        return (
            text(f"{reader} = {channel}.reading"),
            Block(text(f"if {reader} is not None:"), there),
            Block(text("else:"), waits),
        )

    def _offered(self, channel: str, value: str, alternated: bool) -> Statements:
        me, ready = self.spelling["me"], self.spelling["ready"]
        parked = (text(f"{channel}.writing = {me}"), text(f"{channel}.offered = {value}"))
        if not alternated:
            return parked
        guards = f"{ready}_guards"
        return (
            *parked,
            text(f"{guards} = {channel}.selector"),
            text(f"{guards}.ready |= {channel}.bit"),
            Block(text(f"if {guards}.armed & {channel}.bit:"), (*self.known(), text(f"{guards}.wake()"))),
        )

    # Several at once

    def read_all(self, reads: Sequence[tuple[End, str]]) -> Statements:
        """Begins all reads in order, then waits for all."""
        spelling = self.spelling
        slow = [(end, into) for end, into in reads if not at_once(end, spelling.medium(end))]
        here = tuple(
            text(f"{into} = {spelling.value_at(end)}") for end, into in reads if at_once(end, spelling.medium(end))
        )
        if not slow:
            return (*self.check(), *here)
        if len(slow) == 1:
            first = reads.index(slow[0])
            return (*self.check_early(first), *here, *self.read(*slow[0]))
        if all(is_inline(spelling.medium(end)) for end, _ in slow):
            return (*self.check(), *here, *self._rendezvous_reads(slow))
        ends = [spelling.source(end) for end, _ in slow]
        waiting = call(f"yield from {self.imports.runtime('read_all')}", *map(Atom, ends))
        wait = (*self.known(), Unpack(tuple(into for _, into in slow), waiting))
        media = [spelling.medium(end) for end, _ in slow]
        if any(medium.kind != "sampled" for medium in media):
            return (*self.check_early(1), *here, *wait)
        there = " and ".join(f"{end}.fresh" for end in ends)
        taken = tuple(
            statement
            for name, (_, into), medium in zip(ends, slow, media, strict=True)
            for statement in self._sample_taken(name, into, medium)
        )
        return (*self.check(), *here, Block(text(f"if {there}:"), taken), Block(text("else:"), wait))

    def check_early(self, before: int) -> Statements:
        """A point of cancellation before accesses that are none."""
        return self.check() if before else ()

    def _rendezvous_reads(self, reads: Sequence[tuple[End, str]]) -> Statements:
        me, writer, waiting = (self.spelling[name] for name in ("me", "writer", "waiting"))
        begun: list[Statement] = [text(f"{waiting} = 0")]
        for source, _ in reads:
            alternated = is_alternated(self.spelling.medium(source))
            before, channel = self._channel(self.spelling.source(source))
            there: list[Statement] = [
                text(f"{channel}.writing = None"),
                text(f"{channel}.value = {channel}.offered"),
            ]
            if alternated:
                there.append(text(f"{channel}.lower()"))
            there += [self.push(writer), *self.report(channel, f"{channel}.value", writer, me)]
            begun += [
                *before,
                text(f"{writer} = {channel}.writing"),
                Block(text(f"if {writer} is not None:"), tuple(there)),
                Block(text("else:"), (text(f"{channel}.reading = {me}"), text(f"{waiting} += 1"))),
            ]
        taken = [text(f"{into} = {self.spelling.source(source)}.value") for source, into in reads]
        return (*begun, *self._all_done(), *taken)

    def _all_done(self) -> Statements:
        waiting = self.spelling["waiting"]
        return (Block(text(f"while {waiting}:"), (text("yield"), text(f"{waiting} -= 1"))),)

    def write_all(self, writes: Sequence[tuple[End, str]]) -> Statements:
        """Offers all values in order, then waits until all were taken."""
        spelling = self.spelling
        media = [spelling.medium(sink) for sink, _ in writes]
        waiting = [position for position, medium in enumerate(media) if medium.kind not in WRITTEN_AT_ONCE]
        one_last = len(waiting) == 1 and all(
            at_once(sink, medium) for (sink, _), medium in list(zip(writes, media, strict=True))[waiting[0] :][1:]
        )
        if not waiting or (one_last and waiting[0] == len(writes) - 1):
            statements: list[Statement] = [*self.check()]
            for sink, value in writes:
                statements += self._unchecked(self.write(sink, value))
            return tuple(statements)
        if all(is_inline(medium) or at_once(sink, medium) for (sink, _), medium in zip(writes, media, strict=True)):
            return (*self.check(), *self._rendezvous_writes(writes))
        pairs = [
            tuple_of((Atom(spelling.sink(sink)), Atom(value)))
            for (sink, value), medium in zip(writes, media, strict=True)
            if medium.kind != "discard"
        ]
        return (*self.known(), run(call(f"yield from {self.imports.runtime('write_all')}", *pairs)))

    def _unchecked(self, statements: Statements) -> Statements:
        check = self.check()
        return statements[1:] if check and statements[:1] == check else statements

    def _rendezvous_writes(self, writes: Sequence[tuple[End, str]]) -> Statements:
        me, reader, waiting = (self.spelling[name] for name in ("me", "reader", "waiting"))
        begun: list[Statement] = [text(f"{waiting} = 0")]
        for sink, value in writes:
            medium = self.spelling.medium(sink)
            if at_once(sink, medium):
                begun += self.write(sink, value)
                continue
            before, channel = self._channel(self.spelling.sink(sink))
            there = (
                text(f"{channel}.reading = None"),
                text(f"{channel}.value = {value}"),
                self.push(reader),
                *self.report(channel, value, me, reader),
            )
            offered = (*self._offered(channel, value, is_alternated(medium)), text(f"{waiting} += 1"))
            begun += [
                *before,
                text(f"{reader} = {channel}.reading"),
                Block(text(f"if {reader} is not None:"), there),
                Block(text("else:"), offered),
            ]
        return (*begun, *self._all_done())

    def take(self, source: End, into: str, guards: str, index: int) -> Statements:
        """The communication of an input guard that was chosen, which is number ``index`` of ``guards``."""
        end = self.spelling.source(source)
        if not is_alternated(self.spelling.medium(source)):
            return (*self.known(), text(f"{into} = {end}.take()"))
        me, writer = self.spelling["me"], self.spelling["writer"]
        before, channel = self._channel(end)
        bit = f"{channel}.bit" if before else str(1 << index)
        return (
            *before,
            text(f"{writer} = {channel}.writing"),
            text(f"{channel}.writing = None"),
            text(f"{into} = {channel}.offered"),
            Block(text(f"if {channel}.selector is {guards}:"), (text(f"{guards}.ready ^= {bit}"),)),
            Block(text("else:"), (text(f"{channel}.lower()"),)),
            self.push(writer),
            *self.report(channel, into, writer, me),
        )
