"""From inputs to outputs through loops that pass values on: how long a change takes, and how old a value may be.

Within a loop a value goes from its sample to its output. From loop to loop it is passed on by a variable or a channel, and the next loop takes it up
at one of its own samples: at most a period and its response later (Davare and others, Period optimization for hard real-time
distributed automotive systems, 2007).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence

from cspdiag.analyses.timing.result import Chain, LoopTiming
from cspdiag.network.actions import Action, ChannelEnd, PortEnd
from cspdiag.network.ir import Network, ProcessClass
from cspdiag.network.walk import parts

LARGEST_NUMBER_OF_WAYS = 10_000
"""Ways from loop to loop that are followed; of programs with more of them some chains are left out."""


def chains(
    network: Network,
    loops: Sequence[LoopTiming],
    modes: Sequence[tuple[int, int]],
    branches: Sequence[Sequence[tuple[str, Action]]],
) -> tuple[list[Chain], bool]:
    """The chains from sampled inputs to outputs, and whether these are all. ``modes`` has of each loop its thread and its cycle there: of two cycles of a
    thread one follows the other, so that nothing is passed on while both run. ``branches`` has of each loop the branches that its threads run.
    """
    own = [branch for branch, loop in zip(branches, loops, strict=True) if loop.response is not None]
    usable = [loop for loop in loops if loop.response is not None]
    mode = [mode for mode, loop in zip(modes, loops, strict=True) if loop.response is not None]
    reads, writes = _ends(network, usable, own)
    periods = {net.path: net.period for net in network.nets if net.external is not None}
    readers: dict[str, list[int]] = defaultdict(list)
    for k, read in enumerate(reads):
        for net in read - set(periods):
            readers[net].append(k)
    following = [
        sorted({k for net in written for k in readers.get(net, ()) if mode[k][0] != own_mode[0] or mode[k] == own_mode})
        for written, own_mode in zip(writes, mode, strict=True)
    ]
    top = f"{network.top}."
    found: list[Chain] = []
    ways = 0
    for first in range(len(usable)):
        for source in sorted(net for net in reads[first] if periods.get(net)):
            pending: list[tuple[int, ...]] = [(first,)]
            while pending:
                if ways == LARGEST_NUMBER_OF_WAYS:
                    return found, False
                ways += 1
                way = pending.pop()
                found += _along(source.removeprefix(top), [usable[k] for k in way])
                pending += [(*way, k) for k in following[way[-1]] if k not in way]
    return found, True


def _along(source: str, loops: Sequence[LoopTiming]) -> Iterator[Chain]:
    """The chains that end with the last of some loops."""
    *passing, last = loops
    if last.latency is not None:
        age = sum(loop.period + (loop.response or 0) for loop in passing) + last.latency[1]
        for sink in last.outputs:
            yield Chain(source, sink, tuple(loop.name for loop in loops), age + last.period, age)


def _ends(
    network: Network, loops: Sequence[LoopTiming], branches: Sequence[Sequence[tuple[str, Action]]]
) -> tuple[list[set[str]], list[set[str]]]:
    """The nets that each loop reads and writes: those of its laws and processes, and those that processes copy into variables of its laws."""
    from cspdiag.analyses.timing.copies import copied_nets

    sources: dict[str, set[str]] = defaultdict(set)
    for source, targets in copied_nets(network).items():
        for target in targets:
            sources[target].add(source)
    read_by: dict[str, set[str]] = defaultdict(set)
    written_by: dict[str, set[str]] = defaultdict(set)
    for net in network.nets:
        for path, _ in net.readers:
            read_by[path].add(net.path)
        for path, _ in net.writers:
            written_by[path].add(net.path)
    narrowed = _Narrowed(network)
    reads: list[set[str]] = []
    writes: list[set[str]] = []
    for loop, own in zip(loops, branches, strict=True):
        read: set[str] = set().union(*(narrowed.to(own, leaf, read_by) for leaf in loop.leaves))
        reads.append(read.union(*(sources.get(net, ()) for net in read)))
        writes.append(set().union(*(narrowed.to(own, leaf, written_by) for leaf in loop.leaves)))
    return reads, writes


class _Narrowed:
    """The nets that leaves use; of a process with branches that different threads run, those that it uses in some of them."""

    def __init__(self, network: Network) -> None:
        self._net_of = {end: net.path for net in network.nets for end in (*net.writers, *net.readers)}
        self._classes = {entry.name: entry for entry in network.classes}
        self._instances = {instance.path: instance for instance in network.instances}
        self._everywhere: dict[tuple[str, int], set[str]] = {}

    def to(self, branches: Sequence[tuple[str, Action]], leaf: str, used_by: Mapping[str, set[str]]) -> set[str]:
        """The nets that a leaf uses in these branches."""
        nets = used_by.get(leaf, set())
        here = [action for process, action in branches if process == leaf]
        if not nets or not here:
            return nets
        key = leaf, id(used_by)
        if key not in self._everywhere:
            entry = self._classes[self._instances[leaf].class_name]
            assert isinstance(entry, ProcessClass)
            self._everywhere[key] = nets - self._nets(leaf, entry.body)
        return self._everywhere[key].union(*(self._nets(leaf, action) & nets for action in here))

    def _nets(self, process: str, action: Action | None) -> set[str]:
        from cspdiag.analyses.timing.copies import net_path

        ends = [part for part in parts(action) if isinstance(part, PortEnd | ChannelEnd)]
        return {net for end in ends if (net := net_path(process, end, self._net_of)) is not None}
