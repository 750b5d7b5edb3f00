"""The order of evaluation of equations: each after those that it reads, in text order where that leaves a choice."""

from __future__ import annotations

import heapq
from collections import deque
from collections.abc import Sequence

from cspdiag.base.record import node
from cspdiag.network.ir.equations import ExternalCall, SubmodelEquation
from cspdiag.network.ir.expression_walk import signals_read

Item = SubmodelEquation | ExternalCall


@node
class Order:
    """Items in order of evaluation, and the loops among the others: each a shortest one of its knot, in the order of reading."""

    items: tuple[Item, ...]
    loops: tuple[tuple[Item, ...], ...]


def reads(item: Item) -> list[str]:
    """Names of the signals that an equation or a call reads."""
    if isinstance(item, SubmodelEquation):
        return signals_read(item.value)
    expressions = [value for _, value in item.arguments + item.inputs]
    return list(dict.fromkeys(name for expression in expressions for name in signals_read(expression)))


def provides(item: Item) -> list[str]:
    """Names of the signals that it gives a value."""
    if isinstance(item, SubmodelEquation):
        return [item.name]
    return [name for _, name, _ in item.outputs]


def ordered(items: Sequence[Item]) -> Order:
    """Sort equations topologically; ties are broken by their place in ``items``. Linear but for the heap of those that are ready.

    Signals that no item provides (inputs, states, time) are had from the beginning.
    """
    provider = {name: index for index, item in enumerate(items) for name in provides(item)}
    needs = [[provider[name] for name in reads(item) if name in provider] for item in items]
    readers: list[list[int]] = [[] for _ in items]
    for index, needed in enumerate(needs):
        for other in needed:
            readers[other].append(index)
    missing = [len(needed) for needed in needs]
    ready = [index for index, count in enumerate(missing) if count == 0]
    done: list[int] = []
    while ready:
        index = heapq.heappop(ready)
        done.append(index)
        for reader in readers[index]:
            missing[reader] -= 1
            if missing[reader] == 0:
                heapq.heappush(ready, reader)
    loops = _loops([index for index, count in enumerate(missing) if count], needs)
    return Order(
        items=tuple(items[index] for index in done),
        loops=tuple(tuple(items[index] for index in loop) for loop in loops),
    )


def _loops(unsorted: list[int], needs: list[list[int]]) -> list[list[int]]:
    """A shortest loop through the first member of every strongly connected component."""
    inside = set(unsorted)
    graph = {index: [other for other in needs[index] if other in inside] for index in unsorted}
    components = (sorted(component) for component in _components(graph))
    return sorted(_shortest_loop(members, graph) for members in components if _is_knot(members, graph))


def _is_knot(members: list[int], graph: dict[int, list[int]]) -> bool:
    return len(members) > 1 or members[0] in graph[members[0]]


def _shortest_loop(members: list[int], graph: dict[int, list[int]]) -> list[int]:
    """The loop in the order of reading: each member reads the next, the last reads the first."""
    first, inside = members[0], set(members)
    came_from: dict[int, int] = {}
    pending = deque([first])
    while pending:
        present = pending.popleft()
        for other in graph[present]:
            if other == first:
                loop = [present]
                while loop[-1] != first:
                    loop.append(came_from[loop[-1]])
                return loop[::-1]
            if other in inside and other not in came_from:
                came_from[other] = present
                pending.append(other)
    raise AssertionError("a strongly connected component has a loop through each of its members")


def _components(graph: dict[int, list[int]]) -> list[list[int]]:
    """Strongly connected components (Tarjan 1972), without recursion."""
    number: dict[int, int] = {}
    lowest: dict[int, int] = {}
    stack: list[int] = []
    waiting: set[int] = set()
    found: list[list[int]] = []
    for root in graph:
        if root in number:
            continue
        path = [(root, iter(graph[root]))]
        number[root] = lowest[root] = len(number)
        stack.append(root)
        waiting.add(root)
        while path:
            present, others = path[-1]
            for other in others:
                if other not in number:
                    number[other] = lowest[other] = len(number)
                    stack.append(other)
                    waiting.add(other)
                    path.append((other, iter(graph[other])))
                    break
                if other in waiting:
                    lowest[present] = min(lowest[present], number[other])
            else:
                path.pop()
                if path:
                    lowest[path[-1][0]] = min(lowest[path[-1][0]], lowest[present])
                if lowest[present] == number[present]:
                    component = [stack.pop()]
                    while component[-1] != present:
                        component.append(stack.pop())
                    waiting.difference_update(component)
                    found.append(component)
    return found
