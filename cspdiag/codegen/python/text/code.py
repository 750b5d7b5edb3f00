"""Python expressions as trees that know their precedence and their text on one line.

The generators build these trees; ``layout`` breaks them over lines if a line is too short.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import ClassVar, Literal, TypeAlias, cast

from cspdiag.base.record import lazily, record
from cspdiag.codegen.shared.parentheses import Operands, Parentheses
from cspdiag.codegen.shared.trees import Closed, Counted, nodes

(
    LOOSEST, CONDITIONAL, OR, AND, NOT, COMPARISON, BITS_OR, BITS_AND, SHIFT, SUM, PRODUCT, SIGN, AWAIT, PRIMARY,
) = range(14)  # fmt: skip
"""Precedences of Python (The Python Language Reference, section 6.17)."""


class _Node:
    """The common part of all expression nodes."""

    _PRECEDENCE: ClassVar[int]

    @property
    def precedence(self) -> int:
        """How tightly its operator binds."""
        return self._PRECEDENCE

    @lazily
    def flat(self) -> str:
        """The text on one line."""
        return self._flat()

    def _flat(self) -> str:
        raise NotImplementedError

    def field(self, name: str) -> Attribute:
        """``x.name``."""
        return Attribute(at_least(cast("Code", self), PRIMARY), name)

    def at(self, index: Code | int) -> Element:
        """``x[index]``."""
        return Element(at_least(cast("Code", self), PRIMARY), WholeNumber(index) if isinstance(index, int) else index)

    def called(self, *arguments: Code) -> Call:
        """``x(arguments)``."""
        return call(cast("Code", self), *arguments)

    def call(self, method: str, *arguments: Code) -> Call:
        """``x.method(arguments)``."""
        return call(self.field(method), *arguments)


class Primary(_Node):
    """An expression without operators outside brackets."""

    _PRECEDENCE = PRIMARY


@record
class Name(Primary):
    """A name, or one that is qualified by the module that it is imported from."""

    text: str

    def _flat(self) -> str:
        return self.text


@record
class Constant(Primary):
    """A literal that is not counted with: a real, a string, ``True``, ``None``, and also a type."""

    text: str

    def _flat(self) -> str:
        return self.text


@record
class WholeNumber(Primary, Counted):
    """A whole number without a sign, which may become a count in similar statements."""

    value: int

    def _flat(self) -> str:
        return str(self.value)


@record
class Formatted(Primary):
    """An f-string with values: ``f"{name}.cell[3]"``; numbers in it are text."""

    parts: tuple[str | Code, ...]

    def _flat(self) -> str:
        texts = (
            part if isinstance(part, str) else part.flat if isinstance(part, WholeNumber) else f"{{{part.flat}}}"
            for part in self.parts
        )
        return f'f"{"".join(texts)}"'


@record
class Argument:
    """An argument of a call: positional, ``name=value``, or ``*value``."""

    value: Code
    name: str | None = None
    starred: bool = False

    @property
    def prefix(self) -> str:
        """The text before the value."""
        return f"{self.name}=" if self.name else "*" if self.starred else ""

    @property
    def flat(self) -> str:
        """The text on one line."""
        return self.prefix + self.value.flat


@record
class Call(Primary):
    """A call."""

    function: Code
    arguments: tuple[Argument, ...]

    @lazily
    def inside(self) -> str:
        """The arguments on one line."""
        return ", ".join([argument.flat for argument in self.arguments])

    def _flat(self) -> str:
        return f"{self.function.flat}({self.inside})"


@record
class Attribute(Primary):
    """``x.name``."""

    operand: Code
    name: str

    def _flat(self) -> str:
        return f"{self.operand.flat}.{self.name}"


@record
class Element(Primary):
    """``x[index]``."""

    operand: Code
    index: Code

    def _flat(self) -> str:
        return f"{self.operand.flat}[{self.index.flat}]"


@record
class Prefix(_Node):
    """``-x``, ``not x``, ``await x``: the text before the operand, including the blank."""

    text: Literal["-", "not ", "await ", "yield from "]
    operand: Code

    @property
    def precedence(self) -> int:
        """How tightly the operator binds."""
        return {"-": SIGN, "not ": NOT, "await ": AWAIT, "yield from ": LOOSEST}[self.text]

    def _flat(self) -> str:
        return self.text + self.operand.flat


@record
class Chain(_Node):
    """Operands joined by operators of one precedence: ``a + b - c``."""

    level: int
    first: Code
    rest: tuple[tuple[str, Code], ...]

    @property
    def precedence(self) -> int:
        """The precedence of the operators."""
        return self.level

    def _flat(self) -> str:
        return self.first.flat + "".join([f" {operator} {operand.flat}" for operator, operand in self.rest])


@record
class Conditional(_Node):
    """``then if condition else otherwise``."""

    then: Code
    condition: Code
    otherwise: Code

    _PRECEDENCE = CONDITIONAL

    def _flat(self) -> str:
        return f"{self.then.flat} if {self.condition.flat} else {self.otherwise.flat}"


@record
class Parenthesized(Primary):
    """An expression in the parentheses that its context needs."""

    operand: Code

    def _flat(self) -> str:
        return f"({self.operand.flat})"


@record
class Items(Primary):
    """A tuple, a list, a dictionary of entries, or without brackets the values that a statement lists."""

    brackets: Literal["()", "[]", "{}", ""]
    items: tuple[Code, ...]

    def _flat(self) -> str:
        inside = ", ".join([item.flat for item in self.items])
        comma = "," if self.brackets == "()" and len(self.items) == 1 else ""
        return f"{self.brackets[:1]}{inside}{comma}{self.brackets[1:]}"


@record
class Entry(Primary):
    """``key: value`` in a dictionary."""

    key: str
    value: Code

    def _flat(self) -> str:
        return f"{self.key}: {self.value.flat}"


@record
class Comprehension(Primary, Closed):
    """``[element for i in range(8)]``, or with ``()`` a generator in parentheses, and with ``f()`` a function that is
    called with one.
    """

    element: Code
    variable: str
    items: Code
    brackets: str = "[]"

    @property
    def clause(self) -> str:
        """The text after the element."""
        return f"for {self.variable} in {self.items.flat}"

    def _flat(self) -> str:
        return f"{self.brackets[:-1]}{self.element.flat} {self.clause}{self.brackets[-1]}"


@record
class Starred(Primary, Closed):
    """``*value`` in a list or a call."""

    value: Code

    def _flat(self) -> str:
        return f"*{self.value.flat}"


@record
class Named(_Node, Closed):
    """``name := value``: a value that is used again in the same expression; always in parentheses."""

    name: str
    value: Code

    _PRECEDENCE = LOOSEST

    def _flat(self) -> str:
        return f"{self.name} := {self.value.flat}"


Code: TypeAlias = (
    Name
    | Constant
    | WholeNumber
    | Formatted
    | Call
    | Attribute
    | Element
    | Prefix
    | Chain
    | Conditional
    | Parenthesized
    | Items
    | Entry
    | Comprehension
    | Starred
    | Named
)

PARENTHESES: Parentheses[Code] = Parentheses(
    Parenthesized,
    {
        OR: Operands(NOT, NOT),  # `and` binds tighter, but readers should not need to know
        AND: Operands(AND, NOT),
        COMPARISON: Operands(BITS_OR, BITS_OR, chain=False),
        BITS_OR: Operands(BITS_OR, BITS_AND),
        BITS_AND: Operands(BITS_AND, SHIFT),
        SHIFT: Operands(SHIFT, SUM),
        SUM: Operands(SUM, PRODUCT),
        PRODUCT: Operands(PRODUCT, SIGN),
    },
)
"""What binds how tightly, of the operators that the generators use."""

SELF = Name("self")
NONE = Constant("None")
TRUE = Constant("True")
FALSE = Constant("False")


def code(item: Code | str) -> Code:
    """A name as a node."""
    return Name(item) if isinstance(item, str) else item


def own(name: str) -> Attribute:
    """``self.name``."""
    return Attribute(SELF, name)


def call(function: Code | str, *positional: Code, **named: Code) -> Call:
    """A call with positional and named arguments."""
    return Call(
        code(function),
        (*(Argument(value) for value in positional), *(Argument(value, name) for name, value in named.items())),
    )


def tuple_of(items: Iterable[Code]) -> Items:
    """A tuple in parentheses."""
    return Items("()", tuple(items))


def typed(class_: str, argument: str) -> Element:
    """A generic class with its argument: ``In[float]``."""
    return Name(class_).at(Constant(argument))


def counted_to(count: int | Code) -> Call:
    """``range(count)``."""
    return call("range", Constant(str(count)) if isinstance(count, int) else count)


def counted_from(start: int, count: int) -> Call:
    """``range(start, start + count)``."""
    return call("range", Constant(str(start)), Constant(str(start + count))) if start else counted_to(count)


def number(text: str) -> Code:
    """A real number in decimal notation, also one with a sign."""
    return Prefix("-", Constant(text[1:])) if text.startswith("-") else Constant(text)


def integer(value: int) -> Code:
    """A whole number; a negative one is not counted with."""
    return WholeNumber(value) if value >= 0 else Prefix("-", Constant(str(-value)))


def awaited(item: Code) -> Prefix:
    """``await x``."""
    return Prefix("await ", item)


def delegated(item: Code) -> Prefix:
    """``yield from x``."""
    return Prefix("yield from ", item)


def at_least(code: Code, precedence: int) -> Code:
    """``code``, in parentheses if it binds more loosely than ``precedence``."""
    return PARENTHESES.at_least(code, precedence)


def attributes_of_self(item: object) -> Iterator[str]:
    """The attributes of ``self`` that a tree mentions."""
    return (node.name for node in nodes(item) if isinstance(node, Attribute) and node.operand == SELF)


def mentions(item: object, name: str) -> bool:
    """Whether a tree reads a local variable."""
    return any(isinstance(node, Name) and node.text == name for node in nodes(item))
