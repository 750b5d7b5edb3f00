"""Items: the ports, channels and parameters of classes, through which values flow."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypeAlias, assert_never

from cspdiag.network.ir.actions import ChannelEnd, PortEnd
from cspdiag.network.ir.expression_walk import walk
from cspdiag.network.ir.expressions import Expression, ParameterValue, VariableValue
from cspdiag.network.ir.network import Attachment, ConstantEnd, DiscardEnd
from cspdiag.proofs.transitions.classes.program import Class

Item: TypeAlias = tuple[Literal["port", "channel", "parameter"], str, str]
"""A port, a channel or a parameter of a class: its kind, the name of the class, and its own name."""


def items_of(end: Attachment, one: Class) -> set[Item]:
    """The items that an end, in terms of a class, is attached to."""
    match end:
        case PortEnd():
            return {("port", one.name, end.port)}
        case ChannelEnd():
            return {("channel", one.name, end.channel)}
        case ConstantEnd():
            return items_in(end.value, one)
        case DiscardEnd():
            return set()
        case _:
            assert_never(end)


def all_items_in(expressions: Iterable[Expression], one: Class) -> set[Item]:
    """The items that expressions of a class read."""
    return {item for expression in expressions for item in items_in(expression, one)}


def items_in(expression: Expression, one: Class) -> set[Item]:
    """The items that an expression of a class reads."""
    found: set[Item] = set()
    for part in walk(expression):
        match part:
            case VariableValue():
                found.add(("channel", one.name, part.channel))
            case ParameterValue():
                found.add(("parameter", one.name, part.name))
            case _:  # Any other expression; its operands are walked over, too.
                pass
    return found
