"""Text to tokens, one at a time, because the words of a place depend on what the parser can take there."""

from __future__ import annotations

import re
from typing import NamedTuple

from cspdiag.diagnostics import SourceFile
from cspdiag.diagnostics.span import Span
from cspdiag.syntax.tables import END, Tables

WORDS_OF_THEIR_PLACE = frozenset(
    "step method wcet on miss free deadlock livelock terminates schedulable refines failures stop".split()
)
"""Keywords where the grammar asks for them, names everywhere else."""

UNKNOWN = "unknown"
"""The terminal of a character that begins no token."""
OPEN_STRING = "open string"
"""The terminal of a string without its closing quotes."""
OPEN_COMMENT = "open comment"
"""The terminal of a comment without its end."""


class Token(NamedTuple):
    """A token that the tree builder is given."""

    span: Span
    text: str


class Trivia(NamedTuple):
    """A comment, with its markers."""

    start: int
    end: int
    text: str


class Scanner:
    """The regular expressions of the tokens, compiled once."""

    def __init__(self, tables: Tables) -> None:
        self.words = tables.words
        patterns = dict(tables.patterns)
        self.unit = re.compile(patterns.pop("UNIT"))
        del patterns["WHITESPACE"]
        comment = patterns.pop("COMMENT")
        name = patterns.pop("NAME")
        punctuation = sorted(
            (text for text in tables.words if not text[0].isalpha() and text != "_"), key=lambda t: -len(t)
        )
        alternatives = [f"(?P<NAME>{name})", f"(?P<COMMENT>{comment})"]
        alternatives += [f"(?P<{terminal}>{pattern})" for terminal, pattern in patterns.items()]
        alternatives += [r'(?P<OPEN_STRING>"[^"\n]*)', r"(?P<OPEN_COMMENT>/\*[\s\S]*)"]
        alternatives.append("(?P<PUNCTUATION>" + "|".join(map(re.escape, punctuation)) + ")")
        alternatives.append(r"(?P<UNKNOWN>[^ \t\r\n\f])")
        self.token = re.compile(r"[ \t\r\n\f]*(?:" + "|".join(alternatives) + ")")


class Lexer:
    """Walks through a file.

    After ``advance`` the attributes ``kind`` (a terminal), ``text``, ``start`` and ``end`` describe the present token.
    ``comments`` has all comments passed so far, ``docs`` those of them that are doc comments, by the offset of the
    token that follows.
    """

    def __init__(self, source: SourceFile, scanner: Scanner) -> None:
        self._text = source.text
        self._match = scanner.token.match
        self._unit = scanner.unit
        self._words = scanner.words
        self.kind = END
        self.text = ""
        self.start = 0
        self.end = 0
        self.comments: list[Trivia] = []
        self.docs: dict[int, list[Trivia]] = {}

    def advance(self, accepted: dict[str, int]) -> None:
        """Go to the next token, where the parser can take the terminals ``accepted``."""
        match = self._match(self._text, self.end)
        while match is not None and match.lastgroup == "COMMENT":
            match = self._pass_comments(match)
        if match is None:
            self.kind, self.text = END, ""
            self.start = self.end = len(self._text)
            return
        kind = match.lastgroup
        assert kind is not None
        self.start, self.end = match.span(kind)
        text = self.text = match.group(kind)
        if kind == "NAME":
            word = self._words.get(text, "NAME")
            self.kind = "NAME" if text in WORDS_OF_THEIR_PLACE and word not in accepted else word
        elif kind == "PUNCTUATION":
            self.kind = self._words[text]
            if text[0] == "<" and "UNIT" in accepted:
                self._take_unit()
        else:
            self.kind = kind

    def _take_unit(self) -> None:
        match = self._unit.match(self._text, self.start)
        if match is not None:
            self.kind, self.text, self.end = "UNIT", match.group(), match.end()

    def _pass_comments(self, match: re.Match[str]) -> re.Match[str] | None:
        """Collects comments up to the next token, whose match it returns."""
        docs: list[Trivia] = []
        following: re.Match[str] | None = match
        while following is not None and following.lastgroup == "COMMENT":
            start, end = following.span("COMMENT")
            comment = Trivia(start, end, following.group("COMMENT").rstrip())
            self.comments.append(comment)
            if is_doc(comment.text):
                docs.append(comment)
            following = self._match(self._text, end)
        if docs and following is not None and following.lastgroup is not None:
            self.docs[following.start(following.lastgroup)] = docs
        return following


def is_doc(text: str) -> bool:
    """Whether a comment is a doc comment; a line of four slashes or more is none."""
    return text.startswith("///") and not text.startswith("////")
