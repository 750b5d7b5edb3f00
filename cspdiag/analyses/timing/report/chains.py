"""From inputs to outputs through loops that pass values on: how long a change takes, and how old a value may be.

Within a sample of a loop a value goes from law to law and to the outputs. What a law computes before it is handed what
it computes with, and what another loop computes, is a sample later: a value lies in a variable or a channel until it is
taken up at one of the samples of who reads it, at most a period and a response of who writes it (Davare and others,
Period optimization for hard real-time distributed automotive systems, 2007).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from cspdiag.analyses.timing.flow.value_flow import Passing, Spot, Stage
from cspdiag.analyses.timing.result import Chain
from cspdiag.base.record import record, replaced

LARGEST_NUMBER_OF_WAYS = 10_000
"""Ways from loop to loop that are followed; of programs with more of them some chains are left out."""

Latency = Callable[[str, int, int], "tuple[int, int] | None"]
"""Of an output, by its net, the age and the delay of what a loop of a period and a response writes to it; None if it is
none.
"""


@record
class _Way:
    """A value on its way: the stages in which it was, each with what it passed there, their names, and the time until
    the next one has taken it up.
    """

    stages: tuple[int, ...] = ()
    passed: tuple[frozenset[Spot], ...] = ()
    names: tuple[str, ...] = ()
    time: int = 0


def chains(
    passing: Passing, stages: Sequence[Stage], names: Sequence[str], latency: Latency
) -> tuple[list[Chain], bool]:
    """The chains from sampled inputs to outputs, and whether these are all. ``names`` are the paths of the loops."""
    found: dict[tuple[str, str, tuple[str, ...]], Chain] = {}
    looked = 0
    for first, source in _sources(passing, stages):
        entries = frozenset(spot for spot in stages[first].spots if source in passing.move(spot).reads)
        pending = [(_Way(), first, entries)]
        while pending:
            if looked == LARGEST_NUMBER_OF_WAYS:
                return list(found.values()), False
            looked += 1
            way, at, entries = pending.pop()
            here = _in_sample(passing, at, entries)
            through = (*way.names, _name(passing, names[at], here))
            for chain in _ends(passing, stages[at], source, through, way.time, here, latency):
                key = (chain.source, chain.sink, chain.loops)
                if key not in found or found[key].reaction < chain.reaction:
                    found[key] = chain
            pending += _further(
                passing, _Way((*way.stages, at), (*way.passed, frozenset(here)), through, way.time), here
            )
    return list(found.values()), True


def _sources(passing: Passing, stages: Sequence[Stage]) -> Iterator[tuple[int, str]]:
    for k, stage in enumerate(stages):
        read = {net for spot in stage.spots - stage.taken for net in passing.move(spot).reads}
        yield from ((k, net) for net in sorted(read) if passing.periods.get(net) == stage.period)


def _in_sample(passing: Passing, at: int, entries: frozenset[Spot]) -> dict[Spot, int]:
    """The spots that a value passes in one sample of a stage, each with the time that it may have lain in channels
    meanwhile.
    """
    known: dict[tuple[Spot, tuple[Spot, ...]], int] = {}
    pending: list[tuple[Spot, tuple[Spot, ...], int]] = [(spot, (), 0) for spot in sorted(entries)]
    while pending:
        spot, left, waited = pending.pop()
        if known.get((spot, left), -1) >= waited:
            continue
        known[spot, left] = waited
        for hop in passing.hops(at, spot):
            if hop.in_sample and _is_in_time(passing, at, left, hop.spot):
                others = (*left, spot) if hop.spot[0] != spot[0] else left
                pending.append((hop.spot, tuple(part for part in others if part[0] != hop.spot[0]), waited + hop.waits))
    here: dict[Spot, int] = {}
    for (spot, _), waited in known.items():
        here[spot] = max(waited, here.get(spot, 0))
    return here


def _is_in_time(passing: Passing, at: int, left: tuple[Spot, ...], spot: Spot) -> bool:
    """Whether a value that comes back to a thread comes before what is done there next; ``left`` are the spots at which
    it left threads.
    """
    return all(part != spot and passing.is_in_order(at, part, spot) for part in left if part[0] == spot[0])


def _ends(
    passing: Passing,
    stage: Stage,
    source: str,
    through: tuple[str, ...],
    time: int,
    here: Mapping[Spot, int],
    latency: Latency,
) -> Iterator[Chain]:
    """The chains that end with an output of a stage."""
    for spot, waited in sorted(here.items()):
        for net in sorted(passing.move(spot).writes):
            found = latency(net, stage.period, stage.response + waited)
            if found is not None:
                age, delay = found
                yield Chain(_short(source), _short(net), through, time + stage.period + delay, time + age)


def _further(passing: Passing, way: _Way, here: Mapping[Spot, int]) -> Iterator[tuple[_Way, int, frozenset[Spot]]]:
    """Where a value is taken up next, at another sample."""
    at = way.stages[-1]
    known = {(one, spot) for one, spots in zip(way.stages, way.passed, strict=True) for spot in spots}
    entries: dict[int, set[Spot]] = {}
    longest: dict[int, int] = {}
    for spot, waited in here.items():
        for hop in passing.hops(at, spot):
            if (hop.to, hop.spot) not in known:
                entries.setdefault(hop.to, set()).add(hop.spot)
                longest[hop.to] = max(longest.get(hop.to, 0), waited + hop.waits)
    for to in sorted(entries):
        yield replaced(way, time=way.time + longest[to]), to, frozenset(entries[to])


def _name(passing: Passing, loop: str, here: Iterable[Spot]) -> str:
    """That of the loop, or of a law in it if the value does not pass the law that the loop is named after."""
    # Places are numbered from the last to the first.
    laws = [leaf for spot in sorted(here, reverse=True) if (leaf := passing.leaf(spot))]
    return _short(loop if loop in laws or not laws else laws[0])


def _short(path: str) -> str:
    return path.partition(".")[2] or path
