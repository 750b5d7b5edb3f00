"""Where the numbers of a variable, port or channel are cut: where conditions that compare them with constants begin or
cease to hold.

A missing cut costs precision only: a condition that compares numbers in another way is left open.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import TypeAlias, assert_never

from cspdiag.base.graphs import reached
from cspdiag.network.ir.actions import AssignValue, InputEvent, OutputEvent, ReadValue, WriteValue
from cspdiag.network.ir.expression_walk import walk
from cspdiag.network.ir.expressions import (
    ArrayElements,
    BinaryOperation,
    ConditionalValue,
    Conversion,
    ElementValue,
    Expression,
    FieldValue,
    FunctionCall,
    LiteralValue,
    ParameterValue,
    PresentTime,
    SignalValue,
    StructValue,
    TunableValue,
    UnaryOperation,
    VariableValue,
)
from cspdiag.network.ir.network import CoreNetwork, ProcessClass
from cspdiag.network.ir.walk import parts
from cspdiag.proofs.transitions.classes.items import Item, items_of
from cspdiag.proofs.transitions.classes.program import Class, Program
from cspdiag.proofs.transitions.values import UNKNOWN, EvaluationFault, Known, evaluated

Boundaries: TypeAlias = Mapping[Item, frozenset[int]]
"""By item, the numbers that begin a new cell."""

COMPARISONS = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "==": "==", "!=": "!="}
"""The comparisons, each with the one that means the same for exchanged operands."""


def boundaries(program: Program, distinguished: Mapping[str, Collection[int]]) -> Boundaries:
    """The boundaries of all items of a program; ``distinguished`` has further ones for inputs of the outermost process.

    An item whose values are passed on gets the boundaries of all items that they may reach.
    """
    found: defaultdict[Item, set[int]] = defaultdict(set)
    origins: defaultdict[Item, set[Item]] = defaultdict(set)
    for port, more in distinguished.items():
        found["port", program.top.name, port.split("[", 1)[0]].update(more)
    arguments = Arguments(program.network)
    for one in program.classes.values():
        if isinstance(one.definition, ProcessClass):
            for item, cut in _compared(one, arguments):
                found[item].update(cut)
            for item, handed_on in _copies(one):
                origins[item] |= handed_on
    pending = list(found)
    while pending:
        item = pending.pop()
        for origin in origins[item]:
            if not found[item] <= found[origin]:
                found[origin] |= found[item]
                pending.append(origin)
    return {item: frozenset(cut) for item, cut in found.items()}


class Arguments:
    """The values that the parameters of each class have in some instance."""

    def __init__(self, network: CoreNetwork) -> None:
        self._of: defaultdict[str, list[dict[str, Known]]] = defaultdict(list)
        self._of[network.top].append(dict(network.arguments))
        for instance in network.instances:
            self._of[instance.class_name].append(dict(instance.arguments))

    def constants(self, expression: Expression, class_name: str) -> set[int]:
        """The whole numbers that an expression of parameters has as its value in some instance."""
        return {value for value in self.values(expression, class_name) if type(value) is int}

    def values(self, expression: Expression, class_name: str) -> set[Known]:
        """The values that an expression of parameters has in instances of a class; UNKNOWN where it depends on anything
        else.
        """
        names = sorted({part.name for part in walk(expression) if isinstance(part, ParameterValue)})
        cases = {tuple(given.get(name, UNKNOWN) for name in names) for given in self._of[class_name]}
        return {_constant(expression, dict(zip(names, case, strict=True))) for case in cases}


def _constant(expression: Expression, arguments: Mapping[str, Known]) -> Known:
    try:
        return evaluated(expression, lambda _: UNKNOWN, lambda name: arguments.get(name, UNKNOWN))
    except EvaluationFault:
        return UNKNOWN


def _compared(one: Class, arguments: Arguments) -> Iterator[tuple[Item, set[int]]]:
    """The variables that are compared with constants, and where the comparisons cut them."""
    assert isinstance(one.definition, ProcessClass)
    for part in parts(one.definition.body):
        if isinstance(part, BinaryOperation) and part.operator in COMPARISONS:
            for side, operator, other in (
                (part.left, part.operator, part.right),
                (part.right, COMPARISONS[part.operator], part.left),
            ):
                for variable, constant in _differences(side, arguments.constants(other, one.name), one, arguments):
                    yield ("channel", one.name, variable.channel), _cut(operator, constant)


def _differences(
    side: Expression, constants: Iterable[int], one: Class, arguments: Arguments
) -> Iterator[tuple[VariableValue, int]]:
    """The variable in one side of a comparison, to which constants may be added, with the numbers that the variable
    alone is compared with.
    """
    match side:
        case VariableValue():
            yield from ((side, constant) for constant in constants)
        case BinaryOperation(operator="+" | "-" as operator, left=left, right=right):
            sign = 1 if operator == "+" else -1
            for more in arguments.constants(right, one.name):
                shifted = [constant - sign * more for constant in constants]
                yield from _differences(left, shifted, one, arguments)
        case (
            LiteralValue() | ParameterValue() | TunableValue() | SignalValue() | PresentTime() | UnaryOperation()
            | BinaryOperation() | ConditionalValue() | FunctionCall() | Conversion() | FieldValue()
            | ElementValue() | StructValue() | ArrayElements()
        ):  # fmt: skip
            pass
        case _:
            assert_never(side)


def _cut(operator: str, constant: int) -> set[int]:
    match operator:
        case "<" | ">=":
            return {constant}
        case "<=" | ">":
            return {constant + 1}
        case "==" | "!=":
            return {constant, constant + 1}
        case _:
            raise AssertionError(f"`{operator}` is no comparison")


def _copies(one: Class) -> Iterator[tuple[Item, set[Item]]]:
    """Items, and those whose values they get unchanged."""
    assert isinstance(one.definition, ProcessClass)
    for part in parts(one.definition.body):
        match part:
            case AssignValue() if not part.target.indexes:
                yield ("channel", one.name, part.target.channel), _copied(part.value, one)
            case ReadValue() | InputEvent() if not part.target.indexes:
                yield ("channel", one.name, part.target.channel), items_of(part.source, one)
            case WriteValue() | OutputEvent():
                for sink in items_of(part.sink, one):
                    yield sink, _copied(part.value, one)
            case _:  # Any other part hands nothing on.
                pass
    for instance in one.definition.instances:
        for connection in instance.connections:
            inner: Item = ("port", instance.class_name, connection.port)
            for outer in items_of(connection.attachment, one):
                yield inner, {outer}
                yield outer, {inner}


def copied_to(program: Program, outputs: Collection[str]) -> frozenset[Item]:
    """All items of a program whose values may be passed on unchanged to one of the given outputs of the outermost
    process.
    """
    origins: defaultdict[Item, set[Item]] = defaultdict(set)
    for one in program.classes.values():
        if isinstance(one.definition, ProcessClass):
            for item, handed_on in _copies(one):
                origins[item] |= handed_on
    ports: list[Item] = [("port", program.top.name, output.split("[", 1)[0]) for output in outputs]
    return frozenset(reached(ports, origins.__getitem__))


def _copied(expression: Expression, one: Class) -> set[Item]:
    match expression:
        case VariableValue():
            return {("channel", one.name, expression.channel)}
        case ConditionalValue():
            return _copied(expression.then, one) | _copied(expression.otherwise, one)
        case (
            LiteralValue() | ParameterValue() | TunableValue() | SignalValue() | PresentTime() | UnaryOperation()
            | BinaryOperation() | FunctionCall() | Conversion() | FieldValue() | ElementValue() | StructValue()
            | ArrayElements()
        ):  # fmt: skip
            return set()
        case _:
            assert_never(expression)
