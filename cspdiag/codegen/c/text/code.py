"""C expressions as trees that know their precedence, with parentheses where C, compilers or readers need them."""

from __future__ import annotations

from typing import ClassVar, Literal

from cspdiag.base.record import lazily, record
from cspdiag.codegen.c.text.kernel import TAKES_KERNEL
from cspdiag.codegen.shared.document import (
    LINE,
    SOFT,
    Document,
    Fill,
    FirstThatFits,
    Flat,
    Group,
    Nest,
    flat,
    joined,
    listed,
)
from cspdiag.codegen.shared.parentheses import Operands, Parentheses
from cspdiag.codegen.shared.trees import Counted

COMMA, ASSIGNMENT, CONDITIONAL, OR, AND, EQUALITY, RELATION, SUM, PRODUCT, UNARY, POSTFIX = range(11)
"""The precedences of C that the generator uses, the loosest first."""

LINE_LENGTH = 100
"""The longest line of generated code, in characters."""

INDENT = "    "
"""The indentation of a block, and of continuation lines."""

STEP = len(INDENT)


class Code:
    """An expression; ``str`` gives its text on one line."""

    _PRECEDENCE: ClassVar[int] = POSTFIX

    @property
    def precedence(self) -> int:
        """How tightly its operator binds."""
        return self._PRECEDENCE

    @lazily
    def document(self) -> Document:
        """The text, with the places where it may be broken."""
        return self._document()

    def _document(self) -> Document:
        raise NotImplementedError

    def __str__(self) -> str:
        return flat(self.document)

    def field(self, name: str) -> Code:
        """``x.name``."""
        return Postfix(at_least(self, POSTFIX), f".{name}")

    def arrow(self, name: str) -> Code:
        """``x->name``."""
        return Postfix(at_least(self, POSTFIX), f"->{name}")

    def at(self, index: int | Code) -> Code:
        """``x[index]``."""
        return Element(at_least(self, POSTFIX), Count(index, "index") if isinstance(index, int) else index.as_index())

    def as_index(self) -> Code:
        """The same number where any type of integer will do."""
        return self


@record
class Atom(Code):
    """A name or a literal."""

    text: str

    def _document(self) -> Document:
        return self.text


@record
class Count(Code, Counted):
    """An integer that may count from one to the next of similar statements: an index, an unsigned literal, or an
    argument of type ``int64_t``.
    """

    value: int
    form: Literal["index", "unsigned", "argument"]

    def _document(self) -> Document:
        return f"{self.value}U" if self.form == "unsigned" else str(self.value)


@record
class Own(Code):
    """A member of the object that a function works on: ``self->x``."""

    member: Code

    def _document(self) -> Document:
        return ("self->", self.member.document)

    def field(self, name: str) -> Code:
        """``self->x.name``."""
        return Own(self.member.field(name))

    def at(self, index: int | Code) -> Code:
        """``self->x[index]``."""
        return Own(self.member.at(index))


@record
class Postfix(Code):
    """A member of a value: ``.x`` or ``->x``."""

    operand: Code
    text: str

    def _document(self) -> Document:
        return (self.operand.document, self.text)


@record
class Element(Code):
    """``x[i]``."""

    operand: Code
    index: Code

    def _document(self) -> Document:
        return (self.operand.document, "[", self.index.document, "]")


@record
class Call(Code):
    """A call of a function or of a macro that looks like one."""

    function: str
    arguments: tuple[Code, ...]

    def _document(self) -> Document:
        if not self.arguments:
            return f"{self.function}()"
        arguments = listed([argument.document for argument in self.arguments])
        whole = Fill(tuple(map(Flat, arguments)))
        inside = Fill(arguments)
        begins_with_operators = isinstance(self.arguments[0], Chain | Conditional)
        last = (SOFT, inside) if begins_with_operators else inside
        layouts = (Nest(STEP, whole), Nest(STEP, (SOFT, whole)), Nest(STEP, last))
        return (self.function, "(", FirstThatFits(tuple((layout, ")") for layout in layouts)))


