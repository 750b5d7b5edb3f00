"""Expressions of the network as Python expressions: few parentheses, checked integers, IEEE reals."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi
from typing import assert_never

from cspdiag.codegen.python.text.code import (
    AND,
    COMPARISON,
    FALSE,
    OR,
    PRODUCT,
    SUM,
    TRUE,
    Code,
    Conditional,
    Name,
    at_least,
    call,
    own,
    tuple_of,
)
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.operators import infix, minus, negated
from cspdiag.codegen.python.text.types import field_names, literal
from cspdiag.codegen.shared.operations import integer_name, known_comparison, opposite, range_check, truth_of
from cspdiag.model.types import (
    ArrayType,
    BoolType,
    EnumType,
    IntType,
    RealType,
    StructType,
    TextType,
    TimeType,
    Type,
    UnknownType,
    is_single,
)
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
from cspdiag.network.ir.faults import index_fits

_PRECEDENCE = {
    "+": SUM, "-": SUM, "*": PRODUCT, "/": PRODUCT, "and": AND, "or": OR,
    "==": COMPARISON, "!=": COMPARISON, "<": COMPARISON, "<=": COMPARISON, ">": COMPARISON, ">=": COMPARISON,
}  # fmt: skip

_BUILTIN_FUNCTIONS = frozenset({"abs", "min", "max"})
ROUNDED_FUNCTIONS = frozenset(
    {"sqrt", "exp", "log", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "quantize", "deadzone"}
)
"""Functions whose result may need more digits than a binary32 argument has."""


PARAMETERS = own("parameters")
"""The parameters of the program, in a class that has all of them."""


def _unexpected(name: str) -> Code:
    raise LookupError(f"{name} cannot be used here")


@dataclass(frozen=True)
class Printer:
    """Prints the expressions of one class; the functions give the spelling of its names in the context of the
    expression.
    """

    imports: Imports
    parameter: Callable[[str], Code] = _unexpected
    signal: Callable[[str], Code] = _unexpected
    variable: Callable[[str], Code] = _unexpected
    seconds: Callable[[str], Code] | None = None
    """A parameter of type ``time`` in seconds."""
    time: Code | None = None
    program: Code = PARAMETERS
    """The object with the parameters of the program."""

    def print(self, expression: Expression) -> Code:
        """The Python expression."""
        match expression:
            case LiteralValue(value=value, name=name):
                constant = self.imports.constant(name) if name is not None else None
                if constant is not None:
                    return Name(constant)
                if value == pi and isinstance(expression.type, RealType):
                    return Name(self.imports.standard("math", "pi"))
                return literal(value, expression.type, self.imports, expression.span)
            case ParameterValue(name=name):
                return self.parameter(name)
            case TunableValue():
                return self.reference(expression).field("value")
            case VariableValue(channel=channel):
                return self.variable(channel)
            case SignalValue(name=name):
                return self.signal(name)
            case PresentTime(type=TimeType()):
                return call(self.imports.runtime("now"))
            case PresentTime():
                assert self.time is not None, "time is known in environments only"
                return self.time
            case UnaryOperation(operator="not", operand=operand):
                other = opposite(operand)
                return negated(self.print(operand)) if other is None else self.print(other)
            case UnaryOperation(operand=operand):
                return self._checked(expression, minus(self.print(operand)))
            case BinaryOperation():
                return self._operation(expression)
            case ConditionalValue(condition=condition, then=then, otherwise=otherwise):
                chosen = at_least(self.print(then), OR)
                return Conditional(chosen, at_least(self.print(condition), OR), self.print(otherwise))
            case FunctionCall():
                return self._function(expression)
            case Conversion(operand=operand):
                return self._conversion(expression.type, operand)
            case FieldValue(operand=operand, field=field):
                assert isinstance(operand.type, StructType)
                return self.print(operand).field(field_names(operand.type)[field])
            case ElementValue(operand=operand, index=index):
                if index_fits(expression):
                    return self.print(operand).at(self.print(index))
                return call(self.imports.runtime("element"), self.print(operand), self.print(index))
            case StructValue(values=values):
                assert isinstance(expression.type, StructType)
                fields = zip(expression.type.fields, values, strict=True)
                names = field_names(expression.type)
                named = {names[name]: self.print(value) for (name, _), value in fields}
                return call(self.imports.type_(expression.type.name), **named)
            case ArrayElements(values=values):
                return tuple_of(self.print(value) for value in values)
        assert_never(expression)

    def reference(self, expression: TunableValue) -> Code:
        """The object that holds a parameter of the program."""
        if expression.of_program:
            return self.program.field(self.imports.names.parameters[expression.name])
        return self.parameter(expression.name)

    def _operation(self, expression: BinaryOperation) -> Code:
        operator = expression.operator
        known = known_comparison(expression, by_name=False)
        if known is not None:
            return TRUE if known else FALSE
        truth = truth_of(expression)
        if truth is not None:
            condition, holds = truth
            return self.print(condition) if holds else negated(self.print(condition))
        left, right = self.print(expression.left), self.print(expression.right)
        whole = isinstance(expression.left.type, IntType | TimeType)
        match operator:
            case "^":
                return self._checked(expression, call(self.imports.runtime("power"), left, right))
            case "%":
                return call(self.imports.runtime("remainder"), left, right)
            case "/" if whole:
                return self._checked(expression, call(self.imports.runtime("quotient"), left, right))
        return self._checked(expression, infix(operator, _PRECEDENCE[operator], left, right))

    def _checked(self, expression: Expression, code: Code) -> Code:
        """``code``, with a check of the range of its type where it may be exceeded."""
        checked = "float32" if is_single(expression.type) else range_check(expression)
        return code if checked is None else call(self.imports.runtime(checked), code)

    def _function(self, expression: FunctionCall) -> Code:
        function = expression.function
        if function == "seconds" and self.seconds is not None and isinstance(expression.arguments[0], ParameterValue):
            return self._single(expression, self.seconds(expression.arguments[0].name))
        arguments = [self.print(argument) for argument in expression.arguments]
        if function == "seconds":
            return self._single(expression, infix("/", PRODUCT, arguments[0], Name(self.imports.runtime("s"))))
        if function == "until":
            # For a past instant it is negative, so the wait is over immediately; it does not overflow.
            return infix("-", SUM, *arguments)
        if function in _BUILTIN_FUNCTIONS:
            return self._checked(expression, call(function, *arguments))
        code = call(self.imports.runtime("nearest" if function == "round" else function), *arguments)
        return self._checked(expression, code) if function in ROUNDED_FUNCTIONS else code

    def _single(self, expression: Expression, code: Code) -> Code:
        """``code``, rounded where the type is binary32."""
        return call(self.imports.runtime("float32"), code) if is_single(expression.type) else code

    def _conversion(self, type_: Type, operand: Expression) -> Code:
        code = self.print(operand)
        match type_:
            case IntType() | TimeType():
                return call(self.imports.runtime(integer_name(type_)), code)
            case RealType(bits=32):
                return call(self.imports.runtime("float32"), code)
            case RealType():
                widened = isinstance(operand.type, RealType)
                return code if widened else call("float", code)
            case BoolType() | TextType() | EnumType() | StructType() | ArrayType() | UnknownType():
                return code
            case _:
                assert_never(type_)
