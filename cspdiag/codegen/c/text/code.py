"""C expressions as text with a precedence, and statements broken over lines."""

from __future__ import annotations

from cspdiag.base.record import record
from cspdiag.codegen.c.text.literals import in_comment

COMMA, CONDITIONAL, OR, AND, EQUALITY, RELATION, SUM, PRODUCT, UNARY, POSTFIX = range(10)
"""Precedences of C, the loosest first; those that the generator does not use are left out."""

LINE_LENGTH = 100
"""Of generated code."""

INDENT = "    "


@record
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
    remark = "" if comment is None else f"/* {in_comment(comment)} */"
    if comment is not None and len(line) + 1 + len(remark) <= LINE_LENGTH:
        return [f"{line} {remark}"]
    lines = [f"{indent}{remark}"] if comment is not None else []
    return [*lines, *broken(line, indent + INDENT)]


def broken(line: str, deeper: str) -> list[str]:
    """A line as several, each broken at the outermost bracket level that makes it fit; those after the first begin with ``deeper``."""
    lines: list[str] = []
    while len(line) > LINE_LENGTH:
        found = _break(line)
        if found is None:
            break
        position, depth = found
        lines.append(line[:position].rstrip())
        line = deeper + INDENT * depth + line[position:].lstrip()
    return [*lines, line]


def _break(line: str) -> tuple[int, int] | None:
    """Where to break: at the outermost level after a comma, or before the loosest operator; the last such place that fits, and its level."""
    best: tuple[int, int, int] | None = None
    depth, quoted, escaped = 0, False, False
    start = len(line) - len(line.lstrip()) + 1
    for position, character in enumerate(line[:LINE_LENGTH]):
        if character == '"' and not escaped:
            quoted = not quoted
        escaped = quoted and character == "\\" and not escaped
        if quoted:
            continue
        if character in "([{":
            depth += 1
        elif character in ")]}":
            depth -= 1
        elif character == " " and position > start:
            operator = line[position + 1 :].partition(" ")[0]
            looseness = 0 if line[position - 1] == "," else _LOOSENESS.get(operator)
            # An assignment is broken only as a last resort: in an initializer the comma before it is the better place.
            if looseness is None or (operator == "=" and depth > 0):
                continue
            if best is None or (depth, looseness) <= best[:2]:
                best = (depth, looseness, position)
    return None if best is None else (best[2], best[0])


_LOOSENESS = {
    "?": 2, ":": 1, "||": 3, "&&": 4, "==": 5, "!=": 5, "<": 5, "<=": 5, ">": 5, ">=": 5,
    "+": 6, "-": 6, "*": 7, "/": 7, "%": 7, "=": 8, "+=": 8,
}  # fmt: skip
"""Operators by how loosely they bind, the loosest first; a choice is broken before what else there is."""
