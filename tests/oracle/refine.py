"""Whether every sequence of communications at the ports of one program is one of another's, with exact values.

The specification may run its parallel processes communication by communication, in any order; times count in either, but
in the sequences they do not. What the environment offers comes from the domains of the ports, at any time.
"""

from __future__ import annotations

from collections import deque

from tests.oracle.explore import Graph, explore
from tests.oracle.properties import Answer
from tests.oracle.tree import Program

Event = tuple[str, object]


def refines(program: Program, specification: Program, *, limit: int = 6000) -> Answer:
    """Trace refinement at the ports of the specification that the program has, too."""
    common = {port.name for port in program.ports}
    theirs = explore(specification, limit=limit, fine=True)
    ours = explore(program, limit=limit)
    if not theirs.complete:
        return Answer(None, why="the specification is too large")

    def theirs_end(index: int) -> bool:
        return theirs.states[index].ended is not None or not theirs.edges[index]

    first = _closure(theirs, frozenset({0}), common)
    seen = {(0, first)}
    queue: deque[tuple[int, frozenset[int], tuple[Event, ...]]] = deque([(0, first, ())])
    while queue:
        at, allowed, done = queue.popleft()
        for edge in ours.edges[at]:
            after, trace = allowed, done
            for event in edge.visible:
                trace = (*trace, event)
                after = _after(theirs, after, event, common)
                if not after:
                    shown = [f"{port} {value}" for port, value in trace]
                    return Answer(
                        False, shown, len(seen), f"the specification does not do the last of {', '.join(shown)}"
                    )
            if (edge.to, after) not in seen:
                seen.add((edge.to, after))
                queue.append((edge.to, after, trace))
                if len(seen) > 20 * limit:
                    return Answer(None, states=len(seen), why="too large")
    ends = any(ours.states[at].ended == "terminated" and not any(map(theirs_end, allowed)) for at, allowed in seen)
    return Answer(True if ours.complete and not ends else None, states=len(seen))


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
