"""Strongly connected components of graphs (Tarjan, "Depth-first search and linear graph algorithms", 1972), without recursion."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence


def strong_components(roots: Iterable[int], after: Callable[[int], Iterable[int]]) -> Iterator[list[int]]:
    """The strongly connected components that can be reached, ``after`` being the nodes that edges lead to; those that are led to come first."""
    order: dict[int, int] = {}
    low: dict[int, int] = {}
    place: dict[int, int] = {}
    """Where a node that is not yet in a finished component is on the stack."""
    stack: list[int] = []
    for root in roots:
        if root in order:
            continue
        path: list[tuple[int, Iterator[int]]] = []
        fresh: int | None = root
        while True:
            if fresh is not None:
                order[fresh] = low[fresh] = len(order)
                place[fresh] = len(stack)
                stack.append(fresh)
                path.append((fresh, iter(after(fresh))))
            node, rest = path[-1]
            fresh = None
            for target in rest:
                if target not in order:
                    fresh = target
                    break
                if target in place and order[target] < low[node]:
                    low[node] = order[target]
            if fresh is not None:
                continue
            path.pop()
            if low[node] == order[node]:
                component = stack[place[node] :]
                del stack[place[node] :]
                for member in component:
                    del place[member]
                yield component
            if not path:
                break
            above = path[-1][0]
            low[above] = min(low[above], low[node])


def final_components(after: Sequence[Sequence[int]]) -> Iterator[list[int]]:
    """The components that no edge leaves, of a graph in which all nodes can be reached from the first."""
    for component in strong_components(range(len(after)), after.__getitem__):
        members = set(component)
        if all(members.issuperset(after[node]) for node in component):
            yield component
