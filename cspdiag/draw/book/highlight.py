"""Splits program text into pieces of one look each, for highlighting on pages."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from re import Match

from cspdiag.base.record import record
from cspdiag.model.symbols import TYPE_NAMES
from cspdiag.syntax.parse.lexer import CONTEXTUAL_KEYWORDS, Scanner
from cspdiag.syntax.parse.tables import load

_KINDS = {"QUANTITY": "number", "DURATION": "number", "NUMBER": "number", "STRING": "string"}


@record
class Piece:
    """A piece of a line; ``kind`` is ``keyword``, ``type``, ``number``, ``string``, ``comment``, ``doc``,
    or nothing.
    """

    text: str
    kind: str = ""
    link: str = ""


@cache
def _scanner() -> Scanner:
    return Scanner(load())


def highlighted(text: str, links: Mapping[str, str]) -> list[list[Piece]]:
    """The lines of a text in pieces; names in ``links`` lead to their addresses. This works for any text, and the
    pieces add up to it.
    """
    pieces: list[Piece] = []
    at = 0
    before = ""
    scanner = _scanner()
    while at < len(text):
        match = scanner.token.match(text, at)
        if match is None:
            pieces.append(Piece(text[at:]))
            break
        group = match.lastgroup or ""
        start, end = match.span(group)
        if start > at:
            pieces.append(Piece(text[at:start]))
        unit = scanner.unit.match(text, start) if before in TYPE_NAMES and text[start] == "<" else None
        if unit is not None:
            end = unit.end()
            pieces.append(Piece(unit.group(), "type"))
        else:
            pieces.append(_piece(match, group, links))
        before = text[start:end]
        at = end
    return _lines(pieces)


def _piece(match: Match[str], group: str, links: Mapping[str, str]) -> Piece:
    text = match.group(group)
    if group == "COMMENT":
        return Piece(text, "doc" if text.startswith("///") else "comment")
    if group != "NAME":
        return Piece(text, _KINDS.get(group, ""))
    if text in links:
        return Piece(text, "", links[text])
    if text in TYPE_NAMES:
        return Piece(text, "type")
    is_keyword = text in _scanner().words and text not in CONTEXTUAL_KEYWORDS
    return Piece(text, "keyword" if is_keyword else "")


def _lines(pieces: list[Piece]) -> list[list[Piece]]:
    lines: list[list[Piece]] = [[]]
    for piece in pieces:
        first, *others = piece.text.split("\n")
        if first:
            lines[-1].append(Piece(first, piece.kind, piece.link))
        lines += [[Piece(other, piece.kind, piece.link)] if other else [] for other in others]
    return lines
