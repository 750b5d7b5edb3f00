"""The structures and types that headers declare, also those by hand, without a compiler (ISO C11, 6.7)."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from functools import lru_cache

from cspdiag.base.record import record
from cspdiag.codegen.shared.names import words

_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
_DIRECTIVE = re.compile(r"^[ \t]*#[ \t]*(\w*)(?:\\\n|[^\n])*$", re.MULTILINE)
_DEFINITION = re.compile(r"\btypedef\b|\b(?:struct|union)\b[^;{}()=]*(?:\(\([^;{}]*\)\)[^;{}()=]*)?\{")
_BRACE_OR_END = re.compile(r"[{};]")
_MACRO = re.compile(r"^[ \t]*#[ \t]*define[ \t]+(\w+)(?![\w(])[ \t]*((?:\\\n|[^\n])*)$", re.MULTILINE)
_TOKEN = re.compile(r"(\s*)(#[+!-]\d*|\w+|\"(?:\\.|[^\"\\])*\"|'(?:\\.|[^'\\])*'|\S)")
_QUALIFIERS = words(
    "const volatile restrict __restrict _Atomic static extern register inline __inline _Thread_local __extension__"
)
_OWN_TYPES = words("void bool _Bool char short int long signed unsigned float double _Complex")
"""The words of which the names of C's own types are made."""
_ALIGNING = frozenset(("_Alignas", "alignas"))
_ATTRIBUTES = frozenset(("__attribute__", "__attribute"))
_INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*"([^"\n]+)"', re.MULTILINE)
_GUARD = re.compile(r"^[ \t]*#[ \t]*(?:ifndef|if[ \t]*!|pragma[ \t]+once)", re.MULTILINE)
_LONGEST = 10_000
"""Macros that are expanded in one declaration."""
_SHOWN = 40
"""Words of a declaration that are shown in a message."""


@record
class Named:
    """A type with a name, as it is written without qualifiers: ``struct filter``, ``unsigned long``."""

    name: str


@record
class Pointer:
    """To whatever, also to a function."""


@record
class Function:
    """What only pointers and declarations refer to."""


@record
class Array:
    """Elements, as many as an expression says."""

    element: CType
    length: str


@record
class Structure:
    """A structure or a union. ``alignment``: expressions that ask for one, besides that of the members."""

    kind: str
    members: tuple[Member, ...]
    alignment: tuple[str, ...] = ()


@record
class NotUnderstood:
    """A structure that is written in a way that is not known here; ``part`` is its text."""

    part: str


CType = Named | Pointer | Function | Array | Structure | NotUnderstood


@record
class Member:
    """A member of a structure; a structure or a union inside, or a bit-field, may have no ``name``. ``condition``: the
    line on which the preprocessor decides about it, 0 if it does not.
    """

    name: str
    type: CType
    alignment: tuple[str, ...] = ()
    condition: int = 0


def without_comments(text: str) -> str:
    """The text of a header without its comments, each line where it was."""
    return _COMMENT.sub(lambda found: " " + "\n" * found[0].count("\n"), text)


@lru_cache(maxsize=512)
def included_in(text: str) -> tuple[str, ...]:
    """The names in quotes that a text in C includes."""
    return tuple(_INCLUDE.findall(text))


def may_be_included_twice(text: str) -> bool:
    """Whether a header has an include guard."""
    return _GUARD.search(text) is not None


def macros_of(text: str) -> Iterator[tuple[int, str, str]]:
    """The macros without arguments that a text without comments defines: where, their names and texts."""
    for found in _MACRO.finditer(text):
        yield found.start(), found[1], found[2].replace("\\\n", " ").strip()


def declared_types(text: str, macros: dict[str, str]) -> Mapping[str, CType]:
    """What a header without comments defines: ``struct filter``, ``union word``, and names of types.

    ``macros`` are those of the headers that it includes, texts by name; its own are added.
    """
    lengthened = 0
    defined: list[tuple[int, str, str]] = []

    def marked(found: re.Match[str]) -> str:
        """A condition as a word: where it begins, with its line, or that it ends; and that something is included."""
        nonlocal lengthened
        begins = f"#+{text.count(chr(10), 0, found.start()) + 1} " if found[1].startswith("if") else ""
        ends = "#- " if found[1] == "endif" else "#! " if found[1] == "include" else ""
        defined.extend((found.start() + lengthened, name, body) for _, name, body in macros_of(found[0]))
        mark = begins + ends + "\n" * found[0].count("\n")
        lengthened += len(mark) - len(found[0])
        return mark

    plain = _DIRECTIVE.sub(marked, text)
    defined.reverse()
    types: dict[str, CType] = {}
    end = 0
    while found := _DEFINITION.search(plain, end):
        while defined and defined[-1][0] <= found.start():
            _, name, body = defined.pop()
            macros[name] = body
        end = _end_of_declaration(plain, found.start())
        reader = _Reader(plain[found.start() : end], macros)
        reader.read()
        types |= reader.types
    macros |= {name: body for _, name, body in reversed(defined)}
    return types


