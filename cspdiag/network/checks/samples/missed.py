"""Processes that must miss samples: what they do between two reads of a sampled input takes longer than the samples
come.

From its first read on, and until the process ends, each sample of an input is taken before the next one comes. So a
sequential part is summed up by what lies before its reads of each input, after them, and between (``sample_reads``).
Paths are those that may be taken: whatever the conditions, and with events at any time, but only one between two
reads. Times are the least that is certain: what is not known (a partner, computing) takes no time, and a loop without
reads one iteration. What parallel branches both read has books of its own in each, and is left alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import chain, repeat
from typing import assert_never

from cspdiag.base import Report, Span
from cspdiag.base.record import replaced
from cspdiag.network.checks.samples.findings import Findings
from cspdiag.network.checks.samples.first import first_late
from cspdiag.network.checks.samples.gaps import NOTHING, Gap
from cspdiag.network.checks.samples.reads import (
    INSTANT,
    MANY,
    NEVER_ENDS,
    Book,
    Part,
    Reads,
    any_way,
    beside,
    endless,
    free_book,
    least_time,
    not_read,
    one_of,
    one_of_exits,
    one_read,
    part,
    repeated,
    within,
)
from cspdiag.network.checks.samples.sequences import Sequences
from cspdiag.network.infer.contexts import Placed
from cspdiag.network.infer.possible import decided, possible_branches, ways_of_samples
from cspdiag.network.infer.waiting import inputs_of, is_always_ready, known_duration
from cspdiag.network.ir import actions as ir
from cspdiag.network.relations import end_key
from cspdiag.network.shapes import InstanceShape, Key


class MissedSamples:
    """Looks for samples that must be missed; the contexts of instances come first."""

    def __init__(self, report: Report) -> None:
        self.report = report
        self._known: dict[Placed, Part] = {}

    def process(self, placed: Placed, *, is_outermost: bool) -> None:
        """Report what a process does between reads of an input and takes longer than its samples come."""
        body = placed.shape.body
        if body is None or placed.shape.incomplete:
            return
        found = _Process(placed, self._known, self.report)
        self._known[placed] = found.part(body)
        if is_outermost and not found.findings.reported and (late := first_late(placed, body)) is not None:
            found.findings.add_first(late)


class _Process(Sequences):
    """Sums up the parts of one process."""

    def __init__(self, placed: Placed, known: Mapping[Placed, Part], report: Report) -> None:
        super().__init__(placed, Findings(placed, report))
        self.known = known
        self.ready: frozenset[Key] = frozenset()
        """Events that a guard has found ready, so that the next read of them does not wait."""
        self._bodies: dict[tuple[int, frozenset[Key], bool], Part] = {}
        """What follows guards, which may be looked at on several paths."""

    def part(self, action: ir.CoreAction) -> Part:
        match action:
            case ir.RunInstance():
                instance = self.placed.shape.instances[action.instance]
                return self._law(instance, action.span) if instance.shape.is_submodel else self._process(action)
            case ir.ReadValue():
                return self._read((end_key(action.source),), action.span)
            case ir.WriteValue() | ir.AssignValue() | ir.SkipStep() | ir.ResetInstance():
                return INSTANT
            case ir.WaitStep():
                waits = known_duration(self.placed, action.duration)
                return part(Gap(waits, None, action.span)) if waits else INSTANT
            case ir.StopStep():
                return NEVER_ENDS
            case ir.RaiseException():
                return part(None, exits={action.exception: INSTANT})
            case ir.SequentialSteps():
                return self.sequence(map(self.part, action.steps))
            case ir.ParallelSteps():
                return beside(map(self._apart, action.steps))
            case ir.Choice():
                return self._choice(action)
            case ir.Repeat():
                body = self._apart(action.body)
                ends = action.until is not None and decided(self.placed, action.until)
                if ends:
                    return body
                self.findings.check_turns(body, is_endless=action.until is None)
                return endless(body) if action.until is None else repeated(body)
            case ir.WhileLoop():
                if decided(self.placed, action.condition) is False:
                    return INSTANT
                body = self._apart(action.body)
                self.findings.check_turns(body, is_endless=False)
                return one_of([INSTANT, repeated(body)])
            case ir.CountedLoop():
                return self._turns(action)
            case ir.IfElse():
                holds = decided(self.placed, action.condition)
                ways = [action.then] * (holds is not False) + [action.otherwise] * (holds is not True)
                return one_of([self._apart(way) for way in ways])
            case ir.CatchException():
                return self._catch(action)
            case ir.InterruptOn():
                return self._interrupt(action)
            case ir.Group():
                return self.part(action.body)
            case _:
                assert_never(action)

    def _turns(self, loop: ir.CountedLoop[ir.CoreAction]) -> Part:
        """What was ready before the first iteration may be read in it; the others begin all alike."""
        first = self.part(loop.body)
        return self.sequence(chain((first,), repeat(self.part(loop.body), loop.turns - 1)))

    def _apart(self, action: ir.CoreAction) -> Part:
        """A part that is not taken on every path: an event that was ready before it may still be so afterwards."""
        was_ready = self.ready
        found = self.part(action)
        self.ready = was_ready
        return found

    def _law(self, instance: InstanceShape, span: Span) -> Part:
        return self._read([key for key in inputs_of(instance) if key is not None], span)

    def _read(self, keys: Iterable[Key], span: Span) -> Part:
        """Reads that begin at once: a sample is taken when it is there, and then the events are waited for."""
        keys = list(keys)
        event = next((key for key in keys if self._is_event(key)), None)
        time = NOTHING if event is None else Gap(0, event, span)
        self.ready -= set(keys)
        return part(time, {(key, 0): one_read(self.period(key), time, span) for key in keys if self.period(key)})

    def _process(self, action: ir.RunInstance) -> Part:
        """A process keeps books of its own; here it takes time, and may wait for events."""
        inside = self.known.get(self.placed.inside[action.instance])
        if inside is None:
            return INSTANT
        exits = {name: part(_caused(found.time, action.span)) for name, found in inside.exits.items()}
        return part(_caused(inside.time, action.span), exits=exits)

    def _is_event(self, key: Key) -> bool:
        return self.placed.facts[key][0] == "event" and key not in self.ready

    def _choice(self, action: ir.Choice[ir.CoreAction]) -> Part:
        """One of the branches that are possible, whether the conditions of samples hold or not."""
        return one_of([self._chosen(way) for way in ways_of_samples(self.placed, action)])

    def _chosen(self, action: ir.Choice[ir.CoreAction]) -> Part:
        """One of the branches, after what is waited for before it can be chosen."""
        branches = possible_branches(self.placed, action)
        events = [branch for branch in branches if self._event_of(branch) is not None]
        time_outs = [branch for branch in branches if isinstance(branch.event, ir.AfterEvent)]
        if branches and len(events) == len(branches):
            waits = Gap(0, self._event_of(events[0]), events[0].event.span)
            return self.sequence((part(waits), one_of([self._branch(branch, NOTHING, {}) for branch in branches])))
        # Until which moment an event may come: a sample or a time-out is chosen then.
        until = NOTHING
        if len(events) + len(time_outs) == len(branches):
            until = min(filter(None, map(self._time_out, time_outs)), key=lambda gap: gap.duration, default=NOTHING)
        samples = self._samples(branches)
        is_waiting = not any(is_always_ready(self.placed, branch.event) for branch in branches)
        is_certain = (is_waiting or not (samples or events)) and not (time_outs and samples)
        was_tolerated = self.findings.tolerated
        self.findings.tolerated = was_tolerated or not is_certain
        parts = []
        for place, branch in enumerate(branches):
            instead = {}
            for key, sample in samples.items():
                is_first = action.prioritized and place < sample
                is_last = action.prioritized and not is_first
                instead[key, 0] = self._instead_of(key, branch, waits=is_waiting, is_first=is_first, is_last=is_last)
            parts.append(self._branch(branch, until.perhaps if branch in events else NOTHING, instead))
        self.findings.tolerated = was_tolerated
        chosen = one_of(parts)
        if is_certain:
            return chosen
        # Whether a sample comes before a time-out, or is there already, depends on how late one is, of which only a
        # bound is known.
        reads = {book: any_way(book, parts, found.span) for book, found in chosen.reads.items()}
        return part(least_time(parts), reads, chosen.exits)

    def _event_of(self, branch: ir.Branch[ir.CoreAction]) -> Key | None:
        """The event that a guard waits for."""
        if not isinstance(branch.event, ir.InputEvent | ir.ReadyEvent):
            return None
        key = end_key(branch.event.source)
        return key if self._is_event(key) else None

    def _samples(self, branches: Iterable[ir.Branch[ir.CoreAction]]) -> dict[Key, int]:
        """The sampled inputs that guards wait for, with the places of these."""
        guarded = {
            end_key(branch.event.source): place
            for place, branch in enumerate(branches)
            if isinstance(branch.event, ir.InputEvent | ir.ReadyEvent)
        }
        return {key: place for key, place in guarded.items() if self.period(key)}

    def _time_out(self, branch: ir.Branch[ir.CoreAction]) -> Gap | None:
        assert isinstance(branch.event, ir.AfterEvent)
        waits = known_duration(self.placed, branch.event.duration)
        return Gap(waits, None, branch.event.span) if waits else None

    def _branch(
        self, branch: ir.Branch[ir.CoreAction], until: Gap, instead: Mapping[Book, Reads], beside: Part = INSTANT
    ) -> Part:
        """What follows when a branch is chosen, ``until`` a moment at the latest, ``instead`` of samples; its guard
        stands ``beside`` a part, with a book of its own.
        """
        event = branch.event
        if isinstance(event, ir.InputEvent | ir.ReadyEvent):
            key = end_key(event.source)
            was_ready = self.ready
            self.ready = was_ready | {key} if isinstance(event, ir.ReadyEvent) else was_ready - {key}
            following = self._following(branch)
            self.ready = was_ready
            if self.period(key):
                book = free_book(key, beside)
                taken = part(NOTHING, {book: one_read(self.period(key), NOTHING, event.span)})
                return following if isinstance(event, ir.ReadyEvent) else self.sequence((taken, following))
        else:
            following = self._following(branch)
        time = self._time_out(branch) or NOTHING if isinstance(event, ir.AfterEvent) else until
        return self.sequence((part(time, instead), following))

    def _following(self, branch: ir.Branch[ir.CoreAction]) -> Part:
        place = id(branch.body), self.ready, self.findings.tolerated
        if place not in self._bodies:
            self._bodies[place] = self._apart(branch.body)
        return self._bodies[place]

    def _instead_of(
        self, sample: Key, chosen: ir.Branch[ir.CoreAction], *, waits: bool, is_first: bool, is_last: bool
    ) -> Reads:
        """What becomes of a sample where something else is chosen: an event comes at any time, up to the next sample.

        One that ``is_first`` is chosen also where the sample is there already, one that ``is_last`` only before.
        """
        event = self._event_of(chosen) if waits else None
        span = chosen.event.span
        held = NOTHING if event is None else Gap(0, None, span, -self.period(sample) + is_last, event)
        return not_read(held, NOTHING if is_first else None, span)

    def _interrupt(self, action: ir.InterruptOn[ir.CoreAction]) -> Part:
        branch = action.branch
        holds = decided(self.placed, branch.condition)
        if holds is False:
            return self._apart(action.body)
        if holds and is_always_ready(self.placed, branch.event):
            return self._replaced_at_once(action)
        is_time_out = isinstance(branch.event, ir.AfterEvent)
        longest = self._longest(branch) if holds else 0
        was_limit = self.findings.limit
        self.findings.limit = min(was_limit, longest) if longest else was_limit
        body = self._apart(action.body)
        self.findings.limit = was_limit
        handler = self._following(branch) if is_time_out else self._branch(branch, NOTHING, {}, beside=body)
        if body.time is NOTHING and not body.reads:
            return body
        event = self._event_of(branch)
        if event is not None:
            return one_of([body, self.sequence((self._abandoned(body, event, branch.event.span), handler))])
        limit = (self._time_out(branch) if is_time_out else None) or NOTHING
        may_end = not is_time_out or limit is NOTHING or body.time is None or body.time.event is not None
        if not may_end and body.time is not None and body.time.duration < limit.duration:
            return body
        left = self.sequence((self._cut_off(body, limit), handler))
        if not is_time_out and longest and body.time is not None and body.time.event is None:
            may_end = body.time.duration < longest
        if not may_end:
            return replaced(left, exits=one_of_exits((body.exits, left.exits)))
        return one_of([within(body, limit) if is_time_out else body, left])

    def _replaced_at_once(self, action: ir.InterruptOn[ir.CoreAction]) -> Part:
        """A body that is cancelled before it reads or waits, and the branch that follows; only by an exception can it
        end before.
        """
        was_tolerated = self.findings.tolerated
        self.findings.tolerated = True
        body = self._apart(action.body)
        self.findings.tolerated = was_tolerated
        following = self._following(action.branch)
        return replaced(following, exits=one_of_exits((body.exits, following.exits)))

    def _longest(self, branch: ir.Branch[ir.CoreAction]) -> int:
        """After how many nanoseconds a guard surely comes that is a time-out or a sample; 0 where that is not known."""
        if isinstance(branch.event, ir.AfterEvent):
            return known_duration(self.placed, branch.event.duration)
        return (
            self.period(end_key(branch.event.source)) if isinstance(branch.event, ir.InputEvent | ir.ReadyEvent) else 0
        )

    def _abandoned(self, body: Part, event: Key, span: Span) -> Part:
        """A body that an event ends: at any time, at the latest with the next sample that the body waits for."""
        time = Gap(0, event, span) if body.time is None else body.time.perhaps
        reads = {}
        for book, found in body.reads.items():
            held = Gap(0, None, span, -self.period(book[0]), event)
            again = found.most > 1 and found.before is not None
            past = NOTHING if body.time is None or found.before is not None else body.time.perhaps
            reads[book] = replaced(
                found, past=past, after=held if again else None, least=0, drift=None, held=held, pending=None
            )
        return part(time, reads)

    def _cut_off(self, body: Part, limit: Gap) -> Part:
        """A body that is left somewhere, after no more than ``limit``: nothing certain follows its reads."""
        is_longer = body.time is None or body.time.rank >= limit.rank
        reads = {}
        for book, found in body.reads.items():
            is_read = found.before is not None and found.before.rank <= limit.rank
            waits = found.past is None and is_read
            reads[book] = replaced(
                found,
                before=found.before if is_read else None,
                past=None if waits and limit is not NOTHING else limit if is_longer else found.past,
                after=NOTHING if is_read or found.after is not None else None,
                least=0,
                drift=None,
                held=limit if waits and limit.duration < self.period(book[0]) else None,
                pending=None,
            )
        return part(limit if is_longer else body.time, reads)

    def _catch(self, action: ir.CatchException[ir.CoreAction]) -> Part:
        was_tolerated = self.findings.tolerated
        self.findings.tolerated = was_tolerated or action.exception == "Timeout"
        body = self._apart(action.body)
        self.findings.tolerated = was_tolerated
        handler = self._apart(action.handler)
        if action.exception == "Timeout":
            caught = {
                key: replaced(found, before=None, most=MANY, drift=None, pending=None)
                for key, found in body.reads.items()
            }
            body = replaced(body, reads=caught)
            return one_of([body, self.sequence((self._cut_off(body, NOTHING), handler))])
        raised = body.exits.get(action.exception)
        others = {name: found for name, found in body.exits.items() if name != action.exception}
        body = replaced(body, exits=others)
        return body if raised is None else one_of([body, self.sequence((raised, handler))])


def _caused(time: Gap | None, span: Span) -> Gap | None:
    return time if time is None or time is NOTHING else replaced(time, cause=span)
