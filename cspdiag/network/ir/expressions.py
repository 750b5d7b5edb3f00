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
    """An expression has a type and, where it stems from the text, a place."""

    type: Type
    span: Span | None = None


@record(kw_only=True)
class LiteralValue(Typed):
    """A value known at compile time; ``name`` is the ``const`` of the text that it stems from."""

    value: Value
    name: str | None = None

    uncompared: ClassVar[frozenset[str]] = frozenset({"span", "name"})


@record(kw_only=True)
class ParameterValue(Typed):
    """A parameter of the enclosing class (``sample`` and discretized coefficients included).

    ``range``: the least and the greatest value that any instance gives a whole number or a ``time``, once all are
    known.
    """

    name: str
    range: tuple[int, int] | None = None

    uncompared: ClassVar[frozenset[str]] = frozenset({"span", "range"})


@record(kw_only=True)
class VariableValue(Typed):
    """The present value of a channel of kind ``var`` of the enclosing process class; no communication.

    ``range``: the least and the greatest value that it can have here, where the compiler counts in it.
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
"""``seconds`` makes a double of a ``time``, ``finite`` gives a real that is neither infinite nor no number, or else a
fault, ``until`` the duration until an instant, its first argument, from the present one, its second, and none if it is
past; the others are those of the language.
"""

ARITY: dict[Function, int] = {"min": 2, "max": 2, "limit": 3, "atan2": 2, "quantize": 2, "deadzone": 2, "until": 2}
"""Arguments of the functions that do not take one."""


@record(kw_only=True)
class FunctionCall(Typed):
    """A function of the language."""

    function: Function
    arguments: tuple[Expression, ...]


@record(kw_only=True)
class Conversion(Typed):
    """``int16(x)``: to ``type``; out of range is a fault."""

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
    """A struct, its fields in the order of its type."""

    values: tuple[Expression, ...]


@record(kw_only=True)
class ArrayElements(Typed):
    """An array, element by element."""

    values: tuple[Expression, ...]


Expression: TypeAlias = (
    LiteralValue
    | ParameterValue
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
