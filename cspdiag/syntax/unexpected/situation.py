"""A token that the parser does not accept, and its context."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from cspdiag.base import Diagnostic, SourceFile
from cspdiag.base.record import record
from cspdiag.base.span import Span
from cspdiag.syntax.parse.automaton import Automaton
from cspdiag.syntax.parse.lexer import Lexer

CLOSING = {"LPAR": ")", "LSQB": "]", "LBRACE": "}"}
"""Opening brackets, with the text of their closing brackets."""
_CLOSING_TERMINALS = frozenset(["RPAR", "RSQB", "RBRACE"])

_BLOCKS = frozenset(
    [
        *("COMMUNICATION", "COMPOSITION", "FOR", "PROCESS", "SUBMODEL", "DRIVER", "ENVIRONMENT", "ENUM", "STRUCT"),
    ]
)


@record
class Repair:
    """How to continue: replace the token (up to ``end``) by another one, remove it, or insert another one before it."""

    action: Literal["replace", "remove", "insert"]
    terminal: str = ""
    end: int | None = None


Finding = tuple[Diagnostic, Repair | None]
"""A diagnostic and a repair; without a repair, reading continues at the next declaration or definition."""


@record
class Situation:
    """The state of the parser at a token that it does not accept; ``starts[i]`` is the offset of the symbol that led to
    ``states[i + 1]``.
    """

    source: SourceFile
    automaton: Automaton
    states: list[int]
    starts: list[int]
    lexer: Lexer

    @property
    def span(self) -> Span:
        """The place of the present token; at the end of the text, of the last character."""
        start, end = self.lexer.start, self.lexer.end
        return Span(self.source, start, end) if end > start else self.previous

    @property
    def previous(self) -> Span:
        """The place of the previous token."""
        return Span(self.source, self.lexer.before.start, self.lexer.before.end)

    @property
    def kind(self) -> str:
        """The terminal of the present token."""
        return self.lexer.kind

    @property
    def text(self) -> str:
        """The text of the present token."""
        return self.lexer.text

    def can(self, text_or_terminal: str) -> bool:
        """Whether a terminal is allowed here, given by its name or by the text of its keyword or punctuation."""
        return self.automaton.accepts(self.states, self.terminal(text_or_terminal))

    def terminal(self, text: str) -> str:
        """The terminal of a keyword or punctuation; anything else is already a terminal."""
        return self.automaton.tables.words.get(text, text)

    def acceptable(self) -> set[str]:
        """All terminals that are allowed here."""
        row = self.automaton.tables.actions[self.states[-1]]
        return {terminal for terminal in row if self.automaton.accepts(self.states, terminal)}

    def text_of(self, symbol: str) -> str:
        """The text of a keyword or of punctuation; empty for other symbols."""
        return self.automaton.terminal_texts.get(symbol, "")

    def open_symbols(self) -> Iterator[tuple[str, int]]:
        """The symbols of unfinished parts and their offsets, innermost first, without those in closed brackets."""
        symbols = self.automaton.tables.symbols
        closed = 0
        for height in range(len(self.starts) - 1, -1, -1):
            symbol = symbols[self.states[height + 1]]
            if symbol in _CLOSING_TERMINALS:
                closed += 1
            elif symbol in CLOSING and closed:
                closed -= 1
            elif not closed:
                yield symbol, self.starts[height]

    def open_bracket(self) -> tuple[str, Span] | None:
        """The innermost open bracket: its terminal and place."""
        for symbol, start in self.open_symbols():
            if symbol in CLOSING:
                return symbol, Span(self.source, start, start + 1)
        return None

    def since_bracket(self) -> Iterator[tuple[str, int]]:
        """``open_symbols`` up to the innermost open bracket."""
        for symbol, start in self.open_symbols():
            if symbol in CLOSING:
                return
            yield symbol, start

    def block(self) -> str:
        """The keyword of the innermost open block, such as ``COMMUNICATION``; empty outside of all definitions."""
        inside = False
        for symbol, _ in self.open_symbols():
            inside = inside or symbol == "LBRACE"
            if inside and symbol in _BLOCKS:
                return symbol
        return ""
