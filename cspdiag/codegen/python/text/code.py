"""Python expressions as trees that know their precedence and their text on one line.

The generator builds these; ``python_layout`` breaks them over lines where a line is too short.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import ClassVar, Literal, TypeAlias

from cspdiag.base.record import record

CONDITIONAL, OR, AND, NOT, COMPARISON, SUM, PRODUCT, SIGN, AWAIT, PRIMARY = range(10)
"""Precedences of Python, the loosest first (The Python Language Reference, section 6.17)."""


@record
class Atom:
    """A name, a literal or an attribute: text that never breaks; ``precedence`` is lower for a negative number."""

    text: str
    precedence: int = PRIMARY

    @property
    def flat(self) -> str:
        """The text on one line."""
        return self.text


@record
class Argument:
    """An argument of a call: positional, ``name=value``, or ``*value``."""

    value: Code
    name: str | None = None
    starred: bool = False

    @property
    def prefix(self) -> str:
        """What stands before the value."""
        return f"{self.name}=" if self.name else "*" if self.starred else ""

    @property
    def flat(self) -> str:
        """The text on one line."""
        return self.prefix + self.value.flat


@record
class Call:
    """A call of something named."""

    function: str
    arguments: tuple[Argument, ...]
    precedence: ClassVar[int] = PRIMARY

    @cached_property
    def flat(self) -> str:
        """The text on one line."""
        return f"{self.function}({', '.join(argument.flat for argument in self.arguments)})"


@record
class Postfix:
    """An attribute or an element of a value: ``operand.x``, ``operand[0]``."""

    operand: Code
    text: str
    precedence: ClassVar[int] = PRIMARY

    @cached_property
    def flat(self) -> str:
        """The text on one line."""
        return self.operand.flat + self.text


@record
class Prefix:
    """``-x``, ``not x``, ``await x``: the text before the operand, blank included."""

    text: Literal["-", "not ", "await "]
    operand: Code

    @property
    def precedence(self) -> int:
        """How tightly the operator binds."""
        return {"-": SIGN, "not ": NOT, "await ": AWAIT}[self.text]

    @cached_property
    def flat(self) -> str:
        """The text on one line."""
        return self.text + self.operand.flat


@record
class Chain:
    """Operands joined by operators of one precedence: ``a + b - c``."""

    precedence: int
    first: Code
    rest: tuple[tuple[str, Code], ...]

    @cached_property
    def flat(self) -> str:
        """The text on one line."""
        return self.first.flat + "".join(f" {operator} {operand.flat}" for operator, operand in self.rest)


@record
class Conditional:
    """``then if condition else otherwise``."""

    then: Code
    condition: Code
    otherwise: Code
    precedence: ClassVar[int] = CONDITIONAL

    @cached_property
    def flat(self) -> str:
        """The text on one line."""
        return f"{self.then.flat} if {self.condition.flat} else {self.otherwise.flat}"


@record
class Parenthesized:
    """An expression in the parentheses that its surroundings ask for."""

    operand: Code
    precedence: ClassVar[int] = PRIMARY

    @cached_property
    def flat(self) -> str:
        """The text on one line."""
        return f"({self.operand.flat})"


@record
class Items:
    """A tuple, a list or a dictionary (its items then ``key: value`` by ``name``)."""

    brackets: Literal["()", "[]", "{}"]
    items: tuple[Code, ...]
    precedence: ClassVar[int] = PRIMARY

    @cached_property
    def flat(self) -> str:
        """The text on one line."""
        inside = ", ".join(item.flat for item in self.items)
        comma = "," if self.brackets == "()" and len(self.items) == 1 else ""
        return f"{self.brackets[0]}{inside}{comma}{self.brackets[1]}"


@record
class Entry:
    """``key: value`` in a dictionary."""

    key: str
    value: Code
    precedence: ClassVar[int] = PRIMARY

    @property
    def flat(self) -> str:
        """The text on one line."""
        return f"{self.key}: {self.value.flat}"


@record
class Comprehension:
    """``[element for i in range(8)]``, or a generator in parentheses."""

    element: Code
    clause: str
    brackets: Literal["[]", "()"] = "[]"
    precedence: ClassVar[int] = PRIMARY

    @cached_property
    def flat(self) -> str:
        """The text on one line."""
        return f"{self.brackets[0]}{self.element.flat} {self.clause}{self.brackets[1]}"


@record
class Starred:
    """``*value`` in a list."""

    value: Code
    precedence: ClassVar[int] = PRIMARY

    @property
    def flat(self) -> str:
        """The text on one line."""
        return f"*{self.value.flat}"


@record
class Named:
    """``name := value``: a value that is wanted again in the same expression; always in parentheses."""

    name: str
    value: Code
    precedence: ClassVar[int] = CONDITIONAL - 1

    @property
    def flat(self) -> str:
        """The text on one line."""
        return f"{self.name} := {self.value.flat}"


Code: TypeAlias = (
    Atom
    | Call
    | Postfix
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


def call(function: str, *positional: Code, **named: Code) -> Call:
    """A call with positional and named arguments."""
    return Call(
        function,
        (*(Argument(value) for value in positional), *(Argument(value, name) for name, value in named.items())),
    )


def tuple_of(items: Iterable[Code]) -> Items:
    """A tuple in parentheses."""
    return Items("()", tuple(items))


def at_least(code: Code, precedence: int) -> Code:
    """``code``, in parentheses if it binds more loosely than ``precedence``."""
    return code if code.precedence >= precedence else Parenthesized(code)


def infix(operator: str, precedence: int, left: Code, right: Code) -> Code:
    """``left operator right`` for an operator that groups to the left; comparisons do not chain."""
    right = at_least(right, precedence + 1)
    if precedence == COMPARISON:
        return Chain(precedence, at_least(left, precedence + 1), ((operator, right),))
    if isinstance(left, Chain) and left.precedence == precedence:
        return Chain(precedence, left.first, (*left.rest, (operator, right)))
    return Chain(precedence, at_least(left, precedence), ((operator, right),))
