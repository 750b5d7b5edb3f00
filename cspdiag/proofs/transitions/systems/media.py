"""Components that are not processes: channels with memory, the reading ends of a broadcast, shared variables, and the
partner ``nobody``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product

from cspdiag.proofs.transitions.occurrences import MediumFacts
from cspdiag.proofs.transitions.systems.system import Component, Edge, Place
from cspdiag.proofs.transitions.values import UNKNOWN, Known

_MOST_CONTENTS = 300


def nobody() -> Component:
    """A partner that never arrives, for a channel whose other side is used by no process."""
    return Component("nobody", ((),), frozenset({0}), process=False)


def queue(
    medium: MediumFacts,
    writes: Mapping[Known, Sequence[int]],
    reads: Mapping[Known, Sequence[int]],
) -> Component:
    """The component of a ``buffer``, or of an ``overwrite``, which drops its oldest value when it is full.

    ``writes`` and ``reads`` are the events by value. States are the possible contents if these are few, otherwise only
    the number of values.
    """
    values = list(dict.fromkeys([*writes, *reads]))
    contents = _contents(values, medium.capacity)
    if contents is None:
        return _counting(medium, writes, reads)
    numbers = {content: number for number, content in enumerate(contents)}
    edges: list[tuple[Edge, ...]] = []
    for content in contents:
        found: list[Edge] = []
        for value, events in writes.items():
            longer = (*content, value)
            if len(longer) > medium.capacity:
                if medium.kind == "buffer":
                    continue
                longer = longer[1:]
            found += [(event, numbers[longer]) for event in events]
        if content:
            found += [(event, numbers[content[1:]]) for event in reads.get(content[0], ())]
        edges.append(tuple(found))
    places = {
        number: Place(f"holds {len(content)} of {medium.capacity}", medium.span) for content, number in numbers.items()
    }
    return Component(medium.name, tuple(edges), places=places, process=False, path=medium.name)


def counts_only(medium: MediumFacts, values: Sequence[Known]) -> bool:
    """Whether a queue has too many possible contents for its values to be distinguished when they are read."""
    return _contents(list(values), medium.capacity) is None


def _contents(values: list[Known], capacity: int) -> list[tuple[Known, ...]] | None:
    number = sum(len(values) ** length for length in range(min(capacity, 10) + 1))
    if number > _MOST_CONTENTS or (len(values) > 1 and capacity > 10):
        return None if len(values) > 1 else [tuple(values) * length for length in range(capacity + 1)]
    if len(values) <= 1:
        return [tuple(values) * length for length in range((capacity if values else 0) + 1)]
    return [content for length in range(capacity + 1) for content in product(values, repeat=length)]


def _counting(
    medium: MediumFacts, writes: Mapping[Known, Sequence[int]], reads: Mapping[Known, Sequence[int]]
) -> Component:
    written = [event for events in writes.values() for event in events]
    read = [event for events in reads.values() for event in events]
    edges: list[tuple[Edge, ...]] = []
    for count in range(medium.capacity + 1):
        more = count + 1 if count < medium.capacity else count if medium.kind == "overwrite" else None
        found = [] if more is None else [(event, more) for event in written]
        if count:
            found += [(event, count - 1) for event in read]
        edges.append(tuple(found))
    return Component(medium.name, tuple(edges), process=False, path=medium.name)


def latch(
    name: str,
    writes: Mapping[Known, Sequence[int]],
    takes: Mapping[Known, Sequence[int]],
    delivered: Sequence[int],
    withdrawn: Sequence[int],
    seen: Sequence[int] = (),
) -> Component:
    """One reading end of a ``broadcast``: free, or with a value that its reader has not taken.

    When all ends are free the value has been ``delivered``, and the writer continues; a writer that is cancelled takes
    the value back (``withdrawn``). While there is a value the guard of an interrupt may see it (``seen``).
    """
    values = list(writes)
    free: list[Edge] = [(event, number + 1) for number, value in enumerate(values) for event in writes[value]]
    edges = [(*free, *((event, 0) for event in (*delivered, *withdrawn)))]
    for number, value in enumerate(values, start=1):
        leaving = ((event, 0) for event in (*takes.get(value, ()), *withdrawn))
        edges.append((*leaving, *((event, number) for event in seen)))
    return Component(name, tuple(edges), process=False, path=name)


def variable(
    medium: MediumFacts, loads: Mapping[Known, Sequence[int]], stores: Mapping[Known, Sequence[int]]
) -> Component:
    """A variable that several components access: its state is its value."""
    domain = medium.domain
    values = [UNKNOWN] if domain is None else list(domain)
    numbers = {value: number for number, value in enumerate(values)}
    changes = [(event, numbers[value]) for value, events in stores.items() for event in events]
    edges = tuple(
        (*((event, number) for event in loads.get(value, ())), *changes) for number, value in enumerate(values)
    )
    initial = UNKNOWN if domain is None else medium.distinguished(medium.initial)
    return Component(medium.name, edges, initial=numbers[initial], process=False, path=medium.name)
