"""From inputs to outputs through loops that pass values on: how long a change takes, and how old a value may be.

Within a loop a value goes from its sample to its output. From loop to loop it is passed on by a variable or a channel, and the next loop takes it up
at one of its own samples: at most a period and its response later (Davare and others, Period optimization for hard real-time
distributed automotive systems, 2007).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cspdiag.analyses.timing.result import Chain, LoopTiming
from cspdiag.network.actions import Action, ChannelEnd, PortEnd
from cspdiag.network.ir import Network, ProcessClass
from cspdiag.network.walk import parts

LARGEST_NUMBER_OF_CHAINS = 1000


def chains(
    network: Network,
    loops: Sequence[LoopTiming],
    modes: Sequence[tuple[int, int]],
    branches: Sequence[Sequence[tuple[str, Action]]],
) -> Iterator[Chain]:
    """All chains from a sampled input to an output. ``modes`` has of each loop its thread and its cycle there: of two cycles of a
    thread one follows the other, so that nothing is passed on while both run. ``branches`` has of each loop the branches that its threads run.
    """
    own = [branch for branch, loop in zip(branches, loops, strict=True) if loop.response is not None]
    usable = [loop for loop in loops if loop.response is not None]
    mode = [mode for mode, loop in zip(modes, loops, strict=True) if loop.response is not None]
    reads, writes = _ends(network, usable, own)
    periods = {net.path: net.period for net in network.nets if net.external is not None}
    top = f"{network.top}."
    found = 0
    for first in range(len(usable)):
        for source in sorted(net for net in reads[first] if periods.get(net)):
            pending: list[tuple[int, ...]] = [(first,)]
            while pending and found < LARGEST_NUMBER_OF_CHAINS:
                way = pending.pop()
                last = usable[way[-1]]
                passed = sum(usable[k].period + (usable[k].response or 0) for k in way[:-1])
                if last.latency is not None:
                    for sink in last.outputs:
                        found += 1
                        names = tuple(usable[k].name for k in way)
                        age = passed + last.latency[1]
                        yield Chain(source.removeprefix(top), sink, names, age + last.period, age)
                pending += [
                    (*way, k)
                    for k in range(len(usable))
                    if k not in way
                    and (mode[k][0] != mode[way[-1]][0] or mode[k] == mode[way[-1]])
                    and (writes[way[-1]] & reads[k]) - set(periods)
                ]


def _ends(
    network: Network, loops: Sequence[LoopTiming], branches: Sequence[Sequence[tuple[str, Action]]]
) -> tuple[list[set[str]], list[set[str]]]:
    """The nets that each loop reads and writes: those of its laws and processes, and those that processes copy into variables of its laws."""
    from cspdiag.analyses.timing.copies import copied_nets

    copied = copied_nets(network)
    elsewhere = _Elsewhere(network)
    reads: list[set[str]] = []
    writes: list[set[str]] = []
    for loop, own in zip(loops, branches, strict=True):
        others = elsewhere.of(own)
        read, written = (
            {
                net.path
                for net in network.nets
                for end, _ in (net.readers if reading else net.writers)
                if end in loop.leaves and (end, net.path) not in others
            }
            for reading in (True, False)
        )
        reads.append(read | {source for source, targets in copied.items() if targets & read})
        writes.append(written)
    return reads, writes


class _Elsewhere:
    """What the processes of some threads do in branches that other threads run."""

    def __init__(self, network: Network) -> None:
        self._net_of = {end: net.path for net in network.nets for end in (*net.writers, *net.readers)}
        self._classes = {entry.name: entry for entry in network.classes}
        self._instances = {instance.path: instance for instance in network.instances}

    def of(self, branches: Sequence[tuple[str, Action]]) -> set[tuple[str, str]]:
        """Processes, each with the path of a net that it uses outside of these branches only."""
        found: set[tuple[str, str]] = set()
        for process in {process for process, _ in branches}:
            entry = self._classes[self._instances[process].class_name]
            assert isinstance(entry, ProcessClass)
            here = [self._used(process, action) for path, action in branches if path == process]
            found |= {(process, net) for net in self._used(process, entry.body) - set().union(*here)}
        return found

    def _used(self, process: str, action: Action | None) -> set[str]:
        from cspdiag.analyses.timing.copies import net_path

        ends = [part for part in parts(action) if isinstance(part, PortEnd | ChannelEnd)]
        return {net for end in ends if (net := net_path(process, end, self._net_of)) is not None}
