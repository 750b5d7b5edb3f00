"""A template with its labels numbered, and without the states before a start that happens at once."""

from __future__ import annotations

from cspdiag.analyses.transitions.template import Label, ParallelId, Spot, Template


class Shape:
    """The machine of a thread; ``started`` says that its parent has started it from the beginning.

    ``forked_at_once`` are the parallels that it has then started too: nothing else can happen first.
    """

    def __init__(self, template: Template, *, started: bool) -> None:
        edges = template.edges
        initial = 0
        self.forked_at_once: list[ParallelId] = []
        if started:
            entered = {target for found in edges for _, target in found}
            if edges[0] and edges[0][0][0] == ("start",):
                initial = edges[0][0][1]
            while len(edges[initial]) == 1 and edges[initial][0][0][0] == "fork":
                (label, target) = edges[initial][0]
                if sum(initial == to for found in edges for _, to in found) > (
                    0 if initial == 0 else _from_idle(edges, initial)
                ):
                    break
                self.forked_at_once.append(label[1])
                initial = target
            del entered
        order = [initial]
        numbers = {initial: 0}
        for state in order:
            for _, target in edges[state]:
                if target not in numbers:
                    numbers[target] = len(order)
                    order.append(target)
        labels: dict[Label, int] = {}
        self.edges: list[list[tuple[int, int]]] = [
            [(labels.setdefault(label, len(labels)), numbers[target]) for label, target in edges[state]]
            for state in order
        ]
        self.labels: list[Label] = list(labels)
        self.label_numbers = labels
        self.terminal = frozenset(numbers[state] for state in template.terminal if state in numbers)
        self.spots: list[Spot] = [template.spots[state] for state in order]


def _from_idle(edges: list[list[tuple[Label, int]]], state: int) -> int:
    """How many edges enter a state from the first one, when nothing leads back to that."""
    if any(target == 0 for found in edges for _, target in found):
        return 0
    return sum(target == state for _, target in edges[0])
