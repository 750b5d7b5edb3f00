"""Expressions, types and names."""

from __future__ import annotations

from typing import Literal, TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import Slotted, node


@node
class Node(Slotted):
    """A node of the syntax tree, which has a place in the source text."""

    span: Span


@node
class Identifier(Node):
    """A name where it is declared or used."""

    text: str


@node
class Number(Node):
    """``12``, ``0.5``, ``1e-3``, ``0.5<rad/s>``: an ``int`` unless written with a point, an exponent or a unit.

    ``unit`` is the text between the angle brackets.
    """

    value: int | float
    unit: str | None
    parenthesized: bool = False


@node
class Duration(Node):
    """``1 ms``: a ``time`` in integer nanoseconds. ``1 kHz``: a frequency in hertz.

    A frequency is a ``double<Hz>`` in expressions and means its period where a ``time`` is expected (``@ 1 kHz``).
    """

    magnitude: float
    unit: Literal["ns", "us", "ms", "s", "min", "Hz", "kHz", "MHz"]
    nanoseconds: int
    """The duration, or the period of the frequency, rounded to whole nanoseconds."""
    parenthesized: bool = False

    @property
    def is_frequency(self) -> bool:
        """Whether this was written as a frequency."""
        return self.unit.endswith("Hz")


@node
class Boolean(Node):
    """``true`` or ``false``."""

    value: bool
    parenthesized: bool = False


@node
class Text(Node):
    """A string in double quotes; only arguments of drivers and external submodels take one."""

    value: str
    parenthesized: bool = False


@node
class Name(Node):
    """A name used as a value."""

    name: str
    parenthesized: bool = False


@node
class Member(Node):
    """``value.name``: a field of a struct, a literal of an enum, or a port of an instance."""

    value: Expression
    name: Identifier
    parenthesized: bool = False


@node
class Index(Node):
    """``value[index]``."""

    value: Expression
    index: Expression
    parenthesized: bool = False


@node
class Unary(Node):
    """``-x`` or ``not x``."""

    operator: Literal["-", "not"]
    operand: Expression
    parenthesized: bool = False


BinaryOperator: TypeAlias = Literal["+", "-", "*", "/", "%", "^", "==", "!=", "<", "<=", ">", ">=", "and", "or"]


@node
class Binary(Node):
    """An operator between two expressions."""

    operator: BinaryOperator
    left: Expression
    right: Expression
    parenthesized: bool = False


@node
class Conditional(Node):
    """``if condition then value else otherwise``."""

    condition: Expression
    then: Expression
    otherwise: Expression
    parenthesized: bool = False


@node
class Argument(Node):
    """A positional argument (``name`` is None) or a named one."""

    name: Identifier | None
    value: Expression


@node
class Call(Node):
    """``limit(x, -1, 1)``, ``Pose(x = 0, y = 1)``, ``int16(n)``."""

    function: Identifier
    arguments: tuple[Argument, ...]
    parenthesized: bool = False


@node
class ArrayValue(Node):
    """``[1, 2, 3]``."""

    elements: tuple[Expression, ...]
    parenthesized: bool = False


Expression: TypeAlias = (
    Number | Duration | Boolean | Text | Name | Member | Index | Unary | Binary | Conditional | Call | ArrayValue
)


@node
class Discard(Node):
    """``_``, the sink that discards values."""


@node
class Replicator(Node):
    """``i < N``: ``i`` counts from 0."""

    name: Identifier
    count: Expression


@node
class Reference(Node):
    """A port, instance, variable or channel: ``feedback``, ``cell[i]``, ``servo.control``, ``cell[i].out[j]``."""

    name: Identifier
    indexes: tuple[Expression, ...] = ()
    member: Identifier | None = None
    member_indexes: tuple[Expression, ...] = ()


@node
class TypeName(Node):
    """``double<rad>[3]``: a name, the text of the unit, the sizes of the dimensions."""

    name: Identifier
    unit: str | None = None
    unit_span: Span | None = None
    dimensions: tuple[Expression, ...] = ()


@node
class Parameter(Node):
    """A parameter of a definition: a compile-time constant for which instances give a value."""

    doc: str | None
    name: Identifier
    type: TypeName
    default: Expression | None


@node
class External(Node):
    """A body in another language: ``python "plant.py:Joint"``."""

    language: Identifier
    target: str
    target_span: Span
