"""Properties of a program: deadlock free, livelock free, terminates, schedulable."""

from __future__ import annotations

from dataclasses import dataclass, field

from tests.oracle.explore import Graph, explore
from tests.oracle.machine.state import Tid
from tests.oracle.programs.tree import Program
from tests.oracle.stuck import stuck, waits_for_others


@dataclass
class Answer:
    """`holds` is None if the exploration was too large, and nothing was found in the explored part."""

    holds: bool | None
    run: list[str] = field(default_factory=list)
    states: int = 0
    why: str = ""


def _found(graph: Graph, index: int, why: str) -> Answer:
    return Answer(False, graph.path(index), len(graph.states), why)


def _none(graph: Graph) -> Answer:
    why = "" if graph.complete or graph.machine.clock.horizon.bounded else "its states hold the clock, which advances"
    return Answer(True if graph.complete else None, states=len(graph.states), why=why)


def deadlock_free(graph: Graph) -> Answer:
    for index, st in enumerate(graph.states):
        found = stuck(graph.linked, st, runs_on=True)
        if found:
            names = ", ".join(".".join(str(branch) for _, branch in tid) or "root" for tid in found)
            return _found(graph, index, f"{names} wait forever at {st.now} ns")
        if st.ended is None and not graph.machine.candidates(st) and not graph.machine.more_follows(st):
            return _found(graph, index, f"nothing happens any more from {st.now} ns on")
    answer = _none(graph)
    if answer.holds and (any(_waiting_forever(graph)) or any(stuck(graph.linked, st) for st in graph.states)):
        answer.holds, answer.why = None, "a process waits forever for a partner that continues"
    return answer


def _waiting_forever(graph: Graph) -> list[bool]:
    """For each state: whether some thread waits there for others, and never continues in any run from there."""
    before: list[list[int]] = [[] for _ in graph.states]
    moves: list[set[Tid]] = [set() for _ in graph.states]
    for index, edges in enumerate(graph.edges):
        for edge in edges:
            before[edge.to].append(index)
            moves[index] |= edge.moved
    todo = list(range(len(graph.states)))
    while todo:
        index = todo.pop()
        for previous in before[index]:
            if not moves[index] <= moves[previous]:
                moves[previous] |= moves[index]
                todo.append(previous)
    return [
        any(waits_for_others(thread) and tid not in moving for tid, thread in st.threads.items())
        for st, moving in zip(graph.states, moves, strict=True)
    ]


def livelock_free(graph: Graph) -> Answer:
    """No cycle of steps in which no time passes and nothing passes an external port."""
    silent = [[edge.to for edge in edges if edge.silent] for edges in graph.edges]
    index = on_cycle(silent)
    return _none(graph) if index is None else _found(graph, index, "repeats forever from here")


def terminates(graph: Graph) -> Answer:
    for index, st in enumerate(graph.states):
        if st.ended is None and not graph.machine.candidates(st) and not graph.machine.more_follows(st):
            return _found(graph, index, "nothing happens any more")
    index_or_none = on_cycle(_own_steps(graph))
    return _none(graph) if index_or_none is None else _found(graph, index_or_none, "repeats forever from here")


def _own_steps(graph: Graph) -> list[list[int]]:
    """The steps of the program, each after any number of arrivals from outside: whatever waits for these gets them in
    the end.
    """
    reached: list[list[int]] = []
    for index in range(len(graph.states)):
        seen, todo = {index}, [index]
        for at in todo:
            for edge in graph.edges[at]:
                if edge.outside and edge.to not in seen:
                    seen.add(edge.to)
                    todo.append(edge.to)
        reached.append([edge.to for at in todo for edge in graph.edges[at] if not edge.outside])
    return reached


def schedulable(graph: Graph) -> Answer:
    """No sample is overwritten before it is taken, whether or not the process ever notices that at a read."""
    for index, st in enumerate(graph.states):
        if st.timeout:
            return _found(graph, index, f"`Timeout` at {st.now} ns")
    for index, st in enumerate(graph.states):
        if st.missed:
            return _found(graph, index, f"a sample is overwritten untaken at {st.now} ns, and never asked for")
    return _none(graph)


def on_cycle(edges: list[list[int]]) -> int | None:
    """A state of a cycle, if there is one: what remains when states without a remaining successor are removed
    repeatedly.
    """
    before: list[list[int]] = [[] for _ in edges]
    count = [len(each) for each in edges]
    for index, each in enumerate(edges):
        for to in each:
            before[to].append(index)
    free = [index for index, number in enumerate(count) if number == 0]
    left = set(range(len(edges)))
    while free:
        index = free.pop()
        left.discard(index)
        for previous in before[index]:
            count[previous] -= 1
            if count[previous] == 0:
                free.append(previous)
    if not left:
        return None
    # Every remaining state leads to another one, so following them from the first ends in a cycle.
    seen: set[int] = set()
    at = min(left)
    while at not in seen:
        seen.add(at)
        at = next(to for to in edges[at] if to in left)
    return at


def decide(program: Program, what: str, *, limit: int = 4000, seconds: float = 3) -> Answer:
    if what == "schedulable":
        return schedulable(explore(program, free=False, wcet=True, limit=limit, seconds=seconds))
    graph = explore(program, limit=limit, seconds=seconds)
    match what:
        case "deadlock free":
            return deadlock_free(graph)
        case "livelock free":
            return livelock_free(graph)
        case "terminates":
            return terminates(graph)
        case _:
            raise ValueError(what)
