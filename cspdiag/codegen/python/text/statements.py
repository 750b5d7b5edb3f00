"""Python statements as trees, and their lines."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from typing import TypeAlias

from cspdiag.base.record import record
from cspdiag.codegen.python.text.code import Atom, Code
from cspdiag.codegen.python.text.layout import INDENT, LINE_LENGTH, bracketed, statement
from cspdiag.codegen.python.text.literals import remark

NOTHING = Atom("")


@record
class Line:
    """A simple statement: ``before code after``."""

    before: str
    code: Code = NOTHING
    after: str = ""
    comment: str | None = None


@record
class Block:
    """A head that ends in a colon, and what it governs; an empty body is ``pass``."""

    head: Line
    body: tuple[Statement, ...]


@record
class Unpack:
    """``a, b = code``."""

    targets: tuple[str, ...]
    code: Code
    comment: str | None = None


Statement: TypeAlias = Line | Block | Unpack


def assign(target: str, value: Code, comment: str | None = None) -> Line:
    """``target = value``."""
    return Line(f"{target} = ", value, comment=comment)


def run(code: Code, comment: str | None = None) -> Line:
    """An expression as a statement."""
    return Line("", code, comment=comment)


_BINDING = re.compile(r"(?:for )?(\w+) (?:=|in)(?: |$)")


def bound_in(statements: Iterable[Statement]) -> Iterator[str]:
    """The local variables that statements set or count with."""
    for item in statements:
        match item:
            case Line(before=before):
                found = _BINDING.match(before)
                if found is not None:
                    yield found[1]
            case Block(head=head, body=body):
                yield from bound_in((head, *body))
            case Unpack(targets=targets):
                yield from targets


def lines(statements: Iterable[Statement], indent: str) -> list[str]:
    """The lines of statements at an indentation; a function among them stands between blank lines."""
    result: list[str] = []
    after_function = False
    for item in statements:
        is_function = isinstance(item, Block) and item.head.before.startswith("def ")
        if result and (is_function or after_function):
            result.append("")
        after_function = is_function
        match item:
            case Line():
                result += statement(item.before, item.code, item.after, indent, item.comment)
            case Block(head=head, body=body):
                result += statement(head.before, head.code, head.after, indent, head.comment)
                rows = lines(body, indent + INDENT)
                result += rows
                if all(row.lstrip().startswith("#") for row in rows):
                    result.append(f"{indent}{INDENT}pass")
            case Unpack():
                result += _unpacking(item, indent)
    return result


def _unpacking(item: Unpack, indent: str) -> list[str]:
    before = f"{', '.join(item.targets)} = "
    opening = item.code.flat.partition("(")[0] + "("
    if len(indent) + len(before) + len(opening) <= LINE_LENGTH:
        return statement(before, item.code, "", indent, item.comment)
    rows = [f"{indent}(", *(f"{indent}{INDENT}{target}," for target in item.targets)]
    comment = [f"{indent}# {remark(item.comment)}"] if item.comment else []
    return [*comment, *rows, *statement(") = ", item.code, "", indent)]


def signature(before: str, parameters: Sequence[str], after: str, indent: str) -> list[str]:
    """The head of a function: on one line, or one parameter a line."""
    return bracketed(indent, f"{before}(", parameters, f"){after}", together=False)
