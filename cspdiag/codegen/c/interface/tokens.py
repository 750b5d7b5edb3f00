"""The words of declarations in C, with macros expanded: in each way, where a macro may mean several texts."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from math import inf
from typing import Generic, TypeVar

from cspdiag.base.record import record
from cspdiag.codegen.c.interface.directives import CONDITIONS, MARK, Directive, Macros
from cspdiag.codegen.c.interface.structures import Key
from cspdiag.codegen.shared.names import words

_TOKEN = re.compile(r"(\s*)(#@|\w+|\"(?:\\.|[^\"\\])*\"|'(?:\\.|[^'\\])*'|\S)")
QUALIFIERS = words(
    "const volatile restrict __restrict _Atomic static extern register inline __inline _Thread_local __extension__"
)
OWN_TYPES = words("void bool _Bool char short int long signed unsigned float double _Complex")
"""The words of which the names of C's own types are made."""
_LONGEST = 10_000
"""Macros that are expanded in one declaration."""
_READINGS = 64
"""Ways to read a part of a declaration, at most."""

Read = TypeVar("Read")


class UnknownSyntaxError(Exception):
    """A declaration is not understood."""


@record
class Token:
    """A word, whether something is between it and the one before, and its line."""

    text: str
    is_spaced: bool
    line: int


def tokens(text: str, line: int) -> Iterator[Token]:
    """Of a text that begins on a line."""
    for found in _TOKEN.finditer(text):
        line += found[1].count("\n")
        yield Token(found[2], bool(found[1]), line)


def text_of(words_: Iterable[Token]) -> str:
    """As it is written."""
    return "".join(f"{' ' if token.is_spaced else ''}{token.text}" for token in words_).strip()


_ANY = ("", "int")
"""What a macro may be that has another definition somewhere else: words that do not matter, and a type."""


@record
class _Reading(Generic[Read]):
    """What a part of a declaration is, None if it is none. ``left``, ``conditions`` and ``condition`` are those behind
    it; ``supposed``: the macros of which another definition was supposed.
    """

    result: Read | None
    left: list[Token]
    conditions: list[int]
    condition: int
    supposed: frozenset[str]


