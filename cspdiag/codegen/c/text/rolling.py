"""Finds the loop behind statements that were unrolled: groups that differ only in numbers that count."""

from __future__ import annotations

import re
from collections.abc import Sequence

from cspdiag.base.record import record
from cspdiag.codegen.c.text.rows import Row, block

LEAST = 3
"""Fewer groups than this stay as they are."""

_NUMBER = re.compile(r"\[(\d+)\]|\b(\d+)U\b|\x01(\d+)\x02")
"""Subscripts, unsigned numbers, and marked arguments."""


def marked(value: int) -> str:
    """A whole number as an argument that may count."""
    return f"\x01{value}\x02"


def rolled(groups: Sequence[Sequence[str]], variable: str = "i") -> list[Row]:
    """The statements of all groups, where at least three that count stand in a row as a loop."""
    parsed = [_Group.of(group) for group in groups]
    result: list[Row] = []
    start = 0
    while start < len(parsed):
        end, steps = _run(parsed, start)
        if end - start >= LEAST and any(steps):
            result += _loop(parsed[start], steps, end - start, variable)
        else:
            end = start + 1
            result += [Row(_plain(text)) for text in groups[start]]
        start = end
    return result


@record
class _Group:
    """Statements with their numbers taken out."""

    skeleton: tuple[str, ...]
    numbers: tuple[int, ...]
    forms: tuple[int, ...]

    @staticmethod
    def of(texts: Sequence[str]) -> _Group:
        found = [match for text in texts for match in _NUMBER.finditer(text)]
        numbers = tuple(int(match[match.lastindex or 0]) for match in found)
        return _Group(
            tuple(_NUMBER.sub("\0", text) for text in texts), numbers, tuple(match.lastindex or 0 for match in found)
        )


def _run(groups: Sequence[_Group], start: int) -> tuple[int, tuple[int, ...]]:
    """The end of the longest run from ``start`` in which every number changes by the same steps."""
    first, end = groups[start], start + 1
    steps: tuple[int, ...] | None = None
    while end < len(groups) and groups[end].skeleton == first.skeleton and groups[end].forms == first.forms:
        change = tuple(b - a for a, b in zip(groups[end - 1].numbers, groups[end].numbers, strict=True))
        if steps is not None and change != steps:
            break
        steps = change
        end += 1
    return end, steps or ()


def _loop(first: _Group, steps: tuple[int, ...], count: int, variable: str) -> list[Row]:
    begin = next((number for number, step in zip(first.numbers, steps, strict=True) if step == 1), 0)
    values = [_value(number, step, begin, variable) for number, step in zip(first.numbers, steps, strict=True)]
    texts = []
    position = 0
    for skeleton in first.skeleton:
        pieces = skeleton.split("\0")
        text = pieces[0]
        for piece in pieces[1:]:
            text += _spelled(values[position], steps[position] != 0, first.forms[position]) + piece
            position += 1
        texts.append(text)
    head = f"for (uint32_t {variable} = {begin}U; {variable} < {begin + count}U; {variable}++)"
    return block(head, [Row(text) for text in texts])


def _value(first: int, step: int, begin: int, variable: str) -> str:
    if step == 0:
        return f"{first}U"
    if step == 1:
        offset = first - begin
        return variable if offset == 0 else f"{variable} {'+' if offset > 0 else '-'} {abs(offset)}U"
    counted = variable if begin == 0 else f"({variable} - {begin}U)"
    product = counted if abs(step) == 1 else f"{abs(step)}U * {counted}"
    if step < 0:
        return f"{first}U - {product}"
    return product if first == 0 else f"{first}U + {product}"


def _spelled(value: str, counts: bool, form: int) -> str:
    if form == 1:
        return f"[{value if counts else value[:-1]}]"
    if form == 2:
        return value if " " not in value else f"({value})"
    if not counts:
        return value[:-1]
    return f"(int64_t){value}" if " " not in value else f"(int64_t)({value})"


def _plain(text: str) -> str:
    return text.replace("\x01", "").replace("\x02", "")
