"""Order and circles in graphs of things that need each other."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from typing import TypeVar

from cspdiag.base.record import field_names, is_record
from cspdiag.syntax import ast

T = TypeVar("T", bound=Hashable)


def components(nodes: Iterable[T], needs: Callable[[T], Sequence[T]]) -> list[list[T]]:
    """The strongly connected components, each after those that it needs (Tarjan, SIAM J. Comput. 1, 1972; without recursion)."""
    number: dict[T, int] = {}
    low: dict[T, int] = {}
    open_nodes: list[T] = []
    is_open: set[T] = set()
    found: list[list[T]] = []
    for root in nodes:
        if root in number:
            continue
        work: list[tuple[T, Iterator[T]]] = [(root, iter(needs(root)))]
        number[root] = low[root] = len(number)
        open_nodes.append(root)
        is_open.add(root)
        while work:
            node, pending = work[-1]
            for needed in pending:
                if needed not in number:
                    number[needed] = low[needed] = len(number)
                    open_nodes.append(needed)
                    is_open.add(needed)
                    work.append((needed, iter(needs(needed))))
                    break
                if needed in is_open:
                    low[node] = min(low[node], number[needed])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[node])
                if low[node] == number[node]:
                    component: list[T] = []
                    while not component or component[-1] is not node:
                        component.append(open_nodes.pop())
                        is_open.discard(component[-1])
                    found.append(component)
    return found


def circle(component: Sequence[T], needs: Callable[[T], Sequence[T]]) -> list[T]:
    """A shortest circle through the first node of a component; empty where there is none."""
    start, members = component[0], set(component)
    came_from: dict[T, T] = {}
    level = [start]
    while level:
        following = []
        for node in level:
            for needed in needs(node):
                if needed is start:
                    path = [node]
                    while path[-1] is not start:
                        path.append(came_from[path[-1]])
                    return path[::-1]
                if needed in members and needed not in came_from:
                    came_from[needed] = node
                    following.append(needed)
        level = following
    return []


def walk(root: ast.Node) -> Iterator[ast.Node]:
    """A node and all nodes below it, in text order."""
    pending: list[object] = [root]
    while pending:
        item = pending.pop()
        if isinstance(item, tuple):
            pending += reversed(item)
        elif isinstance(item, ast.Node) and is_record(item):
            yield item
            pending += [getattr(item, name) for name in reversed(field_names(item)) if name != "source"]
