"""Expressions as fast Python: functions of the runtime are inlined, constants are replaced by their values.

The results are those of the functions, bit for bit, including faults: every rewriting here says why. What is not
rewritten, or cannot be because an operand would be evaluated twice or out of order, is a call of the runtime as at
``-O0``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import assert_never

from cspdiag.codegen.python.fast.temporaries import Temporaries
from cspdiag.codegen.python.plain.expressions import ROUNDED_FUNCTIONS, Printer
from cspdiag.codegen.python.text.code import (
    AND,
    COMPARISON,
    OR,
    PRODUCT,
    SUM,
    Code,
    Conditional,
    Constant,
    Name,
    Named,
    Parenthesized,
    Prefix,
    WholeNumber,
    call,
    integer,
    number,
)
from cspdiag.codegen.python.text.names import Names
from cspdiag.codegen.python.text.operators import infix, minus
from cspdiag.codegen.python.text.types import literal, real
from cspdiag.codegen.shared.operations import integer_name
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
from cspdiag.network.elaborate.constant_value import constant_value
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
    Typed,
    UnaryOperation,
    Value,
    VariableValue,
)
from cspdiag.network.ir.faults import index_fits, may_fault
from cspdiag.network.ir.ranges import exceeds, needs_check, value_range

NANOSECONDS = Constant("1_000_000_000")
"""The number in a second."""

SCALAR = RealType | IntType | TimeType | BoolType
"""The types of values that are printed in place of a name."""

_ZERO, _ONE, _MINUS_ONE = Constant("0.0"), Constant("1.0"), number("-1.0")
_MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}
_UNFOLDED = frozenset({"floor", "ceil"})
"""For constant operands the compiler computes these without the sign of a zero."""


@dataclass(frozen=True)
class FastPrinter(Printer):
    """As ``Printer``; expressions use additional local variables, named by ``temporaries``.

    ``known`` has the values of signals that are constants.
    """

    temporaries: Temporaries = field(default_factory=lambda: Temporaries(Names()))
    known: Mapping[str, Value] = field(default_factory=dict)

    def print(self, expression: Expression) -> Code:
        """The Python expression."""
        with self.temporaries.whole_expression():
            value = self.value(expression)
            if value is not None and isinstance(expression.type, SCALAR):
                return self._literal(value, expression.type, expression)
            match expression:
                case ElementValue(operand=operand, index=index) if not index_fits(expression):
                    return self._element(operand, index)
                case _:  # The others are as in readable Python.
                    return super().print(expression)

    def value(self, expression: Expression) -> Value | None:
        """The value of a constant expression; None if it is not constant, or faults."""
        if isinstance(expression, LiteralValue):
            return expression.value
        if not self._constant(expression):
            return None
        value = constant_value(expression, lambda item: self.known.get(item.name))
        in_range = not isinstance(expression.type, IntType) or _is_in(value, expression.type)
        return value if in_range else None

    def _constant(self, expression: Expression) -> bool:
        match expression:
            case LiteralValue():
                return True
            case SignalValue(name=name):
                return name in self.known
            case Typed(type=RealType(bits=32)):
                return False  # the compiler rounds more often than the runtime
            case Conversion(type=TimeType()):
                return False
            case UnaryOperation(operand=operand) | Conversion(operand=operand) | FieldValue(operand=operand):
                return self._sound(operand)
            case BinaryOperation(left=left, right=right) | ElementValue(operand=left, index=right):
                return self._sound(left) and self._sound(right)
            case ConditionalValue(condition=condition, then=then, otherwise=otherwise):
                return self._sound(condition) and self._sound(then) and self._sound(otherwise)
            case FunctionCall(function=function, arguments=arguments):
                return function not in _UNFOLDED and all(self._sound(argument) for argument in arguments)
            case StructValue(values=values) | ArrayElements(values=values):
                return all(self._sound(value) for value in values)
            case ParameterValue() | TunableValue() | VariableValue() | PresentTime():
                return False
            case _:
                assert_never(expression)

    def _sound(self, part: Expression) -> bool:
        """Whether a part of an expression is constant and does not fault."""
        return self.value(part) is not None

    def _literal(self, value: Value, type_: Type, expression: Expression) -> Code:
        match type_:
            case TimeType():
                return number(f"{value:_}")
            case RealType():
                assert isinstance(value, int | float)
                if value != value or value in (float("inf"), float("-inf")):
                    name = self._math("nan" if value != value else "inf")
                    return minus(name) if value < 0 else name
                return real(float(value), expression.span if isinstance(expression, LiteralValue) else None)
            case (
                BoolType() | IntType() | TextType() | EnumType() | StructType() | ArrayType() | UnknownType()
            ):  # fmt: skip
                return literal(value, type_, self.imports)
            case _:
                assert_never(type_)

    def _math(self, name: str) -> Code:
        return Name(self.imports.standard("math", name))

    # Operands that are used more than once

    def _reused(self, code: Code, type_: Type) -> tuple[Code, Code]:
        """An operand where it is first evaluated, and where it is used again."""
        if _is_simple(code):
            return code, code
        name = self.temporaries.fresh(type_)
        return Parenthesized(Named(name, code)), Name(name)

    # WholeNumber numbers

    def _checked(self, expression: Expression, code: Code) -> Code:
        if not isinstance(expression.type, IntType | TimeType) or not needs_check(expression):
            return super()._checked(expression, code)
        return self._in_range(code, expression.type, exceeds(expression))

    def _in_range(self, code: Code, type_: IntType | TimeType, exceeded: tuple[bool, bool]) -> Code:
        """The function of the runtime is called only for a number outside the range, to raise the fault."""
        word = type_ if isinstance(type_, IntType) else IntType()
        low, high = integer(word.minimum), integer(word.maximum)
        first, again = self._reused(code, type_)
        below, above = exceeded
        if below and above:
            inside: Code = infix("and", AND, infix(">=", COMPARISON, first, low), infix("<=", COMPARISON, again, high))
        elif below:
            inside = infix(">=", COMPARISON, first, low)
        else:
            inside = infix("<=", COMPARISON, first, high)
        return Conditional(again, inside, call(self.imports.runtime(integer_name(type_)), again))

    def _operation(self, expression: BinaryOperation) -> Code:
        right = self.value(expression.right)
        match expression.operator:
            case "/" | "%" if (
                isinstance(expression.left.type, IntType | TimeType) and isinstance(right, int) and right > 0
            ):
                return self._divided(expression)
            case "*" if _is_one(self.value(expression.left)):
                return self.print(expression.right)
            case "*" | "/" if _is_one(right):
                return self.print(expression.left)
            case "==" | "!=" if isinstance(expression.left.type, EnumType):
                sides = [self._ordinal(side) for side in (expression.left, expression.right)]
                return infix(expression.operator, COMPARISON, *sides)
            case "<" | "<=" | ">" | ">=":
                compared = self._compared_magnitude(expression)
                if compared is not None:
                    return compared
            case "+" | "-" | "*" | "/" | "%" | "^" | "==" | "!=" | "and" | "or":
                pass  # As in readable Python.
            case _:
                assert_never(expression.operator)
        return super()._operation(expression)

    def _ordinal(self, expression: Expression) -> Code:
        """A literal of an enum is compared as its number."""
        if isinstance(expression, LiteralValue):
            assert isinstance(expression.value, int)
            return integer(expression.value)
        return self.print(expression)

    def _divided(self, expression: BinaryOperation) -> Code:
        """Python rounds down, the language toward zero: for a positive divisor they differ only below 0."""
        operator = "//" if expression.operator == "/" else "%"
        divisor = self.print(expression.right)
        dividend = self.print(expression.left)
        if value_range(expression.left)[0] >= 0:
            return infix(operator, PRODUCT, dividend, divisor)
        first, again = self._reused(dividend, expression.type)
        mirrored = Parenthesized(infix(operator, PRODUCT, minus(again), divisor))
        return Conditional(
            infix(operator, PRODUCT, again, divisor),
            infix(">=", COMPARISON, first, WholeNumber(0)),
            Prefix("-", mirrored),
        )

    def _conversion(self, type_: Type, operand: Expression) -> Code:
        match type_, operand.type:
            case (IntType() | TimeType(), IntType() | TimeType()):
                word = type_ if isinstance(type_, IntType) else IntType()
                low, high = value_range(operand)
                exceeded = low < word.minimum, high > word.maximum
                code = self.print(operand)
                return self._in_range(code, type_, exceeded) if any(exceeded) else code
            case _:  # The others are as in readable Python.
                return super()._conversion(type_, operand)

    def _element(self, operand: Expression, index: Expression) -> Code:
        array = self.print(operand)
        assert isinstance(operand.type, ArrayType)
        if not _is_simple(array) or self.value(index) is not None:
            return call(self.imports.runtime("element"), array, self.print(index))
        first, again = self._reused(self.print(index), index.type)
        above, below = (
            infix(">=", COMPARISON, first, WholeNumber(0)),
            infix("<", COMPARISON, again, Constant(str(operand.type.size))),
        )
        inside = infix("and", AND, above, below)
        fault = call(self.imports.runtime("element"), array, again)
        return Conditional(array.at(again), inside, fault)

    # Reals

    def _compared_magnitude(self, expression: BinaryOperation) -> Code | None:
        """``abs(x) < c`` as ``x < c and x > -c``; for a NaN both are false, for a negative ``c`` as well."""
        match expression:
            case BinaryOperation(left=FunctionCall(function="abs", arguments=(operand,), type=RealType())):
                bound = self.print(expression.right)
                if not _is_simple(bound) or self.value(expression.left) is not None:
                    return None
                opposite = _negative(bound)
                first, again = self._reused(self.print(operand), expression.left.type)
                upper = infix(expression.operator, COMPARISON, first, bound)
                lower = infix(_MIRRORED[expression.operator], COMPARISON, again, opposite)
                if expression.operator in ("<", "<="):
                    return infix("and", AND, upper, lower)
                return infix("or", OR, upper, lower)
            case BinaryOperation():
                return None
            case _:
                assert_never(expression)

    def _function(self, expression: FunctionCall) -> Code:
        kind = expression.type
        rounded = is_single(kind) and expression.function in ROUNDED_FUNCTIONS
        inlined = self._inlined(expression)
        if inlined is None:
            return super()._function(expression)
        return self._checked(expression, inlined) if rounded else inlined

    def _inlined(self, expression: FunctionCall) -> Code | None:
        given = expression.arguments
        is_real = isinstance(expression.type, RealType)
        match expression.function:
            case "seconds" if self.seconds is None or not isinstance(given[0], ParameterValue):
                return self._single(expression, infix("/", PRODUCT, self.print(given[0]), NANOSECONDS))
            case "limit":
                return self._limit(*given)
            case "min" | "max" if len(given) == 2:
                return super()._checked(expression, self._extreme(expression.function, *given))
            case "sign":
                return self._sign(given[0], is_real)
            case "deadzone":
                return self._deadzone(*given)
            case "finite":
                first, again = self._reused(self.print(given[0]), given[0].type)
                finite = infix("==", COMPARISON, infix("-", SUM, first, again), _ZERO)
                return Conditional(again, finite, call(self.imports.runtime("finite"), again))
            case "sin" | "cos" | "tan":
                return self._trigonometric(expression.function, given[0])
            case "atan2":
                return call(self._math("atan2"), self.print(given[0]), self.print(given[1]))
            case "sqrt":
                first, again = self._reused(self.print(given[0]), given[0].type)
                root = call(self._math("sqrt"), again)
                return Conditional(root, infix(">=", COMPARISON, first, _ZERO), self._math("nan"))
            case (
                "abs" | "min" | "max" | "exp" | "log" | "asin" | "acos" | "atan" | "floor" | "ceil" | "round"
                | "quantize" | "seconds" | "until"
            ):  # fmt: skip
                return None
            case _:
                assert_never(expression.function)

    def _limit(self, value: Expression, low: Expression, high: Expression) -> Code | None:
        """The bounds are evaluated only when they are needed; None if a fault of the upper one could be missed because
        of that.
        """
        highest = self.print(high)
        if may_fault(high) and not _is_simple(highest):
            return None
        first, again = self._reused(self.print(value), value.type)
        first_low, low_again = self._reused(self.print(low), low.type)
        first_high, high_again = self._reused(highest, high.type)
        rest = Conditional(high_again, infix(">", COMPARISON, again, first_high), again)
        return Conditional(low_again, infix("<", COMPARISON, first, first_low), rest)

    def _extreme(self, function: str, left: Expression, right: Expression) -> Code:
        """``max`` keeps the first operand unless the second is greater, which matters for zeros and NaNs."""
        first, first_again = self._reused(self.print(left), left.type)
        second, second_again = self._reused(self.print(right), right.type)
        operator = "<" if function == "max" else ">"
        return Conditional(second_again, infix(operator, COMPARISON, first, second), first_again)

    def _sign(self, operand: Expression, is_real: bool) -> Code:
        first, again = self._reused(self.print(operand), operand.type)
        zero, one, minus_one = (_ZERO, _ONE, _MINUS_ONE) if is_real else (WholeNumber(0), WholeNumber(1), integer(-1))
        rest = Conditional(minus_one, infix("<", COMPARISON, again, zero), again if is_real else zero)
        return Conditional(one, infix(">", COMPARISON, first, zero), rest)

    def _deadzone(self, operand: Expression, width: Expression) -> Code | None:
        code = self.print(width)
        if not _is_simple(code):
            return None
        first, x = self._reused(self.print(operand), operand.type)
        nothing = Conditional(x, infix("!=", COMPARISON, x, x), _ZERO)
        below = Conditional(infix("+", SUM, x, code), infix("<", COMPARISON, x, _negative(code)), nothing)
        return Conditional(infix("-", SUM, x, code), infix(">", COMPARISON, first, code), below)

    def _trigonometric(self, function: str, operand: Expression) -> Code:
        """Python's functions do not accept infinities; a NaN gives a NaN in both branches."""
        first, again = self._reused(self.print(operand), operand.type)
        finite = infix("==", COMPARISON, infix("-", SUM, first, again), _ZERO)
        return Conditional(call(self._math(function), again), finite, self._math("nan"))


def _is_one(value: Value | None) -> bool:
    """Whether multiplying by a value changes nothing, not even the sign of a zero."""
    return isinstance(value, float) and value == 1.0


def _is_in(value: Value | None, type_: IntType) -> bool:
    return isinstance(value, int) and type_.minimum <= value <= type_.maximum


def _is_simple(code: Code) -> bool:
    """Whether an operand may be evaluated again: a name or a number, or its negative."""
    match code:
        case Name() | Constant() | WholeNumber():
            return True
        case Prefix(text="-", operand=operand):
            return _is_simple(operand)
        case _:  # Anything else would be computed twice.
            return False


def _negative(code: Code) -> Code:
    return code.operand if isinstance(code, Prefix) and code.text == "-" else minus(code)
