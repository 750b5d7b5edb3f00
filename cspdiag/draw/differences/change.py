"""A change, and the comparison that finds changes in what definitions consist of."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Literal, TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import record, replaced
from cspdiag.draw.elements.texts import same_text

Action: TypeAlias = Literal["added", "removed", "changed", "renamed"]


@record
class DefinitionPart:
    """Something that a definition consists of: its name, its aspects (``type``, ``period``) with their texts, and where
    it is.

    ``key`` is the element of the diagram that shows it, if any; ``text`` is the part as a reader knows it.
    """

    text: str
    aspects: Mapping[str, str]
    key: str = ""
    span: Span | None = None


Parts: TypeAlias = "dict[tuple[str, str], DefinitionPart]"
"""By subject (``port``, ``instance``) and name."""


@record(kw_only=True)
class Change:
    """One difference. ``definition`` is the definition it is in, ``kind`` what that is (``process``); ``subject`` and
    ``name`` are empty for the definition itself.

    ``aspect`` says in what respect a changed part differs; ``before`` and ``after`` are texts, None if there is
    nothing.
    """

    action: Action
    kind: str
    definition: str
    subject: str = ""
    name: str = ""
    aspect: str = ""
    before: str | None = None
    after: str | None = None
    key: str = ""
    span_before: Span | None = None
    span_after: Span | None = None

    uncompared = frozenset({"span_before", "span_after"})


_WITH_UNIT = re.compile(r"(?P<name>\w+)(?:<(?P<unit>[^>]*)>)?(?P<sizes>.*)")


def compare(kind: str, definition: str, before: Parts, after: Parts) -> list[Change]:
    """The parts that were added, removed, or changed; in the order of ``after``, removed ones in the order of
    ``before``.
    """
    changes: list[Change] = []
    for subject, name in _in_order(before, after):
        old, new = before.get((subject, name)), after.get((subject, name))
        shown = new or old
        assert shown is not None
        place = Change(
            action="changed",
            kind=kind,
            definition=definition,
            subject=subject,
            name=name,
            key=shown.key,
            span_before=None if old is None else old.span,
            span_after=None if new is None else new.span,
        )
        if old is None or new is None:
            texts = (old.text if old is not None else None, new.text if new is not None else None)
            changes.append(_with(place, "added" if old is None else "removed", "", *texts))
            continue
        for aspect in dict.fromkeys((*old.aspects, *new.aspects)):
            one, other = old.aspects.get(aspect, ""), new.aspects.get(aspect, "")
            if same_text(one, other) or (aspect == "inferred kind" and not (one and other)):
                continue
            changes.append(_with(place, "changed", *narrowed(aspect, one, other)))
    return changes


def narrowed(aspect: str, before: str, after: str) -> tuple[str, str | None, str | None]:
    """The aspect and its two texts; for types that differ only in their units, the units; for lists of ends, those that
    were removed and added.
    """
    if aspect in ("from", "to"):
        old_ends, new_ends = before.split(", "), after.split(", ")
        removed = ", ".join(end for end in old_ends if end not in new_ends)
        added = ", ".join(end for end in new_ends if end not in old_ends)
        return aspect, removed or None, added or None
    if aspect == "type":
        old, new = _WITH_UNIT.fullmatch(before), _WITH_UNIT.fullmatch(after)
        if old and new and old["unit"] != new["unit"] and (old["name"], old["sizes"]) == (new["name"], new["sizes"]):
            return "unit", old["unit"] or "1", new["unit"] or "1"
    return aspect, before or None, after or None


def _with(place: Change, action: Action, aspect: str, before: str | None, after: str | None) -> Change:
    return replaced(place, action=action, aspect=aspect, before=before, after=after)


def _in_order(before: Parts, after: Parts) -> Iterable[tuple[str, str]]:
    """The parts of both; removed ones are placed after the ones that they followed."""
    order = list(after)
    previous: tuple[str, str] | None = None
    for key in before:
        if key not in after:
            order.insert(0 if previous is None else order.index(previous) + 1, key)
        previous = key
    return order
