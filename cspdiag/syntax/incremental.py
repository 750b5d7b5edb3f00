"""Parses a text again after a change: only the definitions in which something has changed.

Between two definitions the parser is always in the same state, and what it makes of a definition without mistakes
depends on nothing before it. So it can pass over such a definition, and take the node that it has made of it before, if
the characters are the same from the end of the token before it to the end of the token that follows it. Definitions
with mistakes are always read again: which mistakes are reported depends on those before.
"""

from __future__ import annotations

from cspdiag.base import Diagnostic, Report, SourceFile
from cspdiag.base.record import ATOMS, annotations_of, record
from cspdiag.base.span import Span, move
from cspdiag.syntax import ast
from cspdiag.syntax.parse.lexer import Previous
from cspdiag.syntax.parse.tables import END
from cspdiag.syntax.parser import Parser


@record
class Parsed:
    """A text that was parsed: its tree, the mistakes in it, and the definitions that can be used again."""

    source: SourceFile
    tree: ast.SourceTree
    mistakes: list[Diagnostic]
    known: list[KnownItem]


class KnownItem:
    """A definition, import or assertion without mistakes.

    ``last`` is its last token; ``following`` the token after that, which the parser has to see before it knows that the
    item ends. ``comments`` are those after the first token and before the following one, ``docs`` the doc comments
    among them that belong to nothing inside, by the offset of the token after them.
    """

    def __init__(
        self,
        item: ast.Item,
        after: int,
        first: Previous,
        last: Previous,
        following: Previous,
        comments: list[ast.Comment],
        docs: dict[int, list[ast.Comment]],
        has_doc: bool,
    ) -> None:
        self.item = item
        self.after = after
        """The offset of the end of the token before it, 0 if there is none."""
        self.first = first
        self.last = last
        self.following = following
        self.comments = comments
        self.docs = docs
        self.has_doc = has_doc
        """Whether it has taken the doc comment before its first token."""
        self._spans = spans_in(item, *comments)

    @property
    def reach(self) -> int:
        """The offset after the last character on which it depends: one after the following token, which ends there."""
        return self.following.end + 1

    def move(self, source: SourceFile, by: int) -> None:
        """Give it its place in another text."""
        move(self._spans, source, by)
        if by:
            self.after += by
            self.first, self.last = _moved(self.first, by), _moved(self.last, by)
            self.following = _moved(self.following, by)
            self.docs = {offset + by: docs for offset, docs in self.docs.items()}


def parse_again(source: SourceFile, previous: Parsed | None) -> Parsed:
    """The same as parsing a text from its beginning, faster if it is similar to the previous one.

    The nodes of definitions that did not change are the previous ones, which get the places that they have now. So the
    previous tree cannot be used any more.
    """
    report = _CountingReport()
    parser = _IncrementalParser(source, report, previous)
    tree = parser.run()
    return Parsed(source, tree, report.diagnostics, parser.known)


class _CountingReport(Report):
    """Counts also what is reported twice."""

    def __init__(self) -> None:
        super().__init__()
        self.count = 0

    def add(self, diagnostic: Diagnostic) -> None:
        """Add a diagnostic."""
        self.count += 1
        super().add(diagnostic)


@record
class _Beginning:
    """The state at the beginning of a definition; the counts are those of the comments and mistakes before."""

    after: int
    first: Previous
    comments: int
    mistakes: int
    has_doc: bool


