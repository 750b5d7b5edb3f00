"""Steps in which a process waits, one after another, that differ only in numbers that count: they are a loop in C.

``seq i < 16 : (low[i] ? v[i])`` has sixteen steps in the network, and one in C. The turn is a member of the process,
because it has to outlast the waits.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from cspdiag.base.record import record
from cspdiag.codegen.c.process.flow import can_complete
from cspdiag.codegen.c.process.steps.counting import CountableTree, Numbering
from cspdiag.codegen.c.process.struct.members import Members
from cspdiag.codegen.c.text.code import Atom, Code
from cspdiag.codegen.c.text.rolling import VARIABLE
from cspdiag.codegen.shared.trees import LEAST, LONGEST, Outline, repetitions_from
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.walk import all_actions

_PLAIN = (
    ir.SkipStep, ir.ReadValue, ir.WriteValue, ir.AssignValue, ir.WaitStep, ir.RaiseException,
    ir.SequentialSteps, ir.Repeat, ir.WhileLoop, ir.IfElse,
)  # fmt: skip
"""Steps that need only states, and members that all turns can share."""


@record
class Turns:
    """A loop for ``steps`` of a sequence: the number of its turns, what counts them, and the body that they share, in
    which the process ``waits``.
    """

    steps: int
    count: int
    number: Code
    body: ir.Action
    waits: bool


class TurnFinder:
    """The loops among the steps of one sequence."""

    def __init__(self, members: Members, steps: Sequence[ir.Action], turn: Callable[[], Code]) -> None:
        self._members = members
        self._turn = turn
        """Makes the member that counts turns in which the process waits."""
        self._steps = steps
        self._tree = CountableTree(members, _PLAIN)
        self._outlines: dict[int, Outline | None] = {}

    def at(self, start: int) -> Turns | None:
        """The loop that begins with a step; None if the steps do not repeat."""
        for period in range(1, LONGEST + 1):
            end = self._end_of_spans(start, period)
            first = self._steps[start : start + period]
            if end - start < LEAST * period or not all(map(can_complete, first)):
                continue
            times, changes = repetitions_from(self._outlined(start, end), 0, period, _counts)
            if times >= LEAST:
                waits = any(map(self._waits, first))
                number = self._turn() if waits else Atom(VARIABLE)
                numbering = Numbering(self._members, str(number), times, iter(changes))
                body = tuple(numbering.filled(self._tree.tree(step)) for step in first)
                whole = ir.SequentialSteps(span=first[0].span, steps=body)
                return Turns(times * period, times, number, whole, waits)
        return None

    def _end_of_spans(self, start: int, period: int) -> int:
        """Up to where each step has the place in the text of the one ``period`` steps before: others are not alike."""
        end = start + period
        while end < len(self._steps) and self._steps[end].span == self._steps[end - period].span:
            end += 1
        return end

    def _waits(self, action: ir.Action) -> bool:
        """Whether the process may wait in an action."""
        for step in all_actions(action):
            match step:
                case ir.WaitStep():
                    return True
                case ir.ReadValue(source=source) if not self._members.source(source).never_waits:
                    return True
                case ir.WriteValue(sink=sink) if not self._members.sink(sink).never_waits:
                    return True
                case _:  # Every other step continues at once.
                    pass
        return False

    def _outlined(self, start: int, end: int) -> list[Outline]:
        """The outlines of the steps up to ``end``, or up to one that cannot be shared."""
        found: list[Outline] = []
        for position in range(start, end):
            if position not in self._outlines:
                self._outlines[position] = self._tree.outline(self._steps[position])
            outline = self._outlines[position]
            if outline is None:
                break
            found.append(outline)
        return found


def _counts(changes: Sequence[int]) -> bool:
    return min(changes, default=0) >= 0
