"""Finds the loop behind code that was unrolled: elements that differ only in an index that counts.

``Cell(f"{name}.cell[0]", ...)`` and its 999 brothers become one comprehension. The loop is found in the generated code
itself, so that it says what its elements said, by construction.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import TypeVar, assert_never

from cspdiag.base.record import record
from cspdiag.codegen.python.text.code import (
    PRODUCT,
    SUM,
    Argument,
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
    at_least,
)
from cspdiag.codegen.python.text.statements import Block, Line, Statement, Unpack, lines

LEAST = 3
"""Fewer elements than this stay as they are."""

T = TypeVar("T")

_INDEX = re.compile(r"(?<=\[)\d+(?=\])|^\d+$")


class _IrregularError(Exception):
    """Elements do not differ in an index only."""


@record
class Counting:
    """An index variable that counts from ``start``; ``size`` elements in all, round which an index may go."""

    variable: str
    start: int
    size: int

    def text(self, values: Sequence[int]) -> tuple[str, int]:
        """An expression whose values are these, with its precedence."""
        offset = values[0] - self.start
        if all(value == self.start + position + offset for position, value in enumerate(values)):
            if offset == 0:
                return self.variable, Atom("").precedence
            return f"{self.variable} {'+' if offset > 0 else '-'} {abs(offset)}", SUM
        if self.start == 0 and all(value == (position + offset) % self.size for position, value in enumerate(values)):
            return f"({self.variable} + {offset}) % {self.size}", PRODUCT
        raise _IrregularError


def rolled_list(elements: Sequence[Code], variable: str) -> Code:
    """A list of the elements: a comprehension, or single elements around starred ones where only a part counts."""
    if len(elements) >= LEAST:
        whole = template(elements, variable, 0)
        if whole is not None:
            return Comprehension(whole, f"for {variable} in range({len(elements)})")
    items: list[Code] = []
    runs = _Runs([element.flat for element in elements])
    start = 0
    while start < len(elements):
        end = runs.end(start)
        part = _rolled(end - start, _template_from(elements, variable, start))
        if part is None:
            items.append(elements[start])
            start += 1
        else:
            items.append(Starred(Comprehension(part, f"for {variable} in range({start}, {end})", "()")))
            start = end
    return Items("[]", tuple(items))


def _template_from(elements: Sequence[Code], variable: str, start: int) -> Callable[[int], Code | None]:
    return lambda count: template(elements[start : start + count], variable, start)


def template(elements: Sequence[Code], variable: str, start: int) -> Code | None:
    """The expression of ``variable`` that gives the elements, counted from ``start``; None if there is none."""
    if len({_skeleton(element.flat) for element in elements}) > 1:
        return None
    try:
        return _code(elements, Counting(variable, start, len(elements)))
    except _IrregularError:
        return None


def statements_template(
    groups: Sequence[tuple[Statement, ...]], variable: str, start: int
) -> tuple[Statement, ...] | None:
    """Statements in terms of ``variable`` that stand for every group; None if they differ in more than an index."""
    try:
        return _statements(groups, Counting(variable, start, len(groups)))
    except _IrregularError:
        return None


def rolled_steps(groups: Sequence[tuple[Statement, ...]], variable: str) -> tuple[Statement, ...]:
    """Statements one behind the other, where at least three times the same but for an index as a loop."""
    runs = _Runs(["\n".join(lines(group, "")) for group in groups])
    result: list[Statement] = []
    start = 0
    while start < len(groups):
        loop = _loop(groups, runs, start, variable)
        if loop is None:
            result += groups[start]
            start += 1
        else:
            result.append(loop[0])
            start = loop[1]
    return tuple(result)


_LONGEST_BODY = 4


def _loop(
    groups: Sequence[tuple[Statement, ...]], runs: _Runs, start: int, variable: str
) -> tuple[Statement, int] | None:
    for size in range(1, _LONGEST_BODY + 1):

        def body(count: int, size: int = size) -> tuple[Statement, ...] | None:
            rounds = [groups[start + n * size : start + (n + 1) * size] for n in range(count)]
            bodies = [tuple(item for group in groups_ for item in group) for groups_ in rounds]
            return statements_template(bodies, variable, 0)

        end = runs.end(start, size)
        count = (end - start) // size
        statements = _rolled(count, body)
        if statements is not None:
            counter = "_" if runs.is_repeated(start, size) else variable
            return Block(Line(f"for {counter} in range({count}):"), statements), end
    return None


def _rolled(count: int, attempt: Callable[[int], T]) -> T | None:
    """What ``attempt`` makes of ``count`` elements; it is asked about three first, so that those that never become a
    loop cost little.
    """
    if count < LEAST or attempt(LEAST) is None:
        return None
    return attempt(count)


def _skeleton(text: str) -> str:
    return re.sub(r"\d+", "#", text)


class _Runs:
    """Texts of which neighbours differ by numbers that stay or count up by one."""

    def __init__(self, texts: Sequence[str]) -> None:
        self._texts = texts
        self._skeletons = [_skeleton(text) for text in texts]
        self._numbers = [[int(number) for number in re.findall(r"\d+", text)] for text in texts]
        self._breaks: dict[int, int] = {}
        """Where the last run that was followed breaks off, by the size of its rounds."""

    def end(self, start: int, size: int = 1) -> int:
        """The end of the longest run of rounds of ``size`` texts from ``start``."""
        if start + 2 * size > self._breaks.get(size, 0):
            self._breaks[size] = self._break(start, size)
        return start + (self._breaks[size] - start) // size * size

    def _break(self, start: int, size: int) -> int:
        """The first text that goes on from none one round before it as that did from the one before."""
        place = start + size
        while place < len(self._texts):
            change = self._change(place - size, place)
            if change is None or (place >= start + 2 * size and change != self._change(place - 2 * size, place - size)):
                break
            place += 1
        return min(place, len(self._texts))

    def is_repeated(self, start: int, size: int) -> bool:
        """Whether the round after that from ``start`` is the same."""
        return self._texts[start : start + size] == self._texts[start + size : start + 2 * size]

    def _change(self, before: int, after: int) -> list[int] | None:
        """By how much each number of a text differs from that of one before; None where more than that differs."""
        if self._skeletons[before] != self._skeletons[after]:
            return None
        steps = [b - a for a, b in zip(self._numbers[before], self._numbers[after], strict=True)]
        return steps if all(step in (0, 1) for step in steps) else None


def _code(elements: Sequence[Code], counting: Counting) -> Code:
    first = elements[0]
    if any(type(element) is not type(first) for element in elements):
        raise _IrregularError
    match first:
        case Atom():
            return _atom([element.flat for element in elements], first.precedence, counting)
        case Call(arguments=arguments):
            values = [[a.value for a in element.arguments] for element in elements if isinstance(element, Call)]
            parts = _columns(values, counting)
            function = _text([element.function for element in elements if isinstance(element, Call)], counting)
            joined = zip(arguments, parts, strict=True)
            return Call(function, tuple(Argument(part, a.name, a.starred) for a, part in joined))
        case Postfix():
            same = [element for element in elements if isinstance(element, Postfix)]
            operand = _operand([element.operand for element in same], counting)
            return Postfix(operand, _text([element.text for element in same], counting))
        case Prefix(text=text):
            return Prefix(text, _operand([e.operand for e in elements if isinstance(e, Prefix)], counting))
        case Chain(precedence=precedence, rest=rest):
            rows = [[e.first, *(operand for _, operand in e.rest)] for e in elements if isinstance(e, Chain)]
            head, *tail = (_operand(column, counting) for column in _transposed(rows))
            return Chain(precedence, head, tuple((op, part) for (op, _), part in zip(rest, tail, strict=True)))
        case Conditional():
            rows = [[e.then, e.condition, e.otherwise] for e in elements if isinstance(e, Conditional)]
            then, condition, otherwise = (_operand(column, counting) for column in _transposed(rows))
            return Conditional(then, condition, otherwise)
        case Parenthesized():
            return Parenthesized(_code([e.operand for e in elements if isinstance(e, Parenthesized)], counting))
        case Items(brackets=brackets):
            rows = [list(element.items) for element in elements if isinstance(element, Items)]
            return Items(brackets, tuple(_columns(rows, counting)))
        case Entry(key=key):
            return Entry(key, _code([element.value for element in elements if isinstance(element, Entry)], counting))
        case Comprehension() | Starred():
            if all(element == first for element in elements):
                return first
            raise _IrregularError
        case Named():
            raise _IrregularError
        case _:
            assert_never(first)


def _operand(elements: Sequence[Code], counting: Counting) -> Code:
    """What stands beside an operator: a sum that takes the place of a number needs parentheses there."""
    return at_least(_code(elements, counting), elements[0].precedence)


def _columns(rows: Sequence[Sequence[Code]], counting: Counting) -> list[Code]:
    return [_code(column, counting) for column in _transposed(rows)]


def _transposed(rows: Sequence[Sequence[Code]]) -> list[tuple[Code, ...]]:
    if len({len(row) for row in rows}) != 1:
        raise _IrregularError
    return list(zip(*rows, strict=True))


def _atom(texts: Sequence[str], precedence: int, counting: Counting) -> Atom:
    if texts[0].isdigit() and len(set(texts)) > 1:
        if not all(text.isdigit() for text in texts):
            raise _IrregularError
        text, loosest = counting.text([int(text) for text in texts])
        return Atom(text, loosest)
    return Atom(_text(texts, counting), precedence)


def _text(texts: Sequence[str], counting: Counting) -> str:
    """Text with the indexes in brackets that count replaced by the variable; in braces within a string."""
    first = texts[0]
    if all(text == first for text in texts):
        return first
    pieces = [_INDEX.split(text) for text in texts]
    if any(piece != pieces[0] for piece in pieces):
        raise _IrregularError
    indexes = [[int(number) for number in _INDEX.findall(text)] for text in texts]
    result = pieces[0][0]
    for position, piece in enumerate(pieces[0][1:]):
        values = [row[position] for row in indexes]
        if len(set(values)) == 1:
            index = str(values[0])
        else:
            index = counting.text(values)[0]
            index = f"{{{index}}}" if first.startswith('f"') else index
        result += index + piece
    return result


def _statements(groups: Sequence[tuple[Statement, ...]], counting: Counting) -> tuple[Statement, ...]:
    if len({len(group) for group in groups}) != 1:
        raise _IrregularError
    return tuple(_statement(column, counting) for column in zip(*groups, strict=True))


def _statement(elements: Sequence[Statement], counting: Counting) -> Statement:
    first = elements[0]
    if any(type(element) is not type(first) for element in elements):
        raise _IrregularError
    match first:
        case Line():
            rows = [element for element in elements if isinstance(element, Line)]
            if len({(row.after, row.comment) for row in rows}) > 1:
                raise _IrregularError
            before = _text([row.before for row in rows], counting)
            return Line(before, _code([row.code for row in rows], counting), first.after, first.comment)
        case Block():
            blocks = [element for element in elements if isinstance(element, Block)]
            head = _statement([block.head for block in blocks], counting)
            assert isinstance(head, Line)
            return Block(head, _statements([block.body for block in blocks], counting))
        case Unpack():
            if all(element == first for element in elements):
                return first
    raise _IrregularError
