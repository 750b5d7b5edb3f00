"""Which computations may end in a fault: only for those are both outcomes explored, and only inside a ``catch Fault``.

A fault that no process catches ends the program, which is neither a deadlock nor a further communication. Counters
among the 64-bit integers and times (``counting.py``) are taken to stay far from an overflow.
"""

from __future__ import annotations

from functools import cached_property
from typing import assert_never

from cspdiag.model.types import ArrayType, IntType, TimeType, Type, UnknownType
from cspdiag.network.checks.unwritten import may_be_unwritten, ports_of_unwritten
from cspdiag.network.ir.actions import CatchException, ChannelEnd, PortEnd, ReadValue, Target
from cspdiag.network.ir.equations import ExternalCall
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
from cspdiag.network.ir.faults import conversion_fits, index_fits, is_index_of
from cspdiag.network.ir.network import (
    Attachment,
    ConstantEnd,
    CoreNetwork,
    DiscardEnd,
    InstanceOf,
    ProcessClass,
    SubmodelClass,
)
from cspdiag.network.ir.ranges import needs_check
from cspdiag.network.ir.walk import parts
from cspdiag.proofs.transitions.classes.built_in_exceptions import FAULT
from cspdiag.proofs.transitions.classes.counting import Counting

_MAY_FAIL = frozenset({"sqrt", "log", "exp", "asin", "acos", "quantize", "finite"})


def catches_faults(network: CoreNetwork) -> bool:
    """Whether some process catches faults; if none does, proofs are about runs without a fault."""
    return any(
        isinstance(part, CatchException) and part.exception == FAULT
        for entry in network.classes
        if isinstance(entry, ProcessClass)
        for part in parts(entry.body)
    )


class Faults:
    """Which computations of a network may end in a fault."""

    def __init__(self, network: CoreNetwork) -> None:
        self._network = network
        self._known: dict[tuple[str, Expression], bool] = {}
        self._laws: dict[str, bool] = {}

    @cached_property
    def _counting(self) -> Counting:
        return Counting(self._network)

    @cached_property
    def _variables(self) -> dict[str, frozenset[str]]:
        return may_be_unwritten(self._network)

    @cached_property
    def _ports(self) -> dict[str, frozenset[tuple[str, int | None]]]:
        return ports_of_unwritten(self._network)

    def of_network(self) -> bool:
        """Whether some computation may fail, or is written by hand."""
        return any(map(self._of_class, self._network.classes))

    def _of_class(self, entry: ProcessClass | SubmodelClass) -> bool:
        if isinstance(entry, SubmodelClass):
            return self.of_law(entry)
        if entry.body is None:
            return True
        for part in parts(entry.body):
            match part:
                case Target() if self.of_target(part, entry.name):
                    return True
                case ReadValue(source=source) if self.of_read(source, entry.name):
                    return True
                case _ if isinstance(part, Expression) and self._part(part, entry.name):
                    return True
                case _:  # Nothing else computes.
                    pass
        return False

    def of_expression(self, expression: Expression, class_name: str) -> bool:
        """Whether evaluating an expression of a class may fail."""
        key = (class_name, expression)
        known = self._known.get(key)
        if known is None:
            known = self._known[key] = any(self._part(part, class_name) for part in walk(expression))
        return known

    def of_part(self, part: Expression, class_name: str) -> bool:
        """Whether an operation itself may fail, apart from its operands. Sums of reals do not: no run is followed long
        enough for one to become infinite.
        """
        if isinstance(part, FunctionCall) and part.function == "finite":
            return any(isinstance(inner, BinaryOperation) and inner.operator not in ("+", "-") for inner in walk(part))
        return self._part(part, class_name)

    def of_target(self, target: Target, class_name: str) -> bool:
        """Whether an index of an assigned element may be out of range, or evaluating it may fail."""
        kind: Type = self._types[class_name, target.channel] if target.indexes else UnknownType()
        for index in target.indexes:
            if not is_index_of(index, kind) or self.of_expression(index, class_name):
                return True
            assert isinstance(kind, ArrayType)
            kind = kind.element
        return False

    @cached_property
    def _types(self) -> dict[tuple[str, str], Type]:
        classes = [entry for entry in self._network.classes if isinstance(entry, ProcessClass)]
        return {(entry.name, channel.name): channel.type for entry in classes for channel in entry.channels}

    def of_read(self, end: Attachment, class_name: str) -> bool:
        """Whether a variable behind an end of a class may not have been written yet."""
        match end:
            case ChannelEnd():
                return end.channel in self._variables.get(class_name, ())
            case PortEnd():
                return (end.port, end.index) in self._ports.get(class_name, ())
            case ConstantEnd() | DiscardEnd():
                return False
            case _:
                assert_never(end)

    def of_inputs(self, instance: InstanceOf, class_name: str) -> bool:
        """Whether an instance of a submodel may read a variable that has not been written yet."""
        return any(self.of_read(connection.attachment, class_name) for connection in instance.connections)

    def of_law(self, law: SubmodelClass) -> bool:
        """Whether a sample of a control law may fail."""
        known = self._laws.get(law.name)
        if known is None:
            known = self._laws[law.name] = self._of_law(law)
        return known

    def _of_law(self, law: SubmodelClass) -> bool:
        if law.external is not None or any(isinstance(equation, ExternalCall) for equation in law.equations):
            return True
        equations = (*law.equations, *law.derivative_equations)
        values = [equation.value for equation in equations if not isinstance(equation, ExternalCall)]
        values += [value for _, value in (*law.next_values, *law.derivatives)]
        return any(self.of_expression(value, law.name) for value in values)

    def _part(self, part: Expression, class_name: str) -> bool:
        match part:
            case VariableValue():
                return part.channel in self._variables.get(class_name, ())
            case BinaryOperation():
                return self._operation(part, class_name)
            case UnaryOperation(operator="-"):
                return self._may_overflow(part, class_name)
            case FunctionCall():
                return part.function in _MAY_FAIL or (
                    isinstance(part.type, IntType | TimeType) and self._may_overflow(part, class_name)
                )
            case Conversion():
                return not conversion_fits(part)
            case ElementValue():
                return not index_fits(part)
            case (
                LiteralValue() | ParameterValue() | TunableValue() | SignalValue() | PresentTime() | UnaryOperation()
                | ConditionalValue() | FieldValue() | StructValue() | ArrayElements()
            ):  # fmt: skip
                return False
            case _:
                assert_never(part)

    def _operation(self, part: BinaryOperation, class_name: str) -> bool:
        match part.operator:
            case "+" | "-" | "*":
                return isinstance(part.type, IntType | TimeType) and self._may_overflow(part, class_name)
            case "/" | "%":
                return not (isinstance(part.right, LiteralValue) and part.right.value not in (0, -1))
            case "^":
                return True
            case "==" | "!=" | "<" | "<=" | ">" | ">=" | "and" | "or":
                return False
            case _:
                assert_never(part.operator)

    def _may_overflow(self, part: Expression, class_name: str) -> bool:
        return needs_check(part, self._counting.ranges_in(class_name))
