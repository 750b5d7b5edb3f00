"""Branches of a parallel that differ only in their number: they share one step function in C.

``par i < n : (worker[i] || server[i])`` has ``n`` branches in the network, and one step function in C, which reads the
number of the branch that it runs.
"""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.base.record import record
from cspdiag.codegen.c.process.steps.counting import CountableTree, Numbering, counting
from cspdiag.codegen.c.process.struct.members import Members
from cspdiag.codegen.shared.trees import LEAST
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
    for position in range(start, len(steps)):
        found = marked.outline(steps[position])
        if found is None or (before is not None and found.shape != before.shape):
            break
        if before is not None:
            change = [b - a for a, b in zip(before.numbers, found.numbers, strict=True)]
            if min(change, default=0) < 0 or (changes is not None and change != changes):
                break
            changes = change
        count, before = count + 1, found
    if count < LEAST or changes is None:
        return None
    first = counting(marked.tree(steps[start]), iter(changes))
    return Replicas(count, Numbering(members).filled(first, ((number, count),)))
