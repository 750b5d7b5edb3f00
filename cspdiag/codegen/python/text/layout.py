"""Breaks Python statements over lines the way ``ruff format`` does.

Only the constructs that the generator uses are handled; the tests compare every generated file, and random statements,
with the formatter itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import assert_never

from cspdiag.codegen.python.text.code import (
    CONDITIONAL,
    Attribute,
    Call,
    Chain,
    Code,
    Comprehension,
    Conditional,
    Constant,
    Element,
    Entry,
    Formatted,
    Items,
    Name,
    Named,
    Parenthesized,
    Prefix,
    Primary,
    Starred,
    WholeNumber,
)
from cspdiag.codegen.python.text.literals import remark
from cspdiag.codegen.shared.document import LINE, SOFT, Document, FirstThatFits, Flat, Group, Nest, joined, render

LINE_LENGTH = 100
"""The line length of generated code, as in its pyproject.toml."""

INDENT = " " * 4

_LEAST_COMMENT = 40
"""The columns that a comment has, however deep it is nested."""


def statement(before: str, code: Code, after: str = "", indent: str = "", comment: str | None = None) -> list[str]:
    """The lines of ``before code after``, such as ``x = `` or ``if `` ... ``:``.

    ``comment`` is put at the end of the line, or on a line of its own before a statement that leaves no room for it.
    """
    comment = comment and remark(comment)
    line = f"{indent}{before}{code.flat}{after}"
    if comment is not None and len(line) + 4 + len(comment) <= LINE_LENGTH:
        return [f"{line}  # {comment}"]
    lines = [] if comment is None else [f"{indent}# {comment}"]
    if len(line) <= LINE_LENGTH:
        return [*lines, line]
    if isinstance(code, Call) and code.arguments and len(indent + INDENT + code.inside) <= LINE_LENGTH:
        # As ``_at_brackets`` would break it, without a document for each argument.
        return [*lines, f"{indent}{before}{code.function.flat}(", f"{indent}{INDENT}{code.inside}", f"{indent}){after}"]
    return [*lines, *render((before, _statement(code), after), LINE_LENGTH, len(indent))]


def comment_line(indent: str, comment: str) -> str:
    """A comment on its own line, truncated if it is too long; in deep statements it may go past the line length."""
    text = f"# {remark(comment)}".rstrip()
    room = max(LINE_LENGTH - len(indent), _LEAST_COMMENT)
    return indent + (text if len(text) <= room else f"{text[: room - 3].rstrip()}...")


def _statement(code: Code) -> Document:
    """An expression in a statement that does not fit on its line."""
    if isinstance(code, Chain | Conditional | Prefix):
        at_brackets = (_at_brackets(code),) if _splits_at_brackets(code) else ()
        in_parentheses = () if _is_call_behind_keyword(code) else (_surrounded("(", _inside(code), ")"),)
        return FirstThatFits((*at_brackets, *(in_parentheses or (_at_brackets(code),))))
    if isinstance(code, Items) and not code.brackets:
        return _surrounded("(", _listed(code), ")")
    if _is_atom(code):
        return FirstThatFits((_surrounded("(", code.flat, ")"), code.flat))
    return _at_brackets(code)


def _is_call_behind_keyword(code: Code) -> bool:
    return isinstance(code, Prefix) and code.text in ("await ", "yield from ") and isinstance(code.operand, Call)


def _is_atom(code: Code) -> bool:
    """Whether an expression cannot be broken anywhere."""
    if isinstance(code, Attribute | Element):
        return _is_atom(code.operand)
    return isinstance(code, Name | Constant | WholeNumber | Formatted)


def _splits_at_brackets(code: Code) -> bool:
    """Whether an expression with at most one operator of the lowest precedence is broken at its outer brackets, without
    parentheses around it.
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
        case Primary() | Named():
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
        case Primary() | Named():
            return code
        case _:
            assert_never(code)


