"""Chains from inputs to outputs through loops: how long a change takes, and how old a value may be.

Within a sample of a loop a value passes from law to law and to the outputs. If a law computes before it receives the
value, or another loop does, a sample is added: the value lies in a variable or a channel until the reader takes it at
one of its samples, which takes at most a period and a response time of the writer (Davare and others, Period
optimization for hard real-time distributed automotive systems, 2007).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from cspdiag.analyses.timing.flow.value_flow import Hop, Location, Stage, ValueFlow
from cspdiag.analyses.timing.refusal import Refusal
from cspdiag.analyses.timing.result import Chain
from cspdiag.base.record import record, replaced

LARGEST_NUMBER_OF_ROUTES = 10_000
"""Routes from loop to loop that are followed; if there are more, some chains are left out."""

Latency = Callable[[str, int, int, bool], "tuple[int, int] | None"]
"""By the net of an output, the period and response time of the loop that writes it, and whether it does so in each
sample: the age and the delay of the output; None if the net leads to no output.
"""


@record
class _Unbounded:
    """Why a value may be used at any later time, or why not each value is passed on; None where neither is so."""

    age: Refusal | None = None
    reaction: Refusal | None = None

    def also(self, other: _Unbounded) -> _Unbounded:
        """The same with the reasons of another one where this has none."""
        return _Unbounded(self.age or other.age, self.reaction or other.reaction)


@record
class _Route:
    """The route of a value: the stages it has passed with its locations in each, their names, the time until the next
    stage has it, and why that may have no bound.
    """

    stages: tuple[int, ...] = ()
    passed: tuple[frozenset[Location], ...] = ()
    names: tuple[str, ...] = ()
    time: int = 0
    unbounded: _Unbounded = _Unbounded()


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
            unbounded = _unbounded_in_sample(flow, stages[at], at, dict.fromkeys(entries, route.unbounded), here)
            for chain in _ends(flow, stages[at], at, source, through, route.time, here, unbounded, latency):
                key = (chain.source, chain.sink, chain.loops)
                found[key] = _longest(found[key], chain) if key in found else chain
            passed = (*route.passed, frozenset(here))
            pending += _next_stages(
                flow, _Route((*route.stages, at), passed, through, route.time, route.unbounded), here, unbounded
            )
    return list(found.values()), True


def _longest(one: Chain, other: Chain) -> Chain:
    """The longest times of two chains along the same loops."""
    return replaced(
        one,
        reaction=None if one.reaction is None or other.reaction is None else max(one.reaction, other.reaction),
        age=None if one.age is None or other.age is None else max(one.age, other.age),
        unbounded=other.unbounded if other.age is None and one.age is not None else one.unbounded or other.unbounded,
    )


def _unbounded_in_sample(
    flow: ValueFlow,
    stage: Stage,
    at: int,
    entries: Mapping[Location, _Unbounded],
    here: Mapping[Location, int],
) -> dict[Location, _Unbounded]:
    """For each location that a value passes in a sample, why the times until there may have no bound."""
    found: dict[Location, _Unbounded] = {}
    pending = sorted(entries.items(), key=lambda entry: entry[0])
    while pending:
        location, before = pending.pop()
        if location not in stage.certain:
            before = before.also(_Unbounded(reaction=_not_each(flow, location)))
        known = found.get(location)
        merged = before if known is None else known.also(before)
        if merged == known:
            continue
        found[location] = merged
        for hop in flow.hops(at, location):
            if hop.in_sample and hop.location in here:
                pending.append((hop.location, merged.also(_unbounded_hop(flow, at, location, hop))))
    return found


def _unbounded_hop(flow: ValueFlow, at: int, location: Location, hop: Hop) -> _Unbounded:
    if hop.kept is not None:
        name = hop.kept.rpartition(".")[2]
        reason = f"a value may stay in `{name}` without bound: it is not certain to be replaced in each sample"
        advice = f"write `{name}` in each sample, on every path"
        old = Refusal(hop.kept, reason, flow.span_at(location), advice)
        return _Unbounded(old, old)
    for net in sorted(flow.move_at(location).writes & flow.move_at(hop.location).reads):
        if flow.is_written_elsewhere(at, location, net):
            return _Unbounded(reaction=_replaced(flow, location, net))
    return _Unbounded()


def _not_each(flow: ValueFlow, location: Location) -> Refusal:
    net = min(flow.move_at(location).writes, default="")
    reason = "a change may be seen later without bound: not each sample is certain to be passed on here"
    return Refusal(net, reason, flow.span_at(location), "pass the value on in each sample, on every path")


def _replaced(flow: ValueFlow, location: Location, net: str) -> Refusal:
    name = net.rpartition(".")[2]
    reason = f"a change may be seen later without bound: another value may replace it in `{name}` in the same sample"
    return Refusal(net, reason, flow.span_at(location), f"write `{name}` once in each sample")


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
    at: int,
    source: str,
    through: tuple[str, ...],
    time: int,
    here: Mapping[Location, int],
    unbounded: Mapping[Location, _Unbounded],
    latency: Latency,
) -> Iterator[Chain]:
    """The chains that end at an output of a stage."""
    for location, waited in sorted(here.items()):
        for net in sorted(flow.move_at(location).writes):
            found = latency(net, stage.period, stage.response + waited, net in stage.steady)
            if found is not None:
                age, delay = found
                why = unbounded[location]
                if flow.is_written_elsewhere(at, location, net):
                    why = why.also(_Unbounded(reaction=_replaced(flow, location, net)))
                yield Chain(
                    _short(source),
                    _short(net),
                    through,
                    None if why.reaction else time + stage.period + delay,
                    None if why.age else time + age,
                    why.age or why.reaction,
                )


def _next_stages(
    flow: ValueFlow, route: _Route, here: Mapping[Location, int], unbounded: Mapping[Location, _Unbounded]
) -> Iterator[tuple[_Route, int, frozenset[Location]]]:
    """The stages that take the value at another sample."""
    at = route.stages[-1]
    known = {
        (one, location) for one, locations in zip(route.stages, route.passed, strict=True) for location in locations
    }
    entries: dict[int, set[Location]] = {}
    longest: dict[int, int] = {}
    reasons: dict[int, _Unbounded] = {}
    for location, waited in here.items():
        for hop in flow.hops(at, location):
            why = unbounded[location].also(_unbounded_hop(flow, at, location, hop))
            # A kept value of any age may come by another way to where it has been.
            is_older = why.age is not None and route.unbounded.age is None and not hop.in_sample
            if (hop.to, hop.location) not in known or is_older:
                reasons[hop.to] = reasons.get(hop.to, _Unbounded()).also(why)
                entries.setdefault(hop.to, set()).add(hop.location)
                longest[hop.to] = max(longest.get(hop.to, 0), waited + hop.waits)
    for to in sorted(entries):
        later = replaced(route, time=route.time + longest[to], unbounded=reasons[to])
        yield later, to, frozenset(entries[to])


def _name(flow: ValueFlow, loop: str, here: Iterable[Location]) -> str:
    """The name of the loop, or of a law in it if the value does not pass the law that the loop is named after."""
    # Places are numbered from the last to the first.
    laws = [leaf for location in sorted(here, reverse=True) if (leaf := flow.law_at(location))]
    return _short(loop if loop in laws or not laws else laws[0])


def _short(path: str) -> str:
    return path.partition(".")[2] or path
