"""Whether every sequence of communications at the ports of one program is one of another's, with exact values; and its
failures.

The specification may run its parallel processes communication by communication, in any order; times count in either,
but not in the sequences. What the environment offers is from the domains of the ports, at any time. Ports that the
specification does not have are hidden.
"""

from __future__ import annotations

import time
from collections import deque

from tests.oracle.explore import Graph, explore
from tests.oracle.programs.tree import Alt, Comp, Interrupt, Par, Program, Write, walk
from tests.oracle.properties import Answer

Event = tuple[str, object]


def refines(program: Program, specification: Program, *, failures: bool = False, limit: int = 6000) -> Answer:
    """Refinement at the ports of the specification: of traces, or also of stable failures."""
    common = {port.name for port in program.ports} & {port.name for port in specification.ports}
    theirs = explore(specification, limit=limit, fine=True)
    if not theirs.complete:
        return Answer(None)
    ours = explore(program, limit=limit)
    left_open = "what is refused while an output is about to be written" if failures and _mixed(specification) else ""
    first = _closure(theirs, frozenset({0}), common)
    seen = {(0, first)}
    known: dict[tuple[frozenset[int], Event], frozenset[int]] = {}
    end = time.process_time() + 1
    queue: deque[tuple[int, frozenset[int], tuple[Event, ...]]] = deque([(0, first, ())])
    while queue:
        at, allowed, done = queue.popleft()
        why = _end(ours, at, theirs, allowed)
        mine = accepted(ours, at, common) if failures else None
        if not why and mine is not None and not any(_within(theirs, index, mine, common) for index in allowed):
            why = f"it accepts only {sorted(mine)}, and its specification more, or the end"
        if why:
            return Answer(False, [f"{port} {value}" for port, value in done], len(seen), why)
        for edge in ours.edges[at]:
            after, trace = allowed, done
            for event in edge.visible:
                if event[0] not in common:
                    continue
                trace = (*trace, event)
                if (after, event) not in known:
                    known[after, event] = _after(theirs, after, event, common)
                after = known[after, event]
                if not after:
                    shown = [f"{port} {value}" for port, value in trace]
                    return Answer(
                        False, shown, len(seen), f"the specification does not do the last of {', '.join(shown)}"
                    )
            if (edge.to, after) not in seen:
                seen.add((edge.to, after))
                queue.append((edge.to, after, trace))
        if time.process_time() > end:
            return Answer(None, states=len(seen))
    return Answer(True if ours.complete and not left_open else None, states=len(seen), why=left_open)


def _end(ours: Graph, at: int, theirs: Graph, allowed: frozenset[int]) -> str:
    """The program ends only where its specification may end."""
    if ours.states[at].ended != "terminated" or any(theirs.states[index].ended is not None for index in allowed):
        return ""
    return "it ends, but its specification continues"


def accepted(graph: Graph, index: int, common: set[str]) -> set[str] | None:
    """The inputs at which a program at rest takes an event; None if it continues by itself, or has ended."""
    st = graph.states[index]
    if st.ended is not None or graph.machine.candidates(st) or graph.machine.clock.dues(st) or st.latches:
        return None
    found = graph.machine.awaited(st) & graph.linked.ports.keys()
    return found if found <= common else None  # what arrives at hidden ports is not waited for


def _within(graph: Graph, index: int, inputs: set[str], common: set[str]) -> bool:
    found = accepted(graph, index, common)
    return found is not None and found <= inputs


def _mixed(program: Program) -> bool:
    """Whether a program may write an output or do something else instead.

    While a process writes it is not at rest, so the page does not say what it refuses then.
    """
    outputs = {port.name for port in program.ports if not port.input}

    def writes(part: Comp) -> bool:
        if isinstance(part, Alt):
            return any(isinstance(each.event, Write) and each.event.channel in outputs for each in part.branches)
        return isinstance(part, Par | Interrupt)

    return any(map(writes, walk(program.body)))


def _closure(graph: Graph, states: frozenset[int], common: set[str]) -> frozenset[int]:
    found, todo = set(states), list(states)
    while todo:
        for edge in graph.edges[todo.pop()]:
            if edge.to not in found and not any(port in common for port, _ in edge.visible):
                found.add(edge.to)
                todo.append(edge.to)
    return frozenset(found)


def _after(graph: Graph, states: frozenset[int], event: Event, common: set[str]) -> frozenset[int]:
    reached: set[int] = set()
    for index in states:
        for edge in graph.edges[index]:
            if [each for each in edge.visible if each[0] in common] == [event]:
                reached.add(edge.to)
    return _closure(graph, frozenset(reached), common)