def _has_brackets(code: Code) -> bool:
    if isinstance(code, Call):
        return bool(code.arguments)
    return bool(code.items) if isinstance(code, Items) else isinstance(code, Parenthesized | Comprehension)


def _has_brackets_first(code: Code) -> bool:
    if isinstance(code, Chain):
        return _has_brackets_first(code.first)
    return isinstance(code, Items | Parenthesized) and _has_brackets(code)


def _inside(code: Code) -> Document:
    """An expression that is already between brackets."""
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
        case Primary():
            return _at_brackets(code)
        case _:
            assert_never(code)


def _alternatives(code: Conditional) -> Iterator[tuple[str, Code]]:
    """The parts of a conditional; those after ``else`` without parentheses are on the same level."""
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
        case Name() | Constant() | WholeNumber() | Formatted() | Entry() | Call(arguments=()) | Items(items=()):
            return code.flat
        case Call():
            return _bracketed(code, f"{code.function.flat}(", _arguments(code), ")")
        case Items():
            return _bracketed(code, code.brackets[:1], _listed(code), code.brackets[1:])
        case Comprehension():
            several = (_inside(code.element), LINE, code.clause)
            inner = FirstThatFits((Flat(f"{code.element.flat} {code.clause}"), several))
            return _bracketed(code, code.brackets[:-1], inner, code.brackets[-1])
        case Starred():
            return ("*", _at_brackets(code.value))
        case Parenthesized():
            return _bracketed(code, "(", _inside(code.operand), ")")
        case Attribute():
            return (_at_brackets(code.operand), f".{code.name}")
        case Element():
            return (_at_brackets(code.operand), f"[{code.index.flat}]")
        case Prefix():
            return (code.text, _at_brackets(code.operand))
        case Chain():
            return tuple((operator, _at_brackets(leaf)) for operator, leaf in _leaves(code, ""))
        case Conditional() | Named():
            return _inside(code)
        case _:
            assert_never(code)


def _bracketed(code: Code, opening: str, inner: Document, closing: str) -> Document:
    """On one line, or with the brackets on lines of their own."""
    return FirstThatFits((Flat(code.flat), _surrounded(opening, inner, closing)))


def _surrounded(opening: str, inner: Document, closing: str) -> Document:
    return (opening, Nest(len(INDENT), (SOFT, inner)), SOFT, closing)


def _leaves(code: Code, before: str) -> Iterator[tuple[str, Code]]:
    """The operands of an expression outside brackets, each with the operators before it."""
    match code:
        case Chain():
            yield from _leaves(code.first, before)
            for operator, operand in code.rest:
                yield from _leaves(operand, f" {operator} ")
        case Prefix():
            yield from _leaves(code.operand, before + code.text)
        case (
            Name() | Constant() | WholeNumber() | Formatted() | Attribute() | Element() | Call() | Conditional()
            | Parenthesized() | Items() | Entry() | Comprehension() | Starred() | Named()
        ):  # fmt: skip
            yield before, code
        case _:
            assert_never(code)


def _listed(code: Items) -> Document:
    return joined(LINE, [(_item(item), ",") for item in code.items])


def _item(item: Code) -> Document:
    return (f"{item.key}: ", _inside(item.value)) if isinstance(item, Entry) else _inside(item)


def _arguments(code: Call) -> Document:
    """The arguments together on one line, or each on its own line."""
    return FirstThatFits((Flat(code.inside), joined(LINE, [(a.prefix, _inside(a.value), ",") for a in code.arguments])))


def bracketed(indent: str, before: str, items: Sequence[str], after: str) -> list[str]:
    """``before`` items ``after`` where ``before`` ends in an opening bracket: on one line, or one line an item."""
    whole = Flat((before, ", ".join(items), after))
    apart = _surrounded(before, joined(LINE, [f"{item}," for item in items]), after)
    return render(FirstThatFits((whole, apart)), LINE_LENGTH, len(indent))
