"""C expressions as text with a precedence, and statements broken over lines."""

from __future__ import annotations

from dataclasses import dataclass

COMMA, CONDITIONAL, OR, AND, EQUALITY, RELATION, SUM, PRODUCT, UNARY, POSTFIX = range(10)
"""Precedences of C, the loosest first; those that the generator does not use are left out."""

LINE_LENGTH = 100
"""Of generated code."""

INDENT = "    "


@dataclass(frozen=True)
class Code:
    """An expression; ``str`` gives the text."""

    text: str
    precedence: int = POSTFIX

    def __str__(self) -> str:
        return self.text

    def at_least(self, precedence: int) -> str:
        """The text, in parentheses if its operator is looser than ``precedence``."""
        return self.text if self.precedence >= precedence else f"({self.text})"


def call(function: str, *arguments: Code | str) -> Code:
    """``function(a, b)``."""
    return Code(f"{function}({', '.join(map(str, arguments))})")


def cast(type_name: str, code: Code) -> Code:
    """``(int8_t)x``."""
    return Code(f"({type_name}){code.at_least(UNARY)}", UNARY)


def infix(operator: str, precedence: int, left: Code, right: Code) -> Code:
    """A left-associative operator; comparisons and logic are parenthesized where compilers ask for it."""
    first, second = precedence, precedence + 1
    if precedence in (EQUALITY, RELATION):
        first = second = SUM
    elif precedence == OR:
        first = second = EQUALITY if AND in (left.precedence, right.precedence) else precedence
    return Code(f"{left.at_least(first)} {operator} {right.at_least(second)}", precedence)


def statement(
    before: str, code: Code | str, after: str = ";", indent: str = "", comment: str | None = None
) -> list[str]:
    """The lines of ``before code after``, broken where they are longer than a line may be.

    ``comment`` stands at the end of the line, or on a line of its own before a statement that does not fit with it.
    """
    line = f"{indent}{before}{code}{after}"
    remark = "" if comment is None else f"/* {comment} */"
    if comment is not None and len(line) + 1 + len(remark) <= LINE_LENGTH:
        return [f"{line} {remark}"]
    lines = [f"{indent}{remark}"] if comment is not None else []
    return [*lines, *broken(line, indent + INDENT)]


def broken(line: str, deeper: str) -> list[str]:
    """A line as several, each broken at the outermost bracket level that makes it fit; those after the first begin with ``deeper``."""
    lines: list[str] = []
    while len(line) > LINE_LENGTH:
        position = _break(line)
        if position is None:
            break
        lines.append(line[:position].rstrip())
        line = deeper + line[position:].lstrip()
    return [*lines, line]


def _break(line: str) -> int | None:
    """Where to break: after a comma, or before an operator, at the outermost level; the last such place that fits."""
    best: tuple[int, int] | None = None
    depth, quoted = 0, False
    start = len(line) - len(line.lstrip()) + 1
    for position, character in enumerate(line[:LINE_LENGTH]):
        if character == '"' and line[position - 1] != "\\":
            quoted = not quoted
        if quoted:
            continue
        if character in "([{":
            depth += 1
        elif character in ")]}":
            depth -= 1
        elif character == " " and position > start:
            rest = line[position + 1 :]
            operator = rest.partition(" ")[0]
            # An assignment is broken only as a last resort: in an initializer the comma before it is the better place.
            breaks = line[position - 1] == "," or (operator in _OPERATORS and (operator != "=" or depth == 0))
            if breaks and (best is None or depth <= best[0]):
                best = (depth, position)
    return None if best is None else best[1]


_OPERATORS = frozenset(["+", "-", "*", "/", "%", "==", "!=", "<", "<=", ">", ">=", "&&", "||", "?", ":", "="])
