"""Processes that must miss samples: what they do between two reads of a sampled input takes longer than the samples come.

From its first read on, and until the process ends, each sample of an input is taken before the next one comes. So a sequential part
is summed up by what lies before its first read of each input, after its last, and between. Times are the least that is certain: what
nobody knows (a partner, computing) takes no time. What parallel branches both read has books of its own in each, and is left alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import reduce
from typing import assert_never

from cspdiag.diagnostics import Report, Span
from cspdiag.diagnostics.record import node, replaced
from cspdiag.network.actions import (
    Action,
    AfterEvent,
    AssignValue,
    Branch,
    CatchException,
    Choice,
    Group,
    IfElse,
    InputEvent,
    InterruptOn,
    OptimizedStep,
    OutputEvent,
    ParallelSteps,
    RaiseException,
    ReadValue,
    ReadyEvent,
    Repeat,
    ResetInstance,
    RunInstance,
    SequentialSteps,
    SkipEvent,
    SkipStep,
    StopStep,
    WaitStep,
    WhileLoop,
    WriteValue,
)
from cspdiag.network.contexts import Placed
from cspdiag.network.diagnostics_rates import SamplesMissed
from cspdiag.network.gaps import NOTHING, Elapsed, Gap, either, then
from cspdiag.network.relations import end_key
from cspdiag.network.shapes import InstanceShape, Key
from cspdiag.network.waiting import inputs_of, known_duration, sample_period

_MANY = 1 << 40
"""More reads than anybody counts: those of a loop inside."""


@node
class Reads:
    """The reads of one sampled input in a part: None is what no way through it does.

    ``before`` lies before the first read, ``after`` after the last, ``past`` on a way without one; ``least`` and ``most`` count reads.
    """

    before: Gap | None
    past: Gap | None
    after: Gap | None
    least: int
    most: int
    span: Span


@node
class Part:
    """What a part of a composition takes: ``time`` on a way through it, None where there is none; ``wait`` on every way."""

    time: Gap | None
    wait: int
    reads: Mapping[Key, Reads]


_INSTANT = Part(time=NOTHING, wait=0, reads={})
_NEVER_ENDS = Part(time=None, wait=0, reads={})


class MissedSamples:
    """Looks for samples that must be missed; the contexts of instances come first."""

    def __init__(self, report: Report) -> None:
        self.report = report
        self._known: dict[Placed, Part] = {}

    def process(self, placed: Placed) -> None:
        """Report what a process does between reads of an input and takes longer than its samples come."""
        body = placed.shape.body
        if body is None or placed.shape.incomplete:
            return
        self._known[placed] = _Sequence(placed, self._known, self.report).part(body)


class _Sequence:
    """Sums up the parts of one process, and reports where they are joined."""

    def __init__(self, placed: Placed, known: Mapping[Placed, Part], report: Report) -> None:
        self.placed = placed
        self.known = known
        self.report = report
        self.ready: frozenset[Key] = frozenset()
        """Events that a guard has found ready, so that what follows it reads them without waiting."""
        self.tolerated = False
        """Whether a missed sample is caught here."""

    def part(self, action: Action) -> Part:
        match action:
            case RunInstance():
                instance = self.placed.shape.instances[action.instance]
                return self._law(instance, action.span) if instance.shape.is_submodel else self._process(action)
            case ReadValue():
                return self._read((end_key(action.source),), action.span)
            case WriteValue() | AssignValue() | SkipStep() | ResetInstance():
                return _INSTANT
            case WaitStep():
                waits = known_duration(self.placed, action.duration)
                return Part(time=Gap(waits, None, action.span) if waits else NOTHING, wait=waits, reads={})
            case StopStep() | RaiseException():
                return _NEVER_ENDS
            case SequentialSteps():
                return self._sequence(map(self.part, action.steps))
            case ParallelSteps():
                return _beside([self.part(step) for step in action.steps])
            case Choice():
                return self._choice(action)
            case Repeat():
                body = self.part(action.body)
                self._check_turns(body, is_endless=action.until is None)
                return _endless(body) if action.until is None else _repeated(body)
            case WhileLoop():
                body = self.part(action.body)
                self._check_turns(body, is_endless=False)
                return _either([_INSTANT, _repeated(body)])
            case IfElse():
                return _either([self.part(action.then), self.part(action.otherwise)])
            case CatchException():
                return self._catch(action)
            case InterruptOn():
                body = self.part(action.body)
                left = self._sequence((_abandoned(body), self._branch(action.branch, ())))
                return _either([body, left])
            case Group():
                return self.part(action.body)
            case OptimizedStep():
                raise AssertionError("made by the optimizer, later")
            case _:
                assert_never(action)

    def _law(self, instance: InstanceShape, span: Span) -> Part:
        return self._read([key for key in inputs_of(instance) if key is not None], span)

    def _read(self, keys: Iterable[Key], span: Span) -> Part:
        """Reads that begin at once: a sample is taken when it is there, and then the events are waited for."""
        keys = list(keys)
        event = next((key for key in keys if self._is_event(key)), None)
        time = NOTHING if event is None else Gap(0, event, span)
        reads = {
            key: Reads(before=NOTHING, past=None, after=time, least=1, most=1, span=span)
            for key in keys
            if self._period(key)
        }
        return Part(time=time, wait=0, reads=reads)

    def _process(self, action: RunInstance) -> Part:
        """A process keeps books of its own; here it takes time, and may wait for events."""
        inside = self.known.get(self.placed.inside[action.instance])
        if inside is None:
            return _INSTANT
        time = inside.time
        if time is not None and time is not NOTHING:
            time = replaced(time, cause=action.span)
        return Part(time=time, wait=inside.wait, reads={})

    def _is_event(self, key: Key) -> bool:
        return self.placed.facts[key][0] == "event" and key not in self.ready

    def _period(self, key: Key) -> int:
        return sample_period(self.placed, key)

    def _choice(self, action: Choice) -> Part:
        """An alternative among nothing but events waits for one of them; else a branch is chosen, for all that is certain, at once."""
        sources = [
            end_key(branch.event.source)
            for branch in action.branches
            if isinstance(branch.event, InputEvent | ReadyEvent)
        ]
        guarded = [key for key in sources if self._period(key)]
        chosen = _either([self._branch(branch, guarded) for branch in action.branches])
        if len(sources) < len(action.branches) or not all(map(self._is_event, sources)):
            return chosen
        waits = Gap(0, sources[0], action.branches[0].event.span)
        return self._sequence((Part(time=waits, wait=0, reads={}), chosen))

    def _branch(self, branch: Branch, guarded: Iterable[Key]) -> Part:
        """What follows when a branch is chosen; a time-out passes only while there is no sample of an input that guards another."""
        match branch.event:
            case InputEvent() | ReadyEvent() as event:
                key = end_key(event.source)
                was_ready, self.ready = self.ready, self.ready | {key}
                following = self.part(branch.body)
                self.ready = was_ready
                if isinstance(event, ReadyEvent) or not self._period(key):
                    return following
                taken = Reads(before=NOTHING, past=None, after=NOTHING, least=1, most=1, span=event.span)
                return self._sequence((Part(time=NOTHING, wait=0, reads={key: taken}), following))
            case AfterEvent(duration=duration, span=span):
                passed = known_duration(self.placed, duration)
                nothing = Reads(before=None, past=NOTHING, after=None, least=0, most=0, span=span)
                time = Gap(passed, None, span) if passed else NOTHING
                delay = Part(time=time, wait=passed, reads=dict.fromkeys(guarded, nothing))
                return self._sequence((delay, self.part(branch.body)))
            case OutputEvent() | SkipEvent():
                return self.part(branch.body)
            case _:
                assert_never(branch.event)

    def _catch(self, action: CatchException) -> Part:
        was_tolerated = self.tolerated
        self.tolerated = was_tolerated or action.exception == "Timeout"
        body = self.part(action.body)
        self.tolerated = was_tolerated
        if action.exception == "Timeout":
            caught = {key: replaced(found, before=None, most=_MANY) for key, found in body.reads.items()}
            body = replaced(body, reads=caught)
        return _either([body, self._sequence((_abandoned(body), self.part(action.handler)))])

    def _sequence(self, parts: Iterable[Part]) -> Part:
        """One after another, with a look at what lies between the reads of each input."""
        elapsed = Elapsed()
        wait = 0
        reads: dict[Key, Reads] = {}
        since: dict[Key, int] = {}
        for part in parts:
            for key, other in part.reads.items():
                one = reads.get(key)
                if one is not None:
                    one = _later(one, elapsed.since(since[key]))
                    reads[key] = self._joined(key, one, other)
                elif (before := elapsed.since(0)) is not None:
                    reads[key] = replaced(other, before=then(before, other.before), past=then(before, other.past))
            elapsed.add(part.time)
            since.update(dict.fromkeys(part.reads, elapsed.position))
            wait += part.wait
        reads = {key: _later(found, elapsed.since(since[key])) for key, found in reads.items()}
        return Part(time=elapsed.since(0), wait=wait, reads=reads)

    def _joined(self, key: Key, one: Reads, other: Reads) -> Reads:
        if one.after is not None and other.before is not None:
            self._check(key, one.after.then(other.before), one, other)
        return Reads(
            before=either(one.before, then(one.past, other.before)),
            past=then(one.past, other.past),
            after=either(other.after, then(one.after, other.past)),
            least=one.least + other.least,
            most=one.most + other.most,
            span=other.span,
        )

    def _check(self, key: Key, between: Gap, one: Reads, other: Reads) -> bool:
        """Report a gap in which a sample is certainly overwritten, or may be while an event is waited for."""
        period = self._period(key)
        if self.tolerated or between.cause is None or (between.event is None and between.duration < 2 * period):
            return False
        self.report.add(
            SamplesMissed(
                span=between.cause,
                port=key,
                period=period,
                read=other.span,
                earlier=one.span,
                event=between.event,
                waits=between.duration,
                slower=None,
                reads=1,
                is_certain=True,
            )
        )
        return True

    def _check_turns(self, body: Part, *, is_endless: bool) -> None:
        """What one turn of a loop leaves to the next, and whether it takes as many samples as come in it."""
        slowest = max(((found.least * self._period(key), key) for key, found in body.reads.items()), default=(0, ""))
        for key, found in body.reads.items():
            if found.before is None or found.after is None:
                continue
            # Between two reads there may also be a turn without one.
            between = found.after.then(found.past or NOTHING).then(found.before)
            if self._check(key, between, found, found):
                # What one input misses in a turn, others may miss too: it is one mistake.
                return
            if not 0 < found.most < _MANY:
                continue
            taken = found.most * self._period(key)
            if self.tolerated or not taken:
                continue
            if slowest[0] > taken:
                slower = body.reads[slowest[1]]
                self._report_turns(key, found, slower.span, slowest[1], slowest[0], is_endless)
                return
            if body.wait >= taken and body.time is not None and (cause := _cause(body, found)) is not None:
                self._report_turns(key, found, cause, None, body.wait, is_endless)
                return

    def _report_turns(
        self, key: Key, found: Reads, cause: Span, slower: Key | None, waits: int, is_endless: bool
    ) -> None:
        self.report.add(
            SamplesMissed(
                span=cause,
                port=key,
                period=self._period(key),
                read=found.span,
                earlier=found.span,
                event=None,
                waits=waits,
                slower=slower,
                reads=found.most,
                is_certain=is_endless,
            )
        )


def _cause(body: Part, found: Reads) -> Span | None:
    return next((gap.cause for gap in (found.after, found.before, body.time) if gap is not None and gap.cause), None)


def _later(found: Reads, time: Gap | None) -> Reads:
    """The reads of a part after which something took time, None where there is no way through that."""
    if time is NOTHING:
        return found
    return replaced(found, past=then(found.past, time), after=then(found.after, time))


def _either(parts: list[Part]) -> Part:
    """One of them."""
    if len(parts) == 1:
        return parts[0]
    slowest = sorted(parts, key=lambda part: (-1, 0) if part.time is None else part.time.rank, reverse=True)
    by_key: dict[Key, list[Reads]] = {}
    for part in parts:
        for key, found in part.reads.items():
            by_key.setdefault(key, []).append(found)
    reads: dict[Key, Reads] = {}
    for key, known in by_key.items():
        without = next((part.time for part in slowest if key not in part.reads), None)
        reads[key] = Reads(
            before=reduce(either, (one.before for one in known)),
            past=reduce(either, (one.past for one in known), without),
            after=reduce(either, (one.after for one in known)),
            least=0 if len(known) < len(parts) else min(one.least for one in known),
            most=max(one.most for one in known),
            span=known[0].span,
        )
    return Part(time=slowest[0].time, wait=min(part.wait for part in parts), reads=reads)


def _beside(parts: list[Part]) -> Part:
    """All at once: it takes as long as any; an input that several read has books in each, about which nothing is said."""
    ends = all(part.time is not None for part in parts)
    reads: dict[Key, Reads] = {}
    for part in parts:
        for key, found in part.reads.items():
            if key in reads or not ends:
                found = Reads(before=None, past=None, after=None, least=0, most=_MANY, span=found.span)
            reads[key] = found
    time = reduce(either, (part.time for part in parts)) if ends else None
    return Part(time=time, wait=max(part.wait for part in parts), reads=reads)


def _repeated(body: Part) -> Part:
    """One turn or more."""
    reads = {key: replaced(found, most=_MANY) if found.most else found for key, found in body.reads.items()}
    return replaced(body, reads=reads)


def _endless(body: Part) -> Part:
    reads = {key: replaced(found, past=None, after=None) for key, found in body.reads.items()}
    return Part(time=None, wait=body.wait, reads=reads)


def _abandoned(body: Part) -> Part:
    """Left somewhere: nothing certain lies behind the last read, or before the place."""
    reads = {
        key: Reads(
            before=found.before,
            past=NOTHING,
            after=None if found.before is None and found.after is None else NOTHING,
            least=0,
            most=found.most,
            span=found.span,
        )
        for key, found in body.reads.items()
    }
    return Part(time=NOTHING, wait=0, reads=reads)
