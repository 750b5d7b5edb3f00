"""Expressions of the network representation: typed, resolved, without units.

Values: bool, int (also a ``time`` in nanoseconds and an enum literal by index), float, and tuples for structs and
arrays.
"""

from __future__ import annotations

from typing import ClassVar, Literal, TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import record
from cspdiag.model.types import Type

Value: TypeAlias = "bool | int | float | str | tuple[Value, ...]"


@record(kw_only=True)
class Typed:
    """An expression: it has a type and, if it comes from the text, a span."""

    type: Type
    span: Span | None = None


@record(kw_only=True)
class LiteralValue(Typed):
    """A value known at compile time; ``name`` is the ``const`` of the text that it comes from, if any."""

    value: Value
    name: str | None = None

    uncompared: ClassVar[frozenset[str]] = frozenset({"span", "name"})


@record(kw_only=True)
class ParameterValue(Typed):
    """A parameter of the enclosing class (including ``sample`` and discretized coefficients).

    ``range`` has the least and the greatest value of a whole number or a ``time`` in any instance, once all are known.
    """

    name: str
    range: tuple[int, int] | None = None

    uncompared: ClassVar[frozenset[str]] = frozenset({"span", "range"})


@record(kw_only=True)
class TunableValue(Typed):
    """The present value of a parameter of the program, which may change between two instants.

    In a class it is that of the class's own parameter with this name, which is a reference to one of the program. It is
    ``of_program`` in environments, in what follows from parameters of the program, and until classes have such
    parameters.
    """

    name: str
    of_program: bool = False


@record(kw_only=True)
class VariableValue(Typed):
    """The present value of a channel of kind ``var`` of the enclosing process class; reading it is not a communication.

    ``range`` has the least and the greatest value that it can have here, if the compiler counts in it.
    """

    channel: str
    range: tuple[int, int] | None = None

    uncompared: ClassVar[frozenset[str]] = frozenset({"span", "range"})


@record(kw_only=True)
class SignalValue(Typed):
    """In a submodel: the value of an input, a constant, an equation or a state (its present value), by name."""

    name: str


@record(kw_only=True)
class PresentTime(Typed):
    """The present instant: in an environment a double in seconds, in a composition a ``time``."""


@record(kw_only=True)
class UnaryOperation(Typed):
    """``-x`` or ``not x``."""

    operator: Literal["-", "not"]
    operand: Expression


BinaryOperator: TypeAlias = Literal["+", "-", "*", "/", "%", "^", "==", "!=", "<", "<=", ">", ">=", "and", "or"]


@record(kw_only=True)
class BinaryOperation(Typed):
    """Arithmetic on two operands of the same type (``time`` may be multiplied by ``int``), comparison, or logic."""

    operator: BinaryOperator
    left: Expression
    right: Expression


@record(kw_only=True)
class ConditionalValue(Typed):
    """``if condition then value else otherwise``; only the chosen side is evaluated."""

    condition: Expression
    then: Expression
    otherwise: Expression


Function: TypeAlias = Literal[
    "abs", "min", "max", "limit", "sign", "sqrt", "exp", "log", "sin", "cos", "tan", "asin", "acos",
    "atan", "atan2", "floor", "ceil", "round", "quantize", "deadzone", "seconds", "finite", "until",
]  # fmt: skip
"""The functions: ``seconds`` converts a ``time`` to a double; ``finite`` returns a real number that is finite, and is a
fault otherwise; ``until`` returns the duration until an instant, its first argument, from the present one, its second,
and zero if the instant is past. The others are those of the language.
"""

ARITY: dict[Function, int] = {"min": 2, "max": 2, "limit": 3, "atan2": 2, "quantize": 2, "deadzone": 2, "until": 2}
"""The numbers of arguments of the functions that do not take exactly one."""


@record(kw_only=True)
class FunctionCall(Typed):
    """A function of the language."""

    function: Function
    arguments: tuple[Expression, ...]


@record(kw_only=True)
class Conversion(Typed):
    """A conversion to ``type``, such as ``int16(x)``; a value out of range is a fault."""

    operand: Expression


@record(kw_only=True)
class FieldValue(Typed):
    """A field of a struct."""

    operand: Expression
    field: str


@record(kw_only=True)
class ElementValue(Typed):
    """An element of an array; an index out of range is a fault."""

    operand: Expression
    index: Expression


@record(kw_only=True)
class StructValue(Typed):
    """A struct, with its fields in the order of its type."""

    values: tuple[Expression, ...]


@record(kw_only=True)
class ArrayElements(Typed):
    """An array, element by element."""

    values: tuple[Expression, ...]


Expression: TypeAlias = (
    LiteralValue
    | ParameterValue
    | TunableValue
    | VariableValue
    | SignalValue
    | PresentTime
    | UnaryOperation
    | BinaryOperation
    | ConditionalValue
    | FunctionCall
    | Conversion
    | FieldValue
    | ElementValue
    | StructValue
    | ArrayElements
)
