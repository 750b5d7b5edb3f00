"""What the preprocessor makes of headers by hand, without one: comments, conditions and macros (ISO C11, 6.10)."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from typing import ClassVar

from cspdiag.base.record import EMPTY, record, replaced

_COMMENT = re.compile(r"\"(?:\\.|[^\"\\\n])*\"|'\\?[^\n]'|/\*.*?\*/|//(?:\\\n|[^\n])*", re.DOTALL)
_DIRECTIVE = re.compile(r"^[ \t]*#[ \t]*(\w*)((?:\\\n|[^\n])*)$", re.MULTILINE)
_INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*"([^"\n]+)"', re.MULTILINE)
_GUARD = re.compile(r"^[ \t]*#[ \t]*(?:ifndef|if[ \t]*!|pragma[ \t]+once)", re.MULTILINE)
_MACRO = re.compile(r"^[ \t]*#[ \t]*define[ \t]+(\w+)(?![\w(])[ \t]*((?:\\\n|[^\n])*)$", re.MULTILINE)
_GUARDED = re.compile(r"ifndef\s+(\w+)|if\s*!\s*defined\s*\(?\s*(\w+)\s*\)?")
_NEVER = re.compile(r"if\s*0|ifdef\s+__cplusplus|if\s+defined\s*\(?\s*__cplusplus\s*\)?")
_DEFINED = re.compile(r"(\w+)(?![\w(])(.*)", re.DOTALL)
_WORD = re.compile(r"[A-Za-z_]\w*")
_LETTERS = re.compile(r"[^\n]")
CONDITIONS = frozenset({"if", "ifdef", "ifndef"})
MARK = "#@"
"""What takes the place of a directive that matters between the members of a structure."""
_MARKED = CONDITIONS | {"endif", "include"}


def without_comments(text: str) -> str:
    """The text of a header without its comments, each line where it was."""
    return _COMMENT.sub(_without_comment, text)


def _without_comment(found: re.Match[str]) -> str:
    """What is left of a comment, or of a text in which one may seem to be; a directive does not end inside of one."""
    if found[0][0] != "/":
        return found[0]
    lines = found[0].count("\n")
    before = found.string[found.string.rfind("\n", 0, found.start()) + 1 : found.start()]
    return " " + ("\\\n" if before.lstrip().startswith("#") else "\n") * lines


@lru_cache(maxsize=512)
def included_in(text: str) -> tuple[str, ...]:
    """The names in quotes that a text in C includes."""
    return tuple(_INCLUDE.findall(text))


def may_be_included_twice(text: str) -> bool:
    """Whether a header has an include guard."""
    return _GUARD.search(text) is not None


def macros_of(text: str) -> Iterator[tuple[str, str]]:
    """The names and texts of the macros without arguments that a text without comments defines."""
    for found in _MACRO.finditer(text):
        yield found[1], found[2].replace("\\\n", " ").strip()


@record
class Directive:
    """A line that is for the preprocessor: its first word, what follows, and where it is."""

    word: str
    rest: str
    start: int
    end: int
    line: int

    @property
    def text(self) -> str:
        """As it is written."""
        return f"#{self.word} {self.rest}"


def divided(text: str) -> tuple[str, Sequence[Directive]]:
    """A text without comments as C sees it, each character where it was, and the directives that may matter: not those
    of the include guard, and nothing that is never compiled.
    """
    found = []
    line, end = 1, 0
    for match in _DIRECTIVE.finditer(text):
        line, end = line + text.count("\n", end, match.start()), match.start()
        rest = match[2].replace("\\\n", " ").strip()
        found.append(Directive(match[1], rest, match.start(), match.end(), line))
    guard = [*_guard(found), *_inner_guards(found, text)]
    kept, hidden = _compiled([one for one in found if one not in guard])
    marks = {one.start for one in kept if one.word in _MARKED}
    plain: list[str] = []
    end = 0
    ranges = [*hidden, *((one.start, one.end) for one in found)]
    for start, behind in sorted(ranges, key=lambda both: (both[0], -both[1])):
        if start >= end:
            mark = MARK if start in marks else ""
            plain += [text[end:start], mark, _LETTERS.sub(" ", text[start + len(mark) : behind])]
            end = behind
    return "".join([*plain, text[end:]]).replace("\\\n", " \n"), kept


def _guard(directives: Sequence[Directive]) -> Sequence[Directive]:
    """The include guard: the first condition, which ends last, has no other branch, and defines what it asks for."""
    conditions = [one for one in directives if one.word in CONDITIONS or one.word in ("else", "elif", "endif")]
    name = _asked_for(conditions[0]) if conditions else ""
    depth = 0
    for one in conditions[:-1]:
        depth += 1 if one.word in CONDITIONS else -1 if one.word == "endif" else 0
        if depth == 0 or (depth == 1 and one.word in ("else", "elif")):
            return ()
    if not name or conditions[-1].word != "endif":
        return ()
    is_defining = re.compile(rf"{name}\s*\d*").fullmatch
    defined = [one for one in directives if one.word == "define" and is_defining(one.rest)]
    return (conditions[0], defined[0], conditions[-1]) if defined else ()


def _asked_for(condition: Directive) -> str:
    """The macro that a condition asks not to be defined; empty if it asks for something else."""
    asked = _GUARDED.fullmatch(f"{condition.word} {condition.rest}")
    return (asked[1] or asked[2]) if asked else ""


def _inner_guards(directives: Sequence[Directive], text: str) -> Iterator[Directive]:
    """Guards of a part of a header, as of a type that other headers define, too: what they guard is there once."""
    opened: list[int | None] = []
    for place, one in enumerate(directives):
        if one.word in CONDITIONS:
            opened.append(place)
        elif one.word in ("else", "elif") and opened:
            opened[-1] = None
        elif one.word == "endif" and opened and (begin := opened.pop()) is not None:
            asking, defining = directives[begin : begin + 2]
            name = _asked_for(asking)
            if name and defining.text == f"#define {name}" and text[defining.end : one.start].strip():
                yield from (asking, defining, one)


def _compiled(directives: Iterable[Directive]) -> tuple[list[Directive], list[tuple[int, int]]]:
    """The directives in what may be compiled, and where the other parts are."""
    kept: list[Directive] = []
    never: list[tuple[int, int]] = []
    begin = 0
    holds: list[bool | None] = []
    """Of each open condition, whether it holds, if that is known."""
    for one in directives:
        was_hidden = False in holds
        ends = bool(holds) and one.word in ("else", "elif", "endif")
        before = holds.pop() if ends else None
        is_known = before is not None
        if one.word in CONDITIONS:
            holds.append(False if _NEVER.fullmatch(f"{one.word} {one.rest}") else None)
            is_known = holds[-1] is False
        elif ends and one.word != "endif":
            holds.append(True if is_known and one.word == "else" else None)
            is_known = is_known and one.word == "else"
        is_hidden = False in holds
        if is_hidden and not was_hidden:
            begin = one.start
        elif was_hidden and not is_hidden:
            never.append((begin, one.start))
        if not is_known and not is_hidden:
            # Behind what is never compiled, another branch is the first one.
            kept.append(replaced(one, word="if") if before is False else one)
    return kept, never


@record
class Meaning:
    """What a macro may mean; no ``text``: itself, because it is not defined. ``place``: of its definition."""

    text: str | None
    place: str = ""

    uncompared: ClassVar[frozenset[str]] = frozenset({"place"})


_NOTHING = (Meaning(None),)


class Macros:
    """What the macros without arguments of a header may mean, from one directive to the next."""

    def __init__(
        self, path: str, included: Iterable[Macros] = (), elsewhere: Mapping[str, Sequence[str]] = EMPTY
    ) -> None:
        """After those of the headers that it includes. ``elsewhere``: all texts that a macro has in some header."""
        self._path = path
        self._elsewhere = elsewhere
        self._meanings: dict[str, tuple[Meaning, ...]] = {}
        self._open: list[_Branches] = []
        for other in included:
            for name, meanings in other._meanings.items():
                before = self._meanings.setdefault(name, meanings)
                if before != meanings:
                    self._meanings[name] = tuple(dict.fromkeys((*before, *meanings)))

    def at(self, line: int) -> str:
        """The place of a line."""
        return f"{self._path}:{line}"

    def place_of(self, name: str) -> str:
        """Of a definition of a macro."""
        return next((one.place for one in self._meanings.get(name, ()) if one.text is not None), self._path)

    @property
    def place(self) -> str:
        """Of the innermost condition that is open; empty if there is none."""
        return self.at(self._open[-1].line) if self._open else ""

    def take(self, directive: Directive) -> None:
        """Do what a directive says."""
        match directive.word:
            case "if" | "ifdef" | "ifndef":
                self._open.append(_Branches(directive.line))
            case "else" | "elif" if self._open:
                self._open[-1].next(self._meanings, is_last=directive.word == "else")
            case "endif" if self._open:
                for name, meanings in self._open.pop().joined(self._meanings):
                    self._set(name, meanings)
            case "define" if defined := _DEFINED.fullmatch(directive.rest):
                text = defined[2].strip()
                before = [one for one in self._meanings.get(defined[1], ()) if one.text not in (None, text)]
                self._set(defined[1], (*before, Meaning(text, self.at(directive.line))))
            case "undef":
                self._set(directive.rest, _NOTHING)
            case _:  # Of what does not change macros.
                return

    def _set(self, name: str, meanings: tuple[Meaning, ...]) -> None:
        if self._open:
            self._open[-1].before.setdefault(name, self._meanings.get(name, _NOTHING))
        self._meanings[name] = meanings

    def during(self, directives: Iterable[Directive]) -> Macros:
        """Those of a declaration with directives inside: what stands before one of them, and what after it."""
        inside = Macros(self._path, [self], self._elsewhere)
        for one in directives:
            if one.word == "define":
                inside.take(one)
            elif one.word == "undef" and one.rest in inside._meanings:
                inside._meanings[one.rest] = tuple(dict.fromkeys((*inside._meanings[one.rest], *_NOTHING)))
        return inside

    def meanings(self, name: str) -> tuple[Meaning, ...]:
        """What a name may mean; one without a text if it may be no macro. None if it is none for sure."""
        known = self._meanings.get(name, ())
        if len(known) <= 1:
            return () if known == _NOTHING else known
        if all(one.text is not None for one in known):
            return known
        others = tuple(Meaning(text) for text in self._elsewhere.get(name, ()))
        return tuple(dict.fromkeys((*known, *others)))

    def may_differ(self, words: Iterable[str]) -> bool:
        """Whether one of some words, or of those that they mean, has several meanings."""
        seen: set[str] = set()
        ahead = list(words)
        while ahead:
            word = ahead.pop()
            if word not in seen:
                seen.add(word)
                meanings = self.meanings(word)
                if len(meanings) > 1:
                    return True
                ahead += [inner for one in meanings for inner in _WORD.findall(one.text or "")]
        return False


class _Branches:
    """What happens to macros in the branches of a condition that begins on a line."""

    def __init__(self, line: int) -> None:
        self.line = line
        self.before: dict[str, tuple[Meaning, ...]] = {}
        self._ends: list[dict[str, tuple[Meaning, ...]]] = []
        self._is_whole = False

    def next(self, macros: dict[str, tuple[Meaning, ...]], *, is_last: bool) -> None:
        """End a branch, and begin another one, with the macros that were there before all of them."""
        self._is_whole = self._is_whole or is_last
        self._ends.append({name: macros[name] for name in self.before})
        macros.update(self.before)

    def joined(self, macros: dict[str, tuple[Meaning, ...]]) -> Iterator[tuple[str, tuple[Meaning, ...]]]:
        """The macros that a branch has changed, with what they may mean behind all of them."""
        self.next(macros, is_last=False)
        for name, before in self.before.items():
            ends = [end.get(name, before) for end in self._ends] + ([] if self._is_whole else [before])
            yield name, tuple(dict.fromkeys(one for end in ends for one in end))
