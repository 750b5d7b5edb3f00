"""The order of evaluation of equations: each one after those that it reads, otherwise in text order."""

from __future__ import annotations

import heapq
from collections.abc import Sequence

from cspdiag.base.graphs import is_circular, shortest_circle, strong_components
from cspdiag.base.record import node
from cspdiag.network.ir.equations import ExternalCall, SubmodelEquation

Item = SubmodelEquation | ExternalCall


@node
class Order:
    """Items in order of evaluation, and the algebraic loops among the others: for each strongly connected component a
    shortest loop, in the order of reading.
    """

    items: tuple[Item, ...]
    loops: tuple[tuple[Item, ...], ...]


def provides(item: Item) -> list[str]:
    """Names of the signals that an equation or a call computes."""
    if isinstance(item, SubmodelEquation):
        return [item.name]
    return [name for _, name, _ in item.outputs]


def ordered(items: Sequence[Item]) -> Order:
    """Sorts equations topologically; ties are broken by their position in ``items``. Takes linear time, except for the
    heap of the equations that are ready.

    Signals that no item provides (inputs, states, time) are known from the beginning.
    """
    provider = {name: index for index, item in enumerate(items) for name in provides(item)}
    needs = [[provider[name] for name in item.reads if name in provider] for item in items]
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
    components = (sorted(component) for component in strong_components(graph, graph.__getitem__))
    return sorted(
        shortest_circle(members, graph.__getitem__) for members in components if is_circular(members, graph.__getitem__)
    )
