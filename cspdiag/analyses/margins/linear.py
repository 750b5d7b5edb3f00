"""Values with their slopes: expressions of control laws, linearized exactly where they are smooth.

Forward differentiation: a number is its value at the operating point together with its derivative with respect to
states and inputs. What is not smooth is replaced by its behaviour for small signals, which is recorded: quantization is
replaced by its mean, a limit counts as not reached, an ``if`` keeps the side that is active at the operating point.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, assert_never

from cspdiag.base.errors import CspdiagError
from cspdiag.base.record import record
from cspdiag.model.constants import arithmetic
from cspdiag.model.types import IntType, RealType, StructType
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

if TYPE_CHECKING:
    import numpy

    Slope = numpy.ndarray[tuple[int, ...], numpy.dtype[numpy.float64]]

from cspdiag.base import Span


class NotLinearError(CspdiagError):
    """An expression has no slope at the operating point; ``span`` is its place, if it has one in the text."""

    def __init__(self, reason: str, span: Span | None) -> None:
        super().__init__(reason)
        self.reason = reason
        self.span = span


@record
class Number:
    """A value and its derivative with respect to every state and input, a vector."""

    value: float
    slope: Slope


@record
class Simplification:
    """What was not smooth and how it was replaced, its place, and (by the nonzero entries) the states and inputs that
    it depends on.
    """

    uncompared: ClassVar[frozenset[str]] = frozenset()

    what: str
    span: Span | None
    depends: Slope


class Linearization:
    """Evaluates the expressions of one flattened submodel at an operating point.

    ``parameters`` are those of the instance; ``signals`` is extended by the equations; real values that depend on
    states or inputs are ``Number``.
    """

    def __init__(self, parameters: Mapping[str, Any], size: int, time: float = 0.0) -> None:
        import numpy

        self.numpy = numpy
        self.parameters = parameters
        self.signals: dict[str, Any] = {}
        self.size = size
        self.time = time
        self.simplifications: list[Simplification] = []
        self._compared: list[Any] = []

    def slope(self, value: Any) -> Slope:
        """The slope of a value; zero if it depends on no state or input."""
        return value.slope if isinstance(value, Number) else self.numpy.zeros(self.size)

    def value(self, expression: Expression) -> Any:
        """The value of an expression. Raises NotLinearError if the arithmetic faults or the value has no slope."""
        try:
            return self._value(expression)
        except (arithmetic.UndefinedError, arithmetic.OutOfRangeError, ArithmeticError, ValueError) as problem:
            raise NotLinearError(f"at the operating point {problem}", expression.span) from None

    def _value(self, expression: Expression) -> Any:
        match expression:
            case LiteralValue():
                return expression.value
            case ParameterValue() | TunableValue():
                return self.parameters[expression.name]
            case SignalValue():
                return self.signals[expression.name]
            case VariableValue():
                raise NotLinearError("a variable of a process is not part of a control law", expression.span)
            case PresentTime():
                return self.time
            case UnaryOperation():
                operand = self._value(expression.operand)
                if expression.operator == "not":
                    return not operand
                return Number(-operand.value, -operand.slope) if isinstance(operand, Number) else -operand
            case BinaryOperation():
                return self._binary(expression)
            case ConditionalValue():
                return self._conditional(expression)
            case FunctionCall():
                return self._function(expression, [self._value(argument) for argument in expression.arguments])
            case Conversion():
                operand = self._value(expression.operand)
                if isinstance(operand, Number):
                    if isinstance(expression.type, RealType):
                        return operand
                    self._simplified("conversion to whole numbers is taken as constant", expression.span, operand)
                    operand = operand.value
                assert isinstance(expression.type, IntType | RealType)
                return arithmetic.convert(operand, expression.type)
            case FieldValue():
                assert isinstance(expression.operand.type, StructType)
                names = [name for name, _ in expression.operand.type.fields]
                return self._value(expression.operand)[names.index(expression.field)]
            case ElementValue():
                return self._value(expression.operand)[self._value(expression.index)]
            case StructValue() | ArrayElements():
                return tuple(map(self._value, expression.values))
            case _:
                assert_never(expression)

    def _simplified(self, what: str, span: Span | None, *values: Any) -> None:
        depends = sum((abs(self.slope(value)) for value in values), self.numpy.zeros(self.size))
        if depends.any():
            self.simplifications.append(Simplification(what, span, depends))

    def _conditional(self, expression: ConditionalValue) -> Any:
        outer, self._compared = self._compared, []
        holds = self._value(expression.condition)
        compared, self._compared = self._compared, outer
        side = "then" if holds else "else"
        self._simplified(
            f"the `{side}` side of this `if` is taken", expression.condition.span or expression.span, *compared
        )
        return self._value(expression.then if holds else expression.otherwise)

    def _binary(self, expression: BinaryOperation) -> Any:
        left = self._value(expression.left)
        operator = expression.operator
        if operator in ("and", "or"):
            return left if left == (operator == "or") else self._value(expression.right)
        right = self._value(expression.right)
        if operator in _COMPARISONS:
            self._compared += [left, right]
            return _COMPARISONS[operator](_plain(left), _plain(right))
        if not isinstance(left, Number) and not isinstance(right, Number):
            return arithmetic.operate(operator, left, right, expression.type)
        a, b = _plain(left), _plain(right)
        value = float(arithmetic.operate(operator, float(a), float(b), expression.type))
        da, db = self.slope(left), self.slope(right)
        match operator:
            case "+":
                return Number(value, da + db)
            case "-":
                return Number(value, da - db)
            case "*":
                return Number(value, b * da + a * db)
            case "/":
                return Number(value, (da - value * db) / b)
            case "^" if not db.any():
                return Number(value, (b * a ** (b - 1) if a or b >= 1 else math.nan) * da)
            case "^":
                return Number(value, b * a ** (b - 1) * da + value * math.log(a) * db)
            case "%" | "==" | "!=" | "<" | "<=" | ">" | ">=" | "and" | "or":
                self._simplified("the remainder is taken where it does not jump", expression.span, left, right)
                return Number(value, da - math.trunc(a / b) * db)
            case _:
                assert_never(operator)

    def _function(self, call: FunctionCall, arguments: list[Any]) -> Any:
        if call.function == "seconds":
            return arithmetic.checked(arguments[0] / 1_000_000_000, call.type)
        if not any(isinstance(argument, Number) for argument in arguments):
            return arithmetic.function(call.function, arguments, call.type)
        plain = [_plain(argument) for argument in arguments]
        computed = arithmetic.function(call.function, plain, call.type)
        assert computed is not None
        value = float(computed)
        slopes = [self.slope(argument) for argument in arguments]
        x, dx = plain[0], slopes[0]
        smooth = _SMOOTH.get(call.function)
        if smooth is not None:
            return Number(value, smooth(x, value) * dx)
        match call.function:
            case "finite":
                return arguments[0]
            case "atan2":
                if x == 0 and plain[1] == 0:
                    raise ValueError("the angle of the zero vector has no slope")
                return Number(value, (plain[1] * dx - x * slopes[1]) / (x * x + plain[1] ** 2))
            case "quantize":
                self._simplified("quantization is taken as its mean, without steps", call.span, arguments[0])
                return Number(x, dx)
            case "deadzone":
                inside = abs(x) <= plain[1]
                self._simplified(f"{'inside' if inside else 'outside'} the dead zone", call.span, arguments[0])
                return Number(value, 0 * dx if inside else dx - math.copysign(1.0, x) * slopes[1])
            case "limit":
                reached = "" if plain[1] <= x <= plain[2] else ", though it is at the operating point"
                self._simplified(f"the limit counts as not reached{reached}", call.span, arguments[0])
                return Number(x, dx)
            case "min" | "max":
                chosen = plain.index(computed)
                self._simplified(
                    f"the {'smaller' if call.function == 'min' else 'larger'} one is always the same",
                    call.span,
                    *arguments,
                )
                return Number(value, slopes[chosen])
            case "abs":
                self._simplified("the sign does not change", call.span, arguments[0])
                return Number(value, math.copysign(1.0, x) * dx)
            case (
                "sign" | "sqrt" | "exp" | "log" | "sin" | "cos" | "tan" | "asin" | "acos" | "atan" | "floor"
                | "ceil" | "round"
            ):  # fmt: skip
                self._simplified(f"`{call.function}` is taken as constant", call.span, arguments[0])
                return value
            case "until":
                raise AssertionError("only used in compositions")
            case _:
                assert_never(call.function)


def _plain(value: Any) -> Any:
    return value.value if isinstance(value, Number) else value


_COMPARISONS: dict[str, Callable[[Any, Any], bool]] = {
    "==": lambda a, b: a == b, "!=": lambda a, b: a != b,
    "<": lambda a, b: a < b, "<=": lambda a, b: a <= b, ">": lambda a, b: a > b, ">=": lambda a, b: a >= b,
}  # fmt: skip

_SMOOTH: dict[str, Callable[[float, float], float]] = {
    "sqrt": lambda _, y: 0.5 / y,
    "exp": lambda _, y: y,
    "log": lambda x, _: 1 / x,
    "sin": lambda x, _: math.cos(x),
    "cos": lambda x, _: -math.sin(x),
    "tan": lambda _, y: 1 + y * y,
    "asin": lambda x, _: 1 / math.sqrt(1 - x * x),
    "acos": lambda x, _: -1 / math.sqrt(1 - x * x),
    "atan": lambda x, _: 1 / (1 + x * x),
}
"""The derivative of a function, from its argument and its value."""
