"""Numbers at which operations of a program may fault: an environment that may offer any value may offer these."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.model.types import ArrayType, IntType, RealType, Type
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import BinaryOperation, Conversion, ElementValue, Expression
from cspdiag.network.ir.faults import operation_may_fault
from cspdiag.network.ir.network import CoreNetwork, ProcessClass
from cspdiag.network.ir.walk import parts
from cspdiag.proofs.transitions.classes.faults import catches_faults
from cspdiag.proofs.transitions.ranges import limits_of


def numbers_at_faults(network: CoreNetwork) -> tuple[int | float, ...]:
    """Zero for divisors, what is just outside the limits of conversions and the indexes of arrays, and the ends of
    the ranges of sums; nothing where no process catches a fault, as proofs speak of runs without one then.
    """
    if not catches_faults(network):
        return ()
    found: list[int | float] = []
    for entry in network.classes:
        for part in parts(entry):
            if isinstance(part, Expression) and operation_may_fault(part):
                found += _at(part)
    for entry in network.classes:
        if isinstance(entry, ProcessClass):
            found += _of_targets(entry)
    found += _ends(IntType()) if found else ()
    return tuple({(type(number), number): number for number in found}.values())


def _at(part: Expression) -> Iterator[int | float]:
    match part:
        case BinaryOperation(operator="/" | "%"):
            yield 0
            yield from _ends(part.type)
        case Conversion(type=IntType(minimum=low, maximum=high)):
            yield from (high + 1, low - 1)
            if isinstance(part.operand.type, RealType):
                yield from (float(high + 1), float(low - 1))
        case ElementValue():
            yield from _outside(part.operand.type)
        case _:  # Any other operation fails where it overflows.
            yield from _ends(part.type)


def _of_targets(entry: ProcessClass) -> Iterator[int]:
    types = {channel.name: channel.type for channel in entry.channels}
    for part in parts(entry):
        if isinstance(part, ir.Target) and part.indexes:
            kind: Type | None = types.get(part.channel)
            for _ in part.indexes:
                yield from _outside(kind)
                kind = kind.element if isinstance(kind, ArrayType) else None


def _outside(array: Type | None) -> Iterator[int]:
    if isinstance(array, ArrayType) and array.size is not None:
        yield from (array.size, -1)


def _ends(kind: Type) -> Iterator[int]:
    yield from reversed(limits_of(kind) or ())