class Words:
    """The words of a declaration that begins on a line, the next one last, with directives inside by line. ``is_type``
    says what is the name of a type if it is no macro.
    """

    def __init__(
        self, text: str, macros: Macros, is_type: Callable[[str], bool], directives: Mapping[int, Directive], line: int
    ) -> None:
        self.macros = macros
        self.left = list(tokens(text, line))
        self._may_differ = macros.may_differ({token.text for token in self.left})
        self.left.reverse()
        self._is_type = is_type
        self.directives = directives
        self._known: dict[str, tuple[Sequence[str | None], int]] = {}
        self._expanded = 0
        self.conditions: list[int] = []
        """The lines on which those begin in which the next word is, up to the structure around it."""
        self.condition = 0
        """The line of the one that was met last."""
        self._choices: dict[str, int] = {}
        """Which of its texts a macro with several ones means."""

    def peek(self) -> str:
        """The next word; empty at the end."""
        while self.left:
            token = self.left[-1]
            if token.text == MARK:
                self.left.pop()
                self._take(self.directives[token.line])
                continue
            body = self._body(token.text)
            if body is None or body == token.text:
                return token.text
            self._expanded += 1
            if self._expanded > _LONGEST:
                raise UnknownSyntaxError
            self.left.pop()
            self.left += reversed(list(tokens(body, token.line)))
        return ""

    def peek_line(self) -> int:
        """Of the next word."""
        self.peek()
        return self.left[-1].line if self.left else 0

    def take_marks(self) -> None:
        """Take directives in front of the next word."""
        while self.left and self.left[-1].text == MARK:
            self._take(self.directives[self.left.pop().line])

    def _take(self, directive: Directive) -> None:
        if directive.word == "include":
            raise UnknownSyntaxError
        if directive.word in CONDITIONS:
            self.condition = directive.line
            self.conditions.append(directive.line)
        elif self.conditions:
            self.conditions.pop()

    def _body(self, word: str) -> str | None:
        known = self._known.get(word)
        texts = self._texts(word)[0] if known is None else known[0]
        return texts[self._choices.setdefault(word, 0)] if len(texts) > 1 else texts[0] if texts else None

    def _texts(self, word: str) -> tuple[Sequence[str | None], int]:
        """What a word may mean, None for itself; and how many of these are certain."""
        if word not in self._known:
            meanings = () if word in OWN_TYPES or word in QUALIFIERS else self.macros.meanings(word)
            texts: list[str | None] = [one.text for one in meanings if one.text is not None]
            if len(texts) < len(meanings) and self._is_type(word):
                texts.append(None)
            self._known[word] = [*texts, *(_ANY if len(texts) < len(meanings) else ())], len(texts)
        return self._known[word]

    def accepted(self, *expected: str) -> bool:
        """Whether the next word is one of these; it is consumed then."""
        if self.peek() in expected:
            self.left.pop()
            return True
        return False

    def require(self, word: str) -> None:
        """Consume this word."""
        if not self.accepted(word):
            raise UnknownSyntaxError

    def bracketed(self) -> str:
        """What is between the bracket that was consumed and the one that closes it, as it is written."""
        inside: list[Token] = []
        depth = 1
        while self.left:
            token = self.left.pop()
            depth += 1 if token.text in "([{" else -1 if token.text in ")]}" else 0
            if depth == 0:
                return text_of(inside)
            inside.append(token)
        raise UnknownSyntaxError

    def readings(
        self, read: Callable[[float], Read], alike: Callable[[Read], Mapping[Key, object]]
    ) -> tuple[Sequence[Read], Mapping[Key, str]]:
        """What the next words may declare, in each way to expand macros; and, of each name for which these are not
        ``alike``, where such a macro is defined.

        ``read`` reads the least that it can, and more while more words than the number that it is given are left: all
        ways end at the same word.
        """
        if not self._may_differ:
            return [read(inf)], {}
        before, until = self.left, inf
        while True:
            found, names = self._all_readings(read, until, before)
            certain = [one for one in found if not one.supposed]
            least = min(len(one.left) for one in certain)
            if all(len(one.left) == least for one in certain):
                break
            if least >= until:
                raise UnknownSyntaxError
            until = least
        self.left, self.conditions, self.condition = certain[0].left, certain[0].conditions, certain[0].condition
        results = [one.result for one in certain if one.result is not None]
        shapes = [alike(result) for result in results]
        supposed: dict[str, list[Mapping[Key, object]]] = {name: [] for one in found for name in one.supposed}
        for one in found:
            if one.result is not None and len(one.left) == least:
                for name in one.supposed:
                    supposed[name].append(alike(one.result))
        place = next((self.macros.place_of(name) for name in names), "")
        return results, {
            key: place
            for key in {key: None for shape in shapes for key in shape}
            if any(shape.get(key) != shapes[0].get(key) for shape in shapes)
            or any(all(other.get(key) != shapes[0].get(key) for other in others) for others in supposed.values())
        }

    def _all_readings(
        self, read: Callable[[float], Read], until: float, before: Sequence[Token]
    ) -> tuple[Sequence[_Reading[Read]], Iterable[str]]:
        """Each way to read the words that were left ``before``, and the macros that have several meanings."""
        outer, conditions = self._choices, self.conditions
        found: list[_Reading[Read]] = []
        names: dict[str, None] = {}
        pending = [dict(outer)]
        while pending:
            if len(found) >= _READINGS:
                raise UnknownSyntaxError
            choices = pending.pop()
            self._choices, self.left, self.conditions = dict(choices), [*before], [*conditions]
            try:
                found.append(self._reading(read, until, outer))
            finally:
                made, self._choices = self._choices, outer
            new = [name for name in made if name not in choices]
            names |= dict.fromkeys(new)
            for index, name in enumerate(new):
                first = {**choices, **dict.fromkeys(new[:index], 0)}
                pending += [{**first, name: number} for number in range(1, len(self._texts(name)[0]))]
        return found, names

    def _reading(self, read: Callable[[float], Read], until: float, outer: Mapping[str, int]) -> _Reading[Read]:
        result: Read | None = None
        with suppress(UnknownSyntaxError):
            result = read(until)
        own = [(name, number) for name, number in self._choices.items() if name not in outer]
        supposed = frozenset(name for name, number in own if number >= self._texts(name)[1])
        if result is None and not supposed:
            raise UnknownSyntaxError
        return _Reading(result, self.left, self.conditions, self.condition, supposed)
