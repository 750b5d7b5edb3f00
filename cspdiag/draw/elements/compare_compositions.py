"""Compares two composition diagrams: one diagram with the elements of both, and marks on those that were added, removed
or changed.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import takewhile
from typing import Literal, TypeAlias, assert_never, cast

from cspdiag.base import Span
from cspdiag.base.record import record
from cspdiag.draw.elements.composition import (
    OPERATORS,
    Activity,
    Case,
    Chain,
    Choice,
    Composition,
    CompositionDiagram,
    Condition,
    Guard,
    Guarded,
    Handler,
    Inside,
    Loop,
    NamedGroup,
    Part,
    PartT,
    Replication,
    Watched,
    parts,
    rebuilt,
    walk,
)
from cspdiag.draw.elements.marks import Mark
from cspdiag.draw.elements.texts import meaning, same_text, written_span
from cspdiag.syntax.parse.nesting import raised_recursion_limit

Action: TypeAlias = Literal["added", "removed", "changed"]
_Content: TypeAlias = tuple[object, ...]
_Pair: TypeAlias = tuple[Part | None, Part | None]
_NO_NAMES: Mapping[str, str] = {}


@record
class StepChange:
    """One difference, at the element ``key`` of the common diagram.

    ``subject`` says what was added, removed or changed (``process``, ``guard``, ``condition``, ``operator``, …);
    ``before`` and
    ``after`` are texts, None if there is nothing.
    """

    action: Action
    subject: str
    key: str
    before: str | None
    after: str | None
    span_before: Span | None
    span_after: Span | None

    def __str__(self) -> str:
        match self.action:
            case "added":
                return f"{self.subject} {self.after} added"
            case "removed":
                return f"{self.subject} {self.before} removed"
            case "changed":
                return f"{self.subject} {self.before} → {self.after}"
            case _:
                assert_never(self.action)


@record
class Compared:
    """``diagram`` also has what was removed; ``marks`` are by the keys of its elements."""

    diagram: CompositionDiagram
    marks: dict[str, Mark]
    changes: tuple[StepChange, ...]


@raised_recursion_limit()
def compared(before: CompositionDiagram, after: CompositionDiagram, names: Mapping[str, str] = _NO_NAMES) -> Compared:
    """What differs between two versions of a composition; ``names`` maps former names to present ones."""
    comparison = _Comparison(names)
    old, new = before.root, after.root
    root: Composition | None = None
    if old is not None and new is not None:
        root = comparison.merged(old, new, "1")
    elif new is not None:
        root = comparison.whole(new, "1", "added")
    elif old is not None:
        root = comparison.whole(old, "1", "removed")
    diagram = CompositionDiagram(key=after.key, doc=after.doc, spans=after.spans, root=root)
    return Compared(diagram, comparison.marks, tuple(comparison.changes))


def own_text(element: Part) -> str:
    """The text of an element itself, without its parts."""
    match element:
        case Activity():
            return element.text
        case Guard():
            return element.text if element.condition is None else f"when {element.condition} & {element.text}"
        case Chain():
            return OPERATORS[element.operator, element.prioritized]
        case Loop():
            return element.form
        case Condition():
            return element.text
        case Case():
            return f"if {element.condition}"
        case Handler():
            return f"catch {element.exception}" if element.guard is None else "interrupt"
        case Replication():
            return f"{OPERATORS[element.operator, element.prioritized]} for {element.replicator}"
        case NamedGroup():
            return f"{element.label}:"
        case Inside():
            return element.text
        case Guarded() | Choice() | Watched():
            return ""


def _subject(element: Part) -> str:
    match element:
        case Guard():
            return "guard"
        case Chain():
            return "operator"
        case Loop():
            return "loop"
        case Case() | Condition():
            return "condition"
        case Handler():
            return "handler"
        case Replication():
            return "replication"
        case NamedGroup():
            return "group"
        case Activity() | Guarded() | Choice() | Watched() | Inside():
            return "process"
        case _:
            assert_never(element)


@dataclass
class _Comparison:
    names: Mapping[str, str]
    marks: dict[str, Mark] = field(default_factory=dict)
    changes: list[StepChange] = field(default_factory=list)
    contents: dict[int, _Content] = field(default_factory=dict)
    """The contents of elements with all their parts, by identity; both versions live as long as this."""

    def merged(self, old: PartT, new: PartT, key: str) -> PartT:
        """The element of the common diagram for two in the same place."""
        if self._content(old) == self._content(new):
            return _kept(new, key)
        if type(old) is not type(new):
            return self._replaced(old, new, key)
        if isinstance(new, Handler) and (new.guard is None) is not (cast("Handler", old).guard is None):
            return self._replaced(old, new, key)
        if not same_text(self._own(old), own_text(new)):
            self._changed(old, new, key, _subject(new), own_text(old), own_text(new))
        return rebuilt(new, key, self._merged_parts(old, new, key))

    def whole(self, element: PartT, key: str, action: Action) -> PartT:
        """An element that was added or removed with all its parts; only the element itself has a note."""
        text = _source(element)
        was_added = action == "added"
        span = element.spans[0] if element.spans else None
        change = StepChange(
            action,
            _subject(element) if isinstance(element, Guard | Condition | Case | Handler) else "process",
            key,
            None if was_added else text,
            text if was_added else None,
            None if was_added else span,
            span if was_added else None,
        )
        self._mark(key, change)
        kept = _kept(element, key)
        for part in walk(kept):
            if part.key != key:
                self.marks[part.key] = Mark(action)
        return kept

    def _replaced(self, old: Part, new: PartT, key: str) -> PartT:
        """An element of another kind that replaces the old one, and may contain it."""
        inner = parts(new)
        around = next((part for part in inner if self._content(part) == self._content(old)), None)
        if around is None:
            self._changed(old, new, key, "process", _source(old), _source(new))
            return _kept(new, key)
        if isinstance(new, Loop | Replication | NamedGroup):
            span = new.spans[0] if new.spans else None
            self._mark(key, StepChange("added", _subject(new), key, None, _head(new), None, span))
        found = [
            _kept(part, f"{key}.{number}")
            if part is around or isinstance(part, Condition)
            else self.whole(part, f"{key}.{number}", "added")
            for number, part in enumerate(inner, 1)
        ]
        return rebuilt(new, key, found)

    def _merged_parts(self, old: Part, new: Part, key: str) -> list[Part]:
        found: list[Part] = []
        for number, (one, other) in enumerate(self._pairs(old, new), 1):
            place = f"{key}.{number}"
            if one is not None and other is not None:
                found.append(self.merged(one, other, place))
            elif other is not None:
                found.append(self.whole(other, place, "added"))
            elif one is not None:
                found.append(self.whole(one, place, "removed"))
        return found

    def _pairs(self, old: Part, new: Part) -> list[_Pair]:
        match old, new:
            case Chain(), Chain():
                return self._aligned(old.parts, new.parts)
            case Choice(), Choice():
                otherwise: list[_Pair] = [(old.otherwise, new.otherwise)]
                return self._aligned(old.cases, new.cases) + otherwise * (otherwise != [(None, None)])
            case Loop(), Loop():
                conditions: list[_Pair] = [(old.condition, new.condition)]
                return [(old.process, new.process), *(conditions * (conditions != [(None, None)]))]
            case Watched(), Watched():
                return [(old.process, new.process), *self._aligned(old.handlers, new.handlers)]
            case _:  # Others have as many parts in both.
                return list(zip(parts(old), parts(new), strict=True))

    def _aligned(self, old: Sequence[Part], new: Sequence[Part]) -> list[_Pair]:
        """Pairs of corresponding parts of two lists, in order, as many and as similar as possible; a part without a
        partner is alone.
        """
        begin = self._common(old, new)
        end = self._common(reversed(old[begin:]), reversed(new[begin:]))
        before = list(zip(old[:begin], new[:begin], strict=True))
        after = list(zip(old[len(old) - end :], new[len(new) - end :], strict=True))
        return [*before, *self._matched(old[begin : len(old) - end], new[begin : len(new) - end]), *after]

    def _common(self, old: Iterable[Part], new: Iterable[Part]) -> int:
        """The number of parts at the beginning that are the same."""
        pairs = zip(old, new, strict=False)
        return sum(1 for _ in takewhile(lambda pair: self._content(pair[0]) == self._content(pair[1]), pairs))

    def _matched(self, old: Sequence[Part], new: Sequence[Part]) -> list[_Pair]:
        table = [[0] * (len(new) + 1) for _ in range(len(old) + 1)]
        for i in reversed(range(len(old))):
            for j in reversed(range(len(new))):
                together = table[i + 1][j + 1] + self._likeness(old[i], new[j])
                table[i][j] = max(together, table[i + 1][j], table[i][j + 1])
        pairs: list[_Pair] = []
        i = j = 0
        while i < len(old) or j < len(new):
            if i < len(old) and j < len(new):
                likeness = self._likeness(old[i], new[j])
                if likeness and table[i][j] == table[i + 1][j + 1] + likeness:
                    pairs.append((old[i], new[j]))
                    i, j = i + 1, j + 1
                    continue
            if i < len(old) and (j == len(new) or table[i][j] == table[i + 1][j]):
                pairs.append((old[i], None))
                i += 1
            else:
                pairs.append((None, new[j]))
                j += 1
        return pairs

    def _likeness(self, old: Part, new: Part) -> int:
        """How similar two elements are: 0 if they cannot correspond."""
        if self._content(old) == self._content(new):
            return 9
        if any(self._content(part) == self._content(old) for part in parts(new)):
            return 4
        if type(old) is not type(new):
            return 0
        match old, new:
            case Activity(), Activity():
                is_like = old.form == new.form != "run" and self._own(old).split()[0] == new.text.split()[0]
                return 2 * is_like
            case Guarded(), Guarded():
                same_guard = self._content(old.guard) == self._content(new.guard)
                same_process = self._content(old.process) == self._content(new.process)
                return 1 + 3 * same_guard + 2 * same_process
            case _:  # Other elements of one type are as similar as their own texts.
                return 2 + same_text(self._own(old), own_text(new))

    def _changed(self, old: Part, new: Part, key: str, subject: str, before: str, after: str) -> None:
        spans = [element.spans[0] if element.spans else None for element in (old, new)]
        self._mark(key, StepChange("changed", subject, key, before, after, *spans))

    def _mark(self, key: str, change: StepChange) -> None:
        self.changes.append(change)
        self.marks[key] = Mark(change.action, note=str(change))

    def _own(self, old: Part) -> str:
        """The text of an element of the old version with the new names."""
        text = own_text(old)
        return re.sub(r"\w+", lambda word: self.names.get(word[0], word[0]), text) if self.names else text

    def _content(self, element: Part) -> _Content:
        known = self.contents.get(id(element))
        if known is None:
            inner = (self._content(part) for part in parts(element))
            known = self.contents[id(element)] = (type(element), meaning(self._own(element)), *inner)
        return known


def _head(element: Part) -> str:
    """The text of an element itself, including the condition of a loop."""
    if not isinstance(element, Loop) or element.condition is None:
        return own_text(element)
    return f"while {element.condition.text}" if element.form == "while" else f"mu until {element.condition.text}"


def _kept(element: PartT, key: str) -> PartT:
    return rebuilt(element, key, [_kept(part, f"{key}.{number}") for number, part in enumerate(parts(element), 1)])


def _source(element: Part) -> str:
    """The text of the element, without what only encloses it."""
    match element:
        case Handler():
            guard = "" if element.guard is None else f" {own_text(element.guard)}"
            return f"{own_text(element)}{guard} -> {_source(element.process)}"
        case Case():
            return f"{own_text(element)} then {_source(element.process)}"
        case Activity() | Guard() | Condition():
            return own_text(element)
        case Chain() | Guarded() | Loop() | Choice() | Watched() | Replication() | NamedGroup() | Inside():
            return written_span(element.spans[0]) if element.spans else own_text(element)
        case _:
            assert_never(element)
