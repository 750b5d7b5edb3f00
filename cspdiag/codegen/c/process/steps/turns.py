"""Steps in which a process waits, one after another, that differ only in numbers that count: they are a loop in C.

``seq i < 16 : (low[i] ? v[i])`` has sixteen steps in the network, and one in C. The turn is a member of the process,
because it has to outlast the waits. Loops are found from the inside out, the shortest turns first, so steps that
contain loops, or lie between them, are a loop themselves where they repeat.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from itertools import takewhile
from typing import Any

from cspdiag.base.record import record, replaced
from cspdiag.codegen.c.process.flow import can_complete
from cspdiag.codegen.c.process.steps.counting import (
    CountableTree,
    Counter,
    Counters,
    Numbering,
    counting,
    fields_inside,
)
from cspdiag.codegen.c.process.struct.members import Members
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.code import Atom, Code, own
from cspdiag.codegen.c.text.rolling import VARIABLE
from cspdiag.codegen.shared.trees import LEAST, Outline, outline, repetitions_from
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.walk import all_actions

_PLAIN = (
    ir.SkipStep, ir.ReadValue, ir.WriteValue, ir.AssignValue, ir.WaitStep, ir.RaiseException,
    ir.SequentialSteps, ir.Repeat, ir.WhileLoop, ir.IfElse,
)  # fmt: skip
"""Steps that need only states, and members that all turns can share."""


SHORT = 32
"""Turns of up to this number of steps are searched for everywhere, longer ones where a place in the text recurs."""


@record(kw_only=True)
class Turns(ir.CountedLoop[Any]):
    """A loop whose body all turns share; the process ``waits`` in it. In actions, ``counter`` counts the turns."""

    waits: bool
    counter: Code | None = None


class _Item:
    """A step of a sequence, or a loop in place of several: equal places in the text are a hint that items are alike."""

    def __init__(self, place: Hashable, action: ir.Action) -> None:
        self.place = place
        self.action = action
        self.outline: Outline | None = None
        """None if the code of the item cannot be shared, or before it is asked for."""
        self.tree: Any = action if isinstance(action, Turns) else None
        self.is_known = False


class TurnFinder:
    """The loops in the sequences of one process class."""

    def __init__(self, members: Members, member: Callable[[str], Code]) -> None:
        self._members = members
        self._member = member
        """Makes the member that counts turns in which the process waits, given its name."""
        self._trees = CountableTree(members, _PLAIN)
        self._numbering = Numbering(members)

    def rolled(self, steps: Sequence[ir.Action]) -> list[ir.Action]:
        """The steps, with loops in place of those that repeat."""
        actions = [item.action for item in self._items(steps)]
        return [self._filled(action, ()) if isinstance(action, Turns) else action for action in actions]

    def tree(self, action: ir.Action) -> Any:
        """The action as a tree that may count, with loops in place of steps that repeat; None if it cannot be
        shared.
        """
        return self._tree(action) if self._trees.is_plain(action) else None

    def filled(self, tree: tuple[Any, ...], counter: Counter) -> tuple[Any, ...]:
        """The actions for several trees that count with what is around them; whatever is no tree stays as it is."""
        return tuple([self._filled(each, (counter,)) if isinstance(each, ir.Step) else each for each in tree])

    def _items(self, steps: Sequence[ir.Action]) -> list[_Item]:
        """The items of a sequence: loops with the shortest turns are found first, because others may repeat them."""
        items = [_Item(step.span, step) for step in steps]
        while True:
            shorter = next((found for found in self._tries(items) if len(found) < len(items)), None)
            if shorter is None:
                return items
            items = shorter

    def _tries(self, items: Sequence[_Item]) -> Iterator[list[_Item]]:
        """The items with loops, of one length of turns after the other."""
        for period in _periods(items):
            yield self._with_loops(items, period)

    def _with_loops(self, items: Sequence[_Item], period: int) -> list[_Item]:
        """The items, with loops of ``period`` items a turn."""
        ends = _ends_of_places(items, period)
        found: list[_Item] = []
        position = 0
        while position < len(items):
            item, covered = self._at(items, position, period, ends[position])
            found.append(item)
            position += covered
        return found

    def _at(self, items: Sequence[_Item], start: int, period: int, end: int) -> tuple[_Item, int]:
        """The loop that begins with an item, and how many it replaces; the item itself if it does not repeat."""
        first = items[start : start + period]
        if end - start < LEAST * period or not all(can_complete(item.action) for item in first):
            return items[start], 1
        times, changes = self._repetitions(items[start : start + LEAST * period], period)
        if times < LEAST:
            return items[start], 1
        times, changes = self._repetitions(items[start:end], period)
        waits = any(self._waits(item.action) for item in first)
        body = counting(tuple([item.tree for item in first]), iter(changes))
        span = first[0].action.span
        whole = ir.SequentialSteps(span=span, steps=body)
        loop = Turns(span=span, body=whole, iterations=times, waits=waits)
        return _Item(tuple([item.place for item in first]), loop), times * period

    def _repetitions(self, items: Sequence[_Item], period: int) -> tuple[int, tuple[int, ...]]:
        """How often the first ``period`` items repeat, and by how much their numbers change."""
        known = map(self._outline, items)
        outlines = [each for each in takewhile(lambda each: each is not None, known) if each is not None]
        return repetitions_from(outlines, 0, period, in_any_steps)

    def _outline(self, item: _Item) -> Outline | None:
        if not item.is_known:
            item.is_known = True
            if item.tree is None and self._trees.is_plain(item.action):
                item.tree = self._tree(item.action)
            item.outline = None if item.tree is None else outline(item.tree)
        return item.outline

    def _tree(self, action: ir.Action) -> Any:
        """The tree of an action, with loops in the sequences inside."""
        if isinstance(action, ir.SequentialSteps):
            items = self._items(action.steps)
            return replaced(action, steps=tuple([item.tree or self._tree(item.action) for item in items]))
        return _mapped(action, self._tree, self._trees.tree)

    def _filled(self, action: Any, around: Counters) -> Any:
        """The action for a tree, with what counts the turns of the loops around it."""
        if isinstance(action, Turns):
            counter = self._counter(action, around)
            inside = (Counter(str(counter), action.iterations), *around)
            return replaced(action, counter=counter, body=self._filled(action.body, inside))
        if isinstance(action, ir.SequentialSteps):
            return replaced(action, steps=tuple([self._filled(step, around) for step in action.steps]))
        return _mapped(
            action, lambda inner: self._filled(inner, around), lambda part: self._numbering.filled(part, around)
        )

    def _counter(self, turns: Turns, around: Counters) -> Code:
        number = sum(each.is_turn and (turns.waits or each.name.startswith(VARIABLE)) for each in around)
        suffix = f"_{number + 1}" if number else ""
        return self._member(f"turn{suffix}") if turns.waits else Atom(f"{VARIABLE}{suffix}")

    def _waits(self, action: ir.Action) -> bool:
        """Whether the process may wait in an action."""
        for step in all_actions(action):
            match step:
                case Turns(waits=True) | ir.WaitStep():
                    return True
                case Turns():  # Its body is a tree.
                    return False
                case ir.ReadValue(source=source) if not self._members.source(source).never_waits:
                    return True
                case ir.WriteValue(sink=sink) if not self._members.sink(sink).never_waits:
                    return True
                case _:  # Every other step continues at once.
                    pass
        return False


def turn_finder(writer: Writer) -> TurnFinder:
    """Finds loops in what a step function does."""
    return TurnFinder(writer.members, lambda name: own(writer.shared_member(name, "uint32_t")))


def _mapped(action: Any, inner: Callable[[Any], Any], part: Callable[[Any], Any]) -> Any:
    """An action with its ``inner`` actions, and what else is a ``part`` of it, replaced."""
    fields = {name: getattr(action, name) for name in fields_inside(action)}
    return replaced(
        action, **{name: (inner if isinstance(each, ir.Step) else part)(each) for name, each in fields.items()}
    )


def _periods(items: Sequence[_Item]) -> list[int]:
    """How many items a turn may have, the fewest first."""
    most = len(items) // LEAST
    last: dict[Hashable, int] = {}
    apart: set[int] = set()
    for position, item in enumerate(items if most > SHORT else ()):
        apart.add(position - last.get(item.place, position))
        last[item.place] = position
    return [*range(1, min(SHORT, most) + 1), *sorted(period for period in apart if SHORT < period <= most)]


def _ends_of_places(items: Sequence[_Item], period: int) -> list[int]:
    """For each item, up to where items have the place in the text of the one ``period`` items before: others are not
    alike.
    """
    ends = [start + period for start in range(len(items))]
    for start in range(len(items) - period - 1, -1, -1):
        if items[start].place == items[start + period].place:
            ends[start] = ends[start + 1]
    return ends


def in_any_steps(_: Sequence[int]) -> bool:
    """Whether a loop may change numbers by these steps: a turn is a number of its own, so it may change none."""
    return True
