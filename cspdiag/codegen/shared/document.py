"""Documents: text that knows where it may be broken over lines (P. Wadler, *A prettier printer*, 2003).

A document is text, a tuple of consecutive documents, or one of the nodes below. Documents are values: whatever builds
them decides nothing about columns, and only `render` knows how long a line may be.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from typing import TypeAlias, assert_never

from cspdiag.base.record import lazily, record


@record
class Line:
    """A place where a line may end; ``flat`` is the text there if it does not."""

    flat: str = " "


class _Around:
    """A node around one document."""

    content: Document

    @lazily
    def on_one_line(self) -> str:
        """The text on one line."""
        return flat(self.content)


@record
class Nest(_Around):
    """Lines that begin inside are indented by ``by`` more columns."""

    by: int
    content: Document


@record
class Group(_Around):
    """On one line if that fits; otherwise all its own lines are broken, and those of inner groups only if necessary."""

    content: Document


@record
class Fill:
    """Items with a `Line` between them, as many on a line as fit. An item after one of several lines begins a new line.

    Those before ``start`` have been laid out.
    """

    items: tuple[Document, ...]
    start: int = 0

    @lazily
    def on_one_line(self) -> str:
        """The text on one line."""
        return " ".join([flat(item) for item in islice(self.items, self.start, None)])


@record
class FirstThatFits:
    """The first of several layouts of one text of which every line fits; the last if none does."""

    layouts: tuple[Document, ...]

    @lazily
    def on_one_line(self) -> str:
        """The text on one line."""
        return flat(self.layouts[0])


@record
class Flat(_Around):
    """Never broken."""

    content: Document


Document: TypeAlias = "str | tuple[Document, ...] | Line | Nest | Group | Fill | FirstThatFits | Flat"

LINE = Line()
SOFT = Line("")


def joined(separator: Document, items: Sequence[Document]) -> tuple[Document, ...]:
    """The items with ``separator`` between them."""
    found: list[Document] = []
    for item in items:
        if found:
            found.append(separator)
        found.append(item)
    return tuple(found)


def listed(items: Sequence[Document], comma: str = ",") -> tuple[Document, ...]:
    """The items, each except the last followed by a comma, for a `Fill`."""
    return (*((item, comma) for item in items[:-1]), *items[-1:])


def flat(document: Document) -> str:
    """The text on one line."""
    if isinstance(document, str):
        return document
    if isinstance(document, tuple):
        return "".join([part if isinstance(part, str) else flat(part) for part in document])
    return document.flat if isinstance(document, Line) else document.on_one_line


def render(document: Document, width: int, indent: int = 0) -> list[str]:
    """The lines, none longer than ``width`` if possible; all except blank ones are indented by ``indent`` columns."""
    text = flat(document)
    if indent + len(text) <= width:
        return [" " * indent + text]
    laid_out = _Layout(width).lines([(indent, True, document)], indent)
    assert laid_out is not None
    first, *rest = laid_out
    return [" " * indent + first, *rest]


_Item: TypeAlias = tuple[int, bool, Document]
"""The indentation of lines that begin in a document, whether its own lines are broken, and the document."""


class _Layout:
    def __init__(self, width: int) -> None:
        self.width = width
        self._found: dict[tuple[int, int, int, int], list[str] | None] = {}
        """What was found for several layouts at a place: they are inside each other, and each tries all inside it."""

    def lines(
        self, items: Sequence[_Item], column: int, following: int = 0, *, only_if_all_fit: bool = False
    ) -> list[str] | None:
        """The lines of consecutive documents, the first without the ``column`` characters before it.

        On the last line, ``following`` more characters come after them. ``only_if_all_fit``: None as soon as a line is
        too long.
        """
        done: list[str] = []
        line = ""
        before = column
        stack = [*reversed(items)]
        while stack:
            depth, broken, document = stack.pop()
            if not broken:
                line += flat(document)
                continue
            match document:
                case str():
                    line += document
                case tuple():
                    stack += [(depth, True, part) for part in reversed(document)]
                case Line():
                    if only_if_all_fit and before + len(line.rstrip()) > self.width:
                        return None
                    done.append(line.rstrip())
                    line, before = " " * depth, 0
                case Nest(by=by, content=content):
                    stack.append((depth + by, True, content))
                case Flat():
                    line += document.on_one_line
                case Group(content=content):
                    fits = self._fits(content, before + len(line), stack, following)
                    stack.append((depth, not fits, content))
                case Fill():
                    if self._fits(document, before + len(line), stack, following):
                        line += flat(document)
                    else:
                        stack.append((depth, True, self._first(document, before + len(line), stack, following)))
                case FirstThatFits(layouts=layouts):
                    place = id(document), depth, before + len(line), self._ahead(stack, following)
                    if place not in self._found:
                        self._found[place] = self._first_of(layouts[:-1], *place[1:])
                    found = self._found[place]
                    if found is None:
                        stack.append((depth, True, layouts[-1]))
                        continue
                    line += found[0]
                    if len(found) > 1:
                        done += [line.rstrip(), *found[1:-1]]
                        line, before = found[-1], 0
                case _:
                    assert_never(document)
        if only_if_all_fit and before + len(line) + following > self.width:
            return None
        return [*done, line]

    def _first(self, fill: Fill, column: int, stack: Sequence[_Item], following: int) -> Document:
        """The first items of a `Fill`, the line after them, which is broken if the next item does not fit, and
        the rest.
        """
        items, start, last = fill.items, fill.start, len(fill.items) - 1
        found: list[Document] = []
        while start < last:
            head, column = items[start], column + len(flat(items[start]))
            start += 1
            ahead = 0 if start < last else self._ahead(stack, following)
            stays = column <= self.width and column + 1 + len(flat(items[start])) + ahead <= self.width
            if not (stays and isinstance(head, Flat)):
                return (*found, Group(head), " " if stays else LINE, Fill(items, start))
            found += [head, " "]
            column += 1
        return (*found, Group(items[last]))

    def _first_of(self, layouts: Sequence[Document], depth: int, column: int, following: int) -> list[str] | None:
        """The lines of the first layout of which every line fits."""
        for layout in layouts:
            if isinstance(layout, Flat):
                text = layout.on_one_line
                found = [text] if column + len(text) + following <= self.width else None
            else:
                found = self.lines([(depth, True, layout)], column, following, only_if_all_fit=True)
            if found is not None:
                return found
        return None

    def _fits(self, content: Document, column: int, stack: Sequence[_Item], following: int) -> bool:
        room = self.width - column
        length = _length_up_to(content, room)
        return length <= room and length + self._ahead(stack, following) <= room

    def _ahead(self, stack: Sequence[_Item], following: int) -> int:
        """The number of characters before the next place where a line can end."""
        count = 0
        for _, broken, document in reversed(stack):
            length, ended = _until_line(document, broken)
            count += length
            if ended:
                return count
        return count + following


def _length_up_to(document: Document, most: int) -> int:
    """The length of the text on one line, or any length above ``most``: a long list is not summed up."""
    match document:
        case tuple():
            length = 0
            for part in document:
                length += len(part) if isinstance(part, str) else _length_up_to(part, most - length)
                if length > most:
                    break
            return length
        case Fill(items=items, start=start):
            length = -1
            for item in islice(items, start, None):
                length += 1 + _length_up_to(item, most - length)
                if length > most:
                    break
            return max(length, 0)
        case str() | Line() | Nest() | Group() | FirstThatFits() | Flat():
            return len(flat(document))
    assert_never(document)


def _until_line(document: Document, broken: bool) -> tuple[int, bool]:
    """The length of a text up to the first place where a line may end, and whether there is one."""
    match document:
        case str():
            return len(document), False
        case tuple():
            count = 0
            for part in document:
                length, ended = (len(part), False) if isinstance(part, str) else _until_line(part, broken)
                count += length
                if ended:
                    return count, True
            return count, False
        case Line(flat=text):
            return (0, True) if broken else (len(text), False)
        case Flat(content=content):
            return len(flat(content)), False
        case Nest(content=content) | Group(content=content):
            return _until_line(content, broken)
        case Fill(items=items, start=start):
            if broken and len(items) > start + 1:
                return _until_line(items[start], broken)[0], True
            return _until_line(joined(LINE, items[start:]), broken)
        case FirstThatFits(layouts=layouts):
            return _until_line(layouts[-1], broken)
    assert_never(document)
