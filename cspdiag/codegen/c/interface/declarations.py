"""The structures and types that headers declare, also those by hand, without a compiler (ISO C11, 6.7)."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress

from cspdiag.codegen.c.interface.directives import CONDITIONS, MARK, Macros, divided
from cspdiag.codegen.c.interface.structures import (
    Array,
    CType,
    Function,
    Member,
    Named,
    NotUnderstood,
    Pointer,
    Structure,
    either,
    members_alike,
    merged,
    types_alike,
)
from cspdiag.codegen.c.interface.tokens import OWN_TYPES, QUALIFIERS, Token, UnknownSyntaxError, Words, text_of, tokens

_DEFINITION = re.compile(r"\btypedef\b|\b(?:struct|union)\b[^;{}()=]*(?:\(\([^;{}]*\)\)[^;{}()=]*)?\{")
_BRACE_OR_END = re.compile(r"[{};]")
_LAST_NAME = re.compile(r"(\w+)\s*\)?\s*(?:\[[^\]]*\]\s*|\([^()]*\)\s*)*;$")
_ALIGNING = frozenset(("_Alignas", "alignas"))
_ATTRIBUTES = frozenset(("__attribute__", "__attribute", "__declspec"))
_SHOWN = 40
"""Words of a declaration that are shown in a message."""


def declared_types(text: str, macros: Macros, is_type: Callable[[str], bool]) -> Mapping[str, tuple[CType, int]]:
    """What a header without comments defines, and on which line: ``struct filter``, ``union word``, and names of types.

    ``macros`` are those of the headers that it includes; its own are added. ``is_type`` says what these define.
    """
    plain, directives = divided(text)
    ahead = sorted(directives, key=lambda one: -one.start)
    types: dict[str, tuple[CType, int]] = {}
    end = 0
    while found := _DEFINITION.search(plain, end):
        while ahead and ahead[-1].start <= found.start():
            macros.take(ahead.pop())
        end = _end_of_declaration(plain, found.start())
        inside = [one for one in reversed(ahead) if one.start < end]
        line = 1 + plain.count("\n", 0, found.start())
        reader = _Reader(
            plain[found.start() : end],
            macros.during(inside) if inside else macros,
            lambda name: name in types or is_type(name),
            {one.line: one for one in inside},
            line,
        )
        for name, type_ in reader.types(macros.place).items():
            before = types.get(name, (type_, line))[0]
            types[name] = (type_ if before == type_ else either((before, type_), macros.at(line))), line
    for one in reversed(ahead):
        macros.take(one)
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
    reader = _Reader(f"{text};", Macros(""), lambda _: False, {}, 0)
    with suppress(UnknownSyntaxError):
        for _, type_, _ in reader.declared():
            return type_
    return Named(text)


class _Reader(Words):
    """Reads a declaration."""

    _types: dict[str, CType]
    _begun: list[Token]

    def types(self, place: str) -> Mapping[str, CType]:
        """The types that it defines, which are there if the preprocessor says so at ``place``."""
        before = [*self.left]
        line = before[-1].line
        try:
            readings, places = self.readings(self._definition, types_alike)
        except UnknownSyntaxError:
            text = text_of(before[::-1])
            name = _LAST_NAME.search(text) if before[-1].text == "typedef" else None
            # Other definitions of the name do not say what it is.
            return {name[1]: NotUnderstood(text.partition("{")[0].strip("; "), line)} if name else {}
        place = place or (self.macros.at(self.condition) if self.condition else "")
        return {
            key: either([one[key] for one in readings if key in one], place or places.get((key, 0), ""))
            for key in {key: None for reading in readings for key in reading}
        }

    def _definition(self, _: float) -> Mapping[str, CType]:
        self._types = {}
        if self.accepted("typedef"):
            self._types |= {name: type_ for name, type_, _ in self.declared()}
        else:
            self._specifiers()
        return self._types

    def declared(self) -> Iterator[tuple[str, CType, tuple[str, ...]]]:
        """The names of one declaration, with their types and alignments."""
        return self._declarators(*self._specifiers())

    # ---- Types

    def _specifiers(self) -> tuple[CType, tuple[str, ...]]:
        """The type in front of declarators, and what it is aligned to."""
        words: list[str] = []
        type_: CType | None = None
        alignment: list[str] = []
        while word := self.peek():
            if word in QUALIFIERS:
                self.left.pop()
            elif self._takes_attribute(alignment):
                continue
            elif word in ("struct", "union", "enum") and type_ is None and not words:
                self.left.pop()
                type_ = self._tagged(word)
            elif type_ is None and (word in OWN_TYPES or (not words and re.match(r"[A-Za-z_]", word))):
                self.left.pop()
                if word in OWN_TYPES:
                    words.append(word)
                else:
                    type_ = Named(word)
            else:
                break
        if type_ is None and not words:
            raise UnknownSyntaxError
        return type_ or Named(" ".join(words)), tuple(alignment)

    def _takes_attribute(self, alignment: list[str]) -> bool:
        """Whether an attribute or an alignment was consumed, which is added to ``alignment``."""
        if self.accepted(*_ALIGNING):
            self.require("(")
            alignment.append(self.bracketed())
        elif self.accepted(*_ATTRIBUTES):
            self.require("(")
            found = re.search(r"\b(?:__)?aligned(?:__)?\b\s*(?:\(([^()]*(?:\([^()]*\)[^()]*)*)\))?", self.bracketed())
            alignment += [found[1] or "16"] if found else []
        else:
            return False
        return True

    def _tagged(self, kind: str) -> CType:
        alignment: list[str] = []
        while self._takes_attribute(alignment):
            pass
        tag = self.left.pop().text if re.match(r"[A-Za-z_]", self.peek()) else ""
        if not self.accepted("{"):
            return Named("int" if kind == "enum" else f"{kind} {tag}")
        if kind == "enum":
            self.bracketed()
            return Named("int")
        body: CType
        around = self.conditions, self.condition
        self.conditions = []
        before = self.left.copy()
        try:
            members = tuple(self._members())
        except UnknownSyntaxError:
            body = self._begun_declaration()
            self.left = before
            self.bracketed()
        else:
            while self._takes_attribute(alignment):
                pass
            body = Structure(kind, members, tuple(alignment))
        self.conditions, self.condition = around
        if not tag:
            return body
        key = f"{kind} {tag}"
        before_it = self._types.get(key, body)
        self._types[key] = body if before_it == body else either((before_it, body), self.macros.at(self.peek_line()))
        return Named(f"{kind} {tag}")

    def _begun_declaration(self) -> NotUnderstood:
        """The member that was begun last, or what is included there, for messages."""
        words = self._begun[::-1]
        while words and words[0].text == MARK:
            directive = self.directives[words[0].line]
            if directive.word not in (*CONDITIONS, "endif"):
                return NotUnderstood(directive.text, directive.line)
            del words[0]
        end = next((index for index, word in enumerate(words) if word.text in (";", MARK)), len(words))
        return NotUnderstood(text_of(words[:end]), words[0].line if words else 0)

    def _members(self) -> Iterator[Member]:
        while self.left:
            self._begun = self.left[-_SHOWN:]
            self.take_marks()
            if self.left and self.left[-1].text == "}":
                self.left.pop()
                return
            found, places = self.readings(self._some_members, members_alike)
            yield from found[0] if len(found) == 1 and not places else merged(found, places)
        raise UnknownSyntaxError

    def _some_members(self, until: float) -> tuple[Member, ...]:
        """Those of the next declaration, and of others while more than ``until`` words are left."""
        members: list[Member] = []
        while (not members or len(self.left) > until) and self.peek() not in ("}", ""):
            if self.accepted(";"):
                continue
            if self.accepted("_Static_assert", "static_assert"):
                self.require("(")
                self.bracketed()
            else:
                members += self._declaration()
        return tuple(members)

    def _declaration(self) -> list[Member]:
        line = self.peek_line()
        condition = self.conditions[-1] if self.conditions else 0
        self.condition = 0
        type_, alignment = self._specifiers()
        found = list(self._declarators(type_, alignment))
        # A condition may also begin inside.
        condition = condition or self.condition
        return [Member(name, whole, (*alignment, *more), condition, line) for name, whole, more in found]

    # ---- Declarators

    def _declarators(self, type_: CType, alignment: tuple[str, ...]) -> Iterator[tuple[str, CType, tuple[str, ...]]]:
        """Each name that is declared up to the semicolon, its type, and alignments of its own."""
        if self.accepted(";"):
            yield "", type_, alignment
            return
        while True:
            name, whole = self._declarator(type_)
            if self.accepted(":"):
                while self.peek() not in (",", ";", ""):
                    self.left.pop()
            own: list[str] = []
            while self._takes_attribute(own):
                pass
            yield name, whole, tuple(own)
            if self.accepted(";"):
                return
            self.require(",")

    def _declarator(self, type_: CType) -> tuple[str, CType]:
        while True:
            if self.accepted("*"):
                type_ = Pointer()
            elif not (self.accepted(*QUALIFIERS) or self._takes_attribute([])):
                break
        if self.accepted("("):
            line = self.peek_line()
            inner = [Token(")", False, line), *reversed(list(tokens(self.bracketed(), line)))]
            type_ = self._suffixed(type_)
            self.left += inner
            found = self._declarator(type_)
            self.require(")")
            return found
        if self.peek() in OWN_TYPES:
            raise UnknownSyntaxError
        name = self.left.pop().text if re.match(r"[A-Za-z_]", self.peek()) else ""
        return name, self._suffixed(type_)

    def _suffixed(self, type_: CType) -> CType:
        """With the brackets that follow it."""
        if self.accepted("["):
            length = self.bracketed()
            return Array(self._suffixed(type_), length)
        if self.accepted("("):
            self.bracketed()
            self._suffixed(type_)
            return Function()
        return type_
