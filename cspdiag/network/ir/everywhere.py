"""Rewrites parts of nested records."""

from __future__ import annotations

from collections.abc import Callable
from operator import is_
from typing import Any, TypeVar

from cspdiag.base.record import annotations_of, field_names, is_record, replaced
from cspdiag.network.ir.walk import may_have_records

T = TypeVar("T")

LEFT_ALONE = frozenset({"span", "type", "doc"})


def rewritten(item: T, change: Callable[[Any], Any]) -> T:
    """``item`` with ``change`` applied to every record in it, innermost first, except spans and types.

    Unchanged parts stay the same objects.
    """
    if isinstance(item, tuple):
        entries: Any = tuple([rewritten(entry, change) for entry in item]) if item else item
        return item if all(map(is_, entries, item)) else entries
    names = fields_inside(item)
    if names is None:
        return item
    changes = {}
    for name in names:
        old = getattr(item, name)
        if old is not None:
            new = rewritten(old, change)
            if new is not old:
                changes[name] = new
    result: T = change(replaced(item, **changes) if changes else item)
    return result


_INSIDE: dict[type, tuple[str, ...] | None] = {}
"""The fields of a record to search, by type; None if it is not a record. Cached, since networks have millions of
parts.
"""


def fields_inside(item: object) -> tuple[str, ...] | None:
    """The fields of a record in which there may be others; None for everything else."""
    try:
        return _INSIDE[type(item)]
    except KeyError:
        names = _INSIDE[type(item)] = _names_inside(item)
        return names


def _names_inside(item: object) -> tuple[str, ...] | None:
    if not is_record(item):
        return None
    kinds = annotations_of(type(item))
    return tuple(name for name in field_names(item) if name not in LEFT_ALONE and may_have_records(kinds[name]))
