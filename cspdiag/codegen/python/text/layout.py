"""Breaks Python statements over lines the way ``ruff format`` does.

Only the constructs that the generator uses are known here; the tests compare every generated file, and random
statements, with the real formatter.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import assert_never

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
from cspdiag.codegen.shared.document import LINE, SOFT, Choice, Document, Flat, Group, Nest, joined, render

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
    return [*lines, *render((before, _statement(code), after), LINE_LENGTH, len(indent))]


def _comment_line(indent: str, comment: str) -> str:
    line = f"{indent}{remark(comment)}"
    return line if len(line) <= LINE_LENGTH else f"{line[: LINE_LENGTH - 3].rstrip()}..."


def _statement(code: Code) -> Document:
    """An expression that stands behind the beginning of a statement, and does not fit on its line."""
    if isinstance(code, Chain | Conditional | Prefix):
        at_brackets = (_at_brackets(code),) if _splits_at_brackets(code) else ()
        in_parentheses = () if _is_awaited_call(code) else (_surrounded("(", _inside(code), ")"),)
        return Choice((*at_brackets, *(in_parentheses or (_at_brackets(code),))))
    if isinstance(code, Atom):
        return Choice((_surrounded("(", code.text, ")"), code.text))
    return _at_brackets(code)


def _is_awaited_call(code: Code) -> bool:
    return isinstance(code, Prefix) and code.text == "await " and isinstance(code.operand, Call)


def _splits_at_brackets(code: Code) -> bool:
    """Whether at most one loosest operator leaves it to the brackets at the ends to break, without
    parentheses around.
    """
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
        case Atom() | Call() | Postfix() | Parenthesized() | Items() | Entry() | Comprehension() | Starred() | Named():
            pass
        case _:
            assert_never(code)


def _last(code: Code) -> Code:
    match code:
        case Chain():
            return _last(code.rest[-1][1])
        case Conditional():
            return _last(code.otherwise)
        case Prefix():
            return _last(code.operand)
        case Atom() | Call() | Postfix() | Parenthesized() | Items() | Entry() | Comprehension() | Starred() | Named():
            return code
        case _:
            assert_never(code)


def _has_brackets(code: Code) -> bool:
    match code:
        case Call():
            return bool(code.arguments)
        case Items():
            return bool(code.items)
        case Parenthesized() | Comprehension():
            return True
        case Atom() | Postfix() | Prefix() | Chain() | Conditional() | Entry() | Starred() | Named():
            return False
        case _:
            assert_never(code)


def _has_brackets_first(code: Code) -> bool:
    match code:
        case Chain():
            return _has_brackets_first(code.first)
        case Items() | Parenthesized():
            return _has_brackets(code)
        case Atom() | Call() | Postfix() | Prefix() | Conditional() | Entry() | Comprehension() | Starred() | Named():
            return False
        case _:
            assert_never(code)


def _inside(code: Code) -> Document:
    """An expression that stands between brackets already."""
    match code:
        case Chain():
            rest = [(f"{operator} ", _inside(operand)) for operator, operand in code.rest]
            return Group(joined(LINE, (_inside(code.first), *rest)))
        case Conditional():
            return Group(joined(LINE, [(start, _inside(operand)) for start, operand in _alternatives(code)]))
        case Prefix():
            return (code.text, _inside(code.operand))
        case Named():
            return (f"{code.name} := ", _inside(code.value))
        case Atom() | Call() | Postfix() | Parenthesized() | Items() | Entry() | Comprehension() | Starred():
            return _at_brackets(code)
        case _:
            assert_never(code)


def _alternatives(code: Conditional) -> Iterator[tuple[str, Code]]:
    """The parts of a conditional; those that follow ``else`` without parentheses stand on the same level."""
    start = ""
    rest: Code = code
    while isinstance(rest, Conditional):
        yield start, rest.then
        yield "if ", rest.condition
        start, rest = "else ", rest.otherwise
    yield start, rest


def _at_brackets(code: Code) -> Document:
    """An expression that is broken at its own brackets."""
    match code:
        case Atom() | Entry() | Call(arguments=()) | Items(items=()):
            return code.flat
        case Call():
            return _bracketed(code, f"{code.function}(", _arguments(code), ")")
        case Items():
            items = joined(LINE, [(_item(item), ",") for item in code.items])
            return _bracketed(code, code.brackets[0], items, code.brackets[1])
        case Comprehension():
            several = (_inside(code.element), LINE, code.clause)
            inner = Choice((Flat(f"{code.element.flat} {code.clause}"), several))
            return _bracketed(code, code.brackets[0], inner, code.brackets[1])
        case Starred():
            return ("*", _at_brackets(code.value))
        case Parenthesized():
            return _bracketed(code, "(", _inside(code.operand), ")")
        case Postfix():
            return (_at_brackets(code.operand), code.text)
        case Prefix():
            return (code.text, _at_brackets(code.operand))
        case Chain():
            return tuple((operator, _at_brackets(leaf)) for operator, leaf in _leaves(code, ""))
        case Conditional() | Named():
            return _inside(code)


def _bracketed(code: Code, opening: str, inner: Document, closing: str) -> Document:
    """On one line, or with the brackets on lines of their own."""
    return Choice((Flat(code.flat), _surrounded(opening, inner, closing)))


def _surrounded(opening: str, inner: Document, closing: str) -> Document:
    return (opening, Nest(len(INDENT), (SOFT, inner)), SOFT, closing)


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


def _item(item: Code) -> Document:
    return (f"{item.key}: ", _inside(item.value)) if isinstance(item, Entry) else _inside(item)


def _arguments(code: Call) -> Document:
    """On one line of their own, or on a line each."""
    together = Flat(", ".join(argument.flat for argument in code.arguments))
    return Choice((together, joined(LINE, [(a.prefix, _inside(a.value), ",") for a in code.arguments])))


def bracketed(indent: str, before: str, items: Sequence[str], after: str, *, together: bool = True) -> list[str]:
    """``before`` items ``after`` where ``before`` ends in an opening bracket: on one line, one indented line, or one
    line an item.

    ``together`` allows the items on one indented line, as for arguments; imports do not.
    """
    inner = Flat(", ".join(items))
    apart = _surrounded(before, joined(LINE, [f"{item}," for item in items]), after)
    beneath = (_surrounded(before, inner, after),) if together else ()
    return render(Choice((Flat((before, inner, after)), *beneath, apart)), LINE_LENGTH, len(indent))
