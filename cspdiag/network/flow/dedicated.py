"""Which channels have one task at each end throughout a run.

A task is what the scheduler resumes: the outermost process, a branch of a parallel or the body of an interrupt, with
all that runs in sequence in it.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import Literal, TypeAlias

from cspdiag.base.graphs import reached
from cspdiag.base.record import kept_for_same
from cspdiag.network.elaborate.fewer.continued import continued
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.external import external_bodies
from cspdiag.network.ir.network import ConstantEnd, DiscardEnd, Medium, Network, ProcessClass, SubmodelClass
from cspdiag.network.ir.walk import actions_inside

Place: TypeAlias = "tuple[str, str, int | None]"
"""A channel of a process class, or a port of it with the index in an array of ports."""

Use: TypeAlias = "tuple[Place, Literal['reads', 'writes']]"


def place_of(process: str, end: ir.End) -> Place:
    """The place of an end in a process class."""
    return (process, end.port, end.index) if isinstance(end, ir.PortEnd) else (process, end.channel, None)


@kept_for_same(1)
def dedicated_places(network: Network) -> frozenset[Place]:
    """The rendezvous channels, without guards, of which one task uses each end, and the ports that are connected to
    none but these. All ports of a class are specialized.

    An instance runs in one task at a time, and counts as one. A program with processes or laws in other languages has
    none, since their values are not checked.
    """
    return frozenset(_dedicated_places(network))


@continued
def _dedicated_places(network: Network) -> tuple[Place, ...]:
    """The same in the order of the text."""
    if any(external_bodies(network.classes, ())):
        return ()
    places: dict[Place, None] = {}
    others: set[Place] = set()
    joined: defaultdict[Place, list[Place]] = defaultdict(list)
    laws = {entry.name for entry in network.classes if isinstance(entry, SubmodelClass)}
    for process in (entry for entry in network.classes if isinstance(entry, ProcessClass)):
        media = dict(_media(process))
        for place, medium in media.items():
            if _is_unguarded_rendezvous(medium):
                places[place] = None
            else:
                others.add(place)
        uses: Counter[Use] = Counter()
        for connected, outer, use in _connections(process, network):
            uses[outer, use] += 1
            joined[connected].append(outer)
            joined[outer].append(connected)
            if connected[0] in laws:
                others.add(outer)
        for task in _tasks(process.body):
            uses.update(set(_uses(process.name, task)))
            others.update(_by_the_runtime(process.name, task, media))
        others.update(place for (place, _), count in uses.items() if count > 1)
    connected_to_others = set(reached(others, joined.__getitem__))
    return tuple(place for place in places if place not in connected_to_others)


def _is_unguarded_rendezvous(medium: Medium) -> bool:
    return medium.kind == "sync" and not medium.guarded_reads and not medium.guarded_writes


def _media(process: ProcessClass) -> Iterator[tuple[Place, Medium]]:
    for channel in process.channels:
        medium = Medium(channel.kind, channel.guarded_reads, channel.guarded_writes)
        yield (process.name, channel.name, None), medium
    for port in process.ports:
        for index, medium in enumerate(port.media):
            yield (process.name, port.name, None if port.size is None else index), medium


def _connections(process: ProcessClass, network: Network) -> Iterator[tuple[Place, Place, Literal["reads", "writes"]]]:
    """The port of each instance, what it is connected to, and whether it reads there or writes."""
    directions: dict[str, dict[str, str]] = {}
    for instance in process.instances:
        name = instance.class_name
        if name not in directions:
            directions[name] = {port.name: port.direction for port in network.class_named(name).ports}
        for connection in instance.connections:
            if not isinstance(connection.attachment, ConstantEnd | DiscardEnd):
                inner = (name, connection.port, connection.index)
                use: Literal["reads", "writes"] = "reads" if directions[name][connection.port] == "in" else "writes"
                yield inner, place_of(process.name, connection.attachment), use


def _tasks(body: ir.Action | None) -> Iterator[list[ir.Action]]:
    """The actions of each task that the composition of a process consists of, without those of instances, and without
    tasks that only run one.
    """
    roots = [] if body is None else [body]
    for root in roots:
        task = []
        pending = [root]
        while pending:
            action = pending.pop()
            task.append(action)
            match action:
                case ir.ParallelSteps(steps=steps):
                    roots += [step for step in steps if not isinstance(step, ir.RunInstance)]
                case ir.InterruptOn(body=interrupted, branch=branch):
                    roots.append(interrupted)
                    pending.append(branch.body)
                case _:  # Any other action runs what is inside it in the same task.
                    pending += actions_inside(action)
        yield task


def _uses(process: str, task: Sequence[ir.Action]) -> Iterator[Use]:
    """The ends at which a task itself communicates, other than by guards."""
    for action in task:
        match action:
            case ir.ReadValue(source=source):
                yield (place_of(process, source), "reads")
            case ir.ReadInputs(reads=reads):
                for read in reads:
                    yield (place_of(process, read.source), "reads")
            case ir.WriteValue(sink=sink):
                yield (place_of(process, sink), "writes")
            case ir.WriteOutputs(writes=writes):
                for write in writes:
                    yield (place_of(process, write.sink), "writes")
            case _:  # No other action communicates, other than by guards.
                pass


def _by_the_runtime(process: str, task: Sequence[ir.Action], media: Mapping[Place, Medium]) -> Iterator[Place]:
    """The ends of laws that wait in a rendezvous and at something else at once, which is left to the runtime."""
    for action in task:
        ends: list[ir.End] = []
        match action:
            case ir.ReadInputs(reads=reads):
                ends = [read.source for read in reads]
            case ir.WriteOutputs(writes=writes):
                ends = [write.sink for write in writes]
            case _:  # No other action communicates at several ends.
                pass
        places = [place_of(process, end) for end in ends]
        if len(places) > 1 and not all(_is_in_place(media[place]) for place in places):
            yield from places


def _is_in_place(medium: Medium) -> bool:
    """Whether an access is a rendezvous without guards of writers, or no communication."""
    return medium.kind in ("var", "constant", "discard") or (medium.kind == "sync" and not medium.guarded_writes)
