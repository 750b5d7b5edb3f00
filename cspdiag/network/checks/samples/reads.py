"""What parts of a composition do to a process that follows samples: the reads in them, and the time around these,
joined as the parts are.

How late a process is, is the time since the sample came that it has read last. A delay makes it later; a read takes a
period off, or all of it where the process waits for the sample. It is too late where it reaches a read two periods
after. So each part turns one lateness into another: the greatest one, on any path.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import reduce
from itertools import count, islice
from typing import TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import node, replaced
from cspdiag.network.checks.samples.gaps import NOTHING, Gap, both, either, then
from cspdiag.network.shapes import Key

Book: TypeAlias = tuple[Key, int]
"""A sampled input, and the number of the book that a process keeps of it: parts in sequence share the first, parallel
branches that both read have others.
"""

MANY = 1 << 40
"""Too many reads to count: those of a loop inside."""


@node
class Reads:
    """The reads of one sampled input in a part: None is what no path through it does.

    ``before`` lies before a read, ``past`` on a path without one, ``after`` after a read, ``drift`` on a whole path
    with reads: their periods are its credit. ``held`` is how late a process is, at least, that followed the samples and
    did not read one, because something else came first; ``pending`` how late at a read inside that comes after that.
    ``least`` and ``most`` count reads.
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
        """How much later a process becomes that is late already."""
        return either(self.past, self.drift)


@node
class Part:
    """What a part of a composition takes: ``time`` on a path through it, None if there is no path; ``exits`` are what
    it does before it raises an exception.
    """

    time: Gap | None
    reads: Mapping[Book, Reads]
    exits: Mapping[str, Part]


def part(time: Gap | None, reads: Mapping[Book, Reads] | None = None, exits: Mapping[str, Part] | None = None) -> Part:
    """A part, mostly one without reads."""
    return Part(time=time, reads=reads or {}, exits=exits or {})


INSTANT = part(NOTHING)
NEVER_ENDS = part(None)


def one_read(period: int, after: Gap, span: Span) -> Reads:
    """A read that begins at once."""
    drift = Gap(after.duration, after.event, after.cause, period)
    return Reads(before=NOTHING, past=None, after=after, least=1, most=1, span=span, drift=drift)


def not_read(held: Gap | None, past: Gap | None, span: Span) -> Reads:
    """A sample that might have been read, where something else came first."""
    return Reads(before=None, past=past, after=None, least=0, most=0, span=span, held=held)


def unknown_reads(span: Span) -> Reads:
    """Reads that are not reported."""
    return Reads(before=None, past=None, after=None, least=0, most=MANY, span=span)


def later(found: Reads, time: Gap | None) -> Reads:
    """The reads of a part after which something took time, None if there is no path through that."""
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
    """The reads of a part before which something took time."""
    if time is NOTHING:
        return found
    return replaced(found, before=then(time, found.before), past=then(time, found.past), drift=then(time, found.drift))


def joined(one: Reads, other: Reads, pending: Gap | None) -> Reads:
    """One part after the other."""
    came_late = other.held if one.after is not None or one.held is not None or one.passing is not None else None
    after = either(then(one.after, other.passing), came_late if one.after is not None else None)
    # One way may have reads in both: what is longer counts, and is as certain as these.
    last = other.after if other.past is None or other.after is None else other.after.perhaps
    first = one.before if one.past is None or one.before is None else one.before.perhaps
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
    """One of them; of none, nothing ever ends."""
    if not parts:
        return NEVER_ENDS
    if len(parts) == 1:
        return parts[0]
    by_key: dict[Book, list[Reads]] = {}
    for each in parts:
        for key, found in each.reads.items():
            by_key.setdefault(key, []).append(found)
    reads: dict[Book, Reads] = {}
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
    """What passes on any of several paths."""
    return min((each.time for each in parts if each.time is not None), key=lambda time: time.rank, default=None)


