"""Breaks Python statements over lines the way ``ruff format`` does.

Only the constructs that the generator uses are known here; the tests compare every generated file, and random statements, with
the real formatter.
"""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.codegen.python_code import (
    Atom,
    Call,
    Chain,
    Code,
    Comprehension,
    Conditional,
    Entry,
    Items,
    Parenthesized,
    Postfix,
    Prefix,
)

LINE_LENGTH = 100
"""Of generated code; its pyproject.toml says the same."""

INDENT = " " * 4


def statement(before: str, code: Code, after: str = "", indent: str = "", comment: str | None = None) -> list[str]:
    """The lines of ``before code after``, such as ``x = `` or ``if `` ... ``:``.

    ``comment`` stands at the end of the line, or on a line of its own before a statement that does not fit with it.
    """
    line = f"{indent}{before}{code.flat}{after}"
    if comment is not None and len(line) + 4 + len(comment) <= LINE_LENGTH:
        return [f"{line}  # {comment}"]
    lines = [] if comment is None else [f"{indent}# {comment}"]
    if len(line) <= LINE_LENGTH:
        return [*lines, line]
    return [*lines, *_broken_statement(indent, before, code, after)]


def _broken_statement(indent: str, before: str, code: Code, after: str) -> list[str]:
    if isinstance(code, Chain | Conditional) or (isinstance(code, Prefix) and code.text != "await "):
        if _splits_at_brackets(code):
            at_brackets = _broken(indent, before, code, after)
            if all(len(line) <= LINE_LENGTH for line in at_brackets):
                return at_brackets
        return [f"{indent}{before}(", *_inside(indent + INDENT, "", code, ""), f"{indent}){after}"]
    if isinstance(code, Atom):
        wrapped = [f"{indent}{before}(", f"{indent}{INDENT}{code.text}", f"{indent}){after}"]
        return wrapped if len(wrapped[1]) <= LINE_LENGTH else [f"{indent}{before}{code.text}{after}"]
    return _broken(indent, before, code, after)


def _splits_at_brackets(code: Code) -> bool:
    """Whether a lone operator leaves it to the brackets of its operands to break."""
    match code:
        case Chain(rest=((_, last),)):
            return _has_brackets(last) or _begins_with_brackets(code.first)
        case Prefix():
            return _has_brackets(code.operand)
    return False


def _has_brackets(code: Code) -> bool:
    match code:
        case Call():
            return bool(code.arguments)
        case Items():
            return bool(code.items)
        case Parenthesized() | Comprehension():
            return True
        case Prefix():
            return _has_brackets(code.operand)
    return False


def _begins_with_brackets(code: Code) -> bool:
    return isinstance(code, Parenthesized) or (isinstance(code, Items) and bool(code.items))


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
            operands = [("", code.then), ("if ", code.condition), ("else ", code.otherwise)]
            return _operands(indent, before, operands, after)
    return _broken(indent, before, code, after)


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
        case Atom() | Entry():
            return [f"{indent}{before}{code.flat}{after}"]
        case Call(arguments=()):
            return [f"{indent}{before}{code.flat}{after}"]
        case Call():
            return [f"{indent}{before}{code.function}(", *_arguments(deeper, code), f"{indent}){after}"]
        case Items(items=()):
            return [f"{indent}{before}{code.flat}{after}"]
        case Items():
            items = [line for item in code.items for line in _item(deeper, item)]
            return [f"{indent}{before}{code.brackets[0]}", *items, f"{indent}{code.brackets[1]}{after}"]
        case Comprehension():
            inner = [*_inside(deeper, "", code.element, ""), f"{deeper}{code.clause}"]
            return [f"{indent}{before}[", *inner, f"{indent}]{after}"] if code.bracketed else inner
        case Parenthesized():
            return [f"{indent}{before}(", *_inside(deeper, "", code.operand, ""), f"{indent}){after}"]
        case Postfix():
            return _broken(indent, before, code.operand, code.text + after)
        case Prefix():
            return _broken(indent, before + code.text, code.operand, after)
        case Chain():
            head = "".join(f"{operand.flat} {operator} " for operand, operator in _but_last(code))
            return _broken(indent, before + head, code.rest[-1][1], after)
        case Conditional():
            return _inside(indent, before, code, after)


def _but_last(code: Chain) -> list[tuple[Code, str]]:
    operands = [code.first, *(operand for _, operand in code.rest)]
    return [(operand, operator) for operand, (operator, _) in zip(operands, code.rest, strict=False)]


def _item(indent: str, item: Code) -> list[str]:
    if isinstance(item, Entry):
        return _inside(indent, f"{item.key}: ", item.value, ",")
    return _inside(indent, "", item, ",")


def _arguments(indent: str, code: Call) -> list[str]:
    line = indent + ", ".join(argument.flat for argument in code.arguments)
    if len(line) <= LINE_LENGTH:
        return [line]
    if len(code.arguments) == 1 and isinstance(code.arguments[0].value, Comprehension):
        argument = code.arguments[0]
        if not argument.value.bracketed:  # type: ignore[union-attr]
            return _inside(indent, "", argument.value, "")
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
