"""All runs of a small program, by search over its states with exact values and exact time."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Hashable, Iterator
from dataclasses import dataclass, field

from tests.oracle.machine.link import Linked, link
from tests.oracle.machine.machine import Machine
from tests.oracle.machine.policy import from_table
from tests.oracle.machine.state import Choice, Delay, Joint, Offer, Op, State, Thread, Tid
from tests.oracle.programs.tree import Law, Port, Program, Value


class Chooser:
    """Takes the answers to open questions from a list, and records how many answers each had."""

    def __init__(self, free: bool, wcet: bool, general: bool, fine: bool) -> None:
        self.fine = fine
        self.free = free
        self.wcet = wcet
        self.general = general
        self.prefix: list[int] = []
        self.arity: list[int] = []
        self.made: list[tuple[str, Value, bool]] = []
        self.anytime = False

    def begin(self, prefix: list[int]) -> None:
        self.prefix, self.arity, self.made = prefix, [], []

    def choose(self, count: int) -> int:
        self.arity.append(count)
        position = len(self.arity) - 1
        return self.prefix[position] if position < len(self.prefix) else 0

    def compute(self, law: Law) -> int:
        if not self.wcet or not law.wcet:
            return 0
        return (law.wcet, 0, law.wcet // 2)[self.choose(3)]

    def sample(self, port: Port, now: int) -> Value:
        if not self.general:
            return from_table(port, now)
        return port.domain[self.choose(len(port.domain))]

    def event(self, port: Port, now: int, last: Value) -> Value | None:
        if not self.general:
            value = from_table(port, now)
            return None if value == last else value
        others = [value for value in port.domain if self.free or value != last]
        chosen = self.choose(len(others) + 1)
        return others[chosen - 1] if chosen else None

    def before(self, port: Port) -> Value | None:
        """An event arrives when it is checked for, or when something waits for it: at any other time it makes no
        difference.
        """
        if not self.anytime:
            return None
        chosen = self.choose(len(port.domain) + 1)
        return port.domain[chosen - 1] if chosen else None

    def passed(self, channel: str, value: Value, external: bool) -> None:
        self.made.append((channel, value, external))

    def following(self) -> Iterator[list[int]]:
        """The prefixes that differ from the last run after its own prefix."""
        done = self.prefix + [0] * (len(self.arity) - len(self.prefix))
        for position in range(len(self.prefix), len(self.arity)):
            for other in range(1, self.arity[position]):
                yield [*done[:position], other]


@dataclass(slots=True)
class Edge:
    to: int
    passes: bool  # time advances
    made: tuple[tuple[str, Value, bool], ...]
    what: str
    written: tuple[tuple[str, Value], ...] = ()  # to external outputs, including latched ones
    moved: frozenset[Tid] = frozenset()  # the threads that moved on
    visible: tuple[tuple[str, Value], ...] = ()  # reads and writes at external ports, in their order
    outside: bool = False  # the environment offers an event, or time advances; no thread ran

    @property
    def silent(self) -> bool:
        return (
            not self.outside
            and not self.passes
            and not self.written
            and not any(external for _, _, external in self.made)
        )


@dataclass
class Graph:
    linked: Linked
    machine: Machine
    states: list[State] = field(default_factory=list)
    edges: list[list[Edge]] = field(default_factory=list)
    parents: list[tuple[int, Edge] | None] = field(default_factory=list)
    complete: bool = True  # otherwise it was too large

    def path(self, index: int) -> list[str]:
        """The steps from the start to a state."""
        steps: list[str] = []
        while (parent := self.parents[index]) is not None:
            index, edge = parent
            steps.append(edge.what)
        return steps[::-1]


def explore(
    program: Program,
    *,
    free: bool = True,
    wcet: bool = False,
    general: bool = True,
    limit: int = 4000,
    seconds: float = 1,
    fine: bool = False,
) -> Graph:
    """The states that can be reached, at most `limit` of them.

    `free`: any ready process of the highest priority may run, and any ready guard of `[]` may be chosen; otherwise as
    the page says. `fine`: others may run after each communication, which a specification allows. `wcet`: laws compute
    for no time, their longest time or half of it. `general`: the environment may offer anything.
    """
    linked = link(program)
    chooser = Chooser(free, wcet, general, fine)
    machine = Machine(linked, chooser)
    graph = Graph(linked, machine)
    known: dict[Hashable, int] = {}
    queue: deque[int] = deque()
    end = time.process_time() + seconds

    def add(st: State, parent: tuple[int, Edge] | None) -> int:
        place = key(linked, machine, st, free, general)
        if place not in known:
            known[place] = len(graph.states)
            graph.states.append(st)
            graph.edges.append([])
            graph.parents.append(parent)
            queue.append(known[place])
        return known[place]

    add(machine.start(), None)
    while queue:
        if len(graph.states) > limit or time.process_time() > end:
            graph.complete = False
            break
        index = queue.popleft()
        for st, edge in _successors(machine, chooser, graph.states[index], free):
            edge.to = add(st, (index, edge))
            graph.edges[index].append(edge)
    return graph


def _successors(machine: Machine, chooser: Chooser, st: State, free: bool) -> Iterator[tuple[State, Edge]]:
    """The states that follow, with edges whose end is not known yet."""
    if st.ended is not None:
        return
    chooser.anytime = free and machine.clock.grid is None
    if chooser.anytime:
        yield from _events(machine, st, machine.awaited(st) & machine.linked.ports.keys())
    candidates = machine.candidates(st)
    instant = None if candidates else machine.clock.next_instant(st)
    if not candidates and instant is None:
        return
    for tid in (candidates if free else candidates[:1]) if candidates else [None]:
        prefixes: list[list[int]] = [[]]
        while prefixes:
            after = st.copy()
            chooser.begin(prefixes.pop())
            machine.written.clear()
            machine.visible.clear()
            if tid is None:
                assert instant is not None
                after.now = instant
                machine.clock.instant(after)
                what = f"at {after.now} ns"
            else:
                machine.run(after, tid)
                what = f"{_name(tid)} runs"
            prefixes += chooser.following()
            made = tuple(chooser.made)
            what += "".join(f", {channel} {value}" for channel, value, _ in made)
            moved = frozenset(tid for tid, thread in st.threads.items() if _moved(thread, after.threads.get(tid)))
            passes = after.now > st.now
            written, visible = tuple(machine.written), tuple(machine.visible)
            yield after, Edge(-1, passes, made, what, written, moved, visible, outside=tid is None)


def _events(machine: Machine, st: State, awaited: set[str]) -> Iterator[tuple[State, Edge]]:
    """Without a grid of the environment, any event may arrive at any time."""
    for port in machine.linked.program.ports:
        for value in port.domain if port.input and port.period is None and port.name in awaited else ():
            if st.events.get(port.name) != value:
                after = st.copy()
                machine.clock.bring(after, port, value)
                yield after, Edge(-1, False, (), f"{port.name} offers {value}", outside=True)


def _moved(before: Thread, after: Thread | None) -> bool:
    if after is None or before.wait is None or after.wait is None:
        return True
    return before.stack != after.stack or before.wait != after.wait


def _name(tid: tuple[tuple[int, int], ...]) -> str:
    return ".".join(str(branch) for _, branch in tid) or "root"


def key(linked: Linked, machine: Machine, st: State, free: bool, general: bool) -> Hashable:
    """A key that is equal for states from which the same runs begin: times count from now, arrivals by their order."""
    if st.ended is not None:
        return st.ended
    seqs: set[int] = set()
    for thread in st.threads.values():
        seqs |= set(_seqs(thread))
    rank = {seq: place for place, seq in enumerate(sorted(seqs))}

    clock, horizon = machine.clock, machine.clock.horizon

    def offer(each: Offer) -> Hashable:
        due = max(each.due - st.now, -1) if each.kind == "after" else 0
        return (*each[:3], horizon.seen(each.channel, each.value, st.now), due, rank[each.seq])

    def operation(op: Op) -> Hashable:
        value = horizon.seen(op.channel, op.value, st.now)
        return (*op[:2], value, rank[op.seq], *op[4:])

    def waiting(thread: Thread) -> Hashable:
        match thread.wait:
            case Joint(ops):
                return tuple(map(operation, ops))
            case Choice(node, offers):
                return (node, *map(offer, offers))
            case Delay(due, seq):
                return (max(due - st.now, -1), rank[seq])
            case other:
                return other

    threads = tuple(
        (
            tid,
            tuple(
                (*frame[:3], None if frame.offer is None else offer(frame.offer), *frame[4:]) for frame in thread.stack
            ),
            waiting(thread),
            thread.signal if thread.wait is None else None,
            thread.cancel,
        )
        for tid, thread in sorted(st.threads.items())
    )
    return (
        threads,
        frozenset(st.ready) if free else tuple(st.ready),
        tuple(horizon.seen(name, st.variables[name], st.now) for name in linked.variables),
        tuple(
            (name, *(horizon.seen(name, value, st.now) for value in held)) for name, held in sorted(st.buffers.items())
        ),
        tuple(sorted(st.laws.items())),
        None if free else tuple(sorted(st.chosen.items())),
        tuple(sorted(st.sessions.items())),
        tuple(sorted(st.samples.items())),
        tuple(sorted(st.offered.items())) if clock.grid else None,
        tuple(sorted(st.events.items())),
        tuple(sorted(st.latches.items())),
        st.running,
        st.now % clock.whole,
        0 if general else min(st.now, clock.last + clock.whole),
        min(st.now, horizon.instant),
        st.missed,
        st.timeout,
    )


def _seqs(thread: Thread) -> Iterator[int]:
    match thread.wait:
        case Joint(ops):
            yield from (op.seq for op in ops)
        case Choice(_, offers):
            yield from (offer.seq for offer in offers)
        case Delay(_, seq):
            yield seq
    yield from (frame.offer.seq for frame in thread.stack if frame.offer is not None)