def any_way(book: Book, parts: list[Part], span: Span) -> Reads:
    """Reads on one of several paths, not known which: nothing is certain but the least of them, and that a sample
    which is late is read.
    """
    ends: list[Gap | None] = []
    for each in parts:
        found = each.reads.get(book)
        ends.append(each.time if found is None else either(found.after, found.held))
    known = [end for end in ends if end is not None]
    held = min(known, key=lambda gap: gap.rank) if len(known) == len(ends) else None
    return replaced(unknown_reads(span), before=NOTHING, held=held)


def beside(branches: Iterable[Part]) -> Part:
    """All at once: it takes as long as any."""
    taken: dict[Key, set[int]] = {}
    parts = [_with_books(each, taken) for each in branches]
    ends = all(each.time is not None for each in parts)
    reads: dict[Book, Reads] = {}
    for position, each in enumerate(parts):
        others = reduce(both, (other.time for number, other in enumerate(parts) if number != position), None)
        for book, found in each.reads.items():
            reads[book] = _beside(found, others) if ends else _without_end(found)
    exits = one_of_exits(_exits_beside(each, parts) for each in parts if each.exits)
    return part(reduce(both, (each.time for each in parts)) if ends else None, reads, exits)


def free_book(key: Key, beside: Part) -> Book:
    """The first book of an input that a part has not which runs beside."""
    taken = _books_of(beside)
    return next(book for number in count() if (book := (key, number)) not in taken)


def _books_of(one: Part) -> set[Book]:
    return {book for each in (one, *one.exits.values()) for book in each.reads}


def _with_books(one: Part, taken: dict[Key, set[int]]) -> Part:
    """A parallel branch with the books that no branch before it has; ``taken`` are these, and then also its own."""
    inside = _books_of(one)
    numbers: dict[Book, Book] = {}
    for key, number in sorted(inside):
        free = (other for other in count() if other not in taken.get(key, ()))
        numbers[key, number] = key, next(islice(free, number, None))
    for key, number in numbers.values():
        taken.setdefault(key, set()).add(number)

    def renumbered(reads: Mapping[Book, Reads]) -> dict[Book, Reads]:
        return {numbers[book]: found for book, found in reads.items()}

    exits = {name: part(found.time, renumbered(found.reads)) for name, found in one.exits.items()}
    return part(one.time, renumbered(one.reads), exits)


def _beside(found: Reads, others: Gap | None) -> Reads:
    """Reads while others take time: all continue together when the last has ended."""
    if others is None or others is NOTHING:
        return found
    drift = found.drift
    if drift is not None:
        drift = both(drift, replaced(others, credit=drift.credit, beside=None))
    after = found.after if others.event is None else then(found.after, others)
    return replaced(found, past=None if found.past is None else both(found.past, others), after=after, drift=drift)


def _exits_beside(one: Part, parts: list[Part]) -> dict[str, Part]:
    others = {
        key: unknown_reads(found.span) for other in parts if other is not one for key, found in other.reads.items()
    }
    return {name: part(found.time, {**found.reads, **others}) for name, found in one.exits.items()}


def within(body: Part, limit: Gap) -> Part:
    """A body that ends before the ``limit``, whatever events it waits for."""

    def limited(gap: Gap | None) -> Gap | None:
        return gap if gap is None or gap.event is None else limit.perhaps

    reads = {
        book: replaced(
            found,
            before=limited(found.before),
            past=limited(found.past),
            after=limited(found.after),
            drift=None if found.drift is None or found.drift.event is not None else found.drift,
            held=limited(found.held),
            pending=limited(found.pending),
        )
        for book, found in body.reads.items()
    }
    return part(limited(body.time), reads, body.exits)


def repeated(body: Part) -> Part:
    """One iteration or more: a process that reads many samples is in time again."""
    reads = {key: replaced(found, most=MANY, drift=None) if found.most else found for key, found in body.reads.items()}
    return replaced(body, reads=reads)


def endless(body: Part) -> Part:
    """Iteration after iteration, left only by an exception."""
    return part(None, {book: _without_end(found) for book, found in body.reads.items()}, body.exits)


def _without_end(found: Reads) -> Reads:
    return replaced(found, past=None, after=None, drift=None, held=None, most=MANY)
