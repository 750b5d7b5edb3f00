"""Until when the present instant decides what a program does."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expression_walk import operands
from cspdiag.network.ir.expressions import BinaryOperation, Expression, FunctionCall, LiteralValue, PresentTime
from cspdiag.network.ir.network import CoreNetwork, ProcessClass
from cspdiag.network.ir.walk import parts
from cspdiag.proofs.transitions.classes.facts import deciding
from cspdiag.proofs.transitions.classes.faults import Faults
from cspdiag.proofs.transitions.classes.items import Item, items_of
from cspdiag.proofs.transitions.classes.program import Class, Program

_COMPARISONS = frozenset({"==", "!=", "<", "<=", ">", ">="})


def last_deciding_instant(network: CoreNetwork) -> float:
    """After this instant, in nanoseconds, the present one decides no condition, no delay, no fault and no value that
    does: infinite where it always may, minus infinity where it never does.
    """
    program = Program(network)
    decides, faults = deciding(program), Faults(network)
    return max(
        (
            instant
            for one in program.classes.values()
            for expression in _deciding_expressions(one, decides, faults)
            for instant in _instants(expression)
        ),
        default=-math.inf,
    )


def _deciding_expressions(one: Class, decides: frozenset[Item], faults: Faults) -> Iterator[Expression]:
    definition = one.definition
    if not isinstance(definition, ProcessClass):
        yield from (part for part in parts(definition) if isinstance(part, Expression))
        return
    for part in parts(definition.body):
        match part:
            case ir.AssignValue() if ("channel", one.name, part.target.channel) in decides:
                yield part.value
            case ir.WriteValue() | ir.OutputEvent() if not decides.isdisjoint(items_of(part.sink, one)):
                yield part.value
            case ir.WaitStep() | ir.AfterEvent():
                yield part.duration
            case ir.Target():
                yield from part.indexes
            case ir.IfElse() | ir.WhileLoop():
                yield part.condition
            case ir.Branch(condition=condition) | ir.Repeat(until=condition) if condition is not None:
                yield condition
            case _ if isinstance(part, Expression) and faults.of_part(part, one.name):
                yield part
            case _:  # Nothing else decides anything, and what is inside it comes by itself.
                pass


def _instants(expression: Expression) -> Iterator[float]:
    """The instants that the present one is compared with, infinite for every other use of it."""
    match expression:
        case PresentTime():
            yield math.inf
        case BinaryOperation(left=PresentTime(), right=LiteralValue(value=int(instant))) if _compares(expression):
            yield instant
        case BinaryOperation(left=LiteralValue(value=int(instant)), right=PresentTime()) if _compares(expression):
            yield instant
        case FunctionCall(function="until", arguments=(LiteralValue(value=int(instant)), PresentTime())):
            yield instant
        case _:  # It may be used deeper inside.
            for operand in operands(expression):
                yield from _instants(operand)


def _compares(operation: BinaryOperation) -> bool:
    return operation.operator in _COMPARISONS
