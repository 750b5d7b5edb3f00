"""Paths, components and cycles of graphs that are given by the successors of each node.

networkx has them as well, but ``check`` cannot afford to load it, and in the proofs its components take three to seven
times as long as these.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from typing import TypeVar

T = TypeVar("T", bound=Hashable)


def reached(roots: Iterable[T], after: Callable[[T], Iterable[T]]) -> Iterator[T]:
    """The roots and everything that can be reached from them, each once, in order of distance from a root."""
    order = list(dict.fromkeys(roots))
    found = set(order)
    for node in order:
        yield node
        fresh = [target for target in dict.fromkeys(after(node)) if target not in found]
        found.update(fresh)
        order += fresh


def strong_components(roots: Iterable[T], after: Callable[[T], Iterable[T]]) -> Iterator[list[T]]:
    """The strongly connected components that can be reached; ``after`` gives the successors of a node.

    Successors of a component come before it; within a component, the nodes reached last come first. Tarjan,
    "Depth-first search and linear graph algorithms", 1972, without recursion.
    """
    order: dict[T, int] = {}
    low: dict[T, int] = {}
    place: dict[T, int] = {}
    """Where a node that is not yet in a finished component is on the stack."""
    stack: list[T] = []
    for root in roots:
        if root in order:
            continue
        path: list[tuple[T, Iterator[T]]] = []
        fresh, is_fresh = root, True
        while True:
            if is_fresh:
                order[fresh] = low[fresh] = len(order)
                place[fresh] = len(stack)
                stack.append(fresh)
                path.append((fresh, iter(after(fresh))))
            node, rest = path[-1]
            is_fresh = False
            for target in rest:
                if target not in order:
                    fresh, is_fresh = target, True
                    break
                if target in place and order[target] < low[node]:
                    low[node] = order[target]
            if is_fresh:
                continue
            path.pop()
            if low[node] == order[node]:
                component = stack[place[node] :]
                del stack[place[node] :]
                for member in component:
                    del place[member]
                component.reverse()
                yield component
            if not path:
                break
            above = path[-1][0]
            low[above] = min(low[above], low[node])


def final_components(after: Sequence[Sequence[int]]) -> Iterator[list[int]]:
    """The components that no edge leaves, in a graph in which all nodes can be reached from the first."""
    for component in strong_components(range(len(after)), after.__getitem__):
        members = set(component)
        if all(members.issuperset(after[node]) for node in component):
            yield component


def is_circular(component: Sequence[T], after: Callable[[T], Iterable[T]]) -> bool:
    """Whether a path leads from a member of a component back to itself."""
    return len(component) > 1 or component[0] in after(component[0])


def shortest_circle(component: Sequence[T], after: Callable[[T], Iterable[T]]) -> list[T]:
    """A shortest cycle through the first node of a component, each node leading to the next; empty if there is none."""
    start, members = component[0], set(component)
    came_from: dict[T, T] = {}
    pending = [start]
    for node in pending:
        for target in after(node):
            if target == start:
                path = [node]
                while path[-1] != start:
                    path.append(came_from[path[-1]])
                return path[::-1]
            if target in members and target not in came_from:
                came_from[target] = node
                pending.append(target)
    return []
