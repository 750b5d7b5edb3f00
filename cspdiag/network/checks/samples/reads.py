"""The effect of the parts of a composition on a process that follows samples: their reads, and the time around these.

The lateness of a process is the time since the sample arrived that it has read last. A delay increases it; a read
decreases it by a period, or to zero if the process waits for the sample. A sample is missed if the lateness reaches two
periods at a read. So each part maps one lateness to another, the greatest one on any path.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import reduce
from itertools import accumulate, count, islice
from typing import TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import node, replaced
from cspdiag.network.checks.samples.gaps import NOTHING, Gap, both, either, then
from cspdiag.network.shapes import Key

Session: TypeAlias = tuple[Key, int]
"""A sampled input, and the number of a session of the process at it: parts in sequence share the first one, parallel
branches that both read have different ones.
"""

MANY = 1 << 40
"""Too many reads to count, such as those of a loop inside."""


@node
class Reads:
    """The reads of one sampled input in a part; None for what no path through it does.

    ``before`` is the gap before a read, ``past`` that of a path without one, ``after`` the gap after a read, ``drift``
    that of a whole path with reads, with their periods as its credit. ``held`` is the least lateness of a process that
    followed the samples and did not read one, because something else came first; ``pending`` is the lateness at a later
    read inside. ``least`` and ``most`` are numbers of reads.
    """

    before: Gap | None
    past: Gap | None
    after: Gap | None
    least: int
    most: int
    span: Span
    drift: Gap | None = None
    held: Gap | None = None
    pending: Gap | None = None

    @property
    def passing(self) -> Gap | None:
        """How much later a process becomes that is already late."""
        return either(self.past, self.drift)


@node
class Part:
    """What a part of a composition takes: ``time`` of a path through it, None if there is no path; ``exits`` are its
    parts before an exception.
    """

    time: Gap | None
    reads: Mapping[Session, Reads]
    exits: Mapping[str, Part]


def part(
    time: Gap | None, reads: Mapping[Session, Reads] | None = None, exits: Mapping[str, Part] | None = None
) -> Part:
    """A part, usually one without reads."""
    return Part(time=time, reads=reads or {}, exits=exits or {})


INSTANT = part(NOTHING)
NEVER_ENDS = part(None)


def one_read(period: int, after: Gap, span: Span) -> Reads:
    """A read that begins immediately."""
    drift = Gap(after.duration, after.event, after.cause, period)
    return Reads(before=NOTHING, past=None, after=after, least=1, most=1, span=span, drift=drift)


def not_read(held: Gap | None, past: Gap | None, span: Span) -> Reads:
    """A sample that might have been read if nothing else had come first."""
    return Reads(before=None, past=past, after=None, least=0, most=0, span=span, held=held)


def unknown_reads(span: Span) -> Reads:
    """Reads that are not reported."""
    return Reads(before=None, past=None, after=None, least=0, most=MANY, span=span)


def later(found: Reads, time: Gap | None) -> Reads:
    """The reads of a part that is followed by a gap, None if no path leads through that."""
    if time is NOTHING:
        return found
    return replaced(
        found,
        past=then(found.past, time),
        after=then(found.after, time),
        drift=then(found.drift, time),
        held=then(found.held, time),
    )


def earlier(found: Reads, time: Gap) -> Reads:
    """The reads of a part that is preceded by a gap."""
    if time is NOTHING:
        return found
    return replaced(found, before=then(time, found.before), past=then(time, found.past), drift=then(time, found.drift))


def joined(one: Reads, other: Reads, pending: Gap | None) -> Reads:
    """The reads of one part followed by another."""
    came_late = other.held if one.after is not None or one.held is not None or one.passing is not None else None
    after = either(then(one.after, other.passing), came_late if one.after is not None else None)
    # A path may have reads in both: the longer gap counts, and is as certain as these.
    last = other.after if other.past is None or other.after is None else other.after.maybe_shorter
    first = one.before if one.past is None or one.before is None else one.before.maybe_shorter
    drifts = (
        then(one.drift, other.drift),
        then(one.drift, other.past),
        then(one.past, other.drift),
    )
    return Reads(
        before=both(first, then(one.passing, other.before)),
        past=then(one.past, other.past),
        after=both(last, after),
        least=one.least + other.least,
        most=one.most + other.most,
        span=other.span if other.most else one.span,
        drift=reduce(either, drifts),
        held=either(came_late, then(one.held, other.passing)),
        pending=pending,
    )


def one_of(parts: list[Part]) -> Part:
    """One of several parts; without any, a part that never ends."""
    if not parts:
        return NEVER_ENDS
    if len(parts) == 1:
        return parts[0]
    by_key: dict[Session, list[Reads]] = {}
    for each in parts:
        for key, found in each.reads.items():
            by_key.setdefault(key, []).append(found)
    reads: dict[Session, Reads] = {}
    for key, known in by_key.items():
        without = _greatest(each.time for each in parts if key not in each.reads)
        reads[key] = Reads(
            before=_greatest(one.before for one in known),
            past=either(without, _greatest(one.past for one in known)),
            after=_greatest(one.after for one in known),
            least=0 if len(known) < len(parts) else min(one.least for one in known),
            most=max(one.most for one in known),
            span=next((one.span for one in known if one.most), known[0].span),
            drift=_greatest(one.drift for one in known),
            held=_greatest(one.held for one in known),
            pending=_greatest(one.pending for one in known),
        )
    return part(_greatest(each.time for each in parts), reads, one_of_exits(each.exits for each in parts))


def one_of_exits(all_exits: Iterable[Mapping[str, Part]]) -> dict[str, Part]:
    """The exits of one of several parts."""
    by_name: dict[str, list[Part]] = {}
    for exits in all_exits:
        for name, found in exits.items():
            by_name.setdefault(name, []).append(found)
    return {name: one_of(found) for name, found in by_name.items()}


def _greatest(gaps: Iterable[Gap | None]) -> Gap | None:
    return reduce(either, gaps, None)


def least_time(parts: list[Part]) -> Gap | None:
    """The shortest time of several paths."""
    return min((each.time for each in parts if each.time is not None), key=lambda time: time.rank, default=None)


def on_some_path(session: Session, parts: list[Part], span: Span) -> Reads:
    """Reads on one of several paths that is not known: certain are only the least lateness, and that a late sample is
    read.
    """
    ends: list[Gap | None] = []
    for each in parts:
        found = each.reads.get(session)
        ends.append(each.time if found is None else either(found.after, found.held))
    known = [end for end in ends if end is not None]
    held = min(known, key=lambda gap: gap.rank) if len(known) == len(ends) else None
    return replaced(unknown_reads(span), before=NOTHING, held=held)


def in_parallel(branches: Iterable[Part]) -> Part:
    """All parts at once, which take as long as the longest."""
    taken: dict[Key, set[int]] = {}
    parts = [_with_sessions(each, taken) for each in branches]
    ends = all(each.time is not None for each in parts)
    times = [each.time for each in parts]
    before = list(accumulate([None, *times], both))
    after = list(accumulate([None, *reversed(times)], lambda later, earlier: both(earlier, later)))[::-1]
    reads: dict[Session, Reads] = {}
    for position, each in enumerate(parts):
        others = both(before[position], after[position + 1])
        for session, found in each.reads.items():
            reads[session] = _while_others_run(found, others) if ends else _without_end(found)
    exits = one_of_exits(_exits_in_parallel(each, parts) for each in parts if each.exits)
    return part(reduce(both, (each.time for each in parts)) if ends else None, reads, exits)


def free_session(key: Key, parallel: Part) -> Session:
    """The first session of an input that is not used in a part which runs in parallel."""
    taken = _sessions_of(parallel)
    return next(session for number in count() if (session := (key, number)) not in taken)


def _sessions_of(one: Part) -> set[Session]:
    return {session for each in (one, *one.exits.values()) for session in each.reads}


def _with_sessions(one: Part, taken: dict[Key, set[int]]) -> Part:
    """A parallel branch with sessions that no branch before it uses; adds its own to ``taken``."""
    inside = _sessions_of(one)
    numbers: dict[Session, Session] = {}
    for key, number in sorted(inside):
        free = (other for other in count() if other not in taken.get(key, ()))
        numbers[key, number] = key, next(islice(free, number, None))
    for key, number in numbers.values():
        taken.setdefault(key, set()).add(number)

    def renumbered(reads: Mapping[Session, Reads]) -> dict[Session, Reads]:
        return {numbers[session]: found for session, found in reads.items()}

    exits = {name: part(found.time, renumbered(found.reads)) for name, found in one.exits.items()}
    return part(one.time, renumbered(one.reads), exits)


def _while_others_run(found: Reads, others: Gap | None) -> Reads:
    """Reads while others take time: all continue when the last one has ended."""
    if others is None or others is NOTHING:
        return found
    drift = found.drift
    if drift is not None:
        drift = both(drift, replaced(others, credit=drift.credit, competing_event=None))
    after = found.after if others.event is None else then(found.after, others)
    return replaced(found, past=None if found.past is None else both(found.past, others), after=after, drift=drift)


def _exits_in_parallel(one: Part, parts: list[Part]) -> dict[str, Part]:
    others = {
        key: unknown_reads(found.span) for other in parts if other is not one for key, found in other.reads.items()
    }
    return {name: part(found.time, {**found.reads, **others}) for name, found in one.exits.items()}


def within(body: Part, limit: Gap) -> Part:
    """A body that ends before the ``limit``, even if it waits for events."""

    def limited(gap: Gap | None) -> Gap | None:
        return gap if gap is None or gap.event is None else limit.maybe_shorter

    reads = {
        session: replaced(
            found,
            before=limited(found.before),
            past=limited(found.past),
            after=limited(found.after),
            drift=None if found.drift is None or found.drift.event is not None else found.drift,
            held=limited(found.held),
            pending=limited(found.pending),
        )
        for session, found in body.reads.items()
    }
    return part(limited(body.time), reads, body.exits)


def repeated(body: Part) -> Part:
    """One or more iterations: a process that reads many samples catches up."""
    reads = {key: replaced(found, most=MANY, drift=None) if found.most else found for key, found in body.reads.items()}
    return replaced(body, reads=reads)


def endless(body: Part) -> Part:
    """Iterations without end, left only by an exception."""
    return part(None, {session: _without_end(found) for session, found in body.reads.items()}, body.exits)


def _without_end(found: Reads) -> Reads:
    return replaced(found, past=None, after=None, drift=None, held=None, most=MANY)
