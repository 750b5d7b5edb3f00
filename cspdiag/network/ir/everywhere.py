"""Rewrites parts of nested records."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from cspdiag.base.record import field_names, is_record, replaced

T = TypeVar("T")

LEFT_ALONE = frozenset({"span", "type", "doc"})


def rewritten(item: T, change: Callable[[Any], Any]) -> T:
    """``item`` with ``change`` applied to every record in it, innermost first, except spans and types.

    Unchanged parts stay the same objects.
    """
    if isinstance(item, tuple):
        entries: Any = tuple([rewritten(entry, change) for entry in item])
        return item if all(new is old for new, old in zip(entries, item, strict=True)) else entries
    names = _INSIDE.get(type(item))
    if names is None:
        names = _INSIDE[type(item)] = _names_inside(item)
    if not names and not is_record(item):
        return item
    changes = {}
    for name in names:
        old = getattr(item, name)
        if isinstance(old, tuple) or is_record(old):
            new = rewritten(old, change)
            if new is not old:
                changes[name] = new
    result: T = change(replaced(item, **changes) if changes else item)
    return result


_INSIDE: dict[type, tuple[str, ...]] = {}
"""The fields to search, by type; cached, since networks have millions of parts."""


def _names_inside(item: object) -> tuple[str, ...]:
    return tuple(name for name in field_names(item) if name not in LEFT_ALONE) if is_record(item) else ()
