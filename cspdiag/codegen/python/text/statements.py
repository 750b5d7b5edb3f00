"""Python statements as trees, and their lines."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Literal, TypeAlias, assert_never

from cspdiag.base.record import record
from cspdiag.codegen.python.text.code import (
    SELF,
    Attribute,
    Call,
    Code,
    Constant,
    Items,
    Name,
    Prefix,
    code,
    counted_to,
)
from cspdiag.codegen.python.text.layout import INDENT, LINE_LENGTH, bracketed, comment_line, statement
from cspdiag.codegen.python.text.literals import docstring, remark
from cspdiag.codegen.shared.trees import Closed, nodes

NOTHING = Constant("")


@record
class Remark:
    """A comment on a line of its own."""

    text: str


@record
class Plain:
    """A simple statement: an expression, or a keyword with or without one."""

    keyword: Literal["", "return", "raise", "break", "pass", "yield", "nonlocal"]
    code: Code | None = None
    comment: str | None = None


@record
class Assign:
    """``target = value``, or another operator that assigns; ``annotation`` declares the target as well."""

    target: Code
    value: Code
    comment: str | None = None
    operator: str = "="
    annotation: str | None = None


@record
class Declare:
    """``target: annotation``, without a value."""

    target: Code
    annotation: str


@record
class Unpack(Closed):
    """``a, b = value``."""

    targets: tuple[Code, ...]
    value: Code
    comment: str | None = None


@record
class Block:
    """A keyword that begins a block, with ``code`` after it, and the name that ``as`` binds; an empty body becomes
    ``pass``.
    """

    keyword: Literal["if", "elif", "else", "while", "try", "except", "finally", "with", "match", "case"]
    code: Code | None
    body: tuple[Statement, ...]
    comment: str | None = None
    bound: str | None = None


@record
class For:
    """``for variable in items``."""

    variable: str
    items: Code
    body: tuple[Statement, ...]


@record
class Function(Closed):
    """A function or method; it is separated from other statements by blank lines."""

    name: str
    parameters: tuple[str, ...]
    body: tuple[Statement, ...]
    returns: str = "None"
    doc: str | None = None
    waits: bool = False
    """Whether it is a coroutine."""


Statement: TypeAlias = Remark | Plain | Assign | Declare | Unpack | Block | For | Function
Statements: TypeAlias = tuple[Statement, ...]

PASS = Plain("pass")
BREAK = Plain("break")
YIELD = Plain("yield")
RAISE = Plain("raise")


def assign(target: Code | str, value: Code, comment: str | None = None) -> Assign:
    """``target = value``."""
    return Assign(code(target), value, comment)


def change(target: Code | str, operator: str, value: Code) -> Assign:
    """``target += value``."""
    return Assign(code(target), value, operator=operator)


def unpack(targets: Sequence[Code], value: Code, comment: str | None = None) -> Statement:
    """``a, b = value``; an assignment for one target, an expression statement for none."""
    match targets:
        case []:
            return run(value, comment)
        case [target]:
            return assign(target, value, comment)
        case _:  # Two or more.
            return Unpack(tuple(targets), value, comment)


def run(code: Code, comment: str | None = None) -> Plain:
    """An expression statement."""
    return Plain("", code, comment)


def return_(*values: Code, comment: str | None = None) -> Plain:
    """``return value``; several values as a tuple."""
    return Plain("return", values[0] if len(values) == 1 else Items("", values), comment)


def nonlocal_(names: Iterable[str]) -> Statements:
    """``nonlocal a, b``; nothing for no names."""
    listed = tuple(map(Name, names))
    return (Plain("nonlocal", Items("", listed)),) if listed else ()


def if_(condition: Code, *then: Statement) -> Block:
    """``if condition:``."""
    return Block("if", condition, then)


def else_(*otherwise: Statement) -> Block:
    """``else:``."""
    return Block("else", None, otherwise)


def try_(*body: Statement) -> Block:
    """``try:``."""
    return Block("try", None, body)


def repeat(count: int, body: Statements, variable: str = "_") -> For:
    """``for _ in range(count):``."""
    return For(variable, counted_to(count), body)


def bound_in(statements: Iterable[Statement]) -> Iterator[str]:
    """The local variables that statements assign or use as loop variables."""
    for item in _statements_in(statements):
        if isinstance(item, For):
            yield item.variable
        elif isinstance(item, Assign | Unpack):
            targets = (item.target,) if isinstance(item, Assign) else item.targets
            yield from (target.text for target in targets if isinstance(target, Name))


def attributes_set(statements: Iterable[Statement]) -> Iterator[str]:
    """The attributes of ``self`` that statements assign."""
    for item in _statements_in(statements):
        target = item.target if isinstance(item, Assign) else None
        if isinstance(target, Attribute) and target.operand == SELF:
            yield target.name


def _statements_in(statements: Iterable[Statement]) -> Iterator[Statement]:
    for item in statements:
        yield item
        if isinstance(item, (Block, For, Function)):
            yield from _statements_in(item.body)


def waits(statements: Iterable[Statement]) -> bool:
    """Whether a generator function may wait in these statements."""
    found = nodes(tuple(statements))
    return any(node == YIELD or (isinstance(node, Prefix) and node.text == "yield from ") for node in found)


def lines(statements: Iterable[Statement], indent: str = "") -> list[str]:
    """The lines of statements at an indentation."""
    result: list[str] = []
    after_function = False
    for item in statements:
        is_function = isinstance(item, Function)
        if result and (is_function or after_function):
            result.append("")
        after_function = is_function
        result += _lines(item, indent)
    return result


def _lines(item: Statement, indent: str) -> list[str]:
    match item:
        case Remark(text=text):
            return [comment_line(indent, text)]
        case Plain(keyword="nonlocal", code=Items(items=names)):
            return [f"{indent}{row}" for row in _rows("nonlocal ", names, LINE_LENGTH - len(indent))]
        case Plain(keyword=keyword, code=code):
            blank = " " if keyword and code is not None else ""
            return statement(f"{keyword}{blank}", code or NOTHING, "", indent, item.comment)
        case Assign(target=target, annotation=annotation):
            declared = f": {annotation}" if annotation else ""
            return statement(f"{target.flat}{declared} {item.operator} ", item.value, "", indent, item.comment)
        case Declare(target=target, annotation=annotation):
            return [f"{indent}{target.flat}: {annotation}"]
        case Unpack():
            return _unpacking(item, indent)
        case Block(keyword=keyword, code=code, bound=bound):
            after = f" as {bound}:" if bound else ":"
            head = statement(f"{keyword} " if code else keyword, code or NOTHING, after, indent, item.comment)
            return [*head, *_body(item.body, indent)]
        case For():
            return [*statement(f"for {item.variable} in ", item.items, ":", indent), *_body(item.body, indent)]
        case Function():
            start = "async def" if item.waits else "def"
            head = bracketed(indent, f"{start} {item.name}(", item.parameters, f") -> {item.returns}:")
            doc = docstring(item.doc, indent + INDENT) if item.doc is not None else []
            return [*head, *doc, *_body(item.body, indent)]
    assert_never(item)


def _rows(keyword: str, names: Sequence[Code], width: int) -> Iterator[str]:
    """A statement that can have no parentheses: as many names on a line as fit, each line a statement of its own."""
    row = ""
    for name in names:
        longer = f"{row}, {name.flat}" if row else f"{keyword}{name.flat}"
        if row and len(longer) > width:
            yield row
            longer = f"{keyword}{name.flat}"
        row = longer
    if row:
        yield row


def _body(body: Statements, indent: str) -> list[str]:
    inner = indent + INDENT
    is_empty = all(isinstance(item, Remark) for item in body)
    return [*lines(body, inner), *([f"{inner}pass"] if is_empty else [])]


def _unpacking(item: Unpack, indent: str) -> list[str]:
    targets = [target.flat for target in item.targets]
    before = f"{', '.join(targets)} = "
    if len(indent) + len(before) + len(_opening(item.value)) <= LINE_LENGTH:
        return statement(before, item.value, "", indent, item.comment)
    rows = [f"{indent}(", *(f"{indent}{INDENT}{target}," for target in targets)]
    comment = [f"{indent}# {remark(item.comment)}"] if item.comment else []
    return [*comment, *rows, *statement(") = ", item.value, "", indent)]


def _opening(value: Code) -> str:
    """The text of a call, which may be awaited, up to its opening bracket."""
    match value:
        case Prefix(text=text, operand=operand):
            return text + _opening(operand)
        case Call(function=function):
            return f"{function.flat}("
        case Items(brackets="()"):
            return "("
        case _:  # Any other expression, whole.
            return value.flat
