"""A line of C as a document that knows where it may be broken; see `cspdiag.codegen.shared.document`."""

from __future__ import annotations

import re
from collections.abc import Sequence

from cspdiag.codegen.c.text.code import STEP, assigned
from cspdiag.codegen.shared.document import (
    LINE,
    SOFT,
    Document,
    Fill,
    FirstThatFits,
    Flat,
    Group,
    Nest,
    flat,
    joined,
    listed,
)

_TOKEN = re.compile(r"""\s+|/\*.*?\*/|"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*'|[()\[\]{},]|[^\s"'()\[\]{},/]+|.""")
_CLOSING = {"(": ")", "[": "]", "{": "}"}
_ASSIGNMENTS = ("=", "+=", "-=", "*=", "/=", "|=", "&=")
_OPERATORS = (("||",), ("&&",), ("==", "!=", "<", "<=", ">", ">="), ("+", "-"), ("*", "/", "%"))
"""Those at which lines are broken, the loosest first."""
_STRING_LENGTH = 80
"""The longest piece of a string that has to be broken."""
_LONG = 80
"""What is before an assignment is kept on one line if it is shorter."""

_Words = list[Document]
"""What is between spaces."""


def line_document(text: str, *, continues: bool) -> Document:
    """The document of a statement, or of what is on one of its lines; ``continues``: it is not on the first one."""
    items = _Reader(text.removesuffix(",")).items("")
    layout = (Fill(listed(items)), "," if text.endswith(",") else "")
    return layout if continues or len(items) == 1 else Nest(STEP, layout)


class _Reader:
    def __init__(self, text: str) -> None:
        self._tokens = _TOKEN.findall(text)
        self._at = 0
        self._closed = _closed(self._tokens)

    def items(self, closing: str) -> list[Document]:
        """What is between commas, up to the bracket that closes; others that nothing opens belong to words."""
        items: list[Document] = []
        words: _Words = [()]
        while self._at < len(self._tokens):
            token = self._tokens[self._at]
            if token == closing:
                break
            self._at += 1
            if token == ",":
                items.append(_item(words))
                words = [()]
            elif token.isspace():
                words += [()] if words[-1] else []
            else:
                is_bracket = self._at - 1 in self._closed
                found = self._bracket(token, is_call=bool(words[-1])) if is_bracket else _atom(token)
                words[-1] = (words[-1], found)
        return [*items, _item(_with_ends(words))]

    def _bracket(self, opening: str, *, is_call: bool) -> Document:
        items = self.items(_CLOSING[opening])
        self._at += 1
        return _enclosed(opening, items, is_call=is_call)


def _closed(tokens: Sequence[str]) -> set[int]:
    """Where brackets are that open and are closed on the same line, not on one below."""
    found: set[int] = set()
    opened: list[int] = []
    for at, token in enumerate(tokens):
        if token in _CLOSING:
            opened.append(at)
        elif any(token == _CLOSING[tokens[place]] for place in opened):
            while token != _CLOSING[tokens[opened[-1]]]:
                opened.pop()
            found.add(opened.pop())
    return found


def _enclosed(opening: str, items: Sequence[Document], *, is_call: bool) -> Document:
    """Items in brackets: as in `cspdiag.codegen.c.text.code.Call`, or what is inside an expression in parentheses."""
    closing = _CLOSING[opening]
    parts = listed(items)
    if opening == "{":
        return Group((opening, Nest(STEP, (SOFT, Fill(parts))), SOFT, closing))
    whole = Fill(tuple(map(Flat, parts)))
    on_next_line = ((SOFT, whole), (SOFT, Fill(parts))) if is_call else ()
    layouts: tuple[Document, ...] = (whole, *on_next_line, Fill(parts))
    return (opening, FirstThatFits(tuple((Nest(STEP, layout), closing) for layout in layouts)))


def _with_ends(words: _Words) -> _Words:
    """The words with what ends a line but is none by itself: `=`, or a brace that opens."""
    kept = list(words)
    while len(kept) > 1 and flat(kept[-1]) in ("", "{", *_ASSIGNMENTS):
        last = kept.pop()
        kept[-1] = (kept[-1], " ", last) if flat(last) else kept[-1]
    return kept


def _item(words: _Words) -> Document:
    names = [flat(word) for word in words]
    for position, name in enumerate(names):
        if name in _ASSIGNMENTS and 0 < position < len(names) - 1:
            head = _row(words[: position + 1])
            return assigned(Flat(head) if len(flat(head)) < _LONG else head, _item(words[position + 1 :]))
    if "?" in names and ":" in names[names.index("?") :]:
        first = names.index("?")
        second = names.index(":", first)
        condition, then, otherwise = words[:first], words[first + 1 : second], words[second + 1 :]
        parts = (_item(condition), LINE, "? ", _item(then), LINE, ": ", _item(otherwise))
        return Group(Nest(STEP, parts))
    for operators in _OPERATORS:
        places = [place for place, name in enumerate(names) if name in operators and place > 0]
        if places:
            bounds = zip([0, *places], [*places, len(words)], strict=True)
            operands = [_row(words[start:end]) for start, end in bounds]
            chained = operators in _OPERATORS[:2]
            return Nest(STEP, Group(joined(LINE, operands)) if chained else Fill(tuple(operands)))
    return _row(words)


def _row(words: _Words) -> Document:
    """Words of which the brackets are broken rather than the space between them."""
    whole = joined(" ", words)
    return whole if len(words) < 2 else FirstThatFits((whole, Nest(STEP, Fill(tuple(words)))))


def _atom(token: str) -> Document:
    if not token.startswith('"') or len(token) <= _STRING_LENGTH:
        return token
    pieces = [""]
    for word in re.findall(r"\S+ *| +", token[1:-1]):
        if pieces[-1] and len(pieces[-1] + word) > _STRING_LENGTH:
            pieces.append("")
        pieces[-1] += word
    return FirstThatFits((token, Group(joined(LINE, [f'"{piece}"' for piece in pieces]))))
