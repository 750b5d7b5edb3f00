"""Cancelled processes whose last assignments can be observed.

A cancelled process continues to its next communication, and may assign variables until then; in a fused program it ends
immediately. The difference can only be observed if an exception is caught and these variables are read afterwards.
"""

from __future__ import annotations

from collections import Counter

from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import SignalValue, VariableValue
from cspdiag.network.ir.network import ProcessClass
from cspdiag.network.ir.walk import channels_written, parts
from cspdiag.optimize.fuse.code import NotStaticError


def refuse_visible_cancellation(entry: ProcessClass) -> None:
    """Raises NotStaticError if a caught exception cancels processes whose variables are read outside the part that it
    ends.
    """
    all_reads = _reads(entry.body)
    repeated = {
        id(part)
        for loop in parts(entry.body)
        if isinstance(loop, ir.Repeat | ir.WhileLoop | ir.CountedLoop)
        for part in parts(loop)
        if isinstance(part, ir.CatchException)
    }
    for part in parts(entry.body):
        if isinstance(part, ir.CatchException) and any(
            isinstance(inside, ir.ParallelSteps) for inside in parts(part.body)
        ):
            reads = all_reads if id(part) in repeated else all_reads - _reads(part.body)
            if any(reads[name] for name in _assigned(part)):
                raise NotStaticError("what a cancelled process still assigns is read after the exception", part.span)


def _reads(action: object) -> Counter[str]:
    found: Counter[str] = Counter()
    for part in parts(action):
        if isinstance(part, VariableValue):
            found[part.channel] += 1
        elif isinstance(part, SignalValue):
            found[part.name] += 1
    return found


def _assigned(catch: ir.CatchException) -> set[str]:
    """Variables, and states of control laws, that change in the part that the exception ends."""
    names = set(channels_written(catch.body))
    for part in parts(catch.body):
        if isinstance(part, ir.RunLaw):
            names.update(name for name, _ in (*part.next_values, *part.derivatives))
    return names