@record
class Prefix(Code):
    """A sign, a negation, an address, a dereferenced pointer, or a cast ``(type)``."""

    text: str
    operand: Code

    _PRECEDENCE = UNARY

    def _document(self) -> Document:
        return (self.text, self.operand.document)


@record
class Chain(Code):
    """Operands joined by operators of one precedence: ``a + b - c``."""

    level: int
    first: Code
    rest: tuple[tuple[str, Code], ...]

    @property
    def precedence(self) -> int:
        """The precedence of the operators."""
        return self.level

    def _document(self) -> Document:
        rest = [(f"{operator} ", operand.document) for operator, operand in self.rest]
        parts = (self.first.document, *rest)
        return Nest(STEP, Fill(parts) if self.level == PRODUCT else Group(joined(LINE, parts)))


@record
class Conditional(Code):
    """``condition ? then : otherwise``."""

    condition: Code
    then: Code
    otherwise: Code

    _PRECEDENCE = CONDITIONAL

    def _document(self) -> Document:
        return self._choices(self.condition.document)

    @property
    def with_whole_condition(self) -> Document:
        """The text, with the condition kept on one line."""
        return self._choices(Flat(self.condition.document))

    def _choices(self, condition: Document) -> Document:
        choices = (LINE, "? ", self.then.document, LINE, ": ", self.otherwise.document)
        return Group(Nest(STEP, (condition, choices)))


@record
class Assignment(Code):
    """``target = value``, possibly with a type before it, or with another assignment operator."""

    target: Code
    value: Code
    operator: str = "="

    _PRECEDENCE = ASSIGNMENT

    def _document(self) -> Document:
        preferred = self.value.with_whole_condition if isinstance(self.value, Conditional) else None
        return assigned((self.target.document, f" {self.operator}"), self.value.document, preferred)


@record
class Sequence(Code):
    """Expressions joined by the comma operator, for use where no statement is possible."""

    parts: tuple[Code, ...]

    _PRECEDENCE = COMMA

    def _document(self) -> Document:
        return Nest(STEP, Fill(listed([part.document for part in self.parts])))


@record
class Parenthesized(Code):
    """An expression in parentheses, which its context needs."""

    operand: Code

    def _document(self) -> Document:
        return ("(", self.operand.document, ")")


@record
class Aggregate(Code):
    """The value of a struct or an array, with or without the names of members; with a type it is a compound literal."""

    parts: tuple[tuple[str | None, Code], ...]
    type_name: str | None = None

    def _document(self) -> Document:
        before = "{" if self.type_name is None else f"({self.type_name}){{"
        named = any(name is not None for name, _ in self.parts)
        inner = [part.document if name is None else (f"{name} = ", part.document) for name, part in self.parts]
        items = joined(LINE, listed(inner)) if named else Fill(listed(inner))
        return Group((before, Nest(STEP, (SOFT, items)), SOFT, "}"))


_PARENTHESES: Parentheses[Code] = Parentheses(
    Parenthesized,
    {
        OR: Operands(UNARY, UNARY),
        AND: Operands(UNARY, UNARY),
        EQUALITY: Operands(SUM, SUM, chain=False),
        RELATION: Operands(SUM, SUM, chain=False),
        SUM: Operands(SUM, PRODUCT),
        PRODUCT: Operands(PRODUCT, UNARY),
    },
)
"""The convention is that of the kernel: operands of ``&&`` and ``||`` and the condition of ``?:`` are in parentheses if
they have binary operators (MISRA C, rule 12.1); sums and products need none.
"""


def assigned(head: Document, value: Document, preferred: Document | None = None) -> Document:
    """``head value``: on one line, else with the whole value on the next line, else broken inside the value, preferably
    as in ``preferred``.
    """
    layouts: list[Document] = [(head, " ", Flat(value)), (head, Nest(STEP, (LINE, Flat(value))))]
    for broken in (value,) if preferred is None else (preferred, value):
        layouts += [(head, " ", broken), (head, Nest(STEP, (LINE, broken)))]
    return FirstThatFits(tuple(layouts))


