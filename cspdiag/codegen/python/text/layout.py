"""Breaks Python statements over lines the way ``ruff format`` does.

Only the constructs that the generator uses are known here; the tests compare every generated file, and random statements, with
the real formatter.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cspdiag.codegen.python.text.code import (
    CONDITIONAL,
    Atom,
    Call,
    Chain,
    Code,
    Comprehension,
    Conditional,
    Entry,
    Items,
    Named,
    Parenthesized,
    Postfix,
    Prefix,
    Starred,
)
from cspdiag.codegen.python.text.literals import remark

LINE_LENGTH = 100
"""Of generated code; its pyproject.toml says the same."""

INDENT = " " * 4


def statement(before: str, code: Code, after: str = "", indent: str = "", comment: str | None = None) -> list[str]:
    """The lines of ``before code after``, such as ``x = `` or ``if `` ... ``:``.

    ``comment`` stands at the end of the line, or on a line of its own before a statement that does not fit with it.
    """
    if before.startswith("#"):
        return [_comment_line(indent, before)]
    comment = comment and remark(comment)
    line = f"{indent}{before}{code.flat}{after}"
    if comment is not None and len(line) + 4 + len(comment) <= LINE_LENGTH:
        return [f"{line}  # {comment}"]
    lines = [] if comment is None else [f"{indent}# {comment}"]
    if len(line) <= LINE_LENGTH or not code.flat:
        return [*lines, line]
    return [*lines, *_broken_statement(indent, before, code, after)]


def _comment_line(indent: str, comment: str) -> str:
    line = f"{indent}{remark(comment)}"
    return line if len(line) <= LINE_LENGTH else f"{line[: LINE_LENGTH - 3].rstrip()}..."


def _broken_statement(indent: str, before: str, code: Code, after: str) -> list[str]:
    if isinstance(code, Chain | Conditional | Prefix):
        if _splits_at_brackets(code):
            at_brackets = _broken(indent, before, code, after)
            if all(len(line) <= LINE_LENGTH for line in at_brackets):
                return at_brackets
        if not _is_awaited_call(code):
            return [f"{indent}{before}(", *_inside(indent + INDENT, "", code, ""), f"{indent}){after}"]
    if isinstance(code, Atom):
        wrapped = [f"{indent}{before}(", f"{indent}{INDENT}{code.text}", f"{indent}){after}"]
        return wrapped if len(wrapped[1]) <= LINE_LENGTH else [f"{indent}{before}{code.text}{after}"]
    return _broken(indent, before, code, after)


def _is_awaited_call(code: Code) -> bool:
    return isinstance(code, Prefix) and code.text == "await " and isinstance(code.operand, Call)


def _splits_at_brackets(code: Code) -> bool:
    """Whether at most one loosest operator leaves it to the brackets at the ends to break, without parentheses around."""
    operators = list(_operators(code))
    if not operators:
        return True
    if min(operators) == CONDITIONAL or operators.count(min(operators)) > 1:
        return False
    return _has_brackets(_last(code)) or _has_brackets_first(code)


def _operators(code: Code) -> Iterator[int]:
    """The precedences of all operators outside brackets."""
    match code:
        case Chain():
            for operand in (code.first, *(operand for _, operand in code.rest)):
                yield from _operators(operand)
            yield from (code.precedence for _ in code.rest)
        case Conditional():
            yield code.precedence
            for operand in (code.then, code.condition, code.otherwise):
                yield from _operators(operand)
        case Prefix():
            yield from _operators(code.operand)


def _last(code: Code) -> Code:
    match code:
        case Chain():
            return _last(code.rest[-1][1])
        case Conditional():
            return _last(code.otherwise)
        case Prefix():
            return _last(code.operand)
    return code


def _has_brackets(code: Code) -> bool:
    match code:
        case Call():
            return bool(code.arguments)
        case Items():
            return bool(code.items)
        case Parenthesized() | Comprehension():
            return True
    return False


def _has_brackets_first(code: Code) -> bool:
    match code:
        case Chain():
            return _has_brackets_first(code.first)
        case Items() | Parenthesized():
            return _has_brackets(code)
    return False


def _inside(indent: str, before: str, code: Code, after: str) -> list[str]:
    """The lines of an expression that stands between brackets already."""
    line = f"{indent}{before}{code.flat}{after}"
    if len(line) <= LINE_LENGTH:
        return [line]
    match code:
        case Chain():
            operands = [("", code.first), *((f"{operator} ", operand) for operator, operand in code.rest)]
            return _operands(indent, before, operands, after)
        case Conditional():
            return _operands(indent, before, list(_alternatives(code)), after)
        case Prefix():
            return _inside(indent, before + code.text, code.operand, after)
        case Named():
            return _inside(indent, f"{before}{code.name} := ", code.value, after)
    return _broken(indent, before, code, after)


def _alternatives(code: Conditional) -> Iterator[tuple[str, Code]]:
    """The parts of a conditional; those that follow ``else`` without parentheses stand on the same level."""
    start = ""
    rest: Code = code
    while isinstance(rest, Conditional):
        yield start, rest.then
        yield "if ", rest.condition
        start, rest = "else ", rest.otherwise
    yield start, rest


def _operands(indent: str, before: str, operands: Sequence[tuple[str, Code]], after: str) -> list[str]:
    lines: list[str] = []
    for position, (operator, operand) in enumerate(operands):
        start = before if position == 0 else operator
        end = after if position == len(operands) - 1 else ""
        lines += _inside(indent, start, operand, end)
    return lines


def _broken(indent: str, before: str, code: Code, after: str) -> list[str]:
    """The lines of an expression broken at its own brackets."""
    deeper = indent + INDENT
    match code:
        case Atom() | Entry() | Call(arguments=()) | Items(items=()):
            return [f"{indent}{before}{code.flat}{after}"]
        case Call():
            return [f"{indent}{before}{code.function}(", *_arguments(deeper, code), f"{indent}){after}"]
        case Items():
            items = [line for item in code.items for line in _item(deeper, item)]
            return [f"{indent}{before}{code.brackets[0]}", *items, f"{indent}{code.brackets[1]}{after}"]
        case Comprehension():
            inner = [f"{deeper}{code.element.flat} {code.clause}"]
            if len(inner[0]) > LINE_LENGTH:
                inner = [*_inside(deeper, "", code.element, ""), f"{deeper}{code.clause}"]
            return [f"{indent}{before}{code.brackets[0]}", *inner, f"{indent}{code.brackets[1]}{after}"]
        case Starred():
            return _broken(indent, f"{before}*", code.value, after)
        case Parenthesized():
            return [f"{indent}{before}(", *_inside(deeper, "", code.operand, ""), f"{indent}){after}"]
        case Postfix():
            return _broken(indent, before, code.operand, code.text + after)
        case Prefix():
            return _broken(indent, before + code.text, code.operand, after)
        case Chain():
            return _flow(indent, before, list(_leaves(code, "")), after)
        case Conditional() | Named():
            return _inside(indent, before, code, after)


def _leaves(code: Code, before: str) -> Iterator[tuple[str, Code]]:
    """What an expression has outside brackets: operands, each with the operators before it."""
    match code:
        case Chain():
            yield from _leaves(code.first, before)
            for operator, operand in code.rest:
                yield from _leaves(operand, f" {operator} ")
        case Prefix():
            yield from _leaves(code.operand, before + code.text)
        case _:
            yield before, code


def _flow(indent: str, before: str, leaves: Sequence[tuple[str, Code]], after: str) -> list[str]:
    """Operands one behind the other; each stays flat if the line then reaches the next bracket, the last of them breaks."""
    lines: list[str] = []
    line = before
    for position, (operator, leaf) in enumerate(leaves):
        line += operator
        following = leaves[position + 1 :]
        if not _has_brackets(leaf) or _reaches(f"{indent}{line}{leaf.flat}", following, after):
            line += leaf.flat
            continue
        broken = _broken(indent, line, leaf, "")
        lines += broken[:-1]
        line = broken[-1].removeprefix(indent)
    return [*lines, f"{indent}{line}{after}"]


def _reaches(line: str, leaves: Sequence[tuple[str, Code]], after: str) -> bool:
    """Whether a line has room for what follows up to the next opening bracket, or for all of it."""
    for operator, leaf in leaves:
        if _has_brackets(leaf):
            opening = leaf.function if isinstance(leaf, Call) else ""
            return len(line) + len(operator) + len(opening) + 1 <= LINE_LENGTH
        line += operator + leaf.flat
    return len(line) + len(after) <= LINE_LENGTH


def _item(indent: str, item: Code) -> list[str]:
    if isinstance(item, Entry):
        return _inside(indent, f"{item.key}: ", item.value, ",")
    return _inside(indent, "", item, ",")


def _arguments(indent: str, code: Call) -> list[str]:
    line = indent + ", ".join(argument.flat for argument in code.arguments)
    if len(line) <= LINE_LENGTH:
        return [line]
    return [line for argument in code.arguments for line in _inside(indent, argument.prefix, argument.value, ",")]


def bracketed(indent: str, before: str, items: Sequence[str], after: str, *, together: bool = True) -> list[str]:
    """``before`` items ``after`` where ``before`` ends in an opening bracket: on one line, one indented line, or one line an item.

    ``together`` allows the items on one indented line, as for arguments; imports do not.
    """
    line = f"{indent}{before}{', '.join(items)}{after}"
    if len(line) <= LINE_LENGTH:
        return [line]
    inner = f"{indent}{INDENT}{', '.join(items)}"
    if together and len(inner) <= LINE_LENGTH:
        return [f"{indent}{before}", inner, f"{indent}{after}"]
    return [f"{indent}{before}", *(f"{indent}{INDENT}{item}," for item in items), f"{indent}{after}"]
