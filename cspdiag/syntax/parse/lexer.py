"""Text to tokens, one at a time, because contextual keywords depend on what the parser accepts."""

from __future__ import annotations

import re
from typing import NamedTuple

from cspdiag.base import Diagnostic, Report, SourceFile
from cspdiag.base.span import Span
from cspdiag.syntax.ast import Comment
from cspdiag.syntax.diagnostics.tokens import UnknownCharacter, UnterminatedComment, UnterminatedString
from cspdiag.syntax.parse.tables import END, Tables

CONTEXTUAL_KEYWORDS = frozenset(
    [
        *("parameter", "step", "method", "wcet", "on", "miss", "place", "stop", "at", "offset"),
        *("free", "deadlock", "livelock", "terminates", "schedulable", "refines", "failures", "hide"),
    ]
)
"""Keywords where the grammar expects them, names everywhere else."""

_SPACE = r"(?:\s|//[^\n]*|/\*[\s\S]*?\*/)*"
_AFTER_AN_OPERAND = re.compile(_SPACE + r"(?:[?!:;.=\[\])}|&]|->|(?:catch|interrupt|until|else)\b|\Z)")
_AFTER_NO_STEP = re.compile(_SPACE + r"(?:[?!:.]|\[(?!\])|->)")
_USED_AS_NAME = {"at": _AFTER_AN_OPERAND, "offset": _AFTER_AN_OPERAND, "stop": _AFTER_NO_STEP}
"""What follows the words that may be a keyword and a name in the same place, if they are the name of a port, a
variable, an instance or a label: ``at`` and ``stop`` in a composition, ``offset`` after the ports of a submodel.
``stop`` alone is the step.
"""

_LOOKALIKES = dict(
    zip(
        "→⟶≤≥≠∥‖□≔−–×·÷∧∨¬",  # noqa: RUF001
        ["->", "->", "<=", ">=", "!=", "||", "||", "[]", ":=", "-", "-", "*", "*", "/", "and", "or", "not"],
        strict=True,
    )
)
_EXPONENTS = {"\N{SUPERSCRIPT TWO}": "^ 2", "\N{SUPERSCRIPT THREE}": "^ 3"}
_LOOKALIKES["&&"] = "and"
"""Characters of papers, word processors and other languages, with their equivalents in this one."""


_LETTER = r"[^\W\u00b2\u00b3\u00b9\u2070-\u207f]"
"""Letters and digits of all scripts except exponents, for names in other alphabets."""

_FOREIGN_NUMBERS = r"0(?:[xX][0-9A-Fa-f]{1,64}|[bB][01]{1,64}|[oO][0-7]{1,64})\b|[0-9]+(?:_[0-9]+)+(?:\.[0-9]+)?\b"
"""Numbers with another base, or with groups of digits."""

_NEXT_CHARACTER = re.compile(r"\s*(\S)")


class Token(NamedTuple):
    """A token for the builders of the tree."""

    span: Span
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
        alternatives = [f"(?P<NAME>{name}(?!{_LETTER}))", f"(?P<COMMENT>{comment})"]
        alternatives.append(f"(?P<MISWRITTEN>{_FOREIGN_NUMBERS})")
        alternatives += [f"(?P<{terminal}>{pattern})" for terminal, pattern in patterns.items()]
        alternatives += [r'(?P<OPEN_STRING>"[^"\n]*?(?=[ \t]*\{?[ \t\r]*(?:\n|\Z)))', r"(?P<OPEN_COMMENT>/\*[\s\S]*)"]
        alternatives.append(f"(?P<LOOKALIKE>{'|'.join(_LOOKALIKES)})")
        alternatives.append("(?P<PUNCTUATION>" + "|".join(map(re.escape, punctuation)) + ")")
        alternatives.append(rf"(?P<FOREIGN>(?![0-9\u00b5\u03bc]){_LETTER}+)")
        alternatives.append(r"(?P<UNKNOWN>[^ \t\r\n\f])")
        self.token = re.compile(r"[ \t\r\n\f]*(?:" + "|".join(alternatives) + ")")


