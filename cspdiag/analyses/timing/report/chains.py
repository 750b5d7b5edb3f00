"""Chains from inputs to outputs through loops: how long a change takes, and how old a value may be.

Within a sample of a loop a value passes from law to law and to the outputs. If a law computes before it receives the
value, or another loop does, a sample is added: the value lies in a variable or a channel until the reader takes it at
one of its samples, which takes at most a period and a response time of the writer (Davare and others, Period
optimization for hard real-time distributed automotive systems, 2007).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from cspdiag.analyses.timing.flow.value_flow import Location, Stage, ValueFlow
from cspdiag.analyses.timing.result import Chain
from cspdiag.base.record import record, replaced

LARGEST_NUMBER_OF_ROUTES = 10_000
"""Routes from loop to loop that are followed; if there are more, some chains are left out."""

Latency = Callable[[str, int, int, bool], "tuple[int, int] | None"]
"""By the net of an output, the period and response time of the loop that writes it, and whether it does so in each
sample: the age and the delay of the output; None if the net leads to no output.
"""


@record
class _Route:
    """The route of a value: the stages it has passed with its locations in each, their names, and the time until the
    next stage has it.
    """

    stages: tuple[int, ...] = ()
    passed: tuple[frozenset[Location], ...] = ()
    names: tuple[str, ...] = ()
    time: int = 0


def chains(
    flow: ValueFlow, stages: Sequence[Stage], names: Sequence[str], latency: Latency
) -> tuple[list[Chain], bool]:
    """The chains from sampled inputs to outputs, and whether these are all. ``names`` are the paths of the loops."""
    found: dict[tuple[str, str, tuple[str, ...]], Chain] = {}
    followed_routes = 0
    for first, source in _sources(flow, stages):
        entries = frozenset(location for location in stages[first].locations if source in flow.move_at(location).reads)
        pending = [(_Route(), first, entries)]
        while pending:
            if followed_routes == LARGEST_NUMBER_OF_ROUTES:
                return list(found.values()), False
            followed_routes += 1
            route, at, entries = pending.pop()
            here = _in_sample(flow, at, entries)
            through = (*route.names, _name(flow, names[at], here))
            for chain in _ends(flow, stages[at], source, through, route.time, here, latency):
                key = (chain.source, chain.sink, chain.loops)
                if key not in found or found[key].reaction < chain.reaction:
                    found[key] = chain
            pending += _next_stages(
                flow, _Route((*route.stages, at), (*route.passed, frozenset(here)), through, route.time), here
            )
    return list(found.values()), True


def _sources(flow: ValueFlow, stages: Sequence[Stage]) -> Iterator[tuple[int, str]]:
    for k, stage in enumerate(stages):
        read = {net for location in stage.locations - stage.triggered for net in flow.move_at(location).reads}
        yield from ((k, net) for net in sorted(read) if flow.periods.get(net) == stage.period)


def _in_sample(flow: ValueFlow, at: int, entries: frozenset[Location]) -> dict[Location, int]:
    """The locations that a value passes in one sample of a stage, each with the time that it may have lain in
    channels.
    """
    known: dict[tuple[Location, tuple[Location, ...]], int] = {}
    pending: list[tuple[Location, tuple[Location, ...], int]] = [(location, (), 0) for location in sorted(entries)]
    while pending:
        location, left, waited = pending.pop()
        if known.get((location, left), -1) >= waited:
            continue
        known[location, left] = waited
        for hop in flow.hops(at, location):
            if hop.in_sample and _is_passed_on_in_time(flow, at, left, hop.location):
                others = (*left, location) if hop.location[0] != location[0] else left
                pending.append(
                    (hop.location, tuple(part for part in others if part[0] != hop.location[0]), waited + hop.waits)
                )
    here: dict[Location, int] = {}
    for (location, _), waited in known.items():
        here[location] = max(waited, here.get(location, 0))
    return here


def _is_passed_on_in_time(flow: ValueFlow, at: int, left: tuple[Location, ...], location: Location) -> bool:
    """Whether a value that returns to a thread arrives before that passes ``location``; ``left`` are the locations at
    which it left threads.
    """
    return all(part != location and flow.is_in_order(at, part, location) for part in left if part[0] == location[0])


def _ends(
    flow: ValueFlow,
    stage: Stage,
    source: str,
    through: tuple[str, ...],
    time: int,
    here: Mapping[Location, int],
    latency: Latency,
) -> Iterator[Chain]:
    """The chains that end at an output of a stage."""
    for location, waited in sorted(here.items()):
        for net in sorted(flow.move_at(location).writes):
            found = latency(net, stage.period, stage.response + waited, net in stage.steady)
            if found is not None:
                age, delay = found
                yield Chain(_short(source), _short(net), through, time + stage.period + delay, time + age)


def _next_stages(
    flow: ValueFlow, route: _Route, here: Mapping[Location, int]
) -> Iterator[tuple[_Route, int, frozenset[Location]]]:
    """The stages that take the value at another sample."""
    at = route.stages[-1]
    known = {
        (one, location) for one, locations in zip(route.stages, route.passed, strict=True) for location in locations
    }
    entries: dict[int, set[Location]] = {}
    longest: dict[int, int] = {}
    for location, waited in here.items():
        for hop in flow.hops(at, location):
            if (hop.to, hop.location) not in known:
                entries.setdefault(hop.to, set()).add(hop.location)
                longest[hop.to] = max(longest.get(hop.to, 0), waited + hop.waits)
    for to in sorted(entries):
        yield replaced(route, time=route.time + longest[to]), to, frozenset(entries[to])


def _name(flow: ValueFlow, loop: str, here: Iterable[Location]) -> str:
    """The name of the loop, or of a law in it if the value does not pass the law that the loop is named after."""
    # Places are numbered from the last to the first.
    laws = [leaf for location in sorted(here, reverse=True) if (leaf := flow.law_at(location))]
    return _short(loop if loop in laws or not laws else laws[0])


def _short(path: str) -> str:
    return path.partition(".")[2] or path
