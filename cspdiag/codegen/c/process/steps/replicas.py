"""Branches of a parallel that differ only in their number: they share one step function in C.

``par i < n : (worker[i] || server[i])`` has ``n`` branches in the network, and one step function in C, which reads the
number of the branch that it runs.
"""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.base.record import record
from cspdiag.codegen.c.process.steps.counting import CountableTree, Counter, Numbering, counting
from cspdiag.codegen.c.process.struct.members import Members
from cspdiag.codegen.shared.trees import LEAST, Outline
from cspdiag.network.elaborate.fewer.rows import rows_from
from cspdiag.network.ir import actions as ir

_PLAIN = (
    ir.RunInstance, ir.SkipStep, ir.StopStep, ir.ReadValue, ir.WriteValue, ir.AssignValue, ir.WaitStep,
    ir.RaiseException, ir.SequentialSteps, ir.ParallelSteps, ir.Repeat, ir.WhileLoop, ir.CountedLoop, ir.IfElse,
    ir.CatchException,
)  # fmt: skip
"""Steps that need only states, and members of which each branch can have its own."""


@record
class Replicas:
    """The number of consecutive branches that are alike, and the body that they share."""

    count: int
    body: ir.Action


def replicas(members: Members, steps: Sequence[ir.Action], start: int, number: str) -> Replicas | None:
    """The branches from ``start`` that are alike; None if they are too few, or if they are instances of processes."""
    if isinstance(steps[start], ir.RunInstance) or len(steps) - start < LEAST:
        return None
    marked = CountableTree(members, _PLAIN)
    count, before, changes = 0, None, None
    while start + count < len(steps):
        found = marked.outline(steps[start + count])
        if found is None or (before is not None and found.shape != before.shape):
            break
        if before is not None:
            change = [b - a for a, b in zip(before.numbers, found.numbers, strict=True)]
            if min(change, default=0) < 0 or (changes is not None and change != changes):
                break
            changes = change
        count, before = count + 1, found
        if count == 2 and changes is not None:
            known = _known(members, steps, start)
            last = marked.outline(steps[start + known - 1]) if known > count else None
            if last is not None and last == _after(found, changes, known - count):
                count, before = known, last
    if count < LEAST or changes is None:
        return None
    first = counting(marked.tree(steps[start]), iter(changes))
    return Replicas(count, Numbering(members).filled(first, (Counter(number, count),)))


def _known(members: Members, steps: Sequence[ir.Action], start: int) -> int:
    """The number of branches of which each is known to differ from the one before in numbers that count. Whether a
    variable has a flag is not known from the branches.
    """
    return 1 if any(members.unwritten.variables.values()) else rows_from(steps, start)


def _after(before: Outline, changes: Sequence[int], count: int) -> Outline:
    """The outline of the branch at this distance from another."""
    numbers = [number + change * count for number, change in zip(before.numbers, changes, strict=True)]
    return Outline(before.shape, tuple(numbers))