class Previous(NamedTuple):
    """The token before the present one."""

    kind: str
    text: str
    start: int
    end: int


class Lexer:
    """Reads a file token by token.

    After ``advance`` the attributes ``kind`` (a terminal), ``text``, ``start`` and ``end`` describe the present token.
    ``comments`` has all comments so far, ``docs`` the doc comments among them, by the offset of the token that follows.
    Mistakes in single characters, strings and comments are reported here.
    """

    def __init__(self, source: SourceFile, scanner: Scanner, report: Report) -> None:
        self._source = source
        self._text = source.text
        self._report = report
        self._match = scanner.token.match
        self._unit = scanner.unit
        self._words = scanner.words
        self._texts: dict[str, str] = {}
        """The texts of names, so that equal ones are one object."""
        self._reported_lines: set[int] = set()
        self._foreign: set[str] = set()
        self.misused: set[str] = set()
        """Keywords that were reported as names."""
        self.mistakes = 0
        """How many mistakes were found, also of those that are not reported again."""
        self.kind = END
        self.text = ""
        self.start = 0
        self.end = 0
        self._before: tuple[str, str, int, int] = END, "", 0, 0
        self.comments: list[Comment] = []
        self.docs: dict[int, list[Comment]] = {}

    @property
    def before(self) -> Previous:
        """The token before the present one."""
        return Previous(*self._before)

    @property
    def present(self) -> Previous:
        """The present token."""
        return Previous(self.kind, self.text, self.start, self.end)

    def pass_over(self, last: Previous, following: Previous) -> None:
        """Go to a later token, before which is ``last``."""
        self._before = last
        self.kind, self.text, self.start, self.end = following

    def advance(self, accepted: dict[str, int]) -> None:
        """Go to the next token; the parser accepts the terminals ``accepted``."""
        if self.end > self.start:
            self._before = self.kind, self.text, self.start, self.end
        else:
            # An inserted token has no place in the text.
            self._before = self.kind, "", *self._before[2:]
        match = self._match(self._text, self.end)
        while match is not None and (match.lastgroup == "COMMENT" or match.lastgroup == "UNKNOWN"):
            match = self._pass_comments(match) if match.lastgroup == "COMMENT" else self._pass_unknown(match)
        if match is None:
            self.kind, self.text = END, ""
            self.start = self.end = len(self._text)
            return
        kind = match.lastgroup
        assert kind is not None
        self.start, self.end = match.span(kind)
        text = self.text = match.group(kind)
        if kind == "NAME":
            self.text = text = self._texts.setdefault(text, text)
            word = self._words.get(text, "NAME")
            if text in CONTEXTUAL_KEYWORDS and (word not in accepted or self._is_used_as_name()):
                word = "NAME"
            self.kind = word
        elif kind == "PUNCTUATION":
            self.kind = self._words[text]
            if text[0] == "<" and "UNIT" in accepted:
                self._take_unit()
        elif kind == "LOOKALIKE":
            self._take_lookalike()
        elif kind == "FOREIGN":
            self._take_foreign()
        elif kind == "MISWRITTEN":
            self._take_malformed_number()
        elif kind == "OPEN_STRING":
            self._report_character(UnterminatedString(Span(self._source, self.start, self.end)))
            self.kind, self.text = "STRING", text + '"'
        elif kind == "OPEN_COMMENT":
            self._report_character(UnterminatedComment(Span(self._source, self.start, self.start + 2)))
            self.kind, self.text, self.start, self.end = END, "", len(self._text), len(self._text)
        else:
            self.kind = kind

    def replace(self, terminal: str, end: int) -> None:
        """Treat the text up to ``end`` as another terminal."""
        self.kind, self.text, self.end = terminal, self._text[self.start : end], end

    def insert(self, terminal: str) -> None:
        """Insert a token without text before the present one."""
        self.kind, self.text, self.end = terminal, "", self.start

    def first_on_line(self) -> bool:
        """Whether the present token is the first on its line."""
        at = self.start - 1
        while at >= 0 and self._text[at] in " \t\r\f":
            at -= 1
        return at < 0 or self._text[at] == "\n"

    def next_character(self) -> str:
        """The next character after the present token that is not a space; empty at the end."""
        match = _NEXT_CHARACTER.match(self._text, self.end)
        return match[1] if match else ""

    def _is_used_as_name(self) -> bool:
        """Whether the present contextual keyword is used as a name, where both are allowed."""
        following = _USED_AS_NAME.get(self.text)
        return following is not None and following.match(self._text, self.end) is not None

    def reported_on_line(self, offset: int) -> bool:
        """Whether the lexer has reported a mistake in a character, string or comment of this line."""
        return bool(self._reported_lines) and self._source.position(offset)[0] in self._reported_lines

    def _report_character(self, diagnostic: Diagnostic) -> None:
        self.mistakes += 1
        self._reported_lines.add(diagnostic.span.line)
        self._report.add(diagnostic)

    def _take_unit(self) -> None:
        match = self._unit.match(self._text, self.start)
        if match is not None:
            self.kind, self.text, self.end = "UNIT", match.group(), match.end()

    def _take_lookalike(self) -> None:
        meant = _LOOKALIKES[self.text]
        self._report_character(UnknownCharacter(Span(self._source, self.start, self.end), self.text, meant))
        self.kind, self.text = self._words[meant], meant

    def _take_foreign(self) -> None:
        """Report a name with letters that the language does not have, once for each name."""
        from cspdiag.syntax.parse.ascii_names import ascii_name

        self.kind = "NAME"
        self.mistakes += 1
        if self.text not in self._foreign:
            self._foreign.add(self.text)
            instead = "pi" if self.text == "\N{GREEK SMALL LETTER PI}" else ascii_name(self.text)
            self._report_character(UnknownCharacter(Span(self._source, self.start, self.end), self.text, instead))

    def _take_malformed_number(self) -> None:
        """Take a malformed number as one token: the parser would see a number followed by a name, which could begin the
        next declaration.
        """
        from cspdiag.syntax.diagnostics.structure import WrongOperator

        found = self.text
        meant = str(int(found, 0)) if found[1].isalpha() else found.replace("_", "")
        span = Span(self._source, self.start, self.end)
        self._report_character(WrongOperator(span, found, meant, "a number", replaced=span))
        self.kind, self.text = "NUMBER", meant

    def _pass_unknown(self, match: re.Match[str]) -> re.Match[str] | None:
        start, end = match.span("UNKNOWN")
        character = self._text[start]
        instead = "us" if character in "\N{MICRO SIGN}\N{GREEK SMALL LETTER MU}" else _EXPONENTS.get(character)
        self._report_character(UnknownCharacter(Span(self._source, start, end), character, instead))
        return self._match(self._text, end)

    def _pass_comments(self, match: re.Match[str]) -> re.Match[str] | None:
        """Collects comments up to the next token, whose match it returns."""
        docs: list[Comment] = []
        following: re.Match[str] | None = match
        while following is not None and following.lastgroup == "COMMENT":
            start, end = following.span("COMMENT")
            text = following.group("COMMENT").rstrip()
            comment = Comment(span=Span(self._source, start, start + len(text)), text=text)
            self.comments.append(comment)
            if is_doc(text):
                docs.append(comment)
            following = self._match(self._text, end)
        if docs:
            group = following.lastgroup if following is not None else None
            end_of_text = len(self._text)
            self.docs[following.start(group) if following is not None and group else end_of_text] = docs
        return following


def is_doc(text: str) -> bool:
    """Whether a comment is a doc comment; a line of four slashes or more is not."""
    return text.startswith("///") and not text.startswith("////")
