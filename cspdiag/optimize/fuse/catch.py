"""What a process has assigned when it is cancelled, and who sees that.

A cancelled process goes on to its next communication, and may assign to variables on the way; a fused one ends where it
is. That makes a difference only where an exception is caught and these variables are read afterwards.
"""

from __future__ import annotations

from collections import Counter

from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import SignalValue, VariableValue
from cspdiag.network.ir.network import ProcessClass
from cspdiag.network.ir.walk import channels_written, parts
from cspdiag.optimize.fuse.code import NotStaticError


def refuse_seen_cancellation(entry: ProcessClass) -> None:
    """Raises NotStaticError where a caught exception cancels processes whose variables are read outside of what it
    ends.
    """
    everything = _reads(entry.body)
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
            reads = everything if id(part) in repeated else everything - _reads(part.body)
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
    """Variables, and states of control laws, that change in what the exception ends."""
    names = set(channels_written(catch.body))
    for part in parts(catch.body):
        if isinstance(part, ir.RunLaw):
            names.update(name for name, _ in (*part.next_values, *part.derivatives))
    return names
