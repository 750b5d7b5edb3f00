"""Finds the loop behind code that was unrolled: elements that differ only in an index that counts.

``Cell(f"{name}.cell[0]", ...)`` and its 999 brothers become one comprehension. The loop is found in the generated code itself, so that
it says what its elements said, by construction.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from cspdiag.codegen.python_code import (
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
    Parenthesized,
    Postfix,
    Prefix,
    Starred,
    at_least,
)
from cspdiag.codegen.python_statements import Block, Line, Statement, Unpack, lines

LEAST = 3
"""Fewer elements than this stay as they are."""

_INDEX = re.compile(r"(?<=\[)\d+(?=\])|^\d+$")


class _IrregularError(Exception):
    """Elements do not differ in an index only."""


@dataclass(frozen=True)
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
    start = 0
    while start < len(elements):
        end = _run_end([element.flat for element in elements], start)
        part = template(elements[start:end], variable, start) if end - start >= LEAST else None
        if part is None:
            items.append(elements[start])
            start += 1
        else:
            items.append(Starred(Comprehension(part, f"for {variable} in range({start}, {end})", "()")))
            start = end
    return Items("[]", tuple(items))


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
    texts = ["\n".join(lines(group, "")) for group in groups]
    result: list[Statement] = []
    start = 0
    while start < len(groups):
        loop = _loop(groups, texts, start, variable)
        if loop is None:
            result += groups[start]
            start += 1
        else:
            result.append(loop[0])
            start = loop[1]
    return tuple(result)


_LONGEST_BODY = 4


def _loop(
    groups: Sequence[tuple[Statement, ...]], texts: Sequence[str], start: int, variable: str
) -> tuple[Statement, int] | None:
    for size in range(1, _LONGEST_BODY + 1):
        count = (len(groups) - start) // size
        chunks = ["\n".join(texts[start + n * size : start + (n + 1) * size]) for n in range(count)]
        end = _run_end(chunks, 0) if count >= LEAST else 0
        if end < LEAST:
            continue
        bodies = [
            tuple(item for group in groups[start + n * size : start + (n + 1) * size] for item in group)
            for n in range(end)
        ]
        body = statements_template(bodies, variable, 0)
        if body is not None:
            counter = "_" if chunks[0] == chunks[1] else variable
            return Block(Line(f"for {counter} in range({end}):"), body), start + end * size
    return None


def _skeleton(text: str) -> str:
    return re.sub(r"\d+", "#", text)


def _run_end(texts: Sequence[str], start: int) -> int:
    """The end of the longest run of texts from ``start`` whose numbers stay or count up by one."""
    if start + 1 >= len(texts):
        return start + 1
    skeleton = _skeleton(texts[start])
    numbers = _numbers(texts[start])
    change: list[int] | None = None
    end = start + 1
    while end < len(texts) and _skeleton(texts[end]) == skeleton:
        following = _numbers(texts[end])
        changed = [after - before for before, after in zip(numbers, following, strict=True)]
        if any(step not in (0, 1) for step in changed) or (change is not None and changed != change):
            break
        numbers, change = following, changed
        end += 1
    return end


def _numbers(text: str) -> list[int]:
    return [int(number) for number in re.findall(r"\d+", text)]


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