def code(item: Code | str) -> Code:
    """A name or a literal as a node."""
    return Atom(item) if isinstance(item, str) else item


def own(member: Code | str) -> Own:
    """``self->member``; ``member`` may be a path, such as a member of a member or an element of one."""
    return Own(code(member))


def unsigned(value: int) -> Count:
    """``3U``."""
    return Count(value, "unsigned")


def at_least(item: Code, precedence: int) -> Code:
    """``item``, in parentheses if its operator binds less tightly than ``precedence``."""
    return _PARENTHESES.at_least(item, precedence)


def call(function: str, *arguments: Code | str) -> Call:
    """``function(a, b)``; what the kernel needs to know of the run is added."""
    if function in TAKES_KERNEL:
        arguments = (CSP, *arguments)
    return Call(function, tuple(at_least(code(argument), ASSIGNMENT) for argument in arguments))


def cast(type_name: str, item: Code) -> Code:
    """``(int8_t)x``; an expression that is already a cast to that type is returned unchanged."""
    if isinstance(item, Prefix) and item.text == f"({type_name})":
        return item
    return Prefix(f"({type_name})", at_least(item, UNARY))


def ignored(item: Code) -> Code:
    """A call whose result is ignored: ``(void)f()``."""
    return Prefix("(void)", item)


def address(item: Code) -> Code:
    """A pointer to an object: ``&x``."""
    if isinstance(item, Prefix) and item.text == "*":
        return item.operand
    return Prefix("&", at_least(item, UNARY))


def target(pointer: Code) -> Code:
    """The object that a pointer points to: ``*x``."""
    if isinstance(pointer, Prefix) and pointer.text == "&":
        return pointer.operand
    return Prefix("*", at_least(pointer, UNARY))


def member_of(pointer: Code, name: str) -> Code:
    """A member of the struct that a pointer points to: ``p->name``."""
    if isinstance(pointer, Prefix) and pointer.text == "&":
        return pointer.operand.field(name)
    return pointer.arrow(name)


def minus(item: Code) -> Code:
    """``-x``, without ever writing ``--x``."""
    inner = at_least(item, UNARY)
    return Prefix("-", Parenthesized(inner) if isinstance(inner, Prefix) and inner.text == "-" else inner)


def negated(condition: Code) -> Code:
    """The negation of a condition."""
    match condition:
        case Prefix(text="!", operand=operand):
            return operand.operand if isinstance(operand, Parenthesized) else operand
        case Chain(first=first, rest=(("==" | "!=" as operator, second),)):
            return Chain(EQUALITY, first, (("!=" if operator == "==" else "==", second),))
        case Atom(text="true" | "false" as text):
            return Atom("false" if text == "true" else "true")
        case Parenthesized(operand=operand):
            return negated(operand)
        case _:  # Any other expression.
            return Prefix("!", at_least(condition, UNARY))


def infix(operator: str, precedence: int, left: Code, right: Code) -> Code:
    """A left-associative binary operation."""
    first, second = _PARENTHESES.operands(precedence, left, right)
    if isinstance(first, Chain) and first.precedence == precedence:
        return Chain(precedence, first.first, (*first.rest, (operator, second)))
    return Chain(precedence, first, ((operator, second),))


def conditional(condition: Code, then: Code, otherwise: Code) -> Conditional:
    """``condition ? then : otherwise``."""
    return Conditional(at_least(condition, UNARY), at_least(then, SUM), at_least(otherwise, SUM))


def assign(target: Code | str, value: Code | str, operator: str = "=") -> Assignment:
    """``target = value``."""
    return Assignment(code(target), code(value), operator)


def in_order(parts: tuple[Code, ...]) -> Code:
    """The value of the last part, with the other parts evaluated before it."""
    *before, last = parts
    return Parenthesized(Sequence((*before, last))) if before else last


CSP = Atom("csp")
"""The state of the run."""
NOW = Atom("csp->now")
"""The present instant."""
CHANGES = Atom("csp->changes")
"""How often the parameters of the program have been set."""
