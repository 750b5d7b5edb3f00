"""Which computations may end in a fault: only those are followed both ways, and only where a ``catch Fault`` is around them.

A fault that nobody catches ends the program, which is neither a deadlock nor a further communication. Sums and differences of 64-bit integers are taken not to
overflow: a counter of milliseconds would need 292 million years.
"""

from __future__ import annotations

from functools import cached_property

from cspdiag.model.types import ArrayType, IntType, RealType, TimeType, Type, UnknownType
from cspdiag.network.actions import ChannelEnd, PortEnd, Target
from cspdiag.network.expression_walk import walk
from cspdiag.network.expressions import (
    BinaryOperation,
    Conversion,
    ElementValue,
    Expression,
    FunctionCall,
    LiteralValue,
    PresentTime,
    UnaryOperation,
    VariableValue,
)
from cspdiag.network.ir import Attachment, ExternalCall, InstanceOf, Network, ProcessClass, SubmodelClass
from cspdiag.network.ranges import needs_check
from cspdiag.network.unwritten import may_be_unwritten, ports_of_unwritten

_MAY_FAIL = frozenset({"sqrt", "log", "exp", "asin", "acos", "quantize", "finite"})


class Faults:
    """What may fail in a network."""

    def __init__(self, network: Network) -> None:
        self._network = network
        self._known: dict[tuple[str, Expression], bool] = {}
        self._laws: dict[str, bool] = {}

    @cached_property
    def _variables(self) -> dict[str, frozenset[str]]:
        return may_be_unwritten(self._network)

    @cached_property
    def _ports(self) -> dict[str, frozenset[tuple[str, int | None]]]:
        return ports_of_unwritten(self._network)

    def of_expression(self, expression: Expression, class_name: str) -> bool:
        """Whether the evaluation in a class may fail."""
        key = (class_name, expression)
        known = self._known.get(key)
        if known is None:
            known = self._known[key] = any(self._part(part, class_name) for part in walk(expression))
        return known

    def of_target(self, target: Target, class_name: str) -> bool:
        """Whether an index of what is assigned may be out of range, or its evaluation may fail."""
        kind: Type = self._types[class_name, target.channel] if target.indexes else UnknownType()
        for index in target.indexes:
            if _out_of_range(index, kind) or self.of_expression(index, class_name):
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
        return False

    def of_inputs(self, instance: InstanceOf, class_name: str) -> bool:
        """Whether an instance of a submodel may read a variable that was not written."""
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
                return _operation(part)
            case UnaryOperation(operator="-") if isinstance(part.type, IntType):
                return part.type.bits < 64 and needs_check(part)
            case FunctionCall():
                return part.function in _MAY_FAIL or (isinstance(part.type, IntType) and needs_check(part))
            case Conversion(operand=operand):
                if isinstance(part.type, RealType):
                    return False
                return isinstance(operand.type, RealType) or needs_check(part)
            case ElementValue(index=index, operand=operand):
                return _out_of_range(index, operand.type)
            case PresentTime():
                return False
        return False


def _out_of_range(index: Expression, array: Type) -> bool:
    """Whether an index may be none of an array's."""
    if not isinstance(index, LiteralValue) or not isinstance(array, ArrayType) or array.size is None:
        return True
    return not (isinstance(index.value, int) and 0 <= index.value < array.size)


def _operation(part: BinaryOperation) -> bool:
    match part.operator:
        case "+" | "-":
            wide = isinstance(part.type, TimeType) or (isinstance(part.type, IntType) and part.type.bits == 64)
            return isinstance(part.type, IntType) and not wide and needs_check(part)
        case "*":
            return isinstance(part.type, IntType | TimeType) and needs_check(part)
        case "/" | "%":
            return not (isinstance(part.right, LiteralValue) and part.right.value not in (0, -1))
        case "^":
            return True
    return False