class _IncrementalParser(Parser):
    """A parser that passes over what it knows, and remembers what it reads."""

    report: _CountingReport

    def __init__(self, source: SourceFile, report: _CountingReport, previous: Parsed | None) -> None:
        super().__init__(source, report)
        self.known: list[KnownItem] = []
        self._repairs = 0
        self._list_state = self.automaton.tables.gotos[self.states[0]][_LIST]
        self._reusable = {} if previous is None else _reusable(previous, source)

    def run(self) -> ast.SourceTree:
        """Read the whole file."""
        tables = self.automaton.tables
        actions, lexer, states = tables.actions, self.lexer, self.states
        lexer.advance(actions[states[-1]])
        beginning: _Beginning | None = None
        while True:
            if self._is_between_items() and (beginning is None or lexer.start != beginning.first.start):
                if beginning is not None:
                    self._remember(beginning)
                while self._pass_over_known():
                    pass
                beginning = self._beginning()
            action = actions[states[-1]].get(lexer.kind)
            if action is None:
                if lexer.kind == END and tables.symbols[states[-1]] == "start":
                    return self._tree(self.values[0])
                self._repair()
            elif action >= 0:
                self._shift(action)
            else:
                self._reduce(~action)

    def _is_between_items(self) -> bool:
        states = self.states
        return len(states) == 1 or (len(states) == 2 and states[1] == self._list_state)

    def _repair(self) -> None:
        self._repairs += 1
        super()._repair()

    def _skip(self) -> None:
        self._repairs += 1
        super()._skip()

    @property
    def _mistakes(self) -> int:
        return self._repairs + self.report.count + self.lexer.mistakes

    def _beginning(self) -> _Beginning:
        lexer = self.lexer
        return _Beginning(
            after=lexer.before.end,
            first=lexer.present,
            comments=len(lexer.comments),
            mistakes=self._mistakes,
            has_doc=lexer.start in lexer.docs,
        )

    def _remember(self, beginning: _Beginning) -> None:
        """Remember the definition between two places, if it has no mistake."""
        if beginning.mistakes != self._mistakes:
            return
        lexer, start = self.lexer, beginning.first.start
        known = KnownItem(
            item=self.values[0][-1],
            after=beginning.after,
            first=beginning.first,
            last=lexer.before,
            following=lexer.present,
            comments=lexer.comments[beginning.comments :],
            docs={offset: docs for offset, docs in lexer.docs.items() if offset > start},
            has_doc=beginning.has_doc and start not in lexer.docs,
        )
        self.known.append(known)

    def _pass_over_known(self) -> bool:
        """Pass over the definition that begins with the present token; False if it has to be read."""
        lexer = self.lexer
        found = self._reusable.get(lexer.start)
        if found is None:
            return False
        known, by = found
        if _moved(known.first, by) != lexer.present or known.after + by != lexer.before.end:
            return False
        known.move(self.source, by)
        if known.has_doc:
            del lexer.docs[lexer.start]
        if len(self.states) == 1:
            self.states.append(self._list_state)
            self.values.append([known.item])
            self.starts.append(lexer.start)
            self.depths.append(0)
        else:
            self.values[0].append(known.item)
        lexer.comments += known.comments
        lexer.docs.update(known.docs)
        lexer.pass_over(known.last, known.following)
        self._end_of_last_token = known.last.end
        self.known.append(known)
        return True


_LIST = "__start_star_0"
"""The rule that Lark makes for the list of the items of a file."""


def _moved(token: Previous, by: int) -> Previous:
    return token._replace(start=token.start + by, end=token.end + by) if by else token


def _reusable(previous: Parsed, source: SourceFile) -> dict[int, tuple[KnownItem, int]]:
    """The definitions of which nothing has changed, with the distance by which they have moved, by where they begin."""
    old, new = previous.source.text, source.text
    by = len(new) - len(old)
    same_before = _common_beginning(old, new)
    same_after = _common_end(old, new, min(len(old), len(new)) - same_before)
    found = {}
    for known in previous.known:
        if known.reach <= same_before:
            found[known.first.start] = known, 0
        elif known.after >= len(old) - same_after:
            found[known.first.start + by] = known, by
    return found


_LONGEST_COMPARED = 1 << 16
"""Characters that are compared at once, a power of two."""


def _common_beginning(old: str, new: str) -> int:
    at, size = 0, _LONGEST_COMPARED
    most = min(len(old), len(new))
    while size:
        while at + size <= most and old[at : at + size] == new[at : at + size]:
            at += size
        size //= 2
    return at


def _common_end(old: str, new: str, most: int) -> int:
    at, size = 0, _LONGEST_COMPARED
    while size:
        while at + size <= most and (
            old[len(old) - at - size : len(old) - at] == new[len(new) - at - size : len(new) - at]
        ):
            at += size
        size //= 2
    return at


_INSIDE: dict[type, tuple[str, ...]] = {}
"""The fields of each class of nodes that may hold places or nodes; none for other values."""


def _fields_inside(kind: type) -> tuple[str, ...]:
    if not hasattr(kind, "__record_fields__"):
        return ()
    return tuple(name for name, type_ in annotations_of(kind).items() if type_ not in ATOMS)


def spans_in(*roots: ast.Item | ast.Comment) -> list[Span]:
    """The places of the roots and of everything below them, each once."""
    found: dict[int, Span] = {}
    pending: list[object] = list(roots)
    while pending:
        item = pending.pop()
        if isinstance(item, Span):
            found[id(item)] = item
        elif isinstance(item, tuple):
            pending.extend(item)
        else:
            kind = type(item)
            names = _INSIDE.get(kind)
            if names is None:
                names = _INSIDE[kind] = _fields_inside(kind)
            pending.extend([getattr(item, name) for name in names])
    return list(found.values())
