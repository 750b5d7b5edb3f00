"""Highlights programs on the site by the scanner of the language, so that a new word needs no second list."""

from __future__ import annotations

from collections.abc import Iterator

from pygments.lexer import Lexer
from pygments.token import Comment, Keyword, Number, String, Text, _TokenType

from cspdiag.draw.book.highlight import highlighted

_TOKENS = {
    "keyword": Keyword,
    "type": Keyword.Type,
    "number": Number,
    "string": String,
    "comment": Comment,
    "doc": String.Doc,
}


class CspLexer(Lexer):
    """The language of communication and composition diagrams."""

    name = "cspdiag"
    aliases = ["csp", "csp-fragment", "composition"]  # noqa: RUF012
    filenames = ["*.csp"]  # noqa: RUF012

    def get_tokens_unprocessed(self, text: str) -> Iterator[tuple[int, _TokenType, str]]:
        """The tokens of a text, which add up to it."""
        at = 0
        for number, line in enumerate(highlighted(text, {})):
            if number:
                yield at, Text, "\n"
                at += 1
            for piece in line:
                yield at, _TOKENS.get(piece.kind, Text), piece.text
                at += len(piece.text)