def _end_of_declaration(text: str, start: int) -> int:
    """Behind the semicolon that ends it."""
    depth = 0
    for found in _BRACE_OR_END.finditer(text, start):
        depth += {"{": 1, "}": -1}.get(found[0], 0)
        if depth < 0 or (depth == 0 and found[0] == ";"):
            return found.end()
    return len(text)


def type_named(text: str) -> CType:
    """The type that is written between the brackets of ``sizeof``; Named if it is not understood."""
    reader = _Reader(f"{text};", {})
    with suppress(_UnknownSyntaxError):
        for _, type_, _ in reader.declared():
            return type_
    return Named(text)


class _UnknownSyntaxError(Exception):
    """A declaration is not understood."""


@record
class _Token:
    text: str
    is_spaced: bool


def _tokens(text: str) -> Iterator[_Token]:
    return (_Token(found[2], bool(found[1])) for found in _TOKEN.finditer(text))


def _text(tokens: Iterable[_Token]) -> str:
    return "".join(f"{' ' if token.is_spaced else ''}{token.text}" for token in tokens).strip()


class _Reader:
    """Reads a declaration."""

    def __init__(self, text: str, macros: Mapping[str, str]) -> None:
        self.types: dict[str, CType] = {}
        self._macros = macros
        self._tokens = list(_tokens(text))
        self._tokens.reverse()
        self._expanded = 0
        self._conditions: list[int] = []
        self._begun: list[_Token] = []

    def read(self) -> None:
        """Read the definition of a type."""
        with suppress(_UnknownSyntaxError):
            if self._accepted("typedef"):
                self.types |= {name: type_ for name, type_, _ in self.declared()}
            else:
                self._specifiers()

    def declared(self) -> Iterator[tuple[str, CType, tuple[str, ...]]]:
        """The names of one declaration, with their types and alignments."""
        return self._declarators(*self._specifiers())

    # ---- Words

    def _peek(self) -> str:
        """The next word, with macros expanded; empty at the end."""
        while self._tokens:
            word = self._tokens[-1].text
            if word[0] == "#":
                self._tokens.pop()
                self._note_condition(word)
                continue
            body = None if word in _OWN_TYPES or word in _QUALIFIERS else self._macros.get(word)
            if body is None:
                return word
            self._expanded += 1
            if self._expanded > _LONGEST:
                raise _UnknownSyntaxError
            self._tokens.pop()
            self._tokens += reversed(list(_tokens(body)))
        return ""

    def _note_condition(self, word: str) -> None:
        if word == "#!":
            raise _UnknownSyntaxError
        if word.startswith("#+"):
            self._conditions.append(int(word[2:]))
        elif self._conditions:
            self._conditions.pop()

    def _accepted(self, *words: str) -> bool:
        """Whether the next word is one of these; it is consumed then."""
        if self._peek() in words:
            self._tokens.pop()
            return True
        return False

    def _require(self, word: str) -> None:
        if not self._accepted(word):
            raise _UnknownSyntaxError

    def _bracketed(self) -> str:
        """What is between the bracket that was consumed and the one that closes it, as it is written."""
        inside: list[_Token] = []
        depth = 1
        while self._tokens:
            token = self._tokens.pop()
            depth += 1 if token.text in "([{" else -1 if token.text in ")]}" else 0
            if depth == 0:
                return _text(inside)
            inside.append(token)
        raise _UnknownSyntaxError

    # ---- Types

    def _specifiers(self) -> tuple[CType, tuple[str, ...]]:
        """The type in front of declarators, and what it is aligned to."""
        words: list[str] = []
        type_: CType | None = None
        alignment: list[str] = []
        while word := self._peek():
            if word in _QUALIFIERS:
                self._tokens.pop()
            elif self._takes_attribute(alignment):
                continue
            elif word in ("struct", "union", "enum") and type_ is None and not words:
                self._tokens.pop()
                type_ = self._tagged(word)
            elif type_ is None and (word in _OWN_TYPES or (not words and re.match(r"[A-Za-z_]", word))):
                self._tokens.pop()
                if word in _OWN_TYPES:
                    words.append(word)
                else:
                    type_ = Named(word)
            else:
                break
        if type_ is None and not words:
            raise _UnknownSyntaxError
        return type_ or Named(" ".join(words)), tuple(alignment)

    def _takes_attribute(self, alignment: list[str]) -> bool:
        """Whether an attribute or an alignment was consumed, which is added to ``alignment``."""
        if self._accepted(*_ALIGNING):
            self._require("(")
            alignment.append(self._bracketed())
        elif self._accepted(*_ATTRIBUTES):
            self._require("(")
            found = re.search(r"\b(?:__)?aligned(?:__)?\b\s*(?:\(([^()]*(?:\([^()]*\)[^()]*)*)\))?", self._bracketed())
            alignment += [found[1] or "16"] if found else []
        else:
            return False
        return True

    def _tagged(self, kind: str) -> CType:
        alignment: list[str] = []
        while self._takes_attribute(alignment):
            pass
        tag = self._tokens.pop().text if re.match(r"[A-Za-z_]", self._peek()) else ""
        if not self._accepted("{"):
            return Named("int" if kind == "enum" else f"{kind} {tag}")
        if kind == "enum":
            self._bracketed()
            return Named("int")
        body: CType
        around, self._conditions = self._conditions, []
        before = self._tokens.copy()
        try:
            members = tuple(self._members())
        except _UnknownSyntaxError:
            body = NotUnderstood(self._begun_declaration())
            self._tokens = before
            self._bracketed()
        else:
            while self._takes_attribute(alignment):
                pass
            body = Structure(kind, members, tuple(alignment))
        self._conditions = around
        if not tag:
            return body
        self.types[f"{kind} {tag}"] = body
        return Named(f"{kind} {tag}")

    def _begun_declaration(self) -> str:
        """The member that was begun last, for messages."""
        return _text(reversed(self._begun)).replace("#!", "#include").partition(";")[0]

    def _members(self) -> Iterator[Member]:
        while True:
            self._begun = self._tokens[-_SHOWN:]
            if self._accepted("}"):
                return
            if self._accepted(";"):
                continue
            if self._accepted("_Static_assert", "static_assert"):
                self._require("(")
                self._bracketed()
                continue
            condition = self._conditions[-1] if self._conditions else 0
            type_, alignment = self._specifiers()
            for name, whole, more in self._declarators(type_, alignment):
                yield Member(name, whole, (*alignment, *more), condition)

    # ---- Declarators

    def _declarators(self, type_: CType, alignment: tuple[str, ...]) -> Iterator[tuple[str, CType, tuple[str, ...]]]:
        """Each name that is declared up to the semicolon, its type, and alignments of its own."""
        if self._accepted(";"):
            yield "", type_, alignment
            return
        while True:
            name, whole = self._declarator(type_)
            if self._accepted(":"):
                while self._peek() not in (",", ";", ""):
                    self._tokens.pop()
            own: list[str] = []
            while self._takes_attribute(own):
                pass
            yield name, whole, tuple(own)
            if self._accepted(";"):
                return
            self._require(",")

    def _declarator(self, type_: CType) -> tuple[str, CType]:
        while True:
            if self._accepted("*"):
                type_ = Pointer()
            elif not (self._accepted(*_QUALIFIERS) or self._takes_attribute([])):
                break
        if self._accepted("("):
            inner = [_Token(")", False), *reversed(list(_tokens(self._bracketed())))]
            type_ = self._suffixed(type_)
            self._tokens += inner
            found = self._declarator(type_)
            self._require(")")
            return found
        if self._peek() in _OWN_TYPES:
            raise _UnknownSyntaxError
        name = self._tokens.pop().text if re.match(r"[A-Za-z_]", self._peek()) else ""
        return name, self._suffixed(type_)

    def _suffixed(self, type_: CType) -> CType:
        """With the brackets that follow it."""
        if self._accepted("["):
            length = self._bracketed()
            return Array(self._suffixed(type_), length)
        if self._accepted("("):
            self._bracketed()
            self._suffixed(type_)
            return Function()
        return type_
